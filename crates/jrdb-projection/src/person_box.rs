//! A box in space around a thing whose centre is known, from the rows of its image box.

use jrdb_types::{Box3d, PixelBox, rig::CylindricalPanorama};
use nalgebra::Point3;

use crate::ProjectionConfig;

/// Heights over the base frame's origin of the top and bottom rows of a box at a horizontal range,
/// metres.
fn top_and_bottom_m(bbox: &PixelBox, range_m: f64, camera: &CylindricalPanorama) -> [f64; 2] {
    [bbox.y, bbox.y + bbox.h].map(|row| (camera.horizon_px - row) * range_m / camera.focal_px)
}

/// The centre moved to the middle height of the image box, and the 3D box of a person there.
///
/// The footprint is the prior `person_footprint_m`; the height is what the image box spans at the
/// centre's range. Without a heading the box is turned to face along the line of sight and has the
/// footprint's width on both sides.
pub(crate) fn person_box(
    center: &Point3<f64>,
    bbox: &PixelBox,
    heading_rad: Option<f64>,
    camera: &CylindricalPanorama,
    config: &ProjectionConfig,
) -> Box3d {
    let [top, bottom] = top_and_bottom_m(bbox, center.x.hypot(center.y), camera);
    let [length, width] = config.person_footprint_m;
    Box3d {
        center: [center.x, center.y, f64::midpoint(top, bottom)],
        size: [if heading_rad.is_some() { length } else { width }, width, top - bottom],
        heading_rad: heading_rad.unwrap_or_else(|| center.y.atan2(center.x)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::PANORAMA as CAMERA;

    #[test]
    fn height_and_middle_come_from_the_rows() {
        let bbox = PixelBox::from([1850.0, 130.0, 60.0, 204.0]);
        let config = ProjectionConfig::default();
        let found = person_box(&Point3::new(4.0, 0.0, 0.3), &bbox, Some(1.0), &CAMERA, &config);
        assert!((found.size[2] - 1.7).abs() < 1e-12);
        assert!((found.center[2] - (80.0 - 124.0) / 2.0 * 4.0 / 480.0).abs() < 1e-12);
        assert_eq!(found.heading_rad, 1.0);
    }
}
