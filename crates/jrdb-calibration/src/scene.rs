//! Clouds for the tests: a floor and what hides it, without a random number generator.

use std::f64::consts::TAU;

use nalgebra::{Point3, Vector3};

/// Slopes of the floor of [`cluttered`].
pub(crate) const SLOPES: [f64; 2] = [0.02, -0.01];
/// Height of the floor of [`cluttered`] under the origin, metres.
pub(crate) const HEIGHT_M: f64 = -0.92;

/// The `i`-th point of an evenly spread sequence in the unit cube (additive recurrence on the powers of
/// the plastic number of three dimensions).
fn spread(i: usize) -> [f64; 3] {
    [0.819_172_513_396, 0.671_043_606_704, 0.549_700_477_902].map(|step| (step * i as f64).fract())
}

/// Points of `z = height_m + slopes · (x, y)`, evenly over a disc of 8 m around the origin.
pub(crate) fn floor(count: usize, slopes: [f64; 2], height_m: f64) -> Vec<Point3<f64>> {
    let at = |i| {
        let [radius, angle, _] = spread(i);
        let (y, x) = (angle * TAU).sin_cos();
        let [x, y] = [x, y].map(|v| v * radius.sqrt() * 8.0);
        Point3::new(x, y, height_m + slopes[0] * x + slopes[1] * y)
    };
    (0..count).map(at).collect()
}

/// The points moved up or down by up to `amplitude_m`, evenly.
pub(crate) fn noisy(points: &[Point3<f64>], amplitude_m: f64) -> Vec<Point3<f64>> {
    let moved = |(i, point): (usize, &Point3<f64>)| {
        point + Vector3::z() * (2.0 * spread(i)[2] - 1.0) * amplitude_m
    };
    points.iter().enumerate().map(moved).collect()
}

/// An upright box full of points.
fn block(count: usize, low: [f64; 3], size: [f64; 3]) -> Vec<Point3<f64>> {
    let at = |i| {
        let [a, b, c] = spread(i);
        Point3::new(low[0] + a * size[0], low[1] + b * size[1], low[2] + c * size[2])
    };
    (0..count).map(at).collect()
}

/// A wall across the way ahead, from 0.95 m under the origin to 1.55 m over it.
pub(crate) fn wall(count: usize, x_m: f64) -> Vec<Point3<f64>> {
    block(count, [x_m, -6.0, -0.95], [0.0, 12.0, 2.5])
}

/// 4,000 floor points with 2 cm of noise and 6,000 others: twenty people, two walls, and a table of
/// 2.4 m by 3 m, 0.75 m over the floor, with more points than any piece of floor of its size.
pub(crate) fn cluttered() -> Vec<Point3<f64>> {
    let mut points = noisy(&floor(4000, SLOPES, HEIGHT_M), 0.02);
    for person in 0..20 {
        let (y, x) = (f64::from(person) * 2.4).sin_cos();
        let range_m = 1.5 + 0.25 * f64::from(person);
        let feet = [x * range_m, y * range_m, HEIGHT_M];
        points.extend(block(100, feet, [0.4, 0.4, 1.7]));
    }
    points.extend(wall(1000, 5.0));
    points.extend(wall(1000, -7.0));
    points.extend(noisy(&block(2000, [1.5, -1.5, HEIGHT_M + 0.75], [2.4, 3.0, 0.0]), 0.01));
    points
}
