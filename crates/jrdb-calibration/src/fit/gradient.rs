//! How strong the edges of an image are, comparable between dark and bright places.

use jrdb_types::Image;

/// Weights of red, green and blue in the luminance (ITU-R BT.601).
const LUMINANCE: [f32; 3] = [0.299, 0.587, 0.114];
/// The Gaussian is cut at this many standard deviations.
const CUT: f64 = 3.0;
/// Bins of the histogram that turns gradients into ranks.
const BINS: usize = 4096;
/// A gradient of this many grey levels per pixel falls in the last bin.
const STEEPEST: f32 = 64.0;

/// Edge strengths of an image: the rank of each pixel's gradient among all pixels, in `[0, 1]`, less the mean
/// of its row, so that neither contrast nor a busy row attracts the cloud.
pub(super) struct EdgeImage {
    width: usize,
    height: usize,
    wraps: bool,
    /// Strengths of the gradient along rows (upright edges), row by row.
    across: Vec<f32>,
    /// Strengths of the gradient along columns (level edges), summed down each column: `height + 1` rows.
    down: Vec<f32>,
}

impl EdgeImage {
    pub(super) fn new(image: &Image, wraps: bool, blur_px: f64) -> Self {
        let (width, height) = (image.width, image.height);
        let luminance: Vec<f32> = image
            .rgb
            .chunks_exact(3)
            .map(|rgb| rgb.iter().zip(LUMINANCE).map(|(&c, w)| f32::from(c) * w).sum())
            .collect();
        let plane = Plane { width, height, wraps, values: luminance };
        let smooth = plane.blurred(&kernel(blur_px));
        let across = smooth.map(|p, x, y| (p.at(x + 1, y) - p.at(x - 1, y)).abs()).ranked();
        let level = smooth.map(|p, x, y| (p.at(x, y + 1) - p.at(x, y - 1)).abs()).ranked();
        let mut down = vec![0.0; width * (height + 1)];
        for at in 0..width * height {
            down[at + width] = down[at] + level.values[at];
        }
        Self { width, height, wraps, across: across.values, down }
    }

    fn column(&self, x: i64) -> Option<usize> {
        let width = self.width as i64;
        let x = if self.wraps { x.rem_euclid(width) } else { x };
        (0..width).contains(&x).then_some(x as usize)
    }

    /// Strength of an upright edge at `(u, v)` pixels; 0 outside the image.
    pub(super) fn upright(&self, u: f64, v: f64) -> f64 {
        let row = v.floor();
        if !(0.0..self.height as f64).contains(&row) || !u.is_finite() {
            return 0.0;
        }
        let left = (u - 0.5).floor();
        let share = u - 0.5 - left;
        let value = |x: i64| {
            let column = self.column(x);
            column.map_or(0.0, |x| f64::from(self.across[row as usize * self.width + x]))
        };
        (1.0 - share) * value(left as i64) + share * value(left as i64 + 1)
    }

    /// Mean strength of level edges in column `u` between two rows, pixels; 0 outside the image, and for a
    /// stretch of less than half a row.
    pub(super) fn level(&self, u: f64, rows: [f64; 2]) -> f64 {
        let bottom = self.height as f64;
        let inside = |v: f64| v.clamp(0.0, bottom);
        let (start, end) = (inside(rows[0].min(rows[1])), inside(rows[0].max(rows[1])));
        let Some(x) = u.is_finite().then(|| self.column(u.floor() as i64)).flatten() else {
            return 0.0;
        };
        let sum_to = |v: f64| {
            let row = (v as usize).min(self.height - 1);
            let [above, below] = [row, row + 1].map(|y| f64::from(self.down[y * self.width + x]));
            above + (below - above) * (v - row as f64)
        };
        if end - start > 0.5 { (sum_to(end) - sum_to(start)) / (end - start) } else { 0.0 }
    }
}

/// Numbers over an image's pixels.
struct Plane {
    width: usize,
    height: usize,
    wraps: bool,
    values: Vec<f32>,
}

impl Plane {
    /// The number at a pixel; beyond the border that of the border, or round the circle.
    fn at(&self, x: isize, y: isize) -> f32 {
        let (width, height) = (self.width as isize, self.height as isize);
        let x = if self.wraps { x.rem_euclid(width) } else { x.clamp(0, width - 1) };
        self.values[(y.clamp(0, height - 1) * width + x) as usize]
    }

    fn map(&self, at: impl Fn(&Self, isize, isize) -> f32) -> Self {
        let mut values = Vec::with_capacity(self.values.len());
        for y in 0..self.height as isize {
            values.extend((0..self.width as isize).map(|x| at(self, x, y)));
        }
        Self { values, ..*self }
    }

    fn blurred(&self, kernel: &[f32]) -> Self {
        let reach = (kernel.len() / 2) as isize;
        let taps = || kernel.iter().zip(-reach..=reach);
        let rows = self.map(|p, x, y| taps().map(|(w, d)| w * p.at(x + d, y)).sum());
        rows.map(|p, x, y| taps().map(|(w, d)| w * p.at(x, y + d)).sum())
    }

    /// Each value's rank: the share of all values in lower bins, less the mean rank of its row.
    fn ranked(mut self) -> Self {
        let bin = |value: f32| ((value / STEEPEST * BINS as f32) as usize).min(BINS - 1);
        let mut lower = vec![0_usize; BINS + 1];
        for &value in &self.values {
            lower[bin(value) + 1] += 1;
        }
        for i in 1..=BINS {
            lower[i] += lower[i - 1];
        }
        let count = self.values.len() as f64;
        for row in self.values.chunks_exact_mut(self.width) {
            for value in &mut *row {
                *value = (lower[bin(*value)] as f64 / count) as f32;
            }
            let mean = row.iter().sum::<f32>() / row.len() as f32;
            row.iter_mut().for_each(|value| *value -= mean);
        }
        self
    }
}

fn kernel(deviation_px: f64) -> Vec<f32> {
    let reach = (CUT * deviation_px).ceil() as i32;
    let weight = |d: i32| (-0.5 * (f64::from(d) / deviation_px).powi(2)).exp();
    let weights: Vec<f64> = (-reach..=reach).map(weight).collect();
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|w| (w / sum) as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Dark, but for a bright block of columns 10 to 19 in rows 10 to 19.
    fn block() -> EdgeImage {
        let mut image = Image::filled(40, 30, [20; 3]);
        for (y, x) in (10..20).flat_map(|y| (10..20).map(move |x| (y, x))) {
            image.rgb[3 * (y * 40 + x)..][..3].fill(220);
        }
        EdgeImage::new(&image, true, 1.0)
    }

    #[test]
    fn upright_edges_are_strong_at_the_sides() {
        let edges = block();
        let best = (0..60).max_by(|&a, &b| {
            let at = |i: i32| edges.upright(f64::from(i) * 0.25, 15.0);
            at(a).total_cmp(&at(b))
        });
        assert!((f64::from(best.unwrap()) * 0.25 - 10.0).abs() <= 0.5);
        assert!(edges.upright(15.0, 15.0) < 0.1);
    }

    #[test]
    fn level_edges_are_strong_between_rows_that_hold_them() {
        let edges = block();
        assert!(edges.level(15.0, [7.0, 13.0]) > 0.2 + edges.level(15.0, [13.0, 17.0]));
        assert_eq!(edges.level(15.0, [17.0, 23.0]), edges.level(15.0, [23.0, 17.0]));
    }

    #[test]
    fn nothing_is_strong_outside_the_image_and_columns_go_round() {
        let edges = block();
        assert_eq!(edges.upright(10.0, -1.0), 0.0);
        assert_eq!(edges.upright(f64::NAN, 5.0), 0.0);
        assert_eq!(edges.level(5.0, [-10.0, -3.0]), 0.0);
        assert_eq!(edges.level(f64::INFINITY, [1.0, 3.0]), 0.0);
        assert_eq!(edges.upright(50.0, 15.0), edges.upright(10.0, 15.0));
    }
}
