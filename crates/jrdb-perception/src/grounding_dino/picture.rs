//! Preprocessing of the DETR family: a picture resized to a shortest and a longest side, on a
//! canvas with a mask of its pixels.

use jrdb_types::Image;
use serde::Deserialize;

use crate::detector::PerceptionError;
use crate::engine::Tensor;
use crate::image::resize;
use crate::image::{PictureConfig, PictureSize};
use crate::json::parse_json;

/// How pictures are prepared: the fields of a `preprocessor_config.json` that matter.
#[derive(Debug, Clone, PartialEq)]
pub struct CanvasConfig {
    /// The picture's shortest side becomes this long, pixels, …
    pub shortest_px: usize,
    /// … unless its longest would become longer than this.
    pub longest_px: usize,
    /// Filter and normalisation; its size is the canvas.
    pub picture: PictureConfig,
}

#[derive(Deserialize)]
struct File {
    size: Edges,
    pad_size: Option<PictureSize>,
    resample: u8,
    rescale_factor: f64,
    image_mean: [f64; 3],
    image_std: [f64; 3],
}

#[derive(Deserialize)]
struct Edges {
    shortest_edge: usize,
    longest_edge: usize,
}

/// A picture on its canvas.
#[derive(Debug, Clone, PartialEq)]
pub struct Canvas {
    /// Normalised channels, zero beyond the picture, f32 `[1, 3, height, width]`.
    pub pixels: Tensor,
    /// 1 where the picture is, i64 `[1, height, width]`.
    pub mask: Tensor,
    /// Columns and rows of the picture on the canvas.
    pub size_px: [usize; 2],
}

impl CanvasConfig {
    /// Reads the text of a `preprocessor_config.json`.
    ///
    /// # Errors
    /// [`PerceptionError::File`] if it is not that, [`PerceptionError::Setting`] if a number is out
    /// of range.
    pub fn from_json(text: &str) -> Result<Self, PerceptionError> {
        let file: File = parse_json("preprocessor_config.json", text)?;
        let (shortest_px, longest_px) = (file.size.shortest_edge, file.size.longest_edge);
        let square = PictureSize { height: longest_px, width: longest_px };
        let size = file.pad_size.unwrap_or(square);
        let picture = PictureConfig {
            size,
            resample: file.resample,
            rescale_factor: file.rescale_factor,
            image_mean: file.image_mean,
            image_std: file.image_std,
        };
        picture.check()?;
        if shortest_px == 0 {
            let (setting, expected) = ("shortest_edge", "at least 1");
            return Err(PerceptionError::Setting { setting, expected, found: 0.0 });
        }
        Ok(Self { shortest_px, longest_px, picture })
    }

    /// Columns and rows of a picture after resizing.
    ///
    /// The reference rounds the shortest side and cuts the other's fraction off; so do we.
    #[must_use]
    pub fn resized(
        [width, height]: [usize; 2],
        shortest_px: usize,
        longest_px: usize,
    ) -> [usize; 2] {
        let (least, most) = (width.min(height) as f64, width.max(height) as f64);
        let (shortest, longest) = (shortest_px as f64, longest_px as f64);
        let is_limited = most / least * shortest > longest;
        let exact = if is_limited { longest * least / most } else { shortest };
        let side = exact.round_ties_even() as usize;
        if width.min(height) == side {
            return [width, height];
        }
        let other =
            |long: usize, short: usize| ((exact * long as f64 / short as f64) as usize).max(1);
        let side = side.max(1);
        if width < height { [side, other(height, width)] } else { [other(width, height), side] }
    }

    /// Columns and rows of a picture on the canvas: as the reference resizes it, and smaller where
    /// the canvas would not hold that.
    fn fitted(&self, size_px: [usize; 2]) -> [usize; 2] {
        let sides = Self::resized(size_px, self.shortest_px, self.longest_px);
        let canvas = [self.picture.size.width, self.picture.size.height];
        let shrink = [0, 1].map(|axis| canvas[axis] as f64 / sides[axis] as f64);
        let shrink = shrink[0].min(shrink[1]).min(1.0);
        [0, 1].map(|axis| ((sides[axis] as f64 * shrink).round() as usize).clamp(1, canvas[axis]))
    }

    /// Puts a picture on the canvas, in its upper left corner.
    #[must_use]
    pub fn prepare(&self, image: &Image) -> Canvas {
        let [width, height] = self.fitted([image.width, image.height]);
        let small = self.picture.planes(&resize(image, width, height, self.picture.filter()));
        let canvas = self.picture.size;
        let area = canvas.width * canvas.height;
        let (mut pixels, mut mask) = (vec![0.0; 3 * area], vec![0; area]);
        for (row, values) in small.chunks_exact(width).enumerate() {
            let (channel, y) = (row / height, row % height);
            let start = channel * area + y * canvas.width;
            pixels[start..start + width].copy_from_slice(values);
            mask[y * canvas.width..][..width].fill(1);
        }
        Canvas {
            pixels: self.picture.tensor(&[pixels]),
            mask: Tensor::I64 { shape: vec![1, canvas.height, canvas.width], data: mask },
            size_px: [width, height],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A canvas as the exporter writes it for tiles of a panorama.
    fn oblong() -> CanvasConfig {
        let text = r#"{"size": {"shortest_edge": 80, "longest_edge": 133}, "pad_size": {"height": 80, "width": 108}, "resample": 2,
            "rescale_factor": 0.00392156862745098, "image_mean": [0.485, 0.456, 0.406], "image_std": [0.229, 0.224, 0.225]}"#;
        CanvasConfig::from_json(text).unwrap()
    }

    #[test]
    fn pictures_that_the_canvas_holds_are_as_large_as_the_reference_makes_them() {
        assert_eq!(oblong().fitted([640, 480]), [106, 80]);
        assert_eq!(oblong().fitted([480, 480]), [80, 80]);
    }

    #[test]
    fn others_become_smaller() {
        assert_eq!(oblong().fitted([480, 640]), [60, 80]);
        assert_eq!(oblong().fitted([1880, 240]), [108, 14]);
        assert_eq!(oblong().fitted([1, 9000]), [1, 80]);
        let tall = Image { width: 30, height: 90, rgb: vec![255; 3 * 30 * 90] };
        let canvas = oblong().prepare(&tall);
        assert_eq!(canvas.size_px, [26, 80]);
        let Tensor::I64 { shape, data } = &canvas.mask else { panic!("a mask is of integers") };
        assert_eq!(
            (shape.as_slice(), data.iter().sum::<i64>()),
            ([1, 80, 108].as_slice(), 26 * 80)
        );
    }
}
