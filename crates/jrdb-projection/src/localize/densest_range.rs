//! The default rule: the densest range bin in the core of the box.

use jrdb_types::{ImageGeometry, PixelBox};
use nalgebra::Point3;

use super::Located;
use crate::box_view::BoxView;
use crate::{BaseCloud, ProjectionConfig};

/// A box and what is known of the thing in it.
#[derive(Debug, Clone, Copy)]
pub struct Target<'a> {
    /// Where it is in the image.
    pub bbox: &'a PixelBox,
    /// The image.
    pub image: ImageGeometry,
    /// Its lines of sight, where the lens has any.
    pub view: Option<BoxView>,
    /// Whether the height of a person bounds the range.
    pub is_person: bool,
}

/// Middle of the densest range bin among the points `inside` the box; `None` without points.
///
/// 1. Keep the points in the core of the box ([`ProjectionConfig::core_columns`], `core_rows`), or all of
///    them when the core has none.
/// 2. For a person, keep the ranges at which a box of this many rows is a person's height
///    (`person_height_m`; without a lower bound for a box cut off by the image), or all when none is left.
/// 3. Take the window of `bin_m` metres of horizontal range that holds most points, the nearest on a tie.
/// 4. The centre is the per-axis median of its points, moved away from the camera by
///    `surface_to_center_m`.
#[must_use]
pub fn densest_range(
    cloud: &BaseCloud,
    inside: &[u32],
    target: &Target<'_>,
    config: &ProjectionConfig,
) -> Option<Located> {
    let eye = target.view.map_or_else(Point3::origin, |view| view.origin);
    let range = |i: u32| {
        let point = cloud.point(i as usize);
        (point.x - eye.x).hypot(point.y - eye.y)
    };
    let core = |i: &u32| in_core(target, cloud.u[*i as usize], cloud.v[*i as usize], config);
    let in_core: Vec<u32> = inside.iter().copied().filter(core).collect();
    let candidates = if in_core.is_empty() { inside } else { &in_core };
    let ranged = candidates.iter().map(|&i| (range(i), i)).collect();
    let used = densest_window(keep_plausible(ranged, target, config), config.bin_m)?;
    let median = median_point(&used, cloud);
    let range_m = (median.x - eye.x).hypot(median.y - eye.y);
    let away = config.surface_to_center_m / range_m;
    let center = Point3::new(
        median.x + (median.x - eye.x) * away,
        median.y + (median.y - eye.y) * away,
        median.z,
    );
    Some(Located { center, used })
}

fn in_core(target: &Target<'_>, u: f32, v: f32, config: &ProjectionConfig) -> bool {
    let bbox = target.bbox;
    let from_left = f64::from(u) - bbox.x;
    let from_left = match target.image.period_px() {
        Some(period) => from_left.rem_euclid(period),
        None => from_left,
    };
    let down = (f64::from(v) - bbox.y) / bbox.h;
    let [left, right] = config.core_columns;
    let [top, bottom] = config.core_rows;
    (left..=right).contains(&(from_left / bbox.w)) && (top..=bottom).contains(&down)
}

/// Nearest and farthest range of the visible surface at which the box may be a whole person.
fn plausible_ranges(view: &BoxView, config: &ProjectionConfig) -> [f64; 2] {
    let [low, high] = config.person_height_m.map(|height_m| view.range_at_height_m(height_m));
    // Of a cut-off person only a part is in the box, and a part may be as near as it likes.
    let slack = config.bin_m / 2.0;
    [if view.cut_off.contains(&true) { 0.0 } else { low - slack }, high + slack]
}

/// The points at a range where the box may be a person; all of them when there are none, or when this says
/// nothing.
fn keep_plausible(
    ranged: Vec<(f64, u32)>,
    target: &Target<'_>,
    config: &ProjectionConfig,
) -> Vec<(f64, u32)> {
    let Some(view) = target.view.filter(|_| target.is_person) else { return ranged };
    let [near, far] = plausible_ranges(&view, config);
    let kept: Vec<(f64, u32)> =
        ranged.iter().copied().filter(|(range, _)| (near..=far).contains(range)).collect();
    if kept.is_empty() { ranged } else { kept }
}

fn densest_window(mut ranged: Vec<(f64, u32)>, bin_m: f64) -> Option<Vec<u32>> {
    ranged.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut best = 0..0;
    let mut end = 0;
    for start in 0..ranged.len() {
        while end < ranged.len() && ranged[end].0 <= ranged[start].0 + bin_m {
            end += 1;
        }
        if end - start > best.len() {
            best = start..end;
        }
    }
    let mut used: Vec<u32> = ranged[best].iter().map(|&(_, i)| i).collect();
    used.sort_unstable();
    (!used.is_empty()).then_some(used)
}

fn median_point(used: &[u32], cloud: &BaseCloud) -> Point3<f64> {
    let median = |column: &[f32]| {
        let mut values: Vec<f32> = used.iter().map(|&i| column[i as usize]).collect();
        values.sort_unstable_by(f32::total_cmp);
        let middle = values.len() / 2;
        let low = values[(values.len() - 1) / 2];
        f64::midpoint(f64::from(low), f64::from(values[middle]))
    };
    Point3::new(median(&cloud.x), median(&cloud.y), median(&cloud.z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::select::points_in_boxes;
    use crate::{CameraModel, Sensors, testing};

    fn cloud(points: &[[f32; 3]], sensors: &Sensors) -> BaseCloud {
        let [x, y, z] = [0, 1, 2].map(|axis| points.iter().map(|p| p[axis]).collect());
        let sensor = "upper".into();
        let sweep = jrdb_types::PointCloud { sensor, x, y, z, ..Default::default() };
        BaseCloud::merge(&[sweep], sensors, &mut Vec::new())
    }

    fn locate(points: &[[f32; 3]], bbox: [f64; 4]) -> Option<Point3<f64>> {
        let sensors = Sensors::new(&testing::rig([0.0; 3], 0.0), None).unwrap();
        let (cloud, bbox) = (cloud(points, &sensors), PixelBox::from(bbox));
        let image = sensors.camera.image();
        let inside = points_in_boxes(&cloud, &[bbox], image);
        let view = BoxView::new(&bbox, &sensors.camera);
        let target = Target { bbox: &bbox, image, view, is_person: true };
        densest_range(&cloud, &inside[0], &target, &ProjectionConfig::default()).map(|l| l.center)
    }

    /// The box of a person of 1.7 m at 4 m straight ahead: 204 rows.
    const PERSON: [f64; 4] = [1850.0, 130.0, 60.0, 204.0];

    #[test]
    fn a_wall_with_more_points_does_not_pull_the_person_away() {
        let person = [[3.9, 0.0, 0.3], [3.9, 0.02, 0.2], [3.95, -0.02, 0.1]];
        let wall: Vec<[f32; 3]> = (0..9_u8).map(|i| [9.0, 0.02 * f32::from(i), 0.0]).collect();
        let center = locate(&[&person[..], &wall[..]].concat(), PERSON).unwrap();
        assert!((center.x - 4.0).abs() < 0.02, "{center}");
    }

    #[test]
    fn an_occluder_too_near_to_be_that_person_is_refused() {
        let occluder: Vec<[f32; 3]> =
            (0..9_u8).map(|i| [1.0, 0.002 * f32::from(i), 0.05]).collect();
        let center = locate(&[&[[3.9, 0.0, 0.3]], &occluder[..]].concat(), PERSON).unwrap();
        assert!((center.x - 4.0).abs() < 1e-6, "{center}");
    }

    #[test]
    fn no_point_no_place() {
        assert_eq!(locate(&[[3.9, 3.9, 0.0]], PERSON), None);
    }
}
