//! Distance and direction words of all ordered pairs at once, without an arc tangent.

use jrdb_types::vocab::{Elevation, Sector};
use jrdb_types::{Direction, DistanceWord, LateralConvention};
use nalgebra::Point3;

use super::distance;
use crate::simd::{Loop, vectorised};

/// Sines and cosines of the four bounds of the sectors: 30°, 45°, 135° and 145°.
const BOUNDS: [(f64, f64); 4] = [
    (0.5, 0.866_025_403_784_438_7),
    (std::f64::consts::FRAC_1_SQRT_2, std::f64::consts::FRAC_1_SQRT_2),
    (std::f64::consts::FRAC_1_SQRT_2, -std::f64::consts::FRAC_1_SQRT_2),
    (0.573_576_436_351_045_9, -0.819_152_044_288_991_9),
];

/// The sectors to the left by the number of bounds that are exceeded.
const TO_THE_LEFT: [Sector; 5] =
    [Sector::Front, Sector::FrontLeft, Sector::Left, Sector::BackLeft, Sector::Back];

/// So near to a bound, in parts of the distance, rounding decides: then the definition does.
const NEAR_BOUND: f64 = 1e-12;

/// The words of every ordered pair of `count` things.
///
/// Row `i` is how things lie to thing `i`. On the diagonal stands what a thing would be to itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Pairwise {
    count: usize,
    lateral: LateralConvention,
    distance_m: Vec<f64>,
    /// 0 to 4: how many bounds the distance exceeds.
    distance_code: Vec<u8>,
    /// How many bounds of sectors the bearing exceeds, plus 8 to the right.
    sector_code: Vec<u8>,
    z: Vec<f64>,
}

/// Relates every ordered pair of things: the same words as [`super::from_person`], 20 times as fast.
///
/// `centers` in metres and `headings_rad` in any one frame with z up; equally long, as thing `i` has center and
/// heading `i`.
///
/// The bearing exceeds the bound β where `left · cos β - ahead · sin β` is positive; the four signs are the sector. Where one is
/// too near to 0 for the rounding to be trusted, [`super::from_person`] decides.
///
/// # Panics
/// When there are not as many headings as centres.
#[must_use]
pub fn pairwise(
    centers: &[Point3<f64>],
    headings_rad: &[f64],
    lateral: LateralConvention,
) -> Pairwise {
    let count = centers.len();
    assert_eq!(count, headings_rad.len(), "one heading for each centre");
    let [x, y, z] = [0, 1, 2].map(|axis| centers.iter().map(|c| c[axis]).collect::<Vec<f64>>());
    let mut pairs = Pairwise {
        count,
        lateral,
        z,
        distance_m: vec![0.0; count * count],
        distance_code: vec![0; count * count],
        sector_code: vec![0; count * count],
    };
    let mut near = Vec::new();
    for (from, (center, heading)) in centers.iter().zip(headings_rad).enumerate() {
        let row = from * count..(from + 1) * count;
        vectorised(Row {
            center,
            sin_cos: heading.sin_cos(),
            columns: [&x, &y, &pairs.z],
            distance_m: &mut pairs.distance_m[row.clone()],
            distance_code: &mut pairs.distance_code[row.clone()],
            sector_code: &mut pairs.sector_code[row.clone()],
        });
        near.extend(row.filter(|&at| pairs.sector_code[at] & NEAR != 0));
    }
    for at in near {
        let (from, to) = (&centers[at / count], &centers[at % count]);
        let alone = super::from_person(
            from,
            Some(headings_rad[at / count]),
            to,
            LateralConvention::Physical,
        );
        pairs.sector_code[at] = alone.direction.map_or(0, code_of);
    }
    pairs
}

/// The bit of a sector code that says: too near to a bound.
const NEAR: u8 = 16;

/// One thing's place and heading, all things' coordinates, and where its row of the pairs goes.
struct Row<'a> {
    center: &'a Point3<f64>,
    sin_cos: (f64, f64),
    columns: [&'a [f64]; 3],
    distance_m: &'a mut [f64],
    distance_code: &'a mut [u8],
    sector_code: &'a mut [u8],
}

impl Loop for Row<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { center, sin_cos: (sin, cos), columns: [x, y, z], .. } = self;
        let offsets = x.iter().zip(y).zip(z);
        let codes = self.distance_code.iter_mut().zip(self.sector_code);
        let pairs = self.distance_m.iter_mut().zip(codes);
        for (((x, y), z), (distance, (distance_code, sector_code))) in offsets.zip(pairs) {
            let [dx, dy, dz] = [x - center.x, y - center.y, z - center.z];
            *distance = (dx * dx + dy * dy + dz * dz).sqrt();
            *distance_code = code_of_distance(*distance);
            *sector_code = code_of_place(cos * dx + sin * dy, cos * dy - sin * dx);
        }
    }
}

#[inline(always)]
fn code_of_distance(distance_m: f64) -> u8 {
    const BOUNDS_M: [f64; 4] = [0.5, 1.5, 5.0, 10.0];
    BOUNDS_M.iter().map(|&bound| u64::from(distance_m > bound)).sum::<u64>() as u8
}

#[inline(always)]
fn code_of_place(ahead: f64, left: f64) -> u8 {
    let beside = left.abs();
    let margin = NEAR_BOUND * (ahead.abs() + beside);
    let (mut exceeded, mut least) = (0_u64, f64::INFINITY);
    for (sin, cos) in BOUNDS {
        let past = beside * cos - ahead * sin;
        exceeded += u64::from(past > 0.0);
        least = least.min(past.abs());
    }
    let is_near = u64::from(least <= margin);
    (exceeded + 8 * u64::from(left < 0.0) + u64::from(NEAR) * is_near) as u8
}

fn code_of(direction: Direction) -> u8 {
    let place = |sector: Sector| TO_THE_LEFT.iter().position(|&s| s == sector);
    let code = match place(direction.sector) {
        Some(code) => code,
        None => place(direction.sector.mirrored()).map_or(0, |code| code | 8),
    };
    code as u8
}

impl Pairwise {
    /// Distance between the centres, metres.
    ///
    /// # Panics
    /// When there is no such thing; so do the other methods.
    #[must_use]
    pub fn distance_m(&self, from: usize, to: usize) -> f64 {
        self.distance_m[from * self.count + to]
    }

    /// Height of thing `to` over thing `from`, metres.
    #[must_use]
    pub fn rise_m(&self, from: usize, to: usize) -> f64 {
        self.z[to] - self.z[from]
    }

    /// The distance in words; `None` when it is not a number.
    #[must_use]
    pub fn distance(&self, from: usize, to: usize) -> Option<DistanceWord> {
        let at = from * self.count + to;
        let word = DistanceWord::ALL[usize::from(self.distance_code[at])];
        if self.distance_m[at].is_nan() { distance::word(f64::NAN) } else { Some(word) }
    }

    /// The sector in which thing `to` lies to thing `from`, under the physical convention.
    #[must_use]
    pub fn physical_sector(&self, from: usize, to: usize) -> Sector {
        let code = self.sector_code[from * self.count + to];
        let sector = TO_THE_LEFT[usize::from(code & 7)];
        if code & 8 == 0 { sector } else { sector.mirrored() }
    }

    /// Where thing `to` is, seen from thing `from`, in words.
    #[must_use]
    pub fn direction(&self, from: usize, to: usize) -> Direction {
        let (sector, rise_m) = (self.physical_sector(from, to), self.rise_m(from, to));
        match self.lateral {
            LateralConvention::Physical => {
                Direction { sector, elevation: Elevation::of_rise(rise_m) }
            }
            LateralConvention::EngineHead => {
                Direction { sector: sector.mirrored(), elevation: Elevation::of_rise(-rise_m) }
            }
        }
    }
}
