//! What a lens is, and how a lens on a robot is a camera.

use jrdb_types::ImageGeometry;
use jrdb_types::rig::FORWARD_CAMERA;
use nalgebra::{Isometry3, Point3, Unit, Vector3};

use super::{CameraModel, Pixel};
use crate::frame;

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

    /// The pixels of many points at once; NaN where a point has none.
    ///
    /// A model that overrides this for speed states how far it may differ from
    /// [`Lens::pixel_from_camera`].
    fn pixels_from_camera(&self, points: &Columns<'_>, pixels: &mut PixelColumns<'_>) {
        let points = points.x.iter().zip(points.y).zip(points.z);
        let pixels = pixels.u.iter_mut().zip(&mut *pixels.v);
        for (((&x, &y), &z), (u, v)) in points.zip(pixels) {
            let point = Point3::new(x, y, z).cast::<f64>();
            let pixel = self.pixel_from_camera(&point);
            (*u, *v) = pixel.map_or((f32::NAN, f32::NAN), |p| (p.u as f32, p.v as f32));
        }
    }
}

/// Coordinates of points, column by column, metres; equally long.
#[derive(Debug, Clone, Copy)]
#[expect(missing_docs, reason = "the three axes")]
pub struct Columns<'a> {
    pub x: &'a [f32],
    pub y: &'a [f32],
    pub z: &'a [f32],
}

/// Where pixels are written: columns `u` and rows `v`, as long as the points.
#[derive(Debug)]
#[expect(missing_docs, reason = "the two axes")]
pub struct PixelColumns<'a> {
    pub u: &'a mut [f32],
    pub v: &'a mut [f32],
}

/// A lens and where it sits on the robot.
///
/// ```
/// use jrdb_projection::CameraModel;
/// use jrdb_projection::camera::PosedCamera;
/// use jrdb_projection::nalgebra::{Point3, Vector3};
/// use jrdb_types::lens::Equirectangular;
///
/// let mut camera = PosedCamera::ahead(Equirectangular { width_px: 800, height_px: 400 });
/// camera.camera_from_base.translation.vector = Vector3::new(0.0, 0.3, 0.0); // y down: 0.3 m above the base
/// let pixel = camera.pixel_from_base(&Point3::new(5.0, 0.0, 0.3)).unwrap();
/// assert!((pixel.u - 400.0).abs() < 1e-9 && (pixel.v - 200.0).abs() < 1e-9);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct PosedCamera<L> {
    /// How rays become pixels.
    pub lens: L,
    /// Takes a point of the base frame to the camera frame (x right, y down, z forward), metres.
    pub camera_from_base: Isometry3<f64>,
}

impl<L> PosedCamera<L> {
    /// A camera at the base frame's origin that looks straight ahead, along +x, upright.
    pub fn ahead(lens: L) -> Self {
        let turned = frame::rotation(&FORWARD_CAMERA).expect("the constant is a rotation");
        Self { lens, camera_from_base: Isometry3::from_parts(Default::default(), turned.inverse()) }
    }
}

/// A lens of whatever model a rig names.
pub type AnyLens = Box<dyn Lens + Send + Sync>;

impl Lens for AnyLens {
    fn image(&self) -> ImageGeometry {
        (**self).image()
    }

    fn pixel_from_camera(&self, point: &Point3<f64>) -> Option<Pixel> {
        (**self).pixel_from_camera(point)
    }

    fn ray_from_pixel(&self, u: f64, v: f64) -> Option<Unit<Vector3<f64>>> {
        (**self).ray_from_pixel(u, v)
    }

    fn ray_origin(&self, u: f64, v: f64) -> Point3<f64> {
        (**self).ray_origin(u, v)
    }

    fn pixels_from_camera(&self, points: &Columns<'_>, pixels: &mut PixelColumns<'_>) {
        (**self).pixels_from_camera(points, pixels);
    }
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
    use jrdb_types::lens::Equirectangular;

    /// A camera that looks forward from 0.1 m ahead of, 0.2 m left of and 0.3 m above the base frame.
    pub(in crate::camera) fn posed<L>(lens: L) -> PosedCamera<L> {
        let rotation = frame::rotation(&FORWARD_CAMERA).unwrap();
        let base_from_camera = Isometry3::from_parts(Vector3::new(0.1, 0.2, 0.3).into(), rotation);
        PosedCamera { lens, camera_from_base: base_from_camera.inverse() }
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
}
