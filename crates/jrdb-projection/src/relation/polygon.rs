//! Overlap and distance of upright boxes seen from above: oriented rectangles in the plane.

use jrdb_types::Box3d;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// An oriented rectangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rectangle {
    center: [f64; 2],
    /// Half the side along the heading, half the side across it.
    half: [f64; 2],
    heading_rad: f64,
}

/// A convex polygon of at most eight corners: all that two rectangles can share.
struct Polygon {
    corners: [[f64; 2]; 8],
    count: usize,
}

impl Rectangle {
    pub(super) fn footprint(bbox: &Box3d) -> Self {
        let [x, y, _] = bbox.center;
        let [length, width, _] = bbox.size;
        Self { center: [x, y], half: [length / 2.0, width / 2.0], heading_rad: bbox.heading_rad }
    }

    /// `self` in the frame of `other`, whose sides are then along the axes.
    ///
    /// Its heading there is taken into `[-π/4, π/4]`, its sides exchanged where that takes a quarter turn: boxes
    /// of the same heading, or at right angles, come out without rounding.
    fn seen_from(&self, other: &Self) -> Self {
        let (sin, cos) = other.heading_rad.sin_cos();
        let [x, y] = [0, 1].map(|axis| self.center[axis] - other.center[axis]);
        let turn = self.heading_rad - other.heading_rad;
        let quarters = (turn / FRAC_PI_2).round();
        let [length, width] = self.half;
        let is_odd = quarters.rem_euclid(2.0) == 1.0;
        Self {
            center: [cos * x + sin * y, cos * y - sin * x],
            half: if is_odd { [width, length] } else { [length, width] },
            heading_rad: (turn - quarters * FRAC_PI_2).clamp(-FRAC_PI_4, FRAC_PI_4),
        }
    }

    /// The corners, counter-clockwise.
    fn corners(&self) -> [[f64; 2]; 4] {
        let (sin, cos) = self.heading_rad.sin_cos();
        let [length, width] = self.half;
        [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]].map(|[ahead, left]| {
            let (ahead, left) = (ahead * length, left * width);
            [self.center[0] + cos * ahead - sin * left, self.center[1] + sin * ahead + cos * left]
        })
    }

    /// Area shared with another rectangle.
    pub(super) fn shared_area(&self, other: &Self) -> f64 {
        let corners = self.seen_from(other).corners();
        let mut polygon = Polygon { corners: [[0.0; 2]; 8], count: 4 };
        polygon.corners[..4].copy_from_slice(&corners);
        for axis in 0..2 {
            for side in [1.0, -1.0] {
                polygon = polygon.clipped(axis, side, other.half[axis]);
            }
        }
        polygon.area()
    }

    /// Least distance to another rectangle; 0 when they touch or overlap.
    pub(super) fn distance(&self, other: &Self) -> f64 {
        let (here, there) = (self.seen_from(other), other.seen_from(self));
        if !here.is_apart_from(other.half) && !there.is_apart_from(self.half) {
            return 0.0;
        }
        // Of two convex polygons that are apart, a corner of one is among the nearest points.
        let nearest = |corners: [[f64; 2]; 4], half: [f64; 2]| {
            let outside =
                |[x, y]: [f64; 2]| (x.abs() - half[0]).max(0.0).hypot((y.abs() - half[1]).max(0.0));
            corners.map(outside).into_iter().fold(f64::INFINITY, f64::min)
        };
        nearest(here.corners(), other.half).min(nearest(there.corners(), self.half))
    }

    /// Whether one of the axes separates this rectangle from the one around the origin.
    fn is_apart_from(&self, half: [f64; 2]) -> bool {
        let corners = self.corners();
        (0..2).any(|axis| {
            let along = corners.map(|corner| corner[axis]);
            along.iter().all(|&c| c > half[axis]) || along.iter().all(|&c| c < -half[axis])
        })
    }
}

impl Polygon {
    /// The part with `side · coordinate ≤ limit` along an axis (Sutherland and Hodgman).
    fn clipped(&self, axis: usize, side: f64, limit: f64) -> Self {
        let mut kept = Self { corners: [[0.0; 2]; 8], count: 0 };
        for index in 0..self.count {
            let (here, next) = (self.corners[index], self.corners[(index + 1) % self.count]);
            let (inside, next_inside) = (limit - side * here[axis], limit - side * next[axis]);
            if inside >= 0.0 {
                kept.push(here);
            }
            if (inside > 0.0 && next_inside < 0.0) || (inside < 0.0 && next_inside > 0.0) {
                let share = inside / (inside - next_inside);
                let mut crossing = [0, 1].map(|i| here[i] + share * (next[i] - here[i]));
                crossing[axis] = side * limit;
                kept.push(crossing);
            }
        }
        kept
    }

    /// Adds a corner. Four cuts of a rectangle leave at most eight; rounding cannot add to them.
    fn push(&mut self, corner: [f64; 2]) {
        if let Some(place) = self.corners.get_mut(self.count) {
            *place = corner;
            self.count += 1;
        }
    }

    /// The shoelace formula.
    fn area(&self) -> f64 {
        let corners = &self.corners[..self.count];
        let next = corners.iter().cycle().skip(1);
        let twice: f64 = corners.iter().zip(next).map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum();
        (twice / 2.0).max(0.0)
    }
}
