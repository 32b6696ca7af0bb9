//! Boxes in a panorama and in space.

use serde::{Deserialize, Serialize};

/// Size of an image and whether its columns close to a circle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ImageGeometry {
    /// Columns, pixels.
    pub width_px: u32,
    /// Rows, pixels.
    pub height_px: u32,
    /// True for a 360° panorama: column `width_px` is column 0 again.
    pub wraps: bool,
}

impl ImageGeometry {
    /// The circle's circumference in pixels where the image wraps.
    #[must_use]
    pub fn period_px(&self) -> Option<f64> {
        self.wraps.then_some(f64::from(self.width_px))
    }

    /// The box with `x` inside a wrapping image, if some of it is in the image.
    ///
    /// # Errors
    /// [`BoxError`] for a box without an area, beside the image, or with an edge further from the image than
    /// [`FAR_SIDES`] times its side: such numbers are a mistake, also where the image wraps.
    ///
    /// ```
    /// use jrdb_types::{ImageGeometry, PixelBox};
    /// let image = ImageGeometry { width_px: 100, height_px: 50, wraps: true };
    /// let left_of_it = PixelBox::from([-30.0, 0.0, 20.0, 20.0]);
    /// assert_eq!(image.checked_box(left_of_it).unwrap().x, 70.0);
    /// assert!(image.checked_box(PixelBox::from([1e12, 0.0, 20.0, 20.0])).is_err());
    /// ```
    pub fn checked_box(&self, bbox: PixelBox) -> Result<PixelBox, BoxError> {
        let numbers = <[f64; 4]>::from(bbox);
        if !bbox.is_proper() {
            return Err(BoxError::NoArea(numbers));
        }
        let [width, height] = [self.width_px, self.height_px].map(f64::from);
        let is_near = |edge: f64, side: f64| edge.abs() <= FAR_SIDES * side;
        let edges = [(bbox.x, width), (bbox.w, width), (bbox.y, height), (bbox.h, height)];
        let wrapped = self.period_px().map_or(bbox, |period| bbox.wrapped(period));
        let whole = PixelBox { x: 0.0, y: 0.0, w: width, h: height };
        let is_inside = wrapped.intersection_px2(&whole) > 0.0;
        if is_inside && edges.iter().all(|(edge, side)| is_near(*edge, *side)) {
            return Ok(wrapped);
        }
        Err(BoxError::Outside { size_px: [self.width_px, self.height_px], found: numbers })
    }
}

/// A box with an edge further from the image's corner than so many of the image's sides is a mistake: detectors put
/// boxes a little over the edge, labels of a panorama at most a turn.
pub const FAR_SIDES: f64 = 4.0;

/// Why a box cannot be used.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BoxError {
    /// Its width or height is not positive, or a number is not finite.
    #[error("expected a box with an area, found {0:?}")]
    NoArea([f64; 4]),
    /// Nothing of it is in the image, or it reaches far out of it.
    #[error("expected a box inside {} x {} pixels, found {found:?}", size_px[0], size_px[1])]
    Outside {
        /// Columns and rows of the image.
        size_px: [u32; 2],
        /// The box: x, y, w, h.
        found: [f64; 4],
    },
}

/// A box in pixels: `[x, x + w)` by `[y, y + h)`, origin at the corner of the top-left pixel.
///
/// In a wrapping image `x` lies in `[0, W)` and `x + w` may exceed `W`: the box then goes on at
/// column 0 (JRDB stores boxes across the seam this way).
///
/// As JSON: `[x, y, w, h]`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(with = "[f64; 4]"))]
#[serde(from = "[f64; 4]", into = "[f64; 4]")]
pub struct PixelBox {
    /// Left edge, pixels.
    pub x: f64,
    /// Top edge, pixels.
    pub y: f64,
    /// Width, pixels.
    pub w: f64,
    /// Height, pixels.
    pub h: f64,
}

impl From<[f64; 4]> for PixelBox {
    fn from([x, y, w, h]: [f64; 4]) -> Self {
        Self { x, y, w, h }
    }
}

impl From<PixelBox> for [f64; 4] {
    fn from(b: PixelBox) -> Self {
        [b.x, b.y, b.w, b.h]
    }
}

impl PixelBox {
    /// Area in square pixels; 0 for a box of negative width or height.
    #[must_use]
    pub fn area_px2(&self) -> f64 {
        self.w.max(0.0) * self.h.max(0.0)
    }

    /// Whether width and height are positive and all numbers finite.
    #[must_use]
    pub fn is_proper(&self) -> bool {
        [self.x, self.y, self.w, self.h].iter().all(|v| v.is_finite())
            && self.w > 0.0
            && self.h > 0.0
    }

    /// Area shared with another box, square pixels, on the plane.
    #[must_use]
    pub fn intersection_px2(&self, other: &Self) -> f64 {
        overlap(self.x, self.w, other.x, other.w) * overlap(self.y, self.h, other.y, other.h)
    }

    /// Area shared with another box, square pixels, on a circle of `period_px` columns.
    ///
    /// Boxes are arcs; each is taken to be at most one turn long.
    #[must_use]
    pub fn circular_intersection_px2(&self, other: &Self, period_px: f64) -> f64 {
        let (w, other_w) = (self.w.min(period_px), other.w.min(period_px));
        let start = (other.x - self.x).rem_euclid(period_px);
        let shared = overlap(0.0, w, start, other_w) + overlap(0.0, w, start - period_px, other_w);
        shared * overlap(self.y, self.h, other.y, other.h)
    }

    /// Intersection over union in `[0, 1]`: on the circle when a period is given, else on the plane.
    ///
    /// Touching boxes give 0, and so does an empty box.
    ///
    /// ```
    /// use jrdb_types::PixelBox;
    /// let across_the_seam = PixelBox::from([3750.0, 0.0, 20.0, 10.0]);
    /// let after_the_seam = PixelBox::from([0.0, 0.0, 10.0, 10.0]);
    /// assert_eq!(across_the_seam.iou(&after_the_seam, Some(3760.0)), 0.5);
    /// assert_eq!(across_the_seam.iou(&after_the_seam, None), 0.0);
    /// ```
    #[must_use]
    pub fn iou(&self, other: &Self, period_px: Option<f64>) -> f64 {
        let shared = match period_px {
            Some(period) => self.circular_intersection_px2(other, period),
            None => self.intersection_px2(other),
        };
        let union = self.area_px2() + other.area_px2() - shared;
        if shared > 0.0 && union > 0.0 { shared / union } else { 0.0 }
    }

    /// The box moved by whole turns so that `x` lies in `[0, period_px)`.
    #[must_use]
    pub fn wrapped(self, period_px: f64) -> Self {
        let x = self.x.rem_euclid(period_px);
        Self { x: if x < period_px { x } else { 0.0 }, ..self }
    }
}

fn overlap(a: f64, a_len: f64, b: f64, b_len: f64) -> f64 {
    ((a + a_len).min(b + b_len) - a.max(b)).max(0.0)
}

/// An upright box in the robot's base frame (x forward, y left, z up).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Box3d {
    /// Geometric centre `[x, y, z]`, metres, base frame.
    pub center: [f64; 3],
    /// Length along the heading, width across it, height: metres.
    pub size: [f64; 3],
    /// Direction the front looks to, radians counter-clockwise from +x, in (-π, π].
    pub heading_rad: f64,
}

/// The floor as a plane in the base frame: `z = height_m + slope · (x, y)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FloorPlane {
    /// z at the origin, metres.
    pub height_m: f64,
    /// Rise along x and along y, metres per metre.
    pub slope: [f64; 2],
}

impl FloorPlane {
    /// Height of the floor at a place, metres.
    #[must_use]
    pub fn height_at_m(&self, x: f64, y: f64) -> f64 {
        self.height_m + self.slope[0] * x + self.slope[1] * y
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn boxes() -> impl Strategy<Value = PixelBox> {
        (0.0..3760.0, 0.0..400.0, 0.1..900.0, 0.1..400.0).prop_map(|(x, y, w, h)| PixelBox {
            x,
            y,
            w,
            h,
        })
    }

    #[test]
    fn a_box_is_its_own_equal_and_touching_boxes_share_nothing() {
        let a = PixelBox::from([10.0, 10.0, 20.0, 20.0]);
        assert_eq!(a.iou(&a, None), 1.0);
        assert_eq!(a.iou(&PixelBox { x: 30.0, ..a }, None), 0.0);
        assert_eq!(a.iou(&PixelBox { w: 0.0, ..a }, None), 0.0);
    }

    proptest! {
        #[test]
        fn circular_iou_is_symmetric(a in boxes(), b in boxes()) {
            let (ab, ba) = (a.iou(&b, Some(3760.0)), b.iou(&a, Some(3760.0)));
            prop_assert!((ab - ba).abs() < 1e-9);
            prop_assert!((0.0..=1.0 + 1e-12).contains(&ab));
        }

        #[test]
        fn circular_iou_does_not_see_a_turn_of_the_panorama(a in boxes(), b in boxes(), shift in 0.0..3760.0) {
            let turn = |p: PixelBox| PixelBox { x: p.x + shift, ..p }.wrapped(3760.0);
            let (before, after) = (a.iou(&b, Some(3760.0)), turn(a).iou(&turn(b), Some(3760.0)));
            prop_assert!((before - after).abs() < 1e-9);
        }

        #[test]
        fn circular_and_planar_agree_away_from_the_seam(a in boxes(), b in boxes()) {
            prop_assume!(a.x + a.w < 3760.0 && b.x + b.w < 3760.0);
            prop_assert!((a.iou(&b, None) - a.iou(&b, Some(3760.0))).abs() < 1e-9);
        }
    }
}
