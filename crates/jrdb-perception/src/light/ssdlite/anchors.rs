//! The boxes from which the model counts its own, and how it does (Liu et al., SSD, 2016, section
//! 2.2).

use jrdb_types::PixelBox;

/// Cells on a side of each grid, coarser and coarser.
const GRIDS: [usize; 6] = [19, 10, 5, 3, 2, 1];
/// Size of each grid's anchors, as a part of the tile; the last one closes the series.
const SCALES: [f64; 7] = [0.2, 0.35, 0.5, 0.65, 0.8, 0.95, 1.0];
/// Size of the finest grid's square anchor.
const SMALLEST: f64 = 0.1;
/// Divisors of the model's numbers for centre and size.
const CENTER_DIVISOR: f64 = 10.0;
const SIZE_DIVISOR: f64 = 5.0;

/// A box in parts of the tile's width and height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Anchor {
    pub(super) cx: f64,
    pub(super) cy: f64,
    pub(super) w: f64,
    pub(super) h: f64,
}

/// The model's 1917 anchors in its order: grid, row, column, shape.
pub(super) fn anchors() -> Vec<Anchor> {
    let mut all = Vec::new();
    for (level, &cells) in GRIDS.iter().enumerate() {
        let shapes = shapes(level);
        let middle = |cell: usize| (cell as f64 + 0.5) / cells as f64;
        for (row, column) in (0..cells).flat_map(|r| (0..cells).map(move |c| (r, c))) {
            let (cx, cy) = (middle(column), middle(row));
            all.extend(shapes.iter().map(|&(w, h)| Anchor { cx, cy, w, h }));
        }
    }
    all
}

/// Width and height of the anchors of one cell: scale `s` at ratio `r` is `s·√r` by `s/√r`.
fn shapes(level: usize) -> Vec<(f64, f64)> {
    let scale = SCALES[level];
    let of = |(scale, ratio): (f64, f64)| (scale * ratio.sqrt(), scale / ratio.sqrt());
    if level == 0 {
        return [(SMALLEST, 1.0), (scale, 2.0), (scale, 0.5)].map(of).to_vec();
    }
    let between = (scale * SCALES[level + 1]).sqrt();
    let ratios = [1.0, 2.0, 0.5, 3.0, 1.0 / 3.0].map(|ratio| (scale, ratio));
    ratios.into_iter().chain([(between, 1.0)]).map(of).collect()
}

impl Anchor {
    /// The box that the model's four numbers (vertical and horizontal shift, height, width) make of
    /// the anchor, cut to the tile, in pixels of a tile of this size.
    pub(super) fn decode(&self, code: &[f32; 4], width_px: f64, height_px: f64) -> PixelBox {
        let [ty, tx, th, tw] = code.map(f64::from);
        let (cx, cy) =
            (self.cx + tx / CENTER_DIVISOR * self.w, self.cy + ty / CENTER_DIVISOR * self.h);
        let (w, h) = (self.w * (tw / SIZE_DIVISOR).exp(), self.h * (th / SIZE_DIVISOR).exp());
        let (x0, x1) = ((cx - w / 2.0).clamp(0.0, 1.0), (cx + w / 2.0).clamp(0.0, 1.0));
        let (y0, y1) = ((cy - h / 2.0).clamp(0.0, 1.0), (cy + h / 2.0).clamp(0.0, 1.0));
        PixelBox::from([x0 * width_px, y0 * height_px, (x1 - x0) * width_px, (y1 - y0) * height_px])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: f64, expected: f64) -> bool {
        (found - expected).abs() < 1e-12
    }

    #[test]
    fn there_are_as_many_anchors_as_the_model_has_and_the_first_and_last_are_known() {
        let all = anchors();
        assert_eq!(all.len(), 1917);
        assert_eq!(all[0], Anchor { cx: 0.5 / 19.0, cy: 0.5 / 19.0, w: 0.1, h: 0.1 });
        assert_eq!(all[3].cx, 1.5 / 19.0);
        let last = all[1916];
        assert!(close(last.w, 0.95_f64.sqrt()) && close(last.h, 0.95_f64.sqrt()));
    }

    #[test]
    fn a_ratio_above_one_is_broader_than_high() {
        let (broad, high) = (anchors()[1], anchors()[2]);
        assert!(close(broad.w, 0.2 * 2.0_f64.sqrt()) && close(broad.h, 0.2 / 2.0_f64.sqrt()));
        assert!(close(high.w, broad.h) && close(high.h, broad.w));
    }

    #[test]
    fn decoding_moves_and_scales_the_anchor() {
        let anchor = Anchor { cx: 0.5, cy: 0.5, w: 0.2, h: 0.4 };
        // Up by a tenth of 0.4, right by two tenths of 0.2; twice as high, as broad as before.
        let twice = 5.0 * 2.0_f32.ln();
        let found = anchor.decode(&[-1.0, 2.0, twice, 0.0], 320.0, 480.0);
        let expected = [0.44 * 320.0, 0.06 * 480.0, 0.2 * 320.0, 0.8 * 480.0];
        for (found, expected) in <[f64; 4]>::from(found).into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-4, "{found} {expected}");
        }
    }

    #[test]
    fn boxes_end_where_the_tile_ends() {
        let anchor = Anchor { cx: 0.1, cy: 0.9, w: 0.4, h: 0.4 };
        let found = <[f64; 4]>::from(anchor.decode(&[0.0; 4], 100.0, 100.0));
        for (found, expected) in found.into_iter().zip([0.0, 70.0, 30.0, 30.0]) {
            assert!(close(found, expected));
        }
    }
}
