//! The tree of named frames: rotations as files write them, checked, and every frame's place in the base.

use std::collections::BTreeMap;

use jrdb_types::{Rotation, Transform};
use nalgebra::{Isometry3, Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};

/// Largest accepted entry of `|R Rᵀ - 1|`, and largest deviation of a quaternion's norm from 1. Calibration
/// files print six digits, which gives 1e-6; at 1e-4 a pixel of a 500 px lens would move by 0.05.
const MAX_DEVIATION: f64 = 1e-4;

/// Why numbers are no rotation or no place.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RotationError {
    /// A number is infinite or not a number.
    #[error("expected finite numbers, found {0}")]
    NotFinite(f64),
    /// The rows of the matrix are not of length one and at right angles.
    #[error(
        "expected a rotation matrix, found one whose rows are off orthonormal by {deviation:.1e} (at most {MAX_DEVIATION:.0e})"
    )]
    NotARotation {
        /// Largest entry of `|R Rᵀ - 1|`.
        deviation: f64,
    },
    /// The rows are orthonormal but left-handed.
    #[error("expected a rotation matrix, found one that mirrors (determinant -1)")]
    Mirrors,
    /// The quaternion's length is not one.
    #[error("expected a quaternion of norm 1, found {norm} (off by at most {MAX_DEVIATION:.0e})")]
    NotAUnitQuaternion {
        /// Its norm.
        norm: f64,
    },
}

/// Why transforms make no tree.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FrameError {
    /// The numbers of one transform.
    #[error("the transform of frame {child:?} in {parent:?} is unusable")]
    BadTransform {
        /// The placed frame.
        child: String,
        /// The frame in which it is placed.
        parent: String,
        /// What is wrong.
        #[source]
        source: RotationError,
    },
    /// A frame is placed twice.
    #[error(
        "expected one transform of frame {child:?}, found one in {first:?} and one in {second:?}"
    )]
    TwoParents {
        /// The frame.
        child: String,
        /// Where the first transform places it.
        first: String,
        /// Where the second does.
        second: String,
    },
    /// The base frame is placed in another.
    #[error("expected the base frame {base:?} to be the root, found it placed in {parent:?}")]
    BaseHasParent {
        /// The base frame.
        base: String,
        /// Where it is placed.
        parent: String,
    },
    /// Frames that are placed in each other.
    #[error("expected a tree of frames, found the cycle {}", frames.join(" in "))]
    Cycle {
        /// The frames of the cycle; the first is repeated at the end.
        frames: Vec<String>,
    },
    /// A frame leads to a root that is not the base.
    #[error("expected frame {frame:?} to hang on the base frame {base:?}, found it on {root:?}")]
    Unconnected {
        /// The frame.
        frame: String,
        /// Where its parents end.
        root: String,
        /// The base frame.
        base: String,
    },
    /// No transform places the frame.
    #[error("no transform places frame {frame:?}; there are {known:?}")]
    Unknown {
        /// The frame asked for.
        frame: String,
        /// The frames of the tree.
        known: Vec<String>,
    },
}

/// A rotation, checked.
///
/// A matrix whose rows are orthonormal to 1e-4 is taken as its nearest rotation.
///
/// ```
/// use jrdb_projection::frame::rotation;
/// use jrdb_types::Rotation;
///
/// let mirrored = Rotation::Matrix([[1., 0., 0.], [0., 1., 0.], [0., 0., -1.]]);
/// let error = rotation(&mirrored).unwrap_err();
/// assert_eq!(error.to_string(), "expected a rotation matrix, found one that mirrors (determinant -1)");
/// ```
///
/// # Errors
/// [`RotationError`], with how far off the numbers are.
pub fn rotation(rotation: &Rotation) -> Result<UnitQuaternion<f64>, RotationError> {
    match *rotation {
        Rotation::RpyRad(angles) => {
            finite(&angles)?;
            let [roll, pitch, yaw] = angles;
            Ok(UnitQuaternion::from_euler_angles(roll, pitch, yaw))
        }
        Rotation::QuaternionWxyz(numbers) => {
            finite(&numbers)?;
            let [w, x, y, z] = numbers;
            let quaternion = Quaternion::new(w, x, y, z);
            let norm = quaternion.norm();
            if (norm - 1.0).abs() > MAX_DEVIATION {
                return Err(RotationError::NotAUnitQuaternion { norm });
            }
            Ok(UnitQuaternion::from_quaternion(quaternion))
        }
        Rotation::Matrix(rows) => {
            finite(rows.as_flattened())?;
            let rotation = nearest_rotation(Matrix3::from(rows).transpose())?;
            Ok(UnitQuaternion::from_rotation_matrix(&rotation))
        }
    }
}

fn finite(numbers: &[f64]) -> Result<(), RotationError> {
    match numbers.iter().find(|number| !number.is_finite()) {
        Some(&bad) => Err(RotationError::NotFinite(bad)),
        None => Ok(()),
    }
}

fn nearest_rotation(mut matrix: Matrix3<f64>) -> Result<Rotation3<f64>, RotationError> {
    let deviation = (matrix * matrix.transpose() - Matrix3::identity()).amax();
    if deviation.is_nan() || deviation > MAX_DEVIATION {
        return Err(RotationError::NotARotation { deviation });
    }
    if matrix.determinant() < 0.0 {
        return Err(RotationError::Mirrors);
    }
    // Newton-Schulz steps to the polar factor: the deviation is squared by each, 1e-4 → 1e-8 → 1e-16.
    for _ in 0..2 {
        matrix = matrix * (Matrix3::identity() * 3.0 - matrix.transpose() * matrix) * 0.5;
    }
    Ok(Rotation3::from_matrix_unchecked(matrix))
}

/// Every frame's place in the base frame.
///
/// ```
/// use jrdb_projection::{frame::FrameTree, nalgebra::Point3};
/// use jrdb_types::{Rotation, Transform};
///
/// let place = |parent: &str, child: &str, translation_m, yaw: f64| Transform {
///     parent: parent.into(), child: child.into(), translation_m, rotation: Rotation::RpyRad([0.0, 0.0, yaw]),
/// };
/// let quarter = std::f64::consts::FRAC_PI_2;
/// let tree = FrameTree::new("base", &[
///     place("mast", "lidar", [0.0, 0.0, 0.5], 0.0),
///     place("base", "mast", [0.2, 0.0, 1.0], quarter), // the mast is turned to the left
/// ])?;
/// let in_base = tree.base_from("lidar")? * Point3::new(3.0, 0.0, 0.0);
/// assert!((in_base - Point3::new(0.2, 3.0, 1.5)).norm() < 1e-12);
/// # Ok::<(), jrdb_projection::frame::FrameError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct FrameTree {
    base_from: BTreeMap<String, Isometry3<f64>>,
}

impl FrameTree {
    /// Checks the transforms and chains them up to the base frame.
    ///
    /// # Errors
    /// [`FrameError`] names the frame and what is wrong with it.
    pub fn new(base: &str, transforms: &[Transform]) -> Result<Self, FrameError> {
        let parents = parents(base, transforms)?;
        let mut base_from = BTreeMap::from([(base.to_owned(), Isometry3::identity())]);
        for child in parents.keys() {
            let chain = chain(child, base, &parents)?;
            let place = chain.iter().fold(Isometry3::identity(), |place, (_, step)| step * place);
            base_from.insert((*child).to_owned(), place);
        }
        Ok(Self { base_from })
    }

    /// The transform that takes points of a frame to the base frame, metres.
    ///
    /// # Errors
    /// [`FrameError::Unknown`].
    pub fn base_from(&self, frame: &str) -> Result<Isometry3<f64>, FrameError> {
        self.base_from.get(frame).copied().ok_or_else(|| FrameError::Unknown {
            frame: frame.into(),
            known: self.base_from.keys().cloned().collect(),
        })
    }
}

/// A frame's parent and its place there.
type Parent<'a> = (&'a str, Isometry3<f64>);

fn parents<'a>(
    base: &str,
    transforms: &'a [Transform],
) -> Result<BTreeMap<&'a str, Parent<'a>>, FrameError> {
    let mut parents: BTreeMap<&str, Parent<'_>> = BTreeMap::new();
    for transform in transforms {
        let (child, parent) = (transform.child.as_str(), transform.parent.as_str());
        if child == base {
            return Err(FrameError::BaseHasParent { base: base.into(), parent: parent.into() });
        }
        if let Some((first, _)) = parents.insert(child, (parent, isometry(transform)?)) {
            let (child, first, second) = (child.into(), first.into(), parent.into());
            return Err(FrameError::TwoParents { child, first, second });
        }
    }
    Ok(parents)
}

fn isometry(transform: &Transform) -> Result<Isometry3<f64>, FrameError> {
    let place = || {
        finite(&transform.translation_m)?;
        let rotation = rotation(&transform.rotation)?;
        Ok(Isometry3::from_parts(Vector3::from(transform.translation_m).into(), rotation))
    };
    place().map_err(|source| FrameError::BadTransform {
        child: transform.child.clone(),
        parent: transform.parent.clone(),
        source,
    })
}

/// The steps from a frame up to the base.
fn chain<'a>(
    child: &'a str,
    base: &str,
    parents: &BTreeMap<&'a str, Parent<'a>>,
) -> Result<Vec<Parent<'a>>, FrameError> {
    let mut steps: Vec<Parent<'_>> = Vec::new();
    let mut frame = child;
    while frame != base {
        let Some(&(parent, step)) = parents.get(frame) else {
            let (child, root, base) = (child.into(), frame.into(), base.into());
            return Err(FrameError::Unconnected { frame: child, root, base });
        };
        steps.push((parent, step));
        // A walk longer than there are frames has met one twice.
        if steps.len() > parents.len() {
            return Err(cycle(parent, parents));
        }
        frame = parent;
    }
    Ok(steps)
}

fn cycle(start: &str, parents: &BTreeMap<&str, Parent<'_>>) -> FrameError {
    let mut frames = vec![start.to_owned()];
    let mut frame = parents[start].0;
    while frame != start {
        frames.push(frame.into());
        frame = parents[frame].0;
    }
    let first = frames.iter().enumerate().min_by_key(|(_, name)| *name).map_or(0, |(at, _)| at);
    frames.rotate_left(first);
    frames.push(frames[0].clone());
    FrameError::Cycle { frames }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;
    use proptest::prelude::*;

    fn place(parent: &str, child: &str) -> Transform {
        let (translation_m, rotation) = ([1.0, 0.0, 0.0], Rotation::RpyRad([0.0, 0.0, 0.1]));
        Transform { parent: parent.into(), child: child.into(), translation_m, rotation }
    }

    fn error(transforms: &[Transform]) -> String {
        FrameTree::new("base", transforms).unwrap_err().to_string()
    }

    #[test]
    fn frames_chain_up_to_the_base_in_any_order_of_the_file() {
        let steps = [place("a", "b"), place("base", "a"), place("b", "c")];
        let tree = FrameTree::new("base", &steps).unwrap();
        let one = Isometry3::from_parts(
            Vector3::x().into(),
            UnitQuaternion::from_euler_angles(0.0, 0.0, 0.1),
        );
        assert!(
            (tree.base_from("c").unwrap().to_homogeneous() - (one * one * one).to_homogeneous())
                .amax()
                < 1e-15
        );
        assert_eq!(tree.base_from("base").unwrap(), Isometry3::identity());
    }

    #[test]
    fn what_is_no_tree_is_named() {
        assert_eq!(
            error(&[place("b", "a"), place("c", "b"), place("a", "c"), place("a", "d")]),
            r#"expected a tree of frames, found the cycle a in b in c in a"#
        );
        assert_eq!(
            error(&[place("base", "a"), place("b", "a")]),
            r#"expected one transform of frame "a", found one in "base" and one in "b""#
        );
        assert_eq!(
            error(&[place("map", "base")]),
            r#"expected the base frame "base" to be the root, found it placed in "map""#
        );
        assert_eq!(
            error(&[place("map", "a")]),
            r#"expected frame "a" to hang on the base frame "base", found it on "map""#
        );
        let tree = FrameTree::new("base", &[place("base", "a")]).unwrap();
        assert_eq!(
            tree.base_from("b").unwrap_err().to_string(),
            r#"no transform places frame "b"; there are ["a", "base"]"#
        );
        assert!(error(&[place("a", "a")]).ends_with("the cycle a in a"));
    }

    #[test]
    fn numbers_that_are_no_rotation_are_refused_with_how_far_off_they_are() {
        let message = |numbers: Rotation| rotation(&numbers).unwrap_err().to_string();
        let scaled = [[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.1, 0.0, 0.0]];
        assert_eq!(
            message(Rotation::Matrix(scaled)),
            "expected a rotation matrix, found one whose rows are off orthonormal by 2.1e-1 (at most 1e-4)"
        );
        assert_eq!(
            message(Rotation::QuaternionWxyz([1.0, 1.0, 0.0, 0.0])),
            format!(
                "expected a quaternion of norm 1, found {} (off by at most 1e-4)",
                2.0_f64.sqrt()
            )
        );
        assert_eq!(
            message(Rotation::RpyRad([0.0, f64::NAN, 0.0])),
            "expected finite numbers, found NaN"
        );
        assert!(rotation(&Rotation::Matrix([[1e200; 3]; 3])).is_err());
        let mut bad = place("base", "a");
        bad.translation_m[1] = f64::INFINITY;
        assert_eq!(error(&[bad]), r#"the transform of frame "a" in "base" is unusable"#);
    }

    #[test]
    fn roll_pitch_and_yaw_turn_about_the_fixed_axes_in_this_order() {
        let turned = rotation(&Rotation::RpyRad([0.3, -0.2, 1.1])).unwrap();
        let about = |axis, angle| UnitQuaternion::from_axis_angle(&axis, angle);
        let expected = about(Vector3::z_axis(), 1.1)
            * about(Vector3::y_axis(), -0.2)
            * about(Vector3::x_axis(), 0.3);
        assert!(turned.angle_to(&expected) < 1e-12);
    }

    #[test]
    fn six_printed_digits_are_enough() {
        let printed = [
            [0.305706, -0.00895443, -0.952084],
            [0.0110396, 0.999922, -0.00585963],
            [0.952062, -0.0087193, 0.305781],
        ];
        let matrix = rotation(&Rotation::Matrix(printed)).unwrap().to_rotation_matrix();
        let matrix = matrix.into_inner();
        assert!((matrix * matrix.transpose() - Matrix3::identity()).amax() < 1e-15);
        assert!((matrix - Matrix3::from(printed).transpose()).amax() < 2e-6);
    }

    proptest! {
        #[test]
        fn the_three_ways_to_write_a_rotation_agree(axis in prop::array::uniform3(-3.0..3.0)) {
            let turn = UnitQuaternion::new(Vector3::from(axis));
            let (roll, pitch, yaw) = turn.euler_angles();
            let matrix = turn.to_rotation_matrix().into_inner();
            let rows = [0, 1, 2].map(|i| [0, 1, 2].map(|j| matrix[(i, j)]));
            let point = Point3::new(1.0, 2.0, 3.0);
            for written in [
                Rotation::RpyRad([roll, pitch, yaw]),
                Rotation::QuaternionWxyz([turn.w, turn.i, turn.j, turn.k]),
                Rotation::Matrix(rows),
            ] {
                let read = rotation(&written).unwrap();
                prop_assert!((read * point - turn * point).norm() < 1e-6, "{written:?}");
            }
        }
    }
}
