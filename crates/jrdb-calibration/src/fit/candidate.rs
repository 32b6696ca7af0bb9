//! Where the image may have an edge because a near thing ends before a far one.

use jrdb_projection::CameraModel;
use nalgebra::{Isometry3, Point3};

use super::FitConfig;
use super::gradient::EdgeImage;
use super::rings::{Beam, rings};

/// Of the places where no surface ends, one of so many is kept: they only say what is usual.
const SMOOTH_KEPT: usize = 4;
/// Neighbours of a ring are at most this many column widths apart.
const RING_GAP_COLUMNS: f64 = 2.0;
/// A place at most this share of the image outside it is kept: the search may bring it in.
const MARGIN: f64 = 0.25;

/// A place between two neighbouring beams.
#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate {
    place: Place,
    /// Whether a near surface ends there before a far one; else it is a place like any other.
    pub(super) is_end: bool,
    /// Which part of the evidence it is left out with, see [`FitConfig::sectors`].
    pub(super) unit: usize,
}

/// Where the near surface, if it ends, ends: base frame, metres.
#[derive(Debug, Clone, Copy)]
enum Place {
    /// At a point: an upright edge.
    At(Point3<f64>),
    /// Between two points, one above the other: a level edge.
    Between([Point3<f64>; 2]),
}

/// The places of one LiDAR in one view.
#[derive(Debug, Clone)]
pub(super) struct Candidates {
    pub(super) origin: Point3<f64>,
    /// Between neighbours of a ring: they fix columns.
    pub(super) upright: Vec<Candidate>,
    /// Between neighbours of a column: they fix rows.
    pub(super) level: Vec<Candidate>,
}

impl Candidates {
    /// The places of a sweep; those far outside the camera's image are left out.
    ///
    /// Units are numbered from `first_unit` by sector.
    pub(super) fn of(
        origin: Point3<f64>,
        points: &[Point3<f64>],
        (camera, first_unit): (&dyn CameraModel, usize),
        config: &FitConfig,
    ) -> Self {
        let rings = rings(&origin, points, config);
        let seen = |candidate: &Candidate| candidate.is_near_image(camera);
        let finish = |all: Vec<Candidate>| {
            let mut smooth = 0_usize;
            let mut kept = |candidate: &Candidate| {
                smooth += usize::from(!candidate.is_end);
                candidate.is_end || smooth.is_multiple_of(SMOOTH_KEPT)
            };
            let near = all.into_iter().filter(seen);
            let numbered = near.map(|c| Candidate { unit: c.unit + first_unit, ..c });
            numbered.filter(|candidate| kept(candidate)).collect()
        };
        let upright = finish(upright(&origin, &rings, config));
        let level = finish(level(&origin, &rings, config));
        Self { origin, upright, level }
    }
}

impl Candidate {
    fn is_near_image(&self, camera: &dyn CameraModel) -> bool {
        let (Place::At(point) | Place::Between([point, _])) = self.place;
        let image = camera.image();
        let size = [image.width_px, image.height_px].map(f64::from);
        camera.pixel_from_base(&point).is_some_and(|pixel| {
            let near = |at: f64, size: f64| (-MARGIN * size..(1.0 + MARGIN) * size).contains(&at);
            near(pixel.u, size[0]) && near(pixel.v, size[1])
        })
    }

    /// How strong the image's edge is there once the cloud has moved.
    pub(super) fn strength(
        &self,
        moved: &Isometry3<f64>,
        camera: &dyn CameraModel,
        image: &EdgeImage,
    ) -> f64 {
        let pixel = |point: &Point3<f64>| camera.pixel_from_base(&(moved * point));
        match &self.place {
            Place::At(point) => pixel(point).map_or(0.0, |at| image.upright(at.u, at.v)),
            Place::Between([lower, upper]) => match (pixel(lower), pixel(upper)) {
                (Some(a), Some(b)) => image.level(a.u, [a.v, b.v]),
                _ => 0.0,
            },
        }
    }
}

/// Whether a surface ends between two beams: how much the step between them exceeds the steps beside it,
/// relative to the nearer beam. Without a step on either side nothing is usual.
fn is_end(step: f64, beside: [Option<f64>; 2], nearer: f64, config: &FitConfig) -> bool {
    let usual = beside.iter().flatten().fold(0.0, |most: f64, step| most.max(step.abs()));
    let known = beside.iter().any(Option::is_some);
    known && (step.abs() - usual) / nearer > config.min_jump
}

/// Places between neighbours of one ring, at the range of the nearer.
fn upright(origin: &Point3<f64>, rings: &[Vec<Beam>], config: &FitConfig) -> Vec<Candidate> {
    let widest_rad = RING_GAP_COLUMNS * config.column_rad;
    let step = |pair: &[Beam]| {
        let near = pair[1].azimuth_rad - pair[0].azimuth_rad <= widest_rad;
        near.then(|| pair[1].inverse_range - pair[0].inverse_range)
    };
    let mut found = Vec::new();
    for ring in rings {
        let steps: Vec<Option<f64>> = ring.windows(2).map(step).collect();
        for (i, pair) in ring.windows(2).enumerate() {
            let Some(step) = steps[i] else { continue };
            let beside = [i.checked_sub(1), Some(i + 1)];
            let beside = beside.map(|at| at.and_then(|at| steps.get(at).copied().flatten()));
            let near = if step > 0.0 { pair[1] } else { pair[0] };
            let azimuth_rad = (pair[0].azimuth_rad + pair[1].azimuth_rad) / 2.0;
            let middle = Beam { azimuth_rad, ..near };
            found.push(Candidate {
                place: Place::At(middle.point(origin, near.inverse_range)),
                is_end: is_end(step, beside, near.inverse_range, config),
                unit: middle.part(config.sectors),
            });
        }
    }
    found
}

/// Places between neighbours of one column. Where the nearer surface ends, it is continued in its own plane up
/// to the farther beam: the end is somewhere on it. Elsewhere the place is between the two points.
fn level(origin: &Point3<f64>, rings: &[Vec<Beam>], config: &FitConfig) -> Vec<Candidate> {
    let columns = (std::f64::consts::TAU / config.column_rad).ceil() as usize;
    let mut grid = vec![vec![None::<Beam>; rings.len()]; columns];
    for (r, ring) in rings.iter().enumerate() {
        for beam in ring {
            grid[beam.part(columns)][r] = Some(*beam);
        }
    }
    let mut found = Vec::new();
    for column in &grid {
        let step = |i: usize| {
            let [a, b] = [column.get(i)?.as_ref()?, column.get(i + 1)?.as_ref()?];
            Some(b.inverse_range - a.inverse_range)
        };
        for i in 0..column.len().saturating_sub(1) {
            let (Some(lower), Some(upper), Some(jump)) = (column[i], column[i + 1], step(i)) else {
                continue;
            };
            let beside = [i.checked_sub(1).and_then(step), step(i + 1)];
            let nearer = lower.inverse_range.max(upper.inverse_range);
            let is_end = is_end(jump, beside, nearer, config);
            let ranges = if is_end {
                continued([lower, upper], beside)
            } else {
                [lower.inverse_range, upper.inverse_range]
            };
            let ends = [lower.point(origin, ranges[0]), upper.point(origin, ranges[1])];
            let unit = lower.part(config.sectors);
            found.push(Candidate { place: Place::Between(ends), is_end, unit });
        }
    }
    found
}

/// Inverse ranges of the nearer surface on both beams: `beside` are its steps before and after the pair.
fn continued([lower, upper]: [Beam; 2], beside: [Option<f64>; 2]) -> [f64; 2] {
    let [low, high] = [lower.inverse_range, upper.inverse_range];
    let near_is_lower = low > high;
    let (near, far) = if near_is_lower { (low, high) } else { (high, low) };
    let step = if near_is_lower { beside[0] } else { beside[1].map(|step| -step) };
    let other = (near + step.unwrap_or(0.0)).clamp(far, near);
    if near_is_lower { [near, other] } else { [other, near] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_projection::camera::PosedCamera;
    use jrdb_types::CylindricalPanorama;

    fn camera() -> PosedCamera<CylindricalPanorama> {
        PosedCamera::ahead(CylindricalPanorama {
            width_px: 3760,
            height_px: 480,
            focal_px: 480.0,
            horizon_px: 210.0,
        })
    }

    /// A wall all around at 6 m, and before it a block at 2 m, up to 0.1 m, within ±0.3 rad ahead; 16 rings.
    fn points() -> Vec<Point3<f64>> {
        let ring = |k: i32| f64::from(2 * k - 15).to_radians().tan();
        let beams = (0..16).flat_map(|k| (-900..900).map(move |i| (ring(k), f64::from(i))));
        let at = |(slope, column): (f64, f64)| {
            let azimuth = (column * 0.2 + 0.1).to_radians();
            let near = azimuth.abs() < 0.3 && 2.0 * slope < 0.1;
            let range = if near { 2.0 } else { 6.0 };
            Point3::new(azimuth.cos(), azimuth.sin(), slope) * range
        };
        beams.map(at).collect()
    }

    fn candidates() -> Candidates {
        Candidates::of(Point3::origin(), &points(), (&camera(), 0), &FitConfig::default())
    }

    fn ends(all: &[Candidate]) -> Vec<Place> {
        all.iter().filter(|c| c.is_end).map(|c| c.place).collect()
    }

    #[test]
    fn sides_of_a_block_are_at_its_range_between_the_beams() {
        let ends = ends(&candidates().upright);
        assert_eq!(ends.len(), 18);
        for place in ends {
            let Place::At(point) = place else { unreachable!() };
            assert!((point.xy().coords.norm() - 2.0).abs() < 1e-9);
            assert!((point.y.atan2(point.x).abs() - 0.3).abs() < 0.004);
        }
    }

    #[test]
    fn the_top_of_a_block_is_between_two_rings_at_its_range() {
        let ends = ends(&candidates().level);
        assert!((80..=90).contains(&ends.len()), "{}", ends.len());
        for place in ends {
            let Place::Between([lower, upper]) = place else { unreachable!() };
            assert!(lower.z < 0.1 && 0.1 < upper.z, "{lower} {upper}");
            assert!((upper.xy().coords.norm() - 2.0).abs() < 1e-9);
        }
    }

    #[test]
    fn a_floor_ends_nowhere_though_its_rings_lie_far_apart() {
        let slopes = (1..8).map(|k| -f64::from(2 * k - 1).to_radians().tan());
        let beams =
            slopes.flat_map(|s| (0..900).map(move |i| (s, (f64::from(i) * 0.4).to_radians())));
        let floor: Vec<_> =
            beams.map(|(slope, a)| Point3::new(a.cos(), a.sin(), slope) * (-0.9 / slope)).collect();
        let found = Candidates::of(Point3::origin(), &floor, (&camera(), 0), &FitConfig::default());
        assert!(ends(&found.level).is_empty() && ends(&found.upright).is_empty());
        assert!(!found.level.is_empty());
    }

    #[test]
    fn a_table_is_continued_in_its_plane() {
        let beam = |slope: f64, inverse_range| Beam { azimuth_rad: 0.0, slope, inverse_range };
        // A table 0.5 m below the LiDAR, seen at slopes -0.2 (and -0.25), before a wall at slope -0.15.
        let ends = continued([beam(-0.2, 0.4), beam(-0.15, 0.1)], [Some(-0.1), Some(0.0)]);
        assert!((ends[1] - 0.3).abs() < 1e-12);
        assert_eq!(continued([beam(-0.2, 0.4), beam(-0.15, 0.1)], [None, None]), [0.4, 0.4]);
    }
}
