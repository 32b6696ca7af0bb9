//! What a lens is, and how a lens on a robot is a camera.

use jrdb_types::ImageGeometry;
use nalgebra::{Isometry3, Point3, Unit, Vector3};
use serde::{Deserialize, Serialize};

use super::{CameraModel, Pixel, pose};

/// A camera in its own frame: x right, y down, z forward, metres.
pub trait Lens {
    /// Size of the image and whether it wraps.
    fn image(&self) -> ImageGeometry;

    /// The pixel of a point, or `None` where the lens has no image of it: behind a pinhole, beyond the
    /// angle up to which the model is one-to-one, at the centre itself, or not finite.
    fn pixel_from_camera(&self, point: &Point3<f64>) -> Option<Pixel>;

    /// The direction that falls on pixel `(u, v)`, from [`Lens::ray_origin`]; `None` where none does.
    fn ray_from_pixel(&self, u: f64, v: f64) -> Option<Unit<Vector3<f64>>>;

    /// Where the ray of pixel `(u, v)` starts: the camera frame's origin, unless the image is put
    /// together from several viewpoints.
    fn ray_origin(&self, _u: f64, _v: f64) -> Point3<f64> {
        Point3::origin()
    }
}

/// A lens and where it sits on the robot.
///
/// As JSON, the pose is a rotation matrix, row by row, and a translation in metres; reading refuses a
/// matrix that is no rotation (see [`Pose`](super::Pose)).
///
/// ```
/// use jrdb_projection::CameraModel;
/// use jrdb_projection::camera::{DistortionModel, Pinhole, PosedCamera};
/// use jrdb_projection::nalgebra::Point3;
///
/// // Looks forward from 0.3 m above the base frame's origin.
/// let camera: PosedCamera<Pinhole> = serde_json::from_str(r#"{
///     "lens": {
///         "width_px": 640, "height_px": 480, "fx": 500.0, "fy": 500.0, "cx": 320.0, "cy": 240.0,
///         "distortion": "none"
///     },
///     "camera_from_base": {
///         "rotation": [[0, -1, 0], [0, 0, -1], [1, 0, 0]],
///         "translation_m": [0, 0.3, 0]
///     }
/// }"#).unwrap();
/// let pixel = camera.pixel_from_base(&Point3::new(5.0, 1.0, 0.3)).unwrap();
/// assert!((pixel.u - 220.0).abs() < 1e-9); // a metre to the left
/// assert!((pixel.v - 240.0).abs() < 1e-9);
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PosedCamera<L> {
    /// How rays become pixels.
    pub lens: L,
    /// Takes a point of the base frame to the camera frame (x right, y down, z forward), metres.
    #[serde(with = "pose::layout")]
    pub camera_from_base: Isometry3<f64>,
}

impl<L: Lens> CameraModel for PosedCamera<L> {
    fn image(&self) -> ImageGeometry {
        self.lens.image()
    }

    fn pixel_from_base(&self, point: &Point3<f64>) -> Option<Pixel> {
        self.lens.pixel_from_camera(&(self.camera_from_base * point))
    }

    fn ray_from_pixel(&self, u: f64, v: f64) -> Option<Unit<Vector3<f64>>> {
        let ray = self.lens.ray_from_pixel(u, v)?;
        Some(self.camera_from_base.rotation.inverse() * ray)
    }

    fn center(&self) -> Point3<f64> {
        self.camera_from_base.inverse_transform_point(&Point3::origin())
    }

    fn ray_origin(&self, u: f64, v: f64) -> Point3<f64> {
        self.camera_from_base.inverse_transform_point(&self.lens.ray_origin(u, v))
    }
}

/// A pixel with finite coordinates, or none.
pub(super) fn finite_pixel(u: f64, v: f64, depth_m: f64) -> Option<Pixel> {
    let finite = u.is_finite() && v.is_finite() && depth_m.is_finite();
    finite.then_some(Pixel { u, v, depth_m })
}

/// A direction of length one, or none when it has no length or is not finite.
pub(super) fn finite_ray(direction: Vector3<f64>) -> Option<Unit<Vector3<f64>>> {
    let norm = direction.norm();
    (norm.is_finite() && norm > 0.0).then(|| Unit::new_unchecked(direction / norm))
}

/// A column on a circle of `width_px` columns, in `[0, W)`.
pub(super) fn wrapped(u: f64, width_px: f64) -> f64 {
    let u = u.rem_euclid(width_px);
    // Rounding can push a column just left of the seam onto W itself.
    if u == width_px { 0.0 } else { u }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::camera::{Equirectangular, Pose};

    /// A camera that looks forward from 0.1 m ahead of, 0.2 m left of and 0.3 m above the base frame.
    pub(in crate::camera) fn posed<L>(lens: L) -> PosedCamera<L> {
        let rotation = [[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]];
        let pose = Pose { rotation, translation_m: [0.2, 0.3, -0.1] };
        PosedCamera { lens, camera_from_base: pose.try_into().unwrap() }
    }

    #[test]
    fn a_posed_lens_sees_from_where_it_sits() {
        let camera = posed(Equirectangular { width_px: 800, height_px: 400 });
        assert!((camera.center() - Point3::new(0.1, 0.2, 0.3)).norm() < 1e-15);
        let pixel = camera.pixel_from_base(&Point3::new(0.1, 5.2, 0.3)).unwrap();
        assert!((pixel.u - 200.0).abs() < 1e-9, "straight left is a quarter from the left edge");
        assert!((pixel.v - 200.0).abs() < 1e-9 && (pixel.depth_m - 5.0).abs() < 1e-12);
        let ray = camera.ray_from_pixel(200.0, 200.0).unwrap();
        assert!((ray.into_inner() - Vector3::y()).norm() < 1e-12);
    }

    #[test]
    fn a_posed_camera_survives_its_file() {
        let camera = posed(Equirectangular { width_px: 800, height_px: 400 });
        let text = serde_json::to_string(&camera).unwrap();
        let again: PosedCamera<Equirectangular> = serde_json::from_str(&text).unwrap();
        assert_eq!(again.lens, camera.lens);
        assert!((again.center() - camera.center()).norm() < 1e-14);
        let extra = text.replacen('{', r#"{"fps":30,"#, 1);
        let error = serde_json::from_str::<PosedCamera<Equirectangular>>(&extra).unwrap_err();
        assert!(error.to_string().contains("unknown field `fps`"), "{error}");
        let skewed = text.replacen("-1.0", "-0.9", 1);
        let error = serde_json::from_str::<PosedCamera<Equirectangular>>(&skewed).unwrap_err();
        assert!(error.to_string().contains("off orthonormal by 1.9e-1"), "{error} in {skewed}");
    }
}
