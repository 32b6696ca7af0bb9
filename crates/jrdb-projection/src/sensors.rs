//! A rig description, checked and resolved: the camera in use and every LiDAR's place in the base frame.

use std::collections::{BTreeMap, BTreeSet};

use jrdb_types::Rig;
use nalgebra::Isometry3;

use crate::camera::{AnyLens, LensError, PosedCamera, any_lens};
use crate::frame::{FrameError, FrameTree};

/// Why a rig description is unusable.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RigError {
    /// The transforms.
    #[error("the rig's frames make no tree")]
    Frames(#[from] FrameError),
    /// Two cameras or two LiDARs with one name.
    #[error("expected every {kind} of the rig to have a name of its own, found {name:?} twice")]
    DuplicateName {
        /// `camera` or `lidar`.
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// The rig has no such camera.
    #[error("expected camera {asked:?} in the rig, found {known:?}")]
    NoCamera {
        /// The camera asked for; empty for the first.
        asked: String,
        /// The cameras that there are.
        known: Vec<String>,
    },
    /// A camera's lens.
    #[error("the lens of camera {camera:?} is unusable")]
    BadLens {
        /// The camera's name.
        camera: String,
        /// What is wrong.
        #[source]
        source: LensError,
    },
}

/// A camera of a rig, wherever it sits and whatever its lens.
pub type RigCamera = PosedCamera<AnyLens>;

/// One camera and all LiDARs of a rig, in the base frame.
pub struct Sensors {
    /// The camera.
    pub camera: RigCamera,
    /// For each LiDAR, by name, the transform `base_from_lidar`.
    pub lidars: BTreeMap<String, Isometry3<f64>>,
}

impl Sensors {
    /// Resolves a rig; `camera` names one of its cameras, the first when absent.
    ///
    /// # Errors
    /// [`RigError`] says what is wrong with the description.
    pub fn new(rig: &Rig, camera: Option<&str>) -> Result<Self, RigError> {
        tracing::trace!(target: "jrdb::resolve_rig", base = %rig.base);
        unique("camera", rig.cameras.iter().map(|camera| &camera.name))?;
        unique("lidar", rig.lidars.iter().map(|lidar| &lidar.name))?;
        let tree = FrameTree::new(&rig.base, &rig.transforms)?;
        let found = match camera {
            None => rig.cameras.first(),
            Some(name) => rig.cameras.iter().find(|camera| camera.name == name),
        };
        let Some(found) = found else {
            let known = rig.cameras.iter().map(|camera| camera.name.clone()).collect();
            return Err(RigError::NoCamera { asked: camera.unwrap_or_default().into(), known });
        };
        let bad_lens = |source| RigError::BadLens { camera: found.name.clone(), source };
        let lens = any_lens(&found.lens).map_err(bad_lens)?;
        let camera_from_base = tree.base_from(&found.frame)?.inverse();
        let lidars = rig.lidars.iter();
        let lidars = lidars.map(|l| Ok((l.name.clone(), tree.base_from(&l.frame)?)));
        let lidars = lidars.collect::<Result<_, FrameError>>()?;
        Ok(Self { camera: PosedCamera { lens, camera_from_base }, lidars })
    }
}

fn unique<'a>(kind: &'static str, names: impl Iterator<Item = &'a String>) -> Result<(), RigError> {
    let mut seen = BTreeSet::new();
    for name in names {
        if !seen.insert(name) {
            return Err(RigError::DuplicateName { kind, name: name.clone() });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing;
    use jrdb_types::LensModel;

    fn error(change: impl Fn(&mut Rig)) -> String {
        let mut rig = testing::rig([0.0; 3], 0.0);
        change(&mut rig);
        Sensors::new(&rig, None).map(|_| ()).unwrap_err().to_string()
    }

    #[test]
    fn a_rig_that_is_wrong_says_where() {
        assert_eq!(
            error(|rig| rig.lidars.push(rig.lidars[0].clone())),
            r#"expected every lidar of the rig to have a name of its own, found "upper" twice"#
        );
        assert_eq!(error(|rig| rig.cameras.clear()), r#"expected camera "" in the rig, found []"#);
        assert_eq!(
            error(|rig| rig.lidars[0].frame = "nowhere".into()),
            "the rig's frames make no tree"
        );
        let blind = |rig: &mut Rig| {
            let LensModel::Cylindrical(lens) = &mut rig.cameras[0].lens else { unreachable!() };
            lens.focal_px = 0.0;
        };
        assert_eq!(error(blind), r#"the lens of camera "panorama" is unusable"#);
    }

    #[test]
    fn a_camera_is_found_by_its_name() {
        let rig = testing::rig([0.0; 3], 0.0);
        assert!(Sensors::new(&rig, Some("panorama")).is_ok());
        let error = Sensors::new(&rig, Some("rear")).map(|_| ()).unwrap_err();
        assert_eq!(error.to_string(), r#"expected camera "rear" in the rig, found ["panorama"]"#);
    }
}
