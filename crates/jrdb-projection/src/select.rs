//! Which points fall into which image boxes.

use jrdb_types::{ImageGeometry, PixelBox};

use crate::cloud::BaseCloud;
use crate::simd::{Loop, vectorised};

/// Indices into the cloud of the points inside each box, ascending.
///
/// Boxes are half-open, and go on across the seam where the image wraps; they start inside it, at `x` in `[0, W)`. A
/// point outside the image is in no box, even where a box reaches out of the image.
///
/// Cost: every point is compared with every box that reaches into its block of 512 points. Where points come in the
/// order of a scan, those of a block lie near each other and most boxes are out of reach.
#[must_use]
pub fn points_in_boxes(
    cloud: &BaseCloud,
    boxes: &[PixelBox],
    image: ImageGeometry,
) -> Vec<Vec<u32>> {
    let mut inside = vec![Vec::new(); boxes.len()];
    for (boxes, inside) in boxes.chunks(MASK_BOXES).zip(inside.chunks_mut(MASK_BOXES)) {
        points_in_some_boxes(cloud, &spans(boxes, image), inside);
    }
    inside
}

/// As many boxes as a mask has bits.
const MASK_BOXES: usize = u32::BITS as usize;

/// Points that are looked at together.
const BLOCK: usize = 512;

fn points_in_some_boxes(cloud: &BaseCloud, spans: &[Span], inside: &mut [Vec<u32>]) {
    let mut near = Vec::new();
    let (mut masks, mut found) = ([0; BLOCK], [0; BLOCK / WORD]);
    for (block, (u, v)) in (0..).zip(cloud.u.chunks(BLOCK).zip(cloud.v.chunks(BLOCK))) {
        let (mut columns, mut rows) = (Extent::NONE, Extent::NONE);
        vectorised(Extents { u, v, columns: &mut columns, rows: &mut rows });
        let meets = |span: &&Span| columns.meets(span.columns) && rows.meets(span.rows);
        near.clear();
        near.extend(spans.iter().filter(meets));
        if near.is_empty() {
            continue;
        }
        near.resize(near.len().next_multiple_of(SPANS), Span::default());
        vectorised(Inside { u, v, spans: &near, masks: &mut masks, found: &mut found });
        for (word, &bits) in found.iter().enumerate() {
            for at in set_bits(bits) {
                let place = word * WORD + at;
                for index in set_bits(masks[place].into()) {
                    inside[index].push(block * BLOCK as u32 + place as u32);
                }
            }
        }
    }
}

/// Places of the bits that are set, ascending.
fn set_bits(mut bits: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let place = bits.trailing_zeros() as usize;
        let is_set = bits != 0;
        bits &= bits.wrapping_sub(1);
        is_set.then_some(place)
    })
}

/// A coordinate from 0 on as a whole number in the same order; what is negative, infinite or no number comes after those.
#[inline(always)]
fn key(coordinate: f32) -> u32 {
    (coordinate + 0.0).to_bits() // the sum of -0.0 and 0.0 is 0.0
}

/// Keys from the first to before the end.
#[derive(Debug, Clone, Copy, Default)]
struct Interval {
    first: u32,
    count: u32,
}

impl Interval {
    /// The keys of the coordinates from one number to before another that lie in `[0, end)`, all pixels.
    ///
    /// Exact for bounds in double precision: a single-precision number is not under a bound exactly when it is not
    /// under the next single-precision number up.
    fn between(from: f64, to: f64, end: u32) -> Self {
        let bound = |at: f64| {
            let at = at.clamp(0.0, end.into());
            let nearest = at as f32;
            key(if f64::from(nearest) < at { nearest.next_up() } else { nearest })
        };
        Self { first: bound(from), count: bound(to) - bound(from) }
    }

    #[inline(always)]
    fn contains(self, key: u32) -> bool {
        key.wrapping_sub(self.first) < self.count
    }
}

/// A box, or the part of one on one side of the seam.
#[derive(Debug, Clone, Copy, Default)]
struct Span {
    /// The bit of its box.
    bit: u32,
    columns: Interval,
    rows: Interval,
}

/// What the boxes cover of the image; those that are not proper cover nothing.
fn spans(boxes: &[PixelBox], image: ImageGeometry) -> Vec<Span> {
    let mut spans = Vec::new();
    for (index, bbox) in boxes.iter().enumerate().filter(|(_, bbox)| bbox.is_proper()) {
        let rows = Interval::between(bbox.y, bbox.y + bbox.h, image.height_px);
        for shift in [Some(0.0), image.period_px()].into_iter().flatten() {
            let start = bbox.x - shift;
            let columns = Interval::between(start, start + bbox.w, image.width_px);
            spans.push(Span { bit: 1 << index, columns, rows });
        }
    }
    spans.retain(|span| span.columns.count > 0 && span.rows.count > 0);
    spans
}

impl Span {
    /// The bit of its box where a pixel lies in it.
    #[inline(always)]
    fn bit_at(self, column: u32, row: u32) -> u32 {
        if self.columns.contains(column) & self.rows.contains(row) { self.bit } else { 0 }
    }
}

/// The least and the greatest key of the coordinates of a block.
#[derive(Debug, Clone, Copy)]
struct Extent {
    least: u32,
    greatest: u32,
}

impl Extent {
    /// Of no key.
    const NONE: Self = Self { least: u32::MAX, greatest: 0 };

    #[inline(always)]
    fn add(&mut self, key: u32) {
        self.least = self.least.min(key);
        self.greatest = self.greatest.max(key);
    }

    fn meets(self, interval: Interval) -> bool {
        interval.first <= self.greatest && self.least < interval.first + interval.count
    }
}

/// Finds the extents of the columns and the rows of a block.
struct Extents<'a> {
    u: &'a [f32],
    v: &'a [f32],
    columns: &'a mut Extent,
    rows: &'a mut Extent,
}

impl Loop for Extents<'_> {
    #[inline(always)]
    fn run(self) {
        let (mut columns, mut rows) = (Extent::NONE, Extent::NONE);
        for (&u, &v) in self.u.iter().zip(self.v) {
            columns.add(key(u));
            rows.add(key(v));
        }
        (*self.columns, *self.rows) = (columns, rows);
    }
}

/// Spans that are compared with a point at a time: points and masks are read and written once for so many.
const SPANS: usize = 4;

/// Points that are found by one look.
const WORD: usize = u64::BITS as usize;

/// Compares the points of a block with spans.
struct Inside<'a> {
    u: &'a [f32],
    v: &'a [f32],
    spans: &'a [Span],
    /// For every point, the bits of the boxes that it lies in.
    masks: &'a mut [u32; BLOCK],
    /// A bit for every point that lies in any.
    found: &'a mut [u64; BLOCK / WORD],
}

impl Loop for Inside<'_> {
    #[inline(always)]
    fn run(self) {
        *self.masks = [0; BLOCK];
        for [a, b, c, d] in self.spans.as_chunks::<SPANS>().0 {
            for ((mask, &u), &v) in self.masks.iter_mut().zip(self.u).zip(self.v) {
                let (u, v) = (key(u), key(v));
                *mask |= a.bit_at(u, v) | b.bit_at(u, v) | c.bit_at(u, v) | d.bit_at(u, v);
            }
        }
        let in_any = self.masks.map(|mask| u8::from(mask != 0));
        for (found, in_any) in self.found.iter_mut().zip(in_any.as_chunks::<WORD>().0) {
            *found = lowest_bits(in_any);
        }
    }
}

/// The lowest bits of bytes that are 0 or 1, in their order.
#[inline(always)]
fn lowest_bits(bytes: &[u8; WORD]) -> u64 {
    /// Brings the lowest bit of byte `i` to bit `56 + i`.
    const TO_THE_TOP: u64 = 0x0102_0408_1020_4080;
    let eights = bytes.as_chunks::<8>().0.iter().enumerate();
    eights.fold(0, |bits, (at, &eight)| {
        bits | (u64::from_le_bytes(eight).wrapping_mul(TO_THE_TOP) >> 56) << (8 * at)
    })
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

    /// The definition.
    fn contains(bbox: &PixelBox, u: f64, v: f64, image: ImageGeometry) -> bool {
        let [width, height] = [image.width_px, image.height_px].map(f64::from);
        let from_left = u - bbox.x;
        let offset = match image.period_px() {
            Some(period) if from_left < 0.0 => from_left + period,
            _ => from_left,
        };
        let is_shown = (0.0..width).contains(&u) && (0.0..height).contains(&v);
        is_shown && (0.0..bbox.w).contains(&offset) && (bbox.y..bbox.y + bbox.h).contains(&v)
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
        fn all_at_once_are_inside_as_each_alone(
            mut pixels in prop::collection::vec((-9.0..3770.0_f64, -9.0..490.0_f64), 0..1400),
            boxes in prop::collection::vec((0.0..3760.0, -9.0..400.0, 0.5..4000.0, 1.0..200.0), 0..70),
            wraps: bool, is_scan: bool,
        ) {
            let image = ImageGeometry { wraps, ..PANORAMA };
            if wraps {
                pixels.retain(|(u, _)| (0.0..3759.9).contains(u));
            }
            if is_scan {
                pixels.sort_by(|a, b| a.0.total_cmp(&b.0));
            }
            let boxes: Vec<PixelBox> = boxes.into_iter().map(|(x, y, w, h)| PixelBox { x, y, w, h }).collect();
            let found = points_in_boxes(&cloud(&pixels), &boxes, image);
            for (bbox, found) in boxes.iter().zip(found) {
                let pixel = |i: usize| (f64::from(pixels[i].0 as f32), f64::from(pixels[i].1 as f32));
                let naive: Vec<u32> = (0..pixels.len())
                    .filter(|&i| contains(bbox, pixel(i).0, pixel(i).1, image))
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
