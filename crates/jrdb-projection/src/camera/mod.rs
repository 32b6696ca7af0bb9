//! Camera models: from points of the base frame to pixels and back.
//!
//! A [`Lens`] draws points of its own frame; in a [`PosedCamera`], which says where the lens sits on the robot,
//! it is a [`CameraModel`] of the base frame. Anything else may be a [`CameraModel`] too.
//!
//! No model folds back: a point beyond the angle up to which a lens is one-to-one has no pixel, rather
//! than a wrong one inside the image.
//!
//! # Adding a model
//!
//! Two files. One new file here: `impl Lens` for the struct with its numbers, known points, and a test that
//! calls [`check_round_trip`]. One `mod` line below. If rig files are to name it, its numbers are a struct and
//! a variant in `jrdb-types/src/lens.rs`, and [`any_lens`] gets an arm.

mod cylindrical;
mod distortion;
mod double_sphere;
mod equirectangular;
mod kannala_brandt;
mod lens;
mod monotonic;
mod pinhole;
pub mod stitched_cylindrical;

use jrdb_types::{ImageGeometry, LensModel};
use nalgebra::{Point3, Unit, Vector3};

pub use distortion::Distortion;
pub use kannala_brandt::{AnglePolynomial, KannalaBrandtLens};
pub use lens::{AnyLens, Columns, Lens, PixelColumns, PosedCamera};
pub use pinhole::PinholeLens;

/// Why numbers make no lens.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LensError {
    /// A number is not finite, or not over 0 where it has to be.
    #[error("expected {field} to be {expected}, found {found}")]
    BadNumber {
        /// Which number.
        field: &'static str,
        /// What it has to be.
        expected: &'static str,
        /// What it is.
        found: f64,
    },
    /// A stitched panorama without views shows nothing.
    #[error("expected at least one view in a stitched panorama, found none")]
    NoViews,
}

/// The lens that a rig describes.
///
/// # Errors
/// [`LensError`] when the numbers make no lens: a size or focal length that is not over 0, anything not
/// finite.
pub fn any_lens(model: &LensModel) -> Result<AnyLens, LensError> {
    let image = model.image();
    positive("width_px", f64::from(image.width_px))?;
    positive("height_px", f64::from(image.height_px))?;
    match model {
        LensModel::Pinhole(lens) => {
            pinhole_numbers(lens.fx, lens.fy, lens.cx, lens.cy)?;
            Ok(Box::new(PinholeLens::from(*lens)))
        }
        LensModel::KannalaBrandt(lens) => {
            pinhole_numbers(lens.fx, lens.fy, lens.cx, lens.cy)?;
            lens.k.iter().try_for_each(|&k| finite("k", k))?;
            Ok(Box::new(KannalaBrandtLens::from(*lens)))
        }
        LensModel::DoubleSphere(lens) => {
            pinhole_numbers(lens.fx, lens.fy, lens.cx, lens.cy)?;
            finite("xi", lens.xi)?;
            let within = (0.0..=1.0).contains(&lens.alpha);
            expect(within, "alpha", "in [0, 1]", lens.alpha)?;
            Ok(Box::new(*lens))
        }
        LensModel::Equirectangular(lens) => Ok(Box::new(*lens)),
        LensModel::Cylindrical(lens) => {
            positive("focal_px", lens.focal_px)?;
            finite("horizon_px", lens.horizon_px)?;
            Ok(Box::new(*lens))
        }
        LensModel::StitchedCylindrical(lens) => {
            positive("focal_px", lens.focal_px)?;
            positive("radius_m", lens.radius_m)?;
            finite("horizon_px", lens.horizon_px)?;
            finite("column_offset_px", lens.column_offset_px)?;
            let views =
                lens.views.iter().flat_map(|v| v.center_m.into_iter().chain([v.azimuth_rad]));
            views.into_iter().try_for_each(|number| finite("views", number))?;
            if lens.views.is_empty() { Err(LensError::NoViews) } else { Ok(Box::new(lens.clone())) }
        }
    }
}

fn pinhole_numbers(fx: f64, fy: f64, cx: f64, cy: f64) -> Result<(), LensError> {
    positive("fx", fx)?;
    positive("fy", fy)?;
    finite("cx", cx)?;
    finite("cy", cy)
}

fn positive(field: &'static str, found: f64) -> Result<(), LensError> {
    expect(found.is_finite() && found > 0.0, field, "finite and over 0", found)
}

fn finite(field: &'static str, found: f64) -> Result<(), LensError> {
    expect(found.is_finite(), field, "finite", found)
}

fn expect(
    holds: bool,
    field: &'static str,
    expected: &'static str,
    found: f64,
) -> Result<(), LensError> {
    if holds { Ok(()) } else { Err(LensError::BadNumber { field, expected, found }) }
}

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
