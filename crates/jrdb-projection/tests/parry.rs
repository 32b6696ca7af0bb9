//! Overlap and gap of boxes against parry, an independent implementation, in general position.
//!
//! Degenerate poses are not compared: there parry's convex polygon clipper is wrong (a box with itself has
//! twice its area). `relation/tests.rs` states what must hold for them.

use jrdb_projection::relation::{adjacency, overlap};
use jrdb_types::Box3d;
use parry3d_f64::math::{Pose, Rotation, Vector, Vector2};
use parry3d_f64::query::details::distance_support_map_support_map;
use parry3d_f64::shape::Cuboid;
use parry3d_f64::transformation::convex_polygons_intersection_points;

/// Numbers in `[0, 1)`, the same in every run.
struct Spread(u64);

impl Spread {
    /// SplitMix64.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// A box of a person's order of size within arm's reach of the origin: about half of all pairs overlap.
    fn bbox(&mut self) -> Box3d {
        let center = [self.within(-0.6, 0.6), self.within(-0.6, 0.6), self.within(-0.5, 0.5)];
        let size = [self.within(0.2, 1.2), self.within(0.2, 1.2), self.within(0.5, 2.0)];
        Box3d { center, size, heading_rad: self.within(-7.0, 7.0) }
    }
}

fn corners(b: &Box3d) -> Vec<Vector2> {
    let (sin, cos) = b.heading_rad.sin_cos();
    let corner = |ahead: f64, left: f64| {
        let (ahead, left) = (ahead * b.size[0] / 2.0, left * b.size[1] / 2.0);
        Vector2::new(b.center[0] + cos * ahead - sin * left, b.center[1] + sin * ahead + cos * left)
    };
    vec![corner(1.0, 1.0), corner(-1.0, 1.0), corner(-1.0, -1.0), corner(1.0, -1.0)]
}

fn iou_by_parry(a: &Box3d, b: &Box3d) -> f64 {
    let mut polygon = Vec::new();
    convex_polygons_intersection_points(&corners(a), &corners(b), &mut polygon);
    let next = polygon.iter().cycle().skip(1);
    let area: f64 = polygon.iter().zip(next).map(|(p, q)| p.perp_dot(*q) / 2.0).sum();
    let top = |b: &Box3d| b.center[2] + b.size[2] / 2.0;
    let bottom = |b: &Box3d| b.center[2] - b.size[2] / 2.0;
    let shared = area.abs() * (top(a).min(top(b)) - bottom(a).max(bottom(b))).max(0.0);
    let volume = |b: &Box3d| b.size.iter().product::<f64>();
    shared / (volume(a) + volume(b) - shared)
}

fn gap_by_parry(a: &Box3d, b: &Box3d) -> f64 {
    let pose = |b: &Box3d| {
        let [x, y, z] = b.center;
        Pose::from_parts(Vector::new(x, y, z), Rotation::from_rotation_z(b.heading_rad))
    };
    let shape = |b: &Box3d| {
        let [l, w, h] = b.size;
        Cuboid::new(Vector::new(l, w, h) / 2.0)
    };
    // Not `query::distance`: for cuboids its shortcut is up to 0.4 m too long.
    let b_in_a = pose(a).inv_mul(&pose(b));
    distance_support_map_support_map(&b_in_a, &shape(a), &shape(b))
}

#[test]
fn overlap_equals_parry_in_general_position() {
    let mut spread = Spread(1);
    let (mut worst, mut overlapping) = (0.0_f64, 0);
    for _ in 0..100_000 {
        let (a, b) = (spread.bbox(), spread.bbox());
        let (ours, theirs) = (overlap::iou(&a, &b), iou_by_parry(&a, &b));
        worst = worst.max((ours - theirs).abs());
        overlapping += usize::from(ours > 0.0);
    }
    assert!(worst < 1e-9, "{worst}");
    assert!((30_000..95_000).contains(&overlapping), "{overlapping} of 100000 pairs overlap");
}

#[test]
fn gaps_equal_parry_in_general_position() {
    let mut spread = Spread(2);
    let mut worst = 0.0_f64;
    for _ in 0..20_000 {
        let (a, mut b) = (spread.bbox(), spread.bbox());
        b.center[0] += spread.within(0.0, 3.0);
        b.center[2] += spread.within(-2.0, 2.0);
        worst = worst.max((adjacency::gap_m(&a, &b) - gap_by_parry(&a, &b)).abs());
    }
    assert!(worst < 1e-6, "{worst}: parry's iteration stops at about this");
}
