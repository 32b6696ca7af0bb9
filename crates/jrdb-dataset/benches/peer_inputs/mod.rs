//! One LiDAR sweep of a room with people, the same to the last `f32` rounding in every language.
//!
//! The numbers come from SplitMix64 used as a counter, so that they depend on a seed and an index only and other programs
//! can be measured on the very same points. Sines and cosines may differ in their last bit.

use std::f64::consts::{PI, TAU};

/// Points of a sweep.
pub(crate) const POINTS: usize = 65_536;

/// The floor in the base frame, metres.
pub(crate) const FLOOR_M: f64 = -1.05;
/// Half the length and half the width of the room, metres.
const ROOM_M: [f64; 2] = [12.0, 7.0];

/// A person: a standing cylinder.
pub(crate) struct Person {
    /// Where it stands, counter-clockwise from ahead, radians.
    pub(crate) azimuth_rad: f64,
    /// Horizontal range of its axis, metres.
    pub(crate) range_m: f64,
    /// Its radius, metres.
    pub(crate) radius_m: f64,
    /// Its height over the floor, metres.
    pub(crate) height_m: f64,
}

/// A sweep in the frame x forward, y left, z up around the panorama's axis, metres.
pub(crate) struct Sweep {
    /// Height of the LiDAR above the panorama's centre, metres.
    pub(crate) height_m: f64,
    /// Seed of the points.
    pub(crate) seed: u64,
}

/// The upper and the lower LiDAR.
pub(crate) const SWEEPS: [Sweep; 2] =
    [Sweep { height_m: 0.335, seed: 101 }, Sweep { height_m: -0.135, seed: 201 }];

/// The number of a seed at an index, in `[0, 1)`.
pub(crate) fn uniform(seed: u64, index: usize) -> f64 {
    let mut z = seed.wrapping_add((index as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

impl Sweep {
    /// The points, row by row.
    pub(crate) fn points(&self) -> Vec<[f32; 3]> {
        self.first_points(POINTS)
    }

    /// The first points, row by row; they lie all around.
    pub(crate) fn first_points(&self, count: usize) -> Vec<[f32; 3]> {
        let people = people();
        (0..count).map(|index| self.point(index, &people).map(|m| m as f32)).collect()
    }

    fn point(&self, index: usize, people: &[Person]) -> [f64; 3] {
        let azimuth = uniform(self.seed, index) * TAU - PI;
        let elevation = (-25.0 + 40.0 * uniform(self.seed + 1, index)).to_radians();
        let noise_m = (uniform(self.seed + 2, index) - 0.5) * 0.04;
        let slope = elevation.sin() / elevation.cos();
        let [along, across] = [azimuth.cos(), azimuth.sin()].map(|part| part.abs().max(1e-9));
        let mut range_m = (ROOM_M[0] / along).min(ROOM_M[1] / across);
        if elevation.sin() < -1e-6 {
            range_m = range_m.min((FLOOR_M - self.height_m) / slope);
        }
        for person in people {
            if let Some(nearer_m) = self.hit(person, azimuth, slope, range_m) {
                range_m = nearer_m;
            }
        }
        range_m += noise_m;
        [range_m * azimuth.cos(), range_m * azimuth.sin(), self.height_m + range_m * slope]
    }

    /// Range at which the beam meets a person in front of what it met before.
    fn hit(&self, person: &Person, azimuth: f64, slope: f64, range_m: f64) -> Option<f64> {
        let off = ((azimuth - person.azimuth_rad + PI).rem_euclid(TAU) - PI).abs();
        if off >= (person.radius_m / person.range_m).asin() {
            return None;
        }
        let beside_m = person.range_m * off.sin();
        let depth_m = (person.radius_m.powi(2) - beside_m.powi(2)).max(0.0).sqrt();
        let hit_m = person.range_m - depth_m;
        let z = self.height_m + hit_m * slope;
        let is_on_body = z > FLOOR_M && z < FLOOR_M + person.height_m;
        (is_on_body && hit_m < range_m).then_some(hit_m)
    }
}

/// A hundred people; the first stands across the seam.
pub(crate) fn people() -> Vec<Person> {
    const COUNT: usize = 100;
    const SEED: u64 = 11;
    let part = |index: usize, which: usize| uniform(SEED, which * COUNT + index);
    let person = |i: usize| Person {
        azimuth_rad: if i == 0 { PI - 0.002 } else { part(i, 0) * TAU - PI },
        range_m: 1.5 + part(i, 1) * 10.0,
        radius_m: 0.22 + part(i, 2) * 0.13,
        height_m: 1.5 + part(i, 3) * 0.4,
    };
    (0..COUNT).map(person).collect()
}
