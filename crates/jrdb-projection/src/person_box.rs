//! Boxes in space around things whose centre is known.

use jrdb_types::Box3d;
use nalgebra::Point3;

use crate::box_view::BoxView;
use crate::{BaseCloud, ProjectionConfig};

/// The centre moved to the middle height of the image box, and the 3D box of a person there.
///
/// The footprint is the prior `person_footprint_m`; the height is what the image box spans at the
/// centre's range. Without a heading the box is turned to face along the line of sight and has the
/// footprint's width on both sides.
pub(crate) fn person_box(
    center: &Point3<f64>,
    view: &BoxView,
    heading_rad: Option<f64>,
    config: &ProjectionConfig,
) -> Box3d {
    let [top, bottom] = view.heights_m(view.range_m(center));
    let [length, width] = config.person_footprint_m;
    Box3d {
        center: [center.x, center.y, f64::midpoint(top, bottom)],
        size: [if heading_rad.is_some() { length } else { width }, width, top - bottom],
        heading_rad: heading_rad.unwrap_or_else(|| center.y.atan2(center.x)),
    }
}

/// The box around the points of a thing of unknown size, turned along the line of sight; `None` from fewer
/// than `config.few_points` points, which say nothing of a size.
///
/// A LiDAR sees the near side only: the box is as deep as what is seen.
pub(crate) fn box_around(
    used: &[u32],
    cloud: &BaseCloud,
    center: &Point3<f64>,
    config: &ProjectionConfig,
) -> Option<Box3d> {
    if used.len() < config.few_points {
        return None;
    }
    let heading_rad = center.y.atan2(center.x);
    let (sin, cos) = heading_rad.sin_cos();
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for point in used.iter().map(|&i| cloud.point(i as usize)) {
        let along = [cos * point.x + sin * point.y, cos * point.y - sin * point.x, point.z];
        for axis in 0..3 {
            low[axis] = low[axis].min(along[axis]);
            high[axis] = high[axis].max(along[axis]);
        }
    }
    let [ahead, left, up] = [0, 1, 2].map(|axis| f64::midpoint(low[axis], high[axis]));
    Some(Box3d {
        center: [cos * ahead - sin * left, sin * ahead + cos * left, up],
        size: [0, 1, 2].map(|axis| high[axis] - low[axis]),
        heading_rad,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Sensors, testing};
    use jrdb_types::PixelBox;

    #[test]
    fn height_and_middle_come_from_the_rows() {
        let sensors = Sensors::new(&testing::rig([0.0; 3], 0.0), None).unwrap();
        let bbox = PixelBox::from([1850.0, 130.0, 60.0, 204.0]);
        let view = BoxView::new(&bbox, &sensors.camera).unwrap();
        let config = ProjectionConfig::default();
        let found = person_box(&Point3::new(4.0, 0.0, 0.3), &view, Some(1.0), &config);
        assert!((found.size[2] - 1.7).abs() < 1e-12);
        assert!((found.center[2] - (80.0 - 124.0) / 2.0 * 4.0 / 480.0).abs() < 1e-12);
        assert_eq!(found.heading_rad, 1.0);
    }

    #[test]
    fn a_box_around_points_lies_along_the_line_of_sight() {
        // A square of half a metre, seen to the left: 2.0 to 2.5 m away.
        let (x, y) = (vec![-0.25, 0.25, -0.25, 0.25, 0.0], vec![2.0, 2.0, 2.5, 2.5, 2.2]);
        let z = vec![0.0, 0.0, 0.0, 0.7, 0.3];
        let cloud = BaseCloud { x, y, z, ..BaseCloud::default() };
        let config = ProjectionConfig::default();
        let around = |used: &[u32]| box_around(used, &cloud, &Point3::new(0.0, 2.2, 0.0), &config);
        let found = around(&[0, 1, 2, 3, 4]).unwrap();
        for (found, expected) in found.center.iter().zip([0.0, 2.25, 0.35]) {
            assert!((found - expected).abs() < 1e-6);
        }
        assert!((found.size[0] - 0.5).abs() < 1e-6 && (found.size[2] - 0.7).abs() < 1e-6);
        assert_eq!(around(&[0, 1, 2, 3]), None);
    }
}
