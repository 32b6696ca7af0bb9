//! Distance and direction words of all ordered pairs at once, without an arc tangent.

use jrdb_types::vocab::{Elevation, Sector};
use jrdb_types::{Direction, DistanceWord, LateralConvention};
use nalgebra::Point3;

use crate::simd::{Loop, vectorised};

/// The sectors to the left by the number of bounds that are exceeded.
const TO_THE_LEFT: [Sector; 5] =
    [Sector::Front, Sector::FrontLeft, Sector::Left, Sector::BackLeft, Sector::Back];

/// The words of every ordered pair of things, a byte each.
///
/// Row `i` is how things lie to thing `i`. On the diagonal stands what a thing would be to itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Pairwise {
    centers: Vec<Point3<f64>>,
    lateral: LateralConvention,
    codes: Vec<u8>,
}

/// How many bounds of sectors the bearing exceeds, 0 to 4.
const SECTOR: u8 = 7;
/// To the right.
const RIGHT: u8 = 8;
/// One bound of distances exceeded; there are four.
const DISTANCE: u8 = 16;
/// So near to a bound that rounding decides.
const NEAR: u8 = 128;

/// Relates every ordered pair of things: the same words as [`super::from_person`], many pairs at a time.
///
/// `centers` in metres and `headings_rad` in any one frame with z up; equally long, as thing `i` has center and
/// heading `i`.
///
/// The bearing exceeds the bound β where `left · cos β - ahead · sin β` is positive; the four signs are the sector. All is
/// in single precision; where that may be wrong, [`super::from_person`] decides.
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
    let places = Places::new(centers);
    // A row is written to the end of its last block of lanes, and the next over what is too much.
    let width = places.columns[0].len();
    let mut codes = vec![0; count * count + (width - count)];
    for (at, (center, &heading_rad)) in centers.iter().zip(headings_rad).enumerate() {
        let codes = &mut codes[at * count..][..width];
        let (sin, cos) = heading_rad.sin_cos();
        let sin_cos = [sin, cos].map(|v| v as f32);
        let mut is_near = false;
        vectorised(Row { places: &places, at, sin_cos, codes, is_near: &mut is_near });
        if is_near {
            decide(center, heading_rad, centers, codes);
        }
    }
    codes.truncate(count * count);
    Pairwise { centers: centers.to_vec(), lateral, codes }
}

/// Finds the words of one row that are uncertain by their definition.
fn decide(from: &Point3<f64>, heading_rad: f64, centers: &[Point3<f64>], codes: &mut [u8]) {
    for (to, code) in centers.iter().zip(codes).filter(|(_, code)| **code & NEAR != 0) {
        let alone = super::from_person(from, Some(heading_rad), to, LateralConvention::Physical);
        let exceeded = alone.distance.map_or(0, |word| word as u8);
        *code = (exceeded * DISTANCE) | alone.direction.map_or(0, code_of);
    }
}

/// Coordinates from the first thing on, metres in single precision, and what that makes uncertain.
struct Places {
    columns: [Vec<f32>; 3],
    /// 0, 1, 2 and so on.
    numbers: Vec<f32>,
    /// Everything that a place and its bearing tell is right within this, metres.
    error_m: f32,
    /// From which squared distance on a bound may be exceeded, and from which it is.
    bounds_m2: [[f32; 2]; 4],
}

/// Columns are filled up to a multiple of so many: two of the widest registers.
const LANES: usize = 32;

impl Places {
    fn new(centers: &[Point3<f64>]) -> Self {
        let origin = centers.first().copied().unwrap_or_default();
        let width = centers.len().next_multiple_of(LANES);
        let columns = [0, 1, 2].map(|axis| {
            let mut column: Vec<f32> =
                centers.iter().map(|c| (c[axis] - origin[axis]) as f32).collect();
            column.resize(width, 0.0);
            column
        });
        let numbers = (0..width).map(|number| number as f32).collect();
        let reach_m = columns.iter().flatten().fold(0.0_f32, |reach, c| reach.max(c.abs()));
        let error_m = reach_m * ERROR;
        let bounds_m2 = [0.5, 1.5, 5.0, 10.0].map(|bound_m: f32| {
            [bound_m - error_m, bound_m + error_m].map(|bound_m| bound_m.max(0.0).powi(2))
        });
        Self { columns, numbers, error_m, bounds_m2 }
    }
}

/// Bound of the error in parts of the greatest coordinate: 64 roundings. How far a place is past a bound of sectors is
/// within 36 (4 of each offset, 14 of turning it, the rest of turning it again), a distance within 20.
const ERROR: f32 = 64.0 * (f32::EPSILON / 2.0);

/// How all things lie to one, which is turned by an angle.
struct Row<'a> {
    places: &'a Places,
    at: usize,
    /// Of its heading.
    sin_cos: [f32; 2],
    codes: &'a mut [u8],
    /// Whether a code is [`NEAR`].
    is_near: &'a mut bool,
}

/// Sine and cosine of 30° and of 145°.
const BOUND_30: (f32, f32) = (0.5, 0.866_025_4);
const BOUND_145: (f32, f32) = (0.573_576_45, -0.819_152_06);

/// 2²³: from here on floats are whole, so that their lowest byte counts.
const COUNTER: f32 = 8_388_608.0;

impl Loop for Row<'_> {
    #[inline(always)]
    fn run(self) {
        let [sin, cos] = self.sin_cos;
        let [x, y, z] = &self.places.columns;
        let [x0, y0, z0] = [x, y, z].map(|column| column[self.at]);
        let itself = self.at as f32;
        let error2_m2 = self.places.error_m * self.places.error_m;
        let mut all = 0;
        let things = x.iter().zip(y).zip(z).zip(&self.places.numbers);
        for ((((&x, &y), &z), &number), code) in things.zip(self.codes) {
            let [dx, dy, dz] = [x - x0, y - y0, z - z0];
            let on_floor_m2 = dx.mul_add(dx, dy * dy);
            let [exceeded, perhaps] = exceeded(dz.mul_add(dz, on_floor_m2), &self.places.bounds_m2);
            let (ahead, left) = (cos.mul_add(dx, sin * dy), cos.mul_add(dy, -sin * dx));
            let beside = left.abs();
            let past = |(sin, cos): (f32, f32)| beside.mul_add(cos, -sin * ahead);
            let [past_30, past_45] = [past(BOUND_30), beside - ahead];
            let [past_135, past_145] = [-beside - ahead, past(BOUND_145)];
            let mut sum = exceeded;
            for past in [past_30, past_45, past_135, past_145] {
                sum = if past > 0.0 { sum + 1.0 } else { sum };
            }
            sum = if left < 0.0 { sum + f32::from(RIGHT) } else { sum };
            // Past no bound is a place farther than √2 of its distance, so a product tells how near the nearer of two is.
            let sure = error2_m2 * on_floor_m2;
            let [front, back] =
                [past_30 * past_45, past_135 * past_145].map(|product| product * product);
            let is_sure = (front > sure) & (back > sure) & (exceeded >= perhaps);
            sum = if is_sure | (number == itself) { sum } else { sum + f32::from(NEAR) };
            *code = sum.to_bits() as u8;
            all |= *code;
        }
        *self.is_near = all & NEAR != 0;
    }
}

/// [`COUNTER`] with the bounds that a squared distance exceeds, and that it may exceed.
#[inline(always)]
fn exceeded(square_m2: f32, bounds_m2: &[[f32; 2]; 4]) -> [f32; 2] {
    let mut sums = [COUNTER; 2];
    for [perhaps_m2, surely_m2] in bounds_m2 {
        sums[0] = if square_m2 > *surely_m2 { sums[0] + f32::from(DISTANCE) } else { sums[0] };
        sums[1] = if square_m2 >= *perhaps_m2 { sums[1] + f32::from(DISTANCE) } else { sums[1] };
    }
    sums
}

fn code_of(direction: Direction) -> u8 {
    let place = |sector: Sector| TO_THE_LEFT.iter().position(|&s| s == sector);
    let code = match place(direction.sector) {
        Some(code) => code,
        None => place(direction.sector.mirrored()).map_or(0, |code| code | usize::from(RIGHT)),
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
        (self.centers[to] - self.centers[from]).norm()
    }

    /// Height of thing `to` over thing `from`, metres.
    #[must_use]
    pub fn rise_m(&self, from: usize, to: usize) -> f64 {
        self.centers[to].z - self.centers[from].z
    }

    /// The distance in words; `None` when it is not a number.
    #[must_use]
    pub fn distance(&self, from: usize, to: usize) -> Option<DistanceWord> {
        let exceeded = self.code(from, to) / DISTANCE;
        // What is not a number exceeds no bound.
        if exceeded == 0 && self.distance_m(from, to).is_nan() {
            return None;
        }
        Some(DistanceWord::ALL[usize::from(exceeded)])
    }

    /// The sector in which thing `to` lies to thing `from`, under the physical convention.
    #[must_use]
    pub fn physical_sector(&self, from: usize, to: usize) -> Sector {
        let code = self.code(from, to);
        let sector = TO_THE_LEFT[usize::from(code & SECTOR)];
        if code & RIGHT == 0 { sector } else { sector.mirrored() }
    }

    fn code(&self, from: usize, to: usize) -> u8 {
        self.codes[from * self.centers.len() + to]
    }

    /// Where thing `to` is, seen from thing `from`, in words.
    #[must_use]
    pub fn direction(&self, from: usize, to: usize) -> Direction {
        let (sector, rise_m) = (self.physical_sector(from, to), self.rise_m(from, to));
        match self.lateral {
            LateralConvention::Physical => {
                Direction { sector, elevation: Elevation::of_rise(rise_m) }
            }
            LateralConvention::BenchmarkMirrored => {
                Direction { sector: sector.mirrored(), elevation: Elevation::of_rise(-rise_m) }
            }
        }
    }
}
