//! Which points fall into which image boxes, in one pass over the points.

use jrdb_types::{ImageGeometry, PixelBox};

use crate::cloud::BaseCloud;

/// Indices into the cloud of the points inside each box, ascending.
///
/// Boxes are half-open, and go on across the seam where the image wraps. Cost: the points once, each
/// compared with the boxes that cover its column.
#[must_use]
pub fn points_in_boxes(
    cloud: &BaseCloud,
    boxes: &[PixelBox],
    image: ImageGeometry,
) -> Vec<Vec<usize>> {
    let columns = boxes_by_column(boxes, image);
    let mut inside = vec![Vec::new(); boxes.len()];
    for (point, (&u, &v)) in cloud.u.iter().zip(&cloud.v).enumerate() {
        // Columns are in [0, W); a saturating cast keeps even a foreign cloud in the table.
        let Some(candidates) = columns.get(u as usize) else { continue };
        for &index in candidates {
            if contains(&boxes[index], u, v, image) {
                inside[index].push(point);
            }
        }
    }
    inside
}

/// Whether pixel `(u, v)` lies in a box, across the seam where the image wraps.
#[must_use]
pub fn contains(bbox: &PixelBox, u: f64, v: f64, image: ImageGeometry) -> bool {
    let offset = match image.period_px() {
        Some(period) => (u - bbox.x).rem_euclid(period),
        None => u - bbox.x,
    };
    (0.0..bbox.w).contains(&offset) && (bbox.y..bbox.y + bbox.h).contains(&v)
}

fn boxes_by_column(boxes: &[PixelBox], image: ImageGeometry) -> Vec<Vec<usize>> {
    let width = image.width_px as usize;
    let mut columns = vec![Vec::new(); width];
    for (index, bbox) in boxes.iter().enumerate().filter(|(_, b)| b.is_proper()) {
        let first = bbox.x.floor().max(0.0) as usize;
        let last = ((bbox.x + bbox.w).ceil() as usize).min(first + width);
        for column in first..last {
            let column = if image.wraps { column % width } else { column };
            if let Some(list) = columns.get_mut(column).filter(|list| list.last() != Some(&index)) {
                list.push(index);
            }
        }
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;
    use proptest::prelude::*;

    const PANORAMA: ImageGeometry = ImageGeometry { width_px: 3760, height_px: 480, wraps: true };

    fn cloud(pixels: &[(f64, f64)]) -> BaseCloud {
        BaseCloud {
            points: vec![Point3::origin(); pixels.len()],
            u: pixels.iter().map(|p| p.0).collect(),
            v: pixels.iter().map(|p| p.1).collect(),
        }
    }

    #[test]
    fn a_box_across_the_seam_holds_points_of_both_ends() {
        let bbox = PixelBox::from([3750.0, 100.0, 20.0, 50.0]);
        let cloud =
            cloud(&[(3755.0, 120.0), (5.0, 120.0), (10.0, 120.0), (5.0, 150.0), (1880.0, 120.0)]);
        assert_eq!(points_in_boxes(&cloud, &[bbox], PANORAMA), [[0, 1]]);
    }

    #[test]
    fn improper_boxes_hold_nothing() {
        let boxes = [[5.0, 0.0, 0.0, 9.0], [f64::NAN, 0.0, 9.0, 9.0], [5.0, 9.0, 9.0, -9.0]];
        let boxes = boxes.map(PixelBox::from);
        assert!(points_in_boxes(&cloud(&[(5.0, 5.0)]), &boxes, PANORAMA).iter().all(Vec::is_empty));
    }

    proptest! {
        #[test]
        fn the_column_table_changes_nothing(
            pixels in proptest::collection::vec((0.0..3760.0, 0.0..480.0), 0..60),
            boxes in proptest::collection::vec((0.0..3760.0, -9.0..400.0, 0.5..4000.0, 1.0..200.0), 0..9),
        ) {
            let boxes: Vec<PixelBox> = boxes.into_iter().map(|(x, y, w, h)| PixelBox { x, y, w, h }).collect();
            let found = points_in_boxes(&cloud(&pixels), &boxes, PANORAMA);
            for (bbox, found) in boxes.iter().zip(found) {
                let naive: Vec<usize> = (0..pixels.len())
                    .filter(|&i| contains(bbox, pixels[i].0, pixels[i].1, PANORAMA))
                    .collect();
                prop_assert_eq!(found, naive);
            }
        }

        #[test]
        fn turning_boxes_and_points_together_changes_nothing(
            u in 0.0..3760.0, x in 0.0..3760.0, w in 1.0..900.0, turn in 0_u32..3760,
        ) {
            let whole = |value: f64| (value.floor() + 0.5 + f64::from(turn)).rem_euclid(3760.0);
            let bbox = |x: f64| PixelBox { x, y: 0.0, w: f64::floor(w), h: 9.0 };
            let x: f64 = f64::floor(x);
            let turned = bbox((x + f64::from(turn)).rem_euclid(3760.0));
            let before = contains(&bbox(x), f64::floor(u) + 0.5, 5.0, PANORAMA);
            prop_assert_eq!(before, contains(&turned, whole(u), 5.0, PANORAMA));
        }
    }
}
