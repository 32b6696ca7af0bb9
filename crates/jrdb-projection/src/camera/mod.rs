//! Camera models: from points of the base frame to pixels and back.
//!
//! Two ways to be a [`CameraModel`]: JRDB's official panorama is one by itself, and a [`Lens`] becomes
//! one in a [`PosedCamera`], which says where the lens sits on the robot.
//!
//! No model folds back: a point beyond the angle up to which a lens is one-to-one has no pixel, rather
//! than a wrong one inside the image.
//!
//! To add a model: one file here with its struct, `impl Lens` (or `impl CameraModel`) and a test that
//! calls [`check_round_trip`]; one `mod` line and one `pub use` below.

mod cylindrical;
mod distortion;
mod double_sphere;
mod equirectangular;
mod kannala_brandt;
mod lens;
mod monotonic;
mod pinhole;
mod pose;
mod stitched_cylindrical;

use jrdb_types::ImageGeometry;
use nalgebra::{Point3, Unit, Vector3};

pub use distortion::{Distortion, DistortionError, DistortionModel};
pub use double_sphere::DoubleSphere;
pub use equirectangular::Equirectangular;
pub use kannala_brandt::{AnglePolynomial, KannalaBrandt};
pub use lens::{Lens, PosedCamera};
pub use pinhole::Pinhole;
pub use pose::{Pose, PoseError};
pub use stitched_cylindrical::{StitchView, StitchedCylindrical};

/// Where a point falls in an image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pixel {
    /// Column, pixels, from the left edge of column 0; in `[0, W)` where the image wraps.
    pub u: f64,
    /// Row, pixels, from the top edge of row 0. May lie outside the image.
    pub v: f64,
    /// How far the point is in the model's own terms, metres: along the optical axis for pinholes,
    /// horizontally for cylindrical panoramas, from the centre for fisheyes and equirectangular images.
    pub depth_m: f64,
}

/// A camera in the robot's base frame (x forward, y left, z up).
pub trait CameraModel {
    /// Size of the image and whether it wraps.
    fn image(&self) -> ImageGeometry;

    /// The pixel of a point, or `None` where the model has no image of it.
    fn pixel_from_base(&self, point: &Point3<f64>) -> Option<Pixel>;

    /// The direction that falls on pixel `(u, v)`, from [`CameraModel::ray_origin`].
    fn ray_from_pixel(&self, u: f64, v: f64) -> Option<Unit<Vector3<f64>>>;

    /// The camera's centre in the base frame, metres.
    fn center(&self) -> Point3<f64>;

    /// Where the ray of pixel `(u, v)` starts in the base frame, metres: the camera's centre, unless
    /// the image is put together from several viewpoints.
    fn ray_origin(&self, _u: f64, _v: f64) -> Point3<f64> {
        self.center()
    }
}

/// The check that every model must pass: pixel → ray → point → the same pixel, at three depths.
///
/// # Panics
/// When a pixel does not come back within `tolerance_px`.
pub fn check_round_trip(camera: &dyn CameraModel, [u, v]: [f64; 2], tolerance_px: f64) {
    for depth_m in [0.5, 5.0, 80.0] {
        let ray = camera.ray_from_pixel(u, v).expect("the model has a ray for this pixel");
        let point = camera.ray_origin(u, v) + ray.into_inner() * depth_m;
        let back =
            camera.pixel_from_base(&point).expect("the model sees the points of its own rays");
        let mut du = (back.u - u).abs();
        if let Some(period) = camera.image().period_px() {
            du = du.min(period - du);
        }
        let error_px = du.max((back.v - v).abs());
        assert!(error_px <= tolerance_px, "({u}, {v}) came back as {back:?}, {error_px} px off");
    }
}
