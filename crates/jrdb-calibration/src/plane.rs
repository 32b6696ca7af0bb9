//! A plane, and the plane that fits points best.

use nalgebra::{Matrix3, Point3, Vector3};

use crate::least_squares::least_direction;

/// The points `p` with `normal · p = offset_m`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Plane {
    /// Unit normal with `z >= 0`.
    pub(crate) normal: Vector3<f64>,
    /// Distance from the origin along the normal, metres.
    pub(crate) offset_m: f64,
}

impl Plane {
    /// The plane `z = height_m + slopes · (x, y)`.
    pub(crate) fn from_slopes(slopes: [f64; 2], height_m: f64) -> Self {
        let normal = Vector3::new(-slopes[0], -slopes[1], 1.0).normalize();
        Self { normal, offset_m: height_m * normal.z }
    }

    pub(crate) fn distance_m(&self, point: &Point3<f64>) -> f64 {
        (self.normal.dot(&point.coords) - self.offset_m).abs()
    }

    /// z where the plane meets the z axis.
    pub(crate) fn height_m(&self) -> f64 {
        self.offset_m / self.normal.z
    }
}

/// Angle between two unit vectors, radians; exact for small angles, where `acos` is not.
pub(crate) fn angle_rad(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    a.cross(b).norm().atan2(a.dot(b))
}

/// A plane with the standard deviations of the points it was fitted to, metres.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fit {
    pub(crate) plane: Plane,
    /// Across the plane: the root mean square of the distances.
    pub(crate) rms_m: f64,
    /// In the plane, along the narrower direction.
    pub(crate) spread_m: f64,
}

/// What is said of points whose coordinates are not numbers: a level plane, infinitely uncertain.
const LEVEL: ([f64; 3], [f64; 3]) = ([f64::INFINITY; 3], [0.0, 0.0, 1.0]);

/// Total least squares: the plane through the centroid, normal to the eigenvector of the scatter
/// matrix's smallest eigenvalue.
///
/// One point at least; sums run in the order of the points.
pub(crate) fn fit(points: &[Point3<f64>]) -> Fit {
    let count = points.len() as f64;
    let centroid = points.iter().map(|p| p.coords).sum::<Vector3<f64>>() / count;
    let scatter = points.iter().fold(Matrix3::zeros(), |sum, point| {
        let arm = point.coords - centroid;
        sum + arm * arm.transpose()
    }) / count;
    let entry = |row, column| scatter[(row, column)];
    let (variances, direction) = least_direction::<3>(entry).unwrap_or(LEVEL);
    let deviation_m = |rank: usize| variances[rank].max(0.0).sqrt();
    let direction = Vector3::from(direction);
    let normal = if direction.z < 0.0 { -direction } else { direction };
    let plane = Plane { normal, offset_m: normal.dot(&centroid) };
    Fit { plane, rms_m: deviation_m(0), spread_m: deviation_m(1) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_plane_by_its_slopes_goes_through_its_points() {
        let plane = Plane::from_slopes([0.1, -0.2], -0.9);
        assert!(plane.distance_m(&Point3::new(2.0, 1.0, -0.9)) < 1e-12);
        assert!((plane.height_m() + 0.9).abs() < 1e-12);
    }

    #[test]
    fn deviations_are_those_of_the_points() {
        let at = |x, y, z| Point3::new(x, y, z);
        let points =
            [at(3.0, 1.0, 0.0), at(-3.0, 1.0, 0.0), at(3.0, -1.0, 0.0), at(-3.0, -1.0, 0.0)];
        let fit = fit(&points);
        assert!((fit.spread_m - 1.0).abs() < 1e-12 && fit.rms_m < 1e-12);
    }

    proptest! {
        #[test]
        fn points_of_a_plane_give_it_back(a in -0.5..0.5, b in -0.5..0.5, height in -2.0..2.0) {
            let corners = [[0.0, 0.0], [4.0, 0.0], [0.0, 3.0], [-2.0, -5.0], [1.0, -1.0]];
            let points = corners.map(|[x, y]| Point3::new(x, y, height + a * x + b * y));
            let (found, expected) = (fit(&points).plane, Plane::from_slopes([a, b], height));
            prop_assert!(angle_rad(&found.normal, &expected.normal) < 1e-9);
            prop_assert!((found.height_m() - height).abs() < 1e-9);
        }
    }
}
