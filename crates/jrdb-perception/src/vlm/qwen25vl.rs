//! Qwen2.5-VL (Bai et al. 2025): pictures of any size as patches, tokens with places in rows and
//! columns, boxes as JSON.

use jrdb_types::Image;
use serde::Deserialize;

use super::causal::Position;
use super::text_model::{TextFile, TextModel};
use crate::detector::PerceptionError;
use crate::engine::Tensor;
use crate::image::resize;
use crate::image::{PictureConfig, PictureSize};
use crate::json::parse_json;

/// Sizes and rules of one model, from the files beside its weights.
#[derive(Debug, Clone, PartialEq)]
pub struct Qwen25VlConfig {
    /// Fewest and most pixels of a picture after resizing.
    pub pixels: [usize; 2],
    /// Side of a patch, pixels.
    pub patch_px: usize,
    /// Patches per side of what becomes one token.
    pub merge: usize,
    /// How often a still picture is repeated in time.
    pub frames: usize,
    /// Filter and normalisation; its size is not used.
    pub picture: PictureConfig,
    /// The text half.
    pub text: TextModel,
}

#[derive(Deserialize)]
struct ModelFile {
    image_token_id: u32,
    #[serde(flatten)]
    flat: Option<TextFile>,
    text_config: Option<TextFile>,
}

#[derive(Deserialize)]
struct PictureFile {
    min_pixels: Option<usize>,
    max_pixels: Option<usize>,
    size: Option<PixelsFile>,
    patch_size: usize,
    merge_size: usize,
    temporal_patch_size: usize,
    #[serde(default = "bicubic")]
    resample: u8,
    #[serde(default = "per_byte")]
    rescale_factor: f64,
    image_mean: [f64; 3],
    image_std: [f64; 3],
}

/// Where newer files keep fewest and most pixels, by names that promise sides.
#[derive(Deserialize)]
struct PixelsFile {
    #[serde(alias = "min_pixels")]
    shortest_edge: Option<usize>,
    #[serde(alias = "max_pixels")]
    longest_edge: Option<usize>,
}

impl PictureFile {
    fn pixels(&self) -> Result<[usize; 2], PerceptionError> {
        let newer = self.size.as_ref();
        let fewest = self.min_pixels.or(newer.and_then(|size| size.shortest_edge));
        let most = self.max_pixels.or(newer.and_then(|size| size.longest_edge));
        let (setting, expected) = ("min_pixels and max_pixels", "in preprocessor_config.json");
        let missing = PerceptionError::Setting { setting, expected, found: 0.0 };
        fewest.zip(most).map(Into::into).ok_or(missing)
    }
}

fn bicubic() -> u8 {
    3
}

fn per_byte() -> f64 {
    1.0 / 255.0
}

/// The greatest ratio of a picture's sides that the model takes.
const RATIO_MAX: f64 = 200.0;

/// The input of the vision encoder.
#[derive(Debug, Clone, PartialEq)]
pub struct Patches {
    /// Patches, those of a token together, f32 `[patches, 3 · frames · side · side]`.
    pub pixels: Tensor,
    /// Frames, rows and columns of patches, i64 `[1, 3]`.
    pub grid: Tensor,
    /// Rows and columns of tokens.
    pub tokens: [usize; 2],
    /// Columns and rows of the resized picture.
    pub size_px: [usize; 2],
}

impl Qwen25VlConfig {
    /// Reads the texts of `config.json`, `generation_config.json` and `preprocessor_config.json`.
    ///
    /// # Errors
    /// [`PerceptionError::File`] if one of them does not have the content that its name promises,
    /// [`PerceptionError::Setting`] if a number is out of range.
    pub fn from_json(
        config: &str,
        generation: &str,
        preprocessor: &str,
    ) -> Result<Self, PerceptionError> {
        let model: ModelFile = parse_json("config.json", config)?;
        let file: PictureFile = parse_json("preprocessor_config.json", preprocessor)?;
        let (setting, expected) = ("text model's sizes", "in config.json");
        let text = model.text_config.or(model.flat);
        let text = text.ok_or(PerceptionError::Setting { setting, expected, found: 0.0 })?;
        let in_range = (1..=64).contains(&file.patch_size) && (1..=8).contains(&file.merge_size);
        if !in_range || !(1..=8).contains(&file.temporal_patch_size) {
            let (setting, expected) =
                ("patch, merge and temporal_patch_size", "in [1, 64] and [1, 8]");
            return Err(PerceptionError::Setting {
                setting,
                expected,
                found: file.patch_size as f64,
            });
        }
        let picture = PictureConfig {
            size: PictureSize { height: 1, width: 1 },
            resample: file.resample,
            rescale_factor: file.rescale_factor,
            image_mean: file.image_mean,
            image_std: file.image_std,
        };
        picture.check()?;
        Ok(Self {
            pixels: file.pixels()?,
            patch_px: file.patch_size,
            merge: file.merge_size,
            frames: file.temporal_patch_size,
            picture,
            text: TextModel::new(&text, model.image_token_id, true, generation)?,
        })
    }

    /// Columns and rows of a picture after resizing: multiples of a token's side, as many pixels as
    /// are allowed.
    ///
    /// # Errors
    /// [`PerceptionError::Setting`] if one side is more than 200 times the other.
    pub fn resized(&self, [width, height]: [usize; 2]) -> Result<[usize; 2], PerceptionError> {
        let ratio = width.max(height) as f64 / width.min(height) as f64;
        if ratio.is_nan() || ratio > RATIO_MAX {
            let (setting, expected) = ("ratio of a picture's sides", "at most 200");
            return Err(PerceptionError::Setting { setting, expected, found: ratio });
        }
        let factor = (self.patch_px * self.merge) as f64;
        let sides = [width as f64, height as f64];
        let near = sides.map(|side| (side / factor).round_ties_even() * factor);
        let [fewest, most] = self.pixels.map(|pixels| pixels as f64);
        let area = near[0] * near[1];
        let fit = if area > most {
            let shrink = (sides[0] * sides[1] / most).sqrt();
            sides.map(|side| ((side / shrink / factor).floor() * factor).max(factor))
        } else if area < fewest {
            let grow = (fewest / (sides[0] * sides[1])).sqrt();
            sides.map(|side| (side * grow / factor).ceil() * factor)
        } else {
            near
        };
        Ok(fit.map(|side| side as usize))
    }

    /// A picture as patches.
    ///
    /// # Errors
    /// As [`Qwen25VlConfig::resized`].
    pub fn prepare(&self, image: &Image) -> Result<Patches, PerceptionError> {
        let [width, height] = self.resized([image.width, image.height])?;
        let small = resize(image, width, height, self.picture.filter());
        let values = self.picture.planes(&small);
        let [columns, rows] = [width / self.patch_px, height / self.patch_px];
        let mut data = Vec::with_capacity(values.len() * self.frames);
        for token_row in 0..rows / self.merge {
            for token in 0..columns / self.merge {
                for patch in 0..self.merge * self.merge {
                    let y = token_row * self.merge + patch / self.merge;
                    let x = token * self.merge + patch % self.merge;
                    self.push_patch(&mut data, &values, [x, y], [width, height]);
                }
            }
        }
        let width_of_patch = 3 * self.frames * self.patch_px * self.patch_px;
        let grid = vec![1, rows as i64, columns as i64];
        Ok(Patches {
            pixels: Tensor::F32 { shape: vec![rows * columns, width_of_patch], data },
            grid: Tensor::I64 { shape: vec![1, 3], data: grid },
            tokens: [rows / self.merge, columns / self.merge],
            size_px: [width, height],
        })
    }

    /// Adds one patch: channel by channel, frame by frame, row by row.
    fn push_patch(
        &self,
        data: &mut Vec<f32>,
        values: &[f32],
        [x, y]: [usize; 2],
        [width, height]: [usize; 2],
    ) {
        let side = self.patch_px;
        for channel in 0..3 {
            for _ in 0..self.frames {
                for row in 0..side {
                    let start = channel * width * height + (y * side + row) * width + x * side;
                    data.extend_from_slice(&values[start..start + side]);
                }
            }
        }
    }

    /// The prompt for a picture of this many tokens and a question.
    #[must_use]
    pub fn prompt(&self, question: &str, [rows, columns]: [usize; 2]) -> String {
        let image = "<|image_pad|>".repeat(rows * columns);
        format!(
            "<|im_start|>system\nYou are a helpful assistant.<|im_end|>\n<|im_start|>user\n\
             <|vision_start|>{image}<|vision_end|>{question}<|im_end|>\n<|im_start|>assistant\n"
        )
    }

    /// The places of a prompt's tokens: words go on one by one; the tokens of the picture lie in
    /// rows and columns at one moment, and what follows goes on behind the farthest of them.
    #[must_use]
    pub fn places(&self, ids: &[u32], [_, columns]: [usize; 2]) -> Vec<Position> {
        let (mut next, mut places) = (0_i64, Vec::with_capacity(ids.len()));
        for run in
            ids.chunk_by(|a, b| (*a == self.text.image_token) == (*b == self.text.image_token))
        {
            if run[0] == self.text.image_token {
                let columns = columns.max(1);
                let place =
                    |at: usize| [0, at / columns, at % columns].map(|step| next + step as i64);
                places.extend((0..run.len()).map(place));
            } else {
                places.extend((next..).map(|place| [place; 3]).take(run.len()));
            }
            next = places.iter().flatten().max().map_or(next, |last| last + 1);
        }
        places
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_every_age_are_read() {
        let sizes = r#""num_key_value_heads": 2, "num_attention_heads": 16, "hidden_size": 2048"#;
        let flat = format!(r#"{{"image_token_id": 7, {sizes}}}"#);
        let nested = format!(
            r#"{{"image_token_id": 7, "hidden_size": 1, "text_config": {{{sizes}, "head_dim": 64}}}}"#
        );
        let read = |config: &str, pixels: &str| {
            let picture = format!(
                r#"{{{pixels} "patch_size": 14, "merge_size": 2, "temporal_patch_size": 2,
                    "image_mean": [0.5, 0.5, 0.5], "image_std": [0.3, 0.3, 0.3]}}"#
            );
            Qwen25VlConfig::from_json(config, r#"{"eos_token_id": [2, 3]}"#, &picture)
        };
        for pixels in [
            r#""min_pixels": 10, "max_pixels": 20,"#,
            r#""min_pixels": null, "max_pixels": null, "size": {"shortest_edge": 10, "longest_edge": 20},"#,
            r#""size": {"min_pixels": 10, "max_pixels": 20},"#,
        ] {
            let (older, newer) = (read(&flat, pixels).unwrap(), read(&nested, pixels).unwrap());
            assert_eq!(
                (older.pixels, older.text.cache_heads, older.text.cache_width),
                ([10, 20], 2, 128)
            );
            assert_eq!(
                (newer.pixels, newer.text.cache_heads, newer.text.cache_width),
                ([10, 20], 2, 64)
            );
        }
        let error = read(&flat, r#""min_pixels": 10,"#).unwrap_err().to_string();
        assert!(error.contains("min_pixels and max_pixels"), "{error}");
    }
}
