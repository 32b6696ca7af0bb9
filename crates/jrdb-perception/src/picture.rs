//! Pictures as models want them: resized as Pillow does, normalised, channel by channel.

use jrdb_types::Image;
use serde::{Deserialize, Serialize};

use crate::detector::PerceptionError;
use crate::engine::Tensor;
use crate::resize::{Filter, resize};
use crate::tokens::parse_json;

/// How a model's pictures are prepared: the fields of a `preprocessor_config.json` that matter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PictureConfig {
    /// The model's input.
    pub size: PictureSize,
    /// Pillow's number of the filter: 2 bilinear, 3 bicubic.
    #[serde(default = "bicubic")]
    pub resample: u8,
    /// What bytes are multiplied with.
    #[serde(default = "per_byte")]
    pub rescale_factor: f64,
    /// Subtracted from each channel after that.
    pub image_mean: [f64; 3],
    /// What each channel is divided by then.
    pub image_std: [f64; 3],
}

/// Size of a model's input, pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct PictureSize {
    /// Rows.
    pub height: usize,
    /// Columns.
    pub width: usize,
}

fn bicubic() -> u8 {
    3
}

fn per_byte() -> f64 {
    1.0 / 255.0
}

/// No model looks at pictures larger than this on a side.
const SIDE_MAX: usize = 8192;

impl PictureConfig {
    /// Reads the text of a `preprocessor_config.json`.
    ///
    /// # Errors
    /// [`PerceptionError::File`] if it is not that, [`PerceptionError::Setting`] if a number is out of range.
    pub fn from_json(text: &str) -> Result<Self, PerceptionError> {
        let config: Self = parse_json("preprocessor_config.json", text)?;
        let out_of_range =
            |setting, expected, found| Err(PerceptionError::Setting { setting, expected, found });
        for side in [config.size.width, config.size.height] {
            if !(1..=SIDE_MAX).contains(&side) {
                return out_of_range("size", "in [1, 8192]", side as f64);
            }
        }
        if !(2..=3).contains(&config.resample) {
            return out_of_range("resample", "2 or 3", config.resample.into());
        }
        match config.image_std.iter().find(|std| **std == 0.0 || !std.is_finite()) {
            Some(std) => out_of_range("image_std", "a number other than 0", *std),
            None => Ok(config),
        }
    }

    /// Pillow's filter.
    #[must_use]
    pub fn filter(&self) -> Filter {
        if self.resample == 2 { Filter::Bilinear } else { Filter::Bicubic }
    }

    /// Resizes a picture to the model's input and normalises it, f32 `[3, height, width]`.
    #[must_use]
    pub fn prepare(&self, image: &Image) -> Vec<f32> {
        self.normalise(&resize(image, self.size.width, self.size.height, self.filter()))
    }

    /// The picture's channels one after the other, normalised, without resizing.
    #[must_use]
    pub fn normalise(&self, image: &Image) -> Vec<f32> {
        let tables = [0, 1, 2].map(|channel| self.table(channel));
        let channel = |channel: usize| {
            image.rgb.iter().skip(channel).step_by(3).map(move |byte| (channel, *byte))
        };
        (0..3).flat_map(channel).map(|(c, byte)| tables[c][usize::from(byte)]).collect()
    }

    /// The normalised value of each byte. The reference rounds to single precision after each operation, so do we.
    fn table(&self, channel: usize) -> Vec<f32> {
        let (mean, std) = (self.image_mean[channel] as f32, self.image_std[channel] as f32);
        (0..=255_u8)
            .map(|byte| ((f64::from(byte) * self.rescale_factor) as f32 - mean) / std)
            .collect()
    }

    /// Prepared pictures as one tensor, f32 `[pictures, 3, height, width]`.
    #[must_use]
    pub fn tensor(&self, pictures: &[Vec<f32>]) -> Tensor {
        let shape = vec![pictures.len(), 3, self.size.height, self.size.width];
        Tensor::F32 { shape, data: pictures.concat() }
    }
}
