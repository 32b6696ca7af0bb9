//! The default rule: the densest range bin in the core of the box.

use jrdb_types::{PixelBox, rig::CylindricalPanorama};
use nalgebra::Point3;

use super::Located;
use crate::{BaseCloud, ProjectionConfig};

/// A box that comes this near to the top or bottom row, pixels, is taken to be cut off by the image.
pub(crate) const EDGE_PX: f64 = 2.0;

/// Middle of the densest range bin among the points `inside` the box; `None` without points.
///
/// 1. Keep the points in the core of the box ([`ProjectionConfig::core_columns`], `core_rows`), or all of
///    them when the core has none.
/// 2. For a person, keep the ranges at which a box of this many rows is a person's height
///    (`person_height_m`; skipped for a box cut off by the image), or all when none is left.
/// 3. Take the window of `bin_m` metres of horizontal range that holds most points, the nearest on a tie.
/// 4. The centre is the per-axis median of its points, moved away from the camera by
///    `surface_to_center_m`.
#[must_use]
pub fn densest_range(
    cloud: &BaseCloud,
    inside: &[usize],
    bbox: &PixelBox,
    is_person: IsPerson,
    camera: &CylindricalPanorama,
    config: &ProjectionConfig,
) -> Option<Located> {
    let width = f64::from(camera.width_px);
    let core: Vec<usize> = inside
        .iter()
        .copied()
        .filter(|&i| in_core(bbox, cloud.u[i], cloud.v[i], width, config))
        .collect();
    let candidates = if core.is_empty() { inside.to_vec() } else { core };
    let range = |i: usize| cloud.points[i].x.hypot(cloud.points[i].y);
    let candidates = match is_person {
        IsPerson::Yes => keep_plausible(candidates, range, plausible_ranges(bbox, camera, config)),
        IsPerson::No => candidates,
    };
    let used = densest_window(candidates, range, config.bin_m)?;
    let median = median_point(&used, &cloud.points);
    let range_m = median.x.hypot(median.y);
    let away = (range_m + config.surface_to_center_m) / range_m;
    Some(Located { center: Point3::new(median.x * away, median.y * away, median.z), used })
}

/// Whether the height of a person bounds the range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IsPerson {
    /// A person.
    Yes,
    /// Something of unknown size.
    No,
}

fn in_core(bbox: &PixelBox, u: f64, v: f64, width: f64, config: &ProjectionConfig) -> bool {
    let across = (u - bbox.x).rem_euclid(width) / bbox.w;
    let down = (v - bbox.y) / bbox.h;
    let [left, right] = config.core_columns;
    let [top, bottom] = config.core_rows;
    (left..=right).contains(&across) && (top..=bottom).contains(&down)
}

/// Nearest and farthest range of the visible surface at which `bbox` may be a whole person.
fn plausible_ranges(
    bbox: &PixelBox,
    camera: &CylindricalPanorama,
    config: &ProjectionConfig,
) -> [f64; 2] {
    let cut_off = bbox.y < EDGE_PX || bbox.y + bbox.h > f64::from(camera.height_px) - EDGE_PX;
    let [low, high] = config.person_height_m.map(|height_m| camera.focal_px * height_m / bbox.h);
    // Of a cut-off person only a part is in the box, and a part may be as near as it likes.
    let slack = config.bin_m / 2.0;
    [if cut_off { 0.0 } else { low - slack }, high + slack]
}

fn keep_plausible(
    all: Vec<usize>,
    range: impl Fn(usize) -> f64,
    [near, far]: [f64; 2],
) -> Vec<usize> {
    let kept: Vec<usize> =
        all.iter().copied().filter(|&i| (near..=far).contains(&range(i))).collect();
    if kept.is_empty() { all } else { kept }
}

fn densest_window(
    mut candidates: Vec<usize>,
    range: impl Fn(usize) -> f64,
    bin_m: f64,
) -> Option<Vec<usize>> {
    candidates.sort_by(|&a, &b| range(a).total_cmp(&range(b)).then(a.cmp(&b)));
    let mut best = 0..0;
    let mut end = 0;
    for start in 0..candidates.len() {
        while end < candidates.len() && range(candidates[end]) <= range(candidates[start]) + bin_m {
            end += 1;
        }
        if end - start > best.len() {
            best = start..end;
        }
    }
    let mut used = candidates[best].to_vec();
    used.sort_unstable();
    (!used.is_empty()).then_some(used)
}

fn median_point(used: &[usize], points: &[Point3<f64>]) -> Point3<f64> {
    let median = |axis: usize| {
        let mut values: Vec<f64> = used.iter().map(|&i| points[i][axis]).collect();
        values.sort_by(f64::total_cmp);
        let middle = values.len() / 2;
        if values.len() % 2 == 1 {
            values[middle]
        } else {
            f64::midpoint(values[middle - 1], values[middle])
        }
    };
    Point3::new(median(0), median(1), median(2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CameraModel;
    use crate::select::points_in_boxes;
    use crate::testing::PANORAMA as CAMERA;

    fn cloud(points: &[[f64; 3]]) -> BaseCloud {
        let points: Vec<Point3<f64>> = points.iter().map(|&p| Point3::from(p)).collect();
        let pixels: Vec<_> = points.iter().map(|p| CAMERA.pixel_from_base(p).unwrap()).collect();
        BaseCloud {
            points,
            u: pixels.iter().map(|p| p.u).collect(),
            v: pixels.iter().map(|p| p.v).collect(),
        }
    }

    fn locate(points: &[[f64; 3]], bbox: [f64; 4]) -> Option<Point3<f64>> {
        let (cloud, bbox) = (cloud(points), PixelBox::from(bbox));
        let inside = points_in_boxes(&cloud, &[bbox], CylindricalPanorama::image(&CAMERA));
        let config = ProjectionConfig::default();
        densest_range(&cloud, &inside[0], &bbox, IsPerson::Yes, &CAMERA, &config).map(|l| l.center)
    }

    /// The box of a person of 1.7 m at 4 m straight ahead: 204 rows.
    const PERSON: [f64; 4] = [1850.0, 130.0, 60.0, 204.0];

    #[test]
    fn a_wall_with_more_points_does_not_pull_the_person_away() {
        let person = [[3.9, 0.0, 0.3], [3.9, 0.02, 0.2], [3.95, -0.02, 0.1]];
        let wall: Vec<[f64; 3]> = (0..9).map(|i| [9.0, 0.02 * f64::from(i), 0.0]).collect();
        let center = locate(&[&person[..], &wall[..]].concat(), PERSON).unwrap();
        assert!((center.x - 4.0).abs() < 0.02, "{center}");
    }

    #[test]
    fn an_occluder_too_near_to_be_that_person_is_refused() {
        let occluder: Vec<[f64; 3]> = (0..9).map(|i| [1.0, 0.002 * f64::from(i), 0.05]).collect();
        let center = locate(&[&[[3.9, 0.0, 0.3]], &occluder[..]].concat(), PERSON).unwrap();
        assert!((center.x - 4.0).abs() < 1e-9, "{center}");
    }

    #[test]
    fn no_point_no_place() {
        assert_eq!(locate(&[[3.9, 3.9, 0.0]], PERSON), None);
    }
}
