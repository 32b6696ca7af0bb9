//! The file layout of a pose, and the check that its matrix is a rotation.

use nalgebra::{Isometry3, Matrix3, Rotation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

/// Largest accepted entry of `|R Rᵀ - 1|`. Calibration files print six digits, which gives 1e-6; at
/// 1e-4 a pixel of a 500 px lens would move by 0.05.
const MAX_DEVIATION: f64 = 1e-4;

/// A rigid transform `p ↦ R p + t` as calibration files write it; becomes an [`Isometry3`] once checked.
///
/// A matrix whose rows are orthonormal to 1e-4 is taken as its nearest rotation.
///
/// ```
/// use jrdb_projection::camera::Pose;
/// use jrdb_projection::nalgebra::Isometry3;
///
/// let mirrored = Pose { rotation: [[1., 0., 0.], [0., 1., 0.], [0., 0., -1.]], translation_m: [0.; 3] };
/// let error = Isometry3::try_from(mirrored).unwrap_err();
/// assert_eq!(error.to_string(), "expected a rotation matrix, found one that mirrors (determinant -1)");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pose {
    /// R, row by row.
    pub rotation: [[f64; 3]; 3],
    /// t, metres, in the target frame: added after the rotation.
    pub translation_m: [f64; 3],
}

/// Why a [`Pose`] is not a rigid transform.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PoseError {
    /// An entry is infinite or not a number.
    #[error("expected finite numbers in a pose, found {0}")]
    NotFinite(f64),
    /// The rows are not of length one and at right angles.
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
}

impl TryFrom<Pose> for Isometry3<f64> {
    type Error = PoseError;

    fn try_from(pose: Pose) -> Result<Self, PoseError> {
        let mut numbers = pose.rotation.iter().flatten().chain(&pose.translation_m);
        if let Some(&bad) = numbers.find(|n| !n.is_finite()) {
            return Err(PoseError::NotFinite(bad));
        }
        let rotation = nearest_rotation(Matrix3::from(pose.rotation).transpose())?;
        let translation = Vector3::from(pose.translation_m);
        Ok(Self::from_parts(translation.into(), UnitQuaternion::from_rotation_matrix(&rotation)))
    }
}

impl From<Isometry3<f64>> for Pose {
    fn from(isometry: Isometry3<f64>) -> Self {
        let matrix = isometry.rotation.to_rotation_matrix().into_inner();
        Self {
            rotation: matrix.transpose().into(),
            translation_m: isometry.translation.vector.into(),
        }
    }
}

fn nearest_rotation(mut matrix: Matrix3<f64>) -> Result<Rotation3<f64>, PoseError> {
    let deviation = (matrix * matrix.transpose() - Matrix3::identity()).amax();
    if deviation.is_nan() || deviation > MAX_DEVIATION {
        return Err(PoseError::NotARotation { deviation });
    }
    if matrix.determinant() < 0.0 {
        return Err(PoseError::Mirrors);
    }
    // Newton-Schulz steps to the polar factor: the deviation is squared by each, 1e-4 → 1e-8 → 1e-16.
    for _ in 0..2 {
        matrix = matrix * (Matrix3::identity() * 3.0 - matrix.transpose() * matrix) * 0.5;
    }
    Ok(Rotation3::from_matrix_unchecked(matrix))
}

/// Serde form of an [`Isometry3`]: a checked [`Pose`].
pub(super) mod layout {
    use nalgebra::Isometry3;
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use super::Pose;

    pub(in crate::camera) fn serialize<S: Serializer>(
        isometry: &Isometry3<f64>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        Pose::from(*isometry).serialize(serializer)
    }

    pub(in crate::camera) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Isometry3<f64>, D::Error> {
        Isometry3::try_from(Pose::deserialize(deserializer)?).map_err(D::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;
    use proptest::prelude::*;

    const TURNED: [[f64; 3]; 3] = [[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]];

    fn pose(rotation: [[f64; 3]; 3]) -> Pose {
        Pose { rotation, translation_m: [1.0, 2.0, 3.0] }
    }

    #[test]
    fn rows_are_rows() {
        let camera_from_base = Isometry3::try_from(pose(TURNED)).unwrap();
        let forward = camera_from_base * Point3::new(5.0, 0.0, 0.0);
        assert!((forward - Point3::new(1.0, 2.0, 8.0)).norm() < 1e-15);
    }

    #[test]
    fn a_matrix_that_is_no_rotation_is_refused_with_its_deviation() {
        let mut scaled = TURNED;
        scaled[2][0] = 1.1;
        let error = Isometry3::try_from(pose(scaled)).unwrap_err();
        assert_eq!(
            error.to_string(),
            "expected a rotation matrix, found one whose rows are off orthonormal by 2.1e-1 (at most 1e-4)"
        );
        scaled[2][0] = f64::INFINITY;
        assert_eq!(
            Isometry3::try_from(pose(scaled)).unwrap_err(),
            PoseError::NotFinite(f64::INFINITY)
        );
        scaled[2][0] = 1e200;
        assert!(Isometry3::try_from(pose(scaled)).is_err());
    }

    #[test]
    fn six_printed_digits_are_enough() {
        let printed = [
            [0.305706, -0.00895443, -0.952084],
            [0.0110396, 0.999922, -0.00585963],
            [0.952062, -0.0087193, 0.305781],
        ];
        let isometry = Isometry3::try_from(pose(printed)).unwrap();
        let matrix = Matrix3::from(Pose::from(isometry).rotation);
        assert!((matrix * matrix.transpose() - Matrix3::identity()).amax() < 1e-15);
        assert!((matrix - Matrix3::from(printed)).amax() < 2e-6);
    }

    proptest! {
        #[test]
        fn every_rotation_survives_its_file(axis in prop::array::uniform3(-3.0..3.0)) {
            let isometry = Isometry3::new(Vector3::new(1.0, 2.0, 3.0), Vector3::from(axis));
            let again = Isometry3::try_from(Pose::from(isometry)).unwrap();
            prop_assert!(again.rotation.angle_to(&isometry.rotation) < 1e-7);
            prop_assert_eq!(again.translation, isometry.translation);
        }
    }
}
