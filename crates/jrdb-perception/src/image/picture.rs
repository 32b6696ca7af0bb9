//! Preprocessing of pictures: resized as by Pillow, normalised, channel by channel.

use jrdb_types::Image;
use serde::{Deserialize, Serialize};

use super::resize::{Filter, Region, Resizer};
use super::tensor::{Layout, Normalise};
use crate::detector::PerceptionError;
use crate::engine::Tensor;
use crate::json::parse_json;

/// How a model's pictures are prepared: the fields of a `preprocessor_config.json` that matter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PictureConfig {
    /// The model's input.
    pub size: PictureSize,
    /// Pillow's number of the filter: 2 bilinear, 3 bicubic.
    #[serde(default = "bicubic")]
    pub resample: u8,
    /// What bytes are multiplied with: 1/255.
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
    /// [`PerceptionError::File`] if it is not that, [`PerceptionError::Setting`] if a number is out
    /// of range.
    pub fn from_json(text: &str) -> Result<Self, PerceptionError> {
        let config: Self = parse_json("preprocessor_config.json", text)?;
        config.check()?;
        Ok(config)
    }

    /// Whether every number is one that pictures can be prepared with.
    pub(crate) fn check(&self) -> Result<(), PerceptionError> {
        let out_of_range =
            |setting, expected, found| Err(PerceptionError::Setting { setting, expected, found });
        for side in [self.size.width, self.size.height] {
            if !(1..=SIDE_MAX).contains(&side) {
                return out_of_range("size", "in [1, 8192]", side as f64);
            }
        }
        if !(2..=3).contains(&self.resample) {
            return out_of_range("resample", "2 or 3", self.resample.into());
        }
        if (self.rescale_factor - per_byte()).abs() > 1e-9 {
            return out_of_range("rescale_factor", "1/255", self.rescale_factor);
        }
        match self.image_std.iter().find(|std| **std == 0.0 || !std.is_finite()) {
            Some(std) => out_of_range("image_std", "a number other than 0", *std),
            None => Ok(()),
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
        self.prepare_part(image, Region::whole(image))
    }

    /// The same of a part of a picture.
    ///
    /// # Panics
    /// When the part is not in the picture.
    #[must_use]
    pub fn prepare_part(&self, image: &Image, part: Region) -> Vec<f32> {
        let PictureSize { height, width } = self.size;
        let mut tensor = vec![0.0; 3 * height * width];
        let mut resizer = Resizer::new(self.filter(), width, height);
        resizer.tensor(image, part, &self.normalise(), Layout::Chw, &mut tensor);
        tensor
    }

    /// A picture's channels one after the other, normalised, without resizing.
    #[must_use]
    pub fn planes(&self, image: &Image) -> Vec<f32> {
        let mut tensor = vec![0.0; image.rgb.len()];
        self.normalise().table().put_planes(&image.rgb, &mut tensor, image.rgb.len() / 3, 0);
        tensor
    }

    fn normalise(&self) -> Normalise {
        let single = |all: [f64; 3]| all.map(|value| value as f32);
        Normalise { mean: single(self.image_mean), std: single(self.image_std) }
    }

    /// Prepared pictures as one tensor, f32 `[pictures, 3, height, width]`.
    #[must_use]
    pub fn tensor(&self, pictures: &[Vec<f32>]) -> Tensor {
        let shape = vec![pictures.len(), 3, self.size.height, self.size.width];
        Tensor::F32 { shape, data: pictures.concat() }
    }
}
