//! A vote over all tilts and heights: the lowest plane with many voters.

use std::collections::BTreeMap;

use nalgebra::Point3;

use crate::FloorConfig;
use crate::plane::Plane;

/// The lowest point of each square of the ground: they alone vote.
pub(crate) fn lowest_of_cells(points: &[Point3<f64>], cell_m: f64) -> Vec<Point3<f64>> {
    let mut lowest: BTreeMap<[i64; 2], Point3<f64>> = BTreeMap::new();
    for point in points {
        let cell = [point.x, point.y].map(|v| (v / cell_m).floor() as i64);
        let kept = lowest.entry(cell).or_insert(*point);
        if point.z < kept.z {
            *kept = *point;
        }
    }
    lowest.into_values().collect()
}

/// The lowest plane that is strong among the planes near it and among all; absent when no voter lies
/// in the range of heights.
pub(crate) fn lowest_strong_plane(voters: &[Point3<f64>], config: &FloorConfig) -> Option<Plane> {
    let profile = profile(voters, config);
    let most = profile.iter().map(|best| best.votes).max().filter(|&votes| votes > 0)?;
    let strong = config.strong_share * most as f64;
    let reach = (config.separation_m / config.tolerance_m).ceil() as usize;
    let leads = |i: usize| {
        let around = i.saturating_sub(reach)..(i + reach + 1).min(profile.len());
        profile[around].iter().all(|other| other.votes <= profile[i].votes)
    };
    let floor = (0..profile.len()).find(|&i| profile[i].votes as f64 >= strong && leads(i))?;
    let height_m = config.height_range_m[0] + config.tolerance_m * (floor + 1) as f64;
    Some(Plane::from_slopes(profile[floor].slopes, height_m))
}

/// The tilt with the most voters at one height.
#[derive(Debug, Clone, Copy, Default)]
struct Best {
    votes: usize,
    slopes: [f64; 2],
}

/// For each height, one tolerance apart from the lowest up: the best of all tilts.
///
/// A plane's voters are those within one tolerance above or below it: two neighbouring bins of a
/// histogram of heights along the tilt.
fn profile(voters: &[Point3<f64>], config: &FloorConfig) -> Vec<Best> {
    let [low_m, high_m] = config.height_range_m;
    let bins = ((high_m - low_m) / config.tolerance_m).ceil() as usize + 1;
    let mut best = vec![Best::default(); bins - 1];
    let mut counts = vec![0; bins];
    for slopes in slopes(config) {
        counts.fill(0);
        for voter in voters {
            let height_m = voter.z - slopes[0] * voter.x - slopes[1] * voter.y;
            let bin = (height_m - low_m) / config.tolerance_m;
            if bin >= 0.0 && bin < bins as f64 {
                counts[bin as usize] += 1;
            }
        }
        for (best, pair) in best.iter_mut().zip(counts.windows(2)) {
            let votes = pair[0] + pair[1];
            if votes > best.votes {
                *best = Best { votes, slopes };
            }
        }
    }
    best
}

/// Every tilt allowed, so dense that neighbours differ by one tolerance at the end of the range; the
/// gentlest first, so that they win ties.
fn slopes(config: &FloorConfig) -> Vec<[f64; 2]> {
    let step = config.tolerance_m / config.range_m;
    let steepest = config.max_tilt_rad.tan();
    let count = (steepest / step).floor() as i32;
    let slope = |i: i32| f64::from(i) * step;
    let mut grid: Vec<[f64; 2]> = (-count..=count)
        .flat_map(|i| (-count..=count).map(move |j| [slope(i), slope(j)]))
        .filter(|[a, b]| a.hypot(*b) <= steepest)
        .collect();
    grid.sort_by(|[a, b], [c, d]| a.hypot(*b).total_cmp(&c.hypot(*d)));
    grid
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(z: f64, side: i32) -> impl Iterator<Item = Point3<f64>> {
        let at = move |i: i32| (f64::from(i) + 0.5) * 0.2;
        (-side..side).flat_map(move |i| (-side..side).map(move |j| Point3::new(at(i), at(j), z)))
    }

    fn height_m(planes: &[(f64, i32)]) -> Option<f64> {
        let voters: Vec<_> = planes.iter().flat_map(|&(z, side)| square(z, side)).collect();
        lowest_strong_plane(&voters, &FloorConfig::default()).map(|plane| plane.height_m())
    }

    #[test]
    fn a_square_has_one_voter_its_lowest_point() {
        let points = [[0.1, 0.1, 0.5], [0.15, 0.1, -0.9], [0.1, 0.1, 1.0], [-0.1, 0.1, 0.2]];
        let voters = lowest_of_cells(&points.map(Point3::from), 0.2);
        assert_eq!(voters, [[-0.1, 0.1, 0.2], [0.15, 0.1, -0.9]].map(Point3::from));
    }

    #[test]
    fn the_lower_of_two_strong_planes_is_taken_though_it_is_the_weaker() {
        assert!((height_m(&[(-0.92, 14), (-0.17, 18)]).unwrap() + 0.92).abs() <= 0.05);
    }

    #[test]
    fn a_weak_plane_under_the_floor_is_not_taken() {
        assert!((height_m(&[(-1.8, 6), (-0.92, 18)]).unwrap() + 0.92).abs() <= 0.05);
    }

    #[test]
    fn planes_a_step_apart_are_one_and_the_stronger_speaks_for_both() {
        assert!((height_m(&[(-1.07, 14), (-0.92, 18)]).unwrap() + 0.92).abs() <= 0.05);
    }

    #[test]
    fn nothing_at_the_heights_allowed_is_no_plane() {
        assert_eq!(height_m(&[(3.0, 18)]), None);
        assert_eq!(height_m(&[]), None);
    }

    #[test]
    fn tilts_start_level_and_end_within_the_limit() {
        let tilts = slopes(&FloorConfig::default());
        assert_eq!(tilts[0], [0.0, 0.0]);
        let steepest = tilts.last().unwrap();
        let limit = FloorConfig::default().max_tilt_rad.tan();
        assert!((limit - 0.005..=limit).contains(&steepest[0].hypot(steepest[1])));
    }
}
