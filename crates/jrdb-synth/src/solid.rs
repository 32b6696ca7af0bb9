//! Upright convex bodies that everything is made of, and where a ray hits them.

use jrdb_projection::nalgebra::{Point3, Rotation2, Vector2, Vector3};

/// What a solid is inside its half sizes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    /// A box.
    Block,
    /// An upright cylinder over an ellipse.
    Cylinder,
    /// An ellipsoid.
    Ellipsoid,
}

/// A body in the base frame (x forward, y left, z up), turned about the vertical only.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Solid {
    pub(super) shape: Shape,
    /// Middle, metres.
    pub(super) center: Point3<f64>,
    /// Half sizes along its own x, y and z, metres.
    pub(super) half: Vector3<f64>,
    /// Where its own x points, radians counter-clockwise.
    pub(super) yaw_rad: f64,
}

/// A half-line from a sensor.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ray {
    /// Start, metres.
    pub(super) from: Point3<f64>,
    /// Unit direction.
    pub(super) along: Vector3<f64>,
}

impl Solid {
    /// A solid given in the frame of something else: at `place`, turned by `yaw_rad`.
    pub(super) fn placed(self, place: Vector2<f64>, floor_m: f64, yaw_rad: f64) -> Self {
        let turned = Rotation2::new(yaw_rad) * self.center.xy().coords + place;
        let center = Point3::new(turned.x, turned.y, self.center.z + floor_m);
        Self { center, yaw_rad: self.yaw_rad + yaw_rad, ..self }
    }

    /// Distance along the ray to its first point on the solid, metres.
    pub(super) fn hit_m(&self, ray: &Ray) -> Option<f64> {
        let from = self.scaled(ray.from - self.center);
        let along = self.scaled(ray.along);
        let [enter, leave] = match self.shape {
            Shape::Block => [0, 1, 2]
                .map(|axis| slab(from[axis], along[axis]))
                .into_iter()
                .fold([f64::NEG_INFINITY, f64::INFINITY], both),
            Shape::Cylinder => both(round(&from.xy(), &along.xy()), slab(from.z, along.z)),
            Shape::Ellipsoid => round(&from, &along),
        };
        (enter <= leave && enter > 0.0).then_some(enter)
    }

    /// Whether a point lies inside.
    pub(super) fn contains(&self, point: &Point3<f64>) -> bool {
        let own = self.scaled(point - self.center);
        match self.shape {
            Shape::Block => own.amax() <= 1.0,
            Shape::Cylinder => own.xy().norm() <= 1.0 && own.z.abs() <= 1.0,
            Shape::Ellipsoid => own.norm() <= 1.0,
        }
    }

    /// A vector in the solid's own axes, in units of its half sizes.
    fn scaled(&self, vector: Vector3<f64>) -> Vector3<f64> {
        let own = Rotation2::new(-self.yaw_rad) * vector.xy();
        Vector3::new(own.x, own.y, vector.z).component_div(&self.half)
    }
}

const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

fn both(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].max(b[0]), a[1].min(b[1])]
}

/// Where `from + t·along` lies in [-1, 1].
fn slab(from: f64, along: f64) -> [f64; 2] {
    if along == 0.0 {
        return if from.abs() <= 1.0 { [f64::NEG_INFINITY, f64::INFINITY] } else { NOTHING };
    }
    let (a, b) = ((-1.0 - from) / along, (1.0 - from) / along);
    [a.min(b), a.max(b)]
}

/// Where `from + t·along` lies in the unit circle or ball.
fn round<const D: usize>(
    from: &jrdb_projection::nalgebra::SVector<f64, D>,
    along: &jrdb_projection::nalgebra::SVector<f64, D>,
) -> [f64; 2] {
    let (a, b, c) = (along.dot(along), from.dot(along), from.dot(from) - 1.0);
    let root = b * b - a * c;
    if a == 0.0 || root < 0.0 {
        return NOTHING;
    }
    [(-b - root.sqrt()) / a, (-b + root.sqrt()) / a]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hit(shape: Shape, yaw_rad: f64, height: f64) -> Option<f64> {
        let (center, half) = (Point3::new(5.0, 0.0, 0.0), Vector3::new(1.0, 0.5, 0.4));
        let ray = Ray { from: Point3::new(0.0, 0.0, height), along: Vector3::x() };
        Solid { shape, center, half, yaw_rad }.hit_m(&ray)
    }

    #[test]
    fn rays_hit_the_near_side_of_every_shape() {
        for shape in [Shape::Block, Shape::Cylinder, Shape::Ellipsoid] {
            assert_eq!(hit(shape, 0.0, 0.0), Some(4.0), "{shape:?}");
            let turned = hit(shape, std::f64::consts::FRAC_PI_2, 0.0).unwrap();
            assert!((turned - 4.5).abs() < 1e-9, "{shape:?} {turned}");
            assert_eq!(hit(shape, 0.0, 0.5), None, "{shape:?}");
        }
        assert!(hit(Shape::Ellipsoid, 0.0, 0.3).unwrap() > hit(Shape::Cylinder, 0.0, 0.3).unwrap());
    }

    #[test]
    fn a_ray_from_above_lands_on_the_lid() {
        let lid = Solid {
            shape: Shape::Cylinder,
            center: Point3::origin(),
            half: Vector3::new(0.3, 0.3, 1.0),
            yaw_rad: 0.0,
        };
        let along = Vector3::new(2.0, 0.0, -1.0).normalize();
        let ray = Ray { from: Point3::new(-2.0, 0.0, 2.0), along };
        let t = lid.hit_m(&ray).unwrap();
        assert!(((ray.from + t * along) - Point3::new(0.0, 0.0, 1.0)).norm() < 1e-12);
    }
}
