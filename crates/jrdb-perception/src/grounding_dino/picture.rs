//! Pictures as the DETR family wants them: resized to a shortest and a longest side, on a canvas that says where the picture ends.

use jrdb_types::Image;
use serde::Deserialize;

use crate::detector::PerceptionError;
use crate::engine::Tensor;
use crate::picture::{PictureConfig, PictureSize};
use crate::resize::resize;
use crate::tokens::parse_json;

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
    /// [`PerceptionError::File`] if it is not that, [`PerceptionError::Setting`] if the canvas cannot hold what it must.
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
        let least = size.width.min(size.height);
        if shortest_px == 0 || longest_px > least {
            let expected = "a canvas at least as large as the longest edge";
            return Err(PerceptionError::Setting {
                setting: "pad_size",
                expected,
                found: least as f64,
            });
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

    /// Puts a picture on the canvas, in its upper left corner.
    #[must_use]
    pub fn prepare(&self, image: &Image) -> Canvas {
        let size = [image.width, image.height];
        let [width, height] = Self::resized(size, self.shortest_px, self.longest_px);
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
