//! Which points fall into which image boxes, in one pass over the points.

use jrdb_types::{ImageGeometry, PixelBox};

use crate::cloud::BaseCloud;
use crate::simd::{Loop, vectorised};

/// Indices into the cloud of the points inside each box, ascending.
///
/// Boxes are half-open, and go on across the seam where the image wraps. A point outside the image is in no box,
/// even where a box reaches out of the image. Cost: the points once for every 64
/// boxes; most points are refused by one look at their column and row.
#[must_use]
pub fn points_in_boxes(
    cloud: &BaseCloud,
    boxes: &[PixelBox],
    image: ImageGeometry,
) -> Vec<Vec<u32>> {
    let mut inside = vec![Vec::new(); boxes.len()];
    for (boxes, inside) in boxes.chunks(MASK_BOXES).zip(inside.chunks_mut(MASK_BOXES)) {
        points_in_some_boxes(cloud, boxes, image, inside);
    }
    inside
}

/// As many boxes as a mask has bits.
const MASK_BOXES: usize = u64::BITS as usize;

fn points_in_some_boxes(
    cloud: &BaseCloud,
    boxes: &[PixelBox],
    image: ImageGeometry,
    inside: &mut [Vec<u32>],
) {
    let masks = Masks::new(boxes, image);
    let mut near = [(0_u32, 0_u64); BLOCK];
    for (block, (u, v)) in (0..).zip(cloud.u.chunks(BLOCK).zip(cloud.v.chunks(BLOCK))) {
        let mut count = 0;
        vectorised(NearAny { masks: &masks, u, v, near: &mut near, count: &mut count });
        for &(place, mut candidates) in &near[..count] {
            let (u, v) = (f64::from(u[place as usize]), f64::from(v[place as usize]));
            if !shows(image, u, v) {
                continue;
            }
            while candidates != 0 {
                let index = candidates.trailing_zeros() as usize;
                candidates &= candidates - 1;
                if contains(&boxes[index], u, v, image) {
                    inside[index].push(block * BLOCK as u32 + place);
                }
            }
        }
    }
}

/// Points that are looked at together.
const BLOCK: usize = 512;

/// Whether pixel `(u, v)` lies in the image.
fn shows(image: ImageGeometry, u: f64, v: f64) -> bool {
    let [width, height] = [image.width_px, image.height_px].map(f64::from);
    (0.0..width).contains(&u) && (0.0..height).contains(&v)
}

/// Whether pixel `(u, v)` lies in a box, across the seam where the image wraps.
///
/// The box starts inside a wrapping image, at `x` in `[0, W)`, as does the pixel.
#[must_use]
pub fn contains(bbox: &PixelBox, u: f64, v: f64, image: ImageGeometry) -> bool {
    let from_left = u - bbox.x;
    let offset = match image.period_px() {
        Some(period) if from_left < 0.0 => from_left + period,
        _ => from_left,
    };
    (0.0..bbox.w).contains(&offset) && (bbox.y..bbox.y + bbox.h).contains(&v)
}

/// Stripes into which columns, and rows, are cut. Both tables lie in the first-level cache together.
const COLUMN_STRIPES: usize = 4096;
const ROW_STRIPES: usize = 512;

/// For every stripe of columns and of rows, a bit for each box that reaches into it or into its neighbours.
struct Masks {
    columns: [u64; COLUMN_STRIPES],
    rows: [u64; ROW_STRIPES],
    columns_per_px: f32,
    rows_per_px: f32,
}

impl Masks {
    fn new(boxes: &[PixelBox], image: ImageGeometry) -> Self {
        let [width, height] = [image.width_px, image.height_px].map(|side| side as f32);
        let mut masks = Self {
            columns: [0; COLUMN_STRIPES],
            rows: [0; ROW_STRIPES],
            columns_per_px: (COLUMN_STRIPES - 1) as f32 / width,
            rows_per_px: (ROW_STRIPES - 1) as f32 / height,
        };
        for (index, bbox) in boxes.iter().enumerate().filter(|(_, bbox)| bbox.is_proper()) {
            let bit = 1 << index;
            mark(&mut masks.rows, masks.rows_per_px, [bbox.y, bbox.y + bbox.h], bit);
            mark(&mut masks.columns, masks.columns_per_px, [bbox.x, bbox.x + bbox.w], bit);
            if let Some(period) = image.period_px() {
                let again = [bbox.x - period, bbox.x + bbox.w - period];
                mark(&mut masks.columns, masks.columns_per_px, again, bit);
            }
        }
        masks
    }

    /// The boxes near a pixel of the image: may be too many, never too few. For another pixel, any.
    #[inline(always)]
    fn at(&self, u: f32, v: f32) -> u64 {
        let column = nearest_whole(u * self.columns_per_px) % COLUMN_STRIPES;
        let row = nearest_whole(v * self.rows_per_px) % ROW_STRIPES;
        self.columns[column] & self.rows[row]
    }
}

/// Sets a bit in the stripes from one coordinate to another, pixels, and in one stripe on either side.
fn mark(masks: &mut [u64], per_px: f32, [from, to]: [f64; 2], bit: u64) {
    let end = ((to * f64::from(per_px)).ceil().max(-1.0) + 2.0) as usize;
    let start = ((from * f64::from(per_px)).floor() - 1.0).max(0.0) as usize;
    let end = end.min(masks.len());
    masks[start.min(end)..end].iter_mut().for_each(|mask| *mask |= bit);
}

/// The nearest whole number of a coordinate in `[0, 2²²)`; anything for another, or for what is no number.
#[inline(always)]
fn nearest_whole(at: f32) -> usize {
    const SHIFT: f32 = 8_388_608.0; // 2²³: from here on, floats are whole and their low bits count
    ((at + SHIFT).to_bits() & 0x007f_ffff) as usize
}

/// Lists the pixels near any box, with the boxes they are near to.
///
/// Every pixel is written and only counted when it is near: without a branch, which for points in no order
/// would cost more than all else.
struct NearAny<'a> {
    masks: &'a Masks,
    u: &'a [f32],
    v: &'a [f32],
    near: &'a mut [(u32, u64); BLOCK],
    count: &'a mut usize,
}

impl Loop for NearAny<'_> {
    #[inline(always)]
    fn run(self) {
        let mut all = [0; BLOCK];
        for ((candidates, &u), &v) in all.iter_mut().zip(self.u).zip(self.v) {
            *candidates = self.masks.at(u, v);
        }
        let mut count = 0;
        for (place, &candidates) in (0..).zip(&all[..self.u.len()]) {
            self.near[count % BLOCK] = (place, candidates);
            count += usize::from(candidates != 0);
        }
        *self.count = count;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const PANORAMA: ImageGeometry = ImageGeometry { width_px: 3760, height_px: 480, wraps: true };

    fn cloud(pixels: &[(f64, f64)]) -> BaseCloud {
        BaseCloud {
            u: pixels.iter().map(|p| p.0 as f32).collect(),
            v: pixels.iter().map(|p| p.1 as f32).collect(),
            ..BaseCloud::default()
        }
    }

    #[test]
    fn a_box_across_the_seam_holds_points_of_both_ends() {
        let bbox = PixelBox::from([3750.0, 100.0, 20.0, 50.0]);
        let cloud =
            cloud(&[(3755.0, 120.0), (5.0, 120.0), (10.0, 120.0), (5.0, 150.0), (1880.0, 120.0)]);
        assert_eq!(points_in_boxes(&cloud, &[bbox], PANORAMA), [[0, 1]]);
        let nowhere = BaseCloud { u: vec![f32::NAN], v: vec![f32::NAN], ..BaseCloud::default() };
        assert!(points_in_boxes(&nowhere, &[bbox], PANORAMA)[0].is_empty());
    }

    #[test]
    fn a_point_outside_the_image_is_in_no_box() {
        let bbox = PixelBox::from([100.0, -60.0, 50.0, 700.0]);
        let rows = (-200..1400).map(|v| (120.0, f64::from(v)));
        let inside = points_in_boxes(&cloud(&rows.collect::<Vec<_>>()), &[bbox], PANORAMA);
        assert_eq!(inside[0], (200..680).collect::<Vec<u32>>());
    }

    #[test]
    fn improper_boxes_hold_nothing() {
        let boxes = [[5.0, 0.0, 0.0, 9.0], [f64::NAN, 0.0, 9.0, 9.0], [5.0, 9.0, 9.0, -9.0]];
        let boxes = boxes.map(PixelBox::from);
        assert!(points_in_boxes(&cloud(&[(5.0, 5.0)]), &boxes, PANORAMA).iter().all(Vec::is_empty));
    }

    proptest! {
        #[test]
        fn the_masks_change_nothing(
            pixels in proptest::collection::vec((0.0..3760.0, 0.0..480.0), 0..60),
            boxes in proptest::collection::vec((0.0..3760.0, -9.0..400.0, 0.5..4000.0, 1.0..200.0), 0..90),
        ) {
            let boxes: Vec<PixelBox> = boxes.into_iter().map(|(x, y, w, h)| PixelBox { x, y, w, h }).collect();
            let found = points_in_boxes(&cloud(&pixels), &boxes, PANORAMA);
            for (bbox, found) in boxes.iter().zip(found) {
                let pixel = |i: usize| (f64::from(pixels[i].0 as f32), f64::from(pixels[i].1 as f32));
                let naive: Vec<u32> = (0..pixels.len())
                    .filter(|&i| contains(bbox, pixel(i).0, pixel(i).1, PANORAMA))
                    .map(|i| i as u32)
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
