//! How each family of models takes a picture and a question.

use jrdb_types::Image;

use super::causal::Position;
use super::internvl::InternVlConfig;
use super::model::Vlm;
use super::qwen25vl::Qwen25VlConfig;
use super::text_model::TextModel;
use crate::detector::PerceptionError;

/// A make of vision-language model, with the sizes and rules of one of its models.
#[derive(Debug, Clone, PartialEq)]
pub enum Family {
    /// InternVL3.5.
    InternVl(InternVlConfig),
    /// Qwen2.5-VL.
    Qwen25Vl(Qwen25VlConfig),
}

/// A picture that a model has seen.
#[derive(Debug, Clone, PartialEq)]
pub struct Shown {
    /// Its tokens, row by row.
    pub features: Vec<f32>,
    /// Rows and columns of the tokens; a single row where they have no places.
    pub tokens: [usize; 2],
    /// Columns and rows that the model saw, pixels.
    pub size_px: [usize; 2],
}

impl Family {
    /// Name of the make.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::InternVl(_) => "internvl",
            Self::Qwen25Vl(_) => "qwen2.5-vl",
        }
    }

    /// The text half.
    #[must_use]
    pub fn text(&self) -> &TextModel {
        match self {
            Self::InternVl(config) => &config.text,
            Self::Qwen25Vl(config) => &config.text,
        }
    }

    /// Shows a picture to a model of this make.
    ///
    /// # Errors
    /// When the picture cannot be prepared or the graph fails.
    pub fn show(&self, vlm: &Vlm, picture: &Image) -> Result<Shown, PerceptionError> {
        match self {
            Self::InternVl(config) => {
                let pixels = config.prepare(picture);
                let tokens = [1, pixels.shape()[0] * config.tokens_per_tile];
                let features = vlm.see(&[("pixel_values", &pixels)])?;
                let size_px = [picture.width, picture.height];
                Ok(Shown { features, tokens, size_px })
            }
            Self::Qwen25Vl(config) => {
                let patches = config.prepare(picture)?;
                let grid = ["image_grid_thw", "grid_thw"]
                    .into_iter()
                    .find(|name| vlm.vision_inputs().iter().any(|known| known == name));
                let mut inputs = vec![("pixel_values", &patches.pixels)];
                inputs.extend(grid.map(|name| (name, &patches.grid)));
                let features = vlm.see(&inputs)?;
                Ok(Shown { features, tokens: patches.tokens, size_px: patches.size_px })
            }
        }
    }

    /// The words of a turn in which the user shows the picture and asks something.
    #[must_use]
    pub fn prompt(&self, question: &str, shown: &Shown) -> String {
        match self {
            Self::InternVl(config) => {
                config.prompt(question, shown.tokens[1] / config.tokens_per_tile.max(1))
            }
            Self::Qwen25Vl(config) => config.prompt(question, shown.tokens),
        }
    }

    /// The places of a prompt's tokens, for families with positions in rows and columns.
    #[must_use]
    pub fn places(&self, ids: &[u32], shown: &Shown) -> Option<Vec<Position>> {
        match self {
            Self::InternVl(_) => None,
            Self::Qwen25Vl(config) => Some(config.places(ids, shown.tokens)),
        }
    }
}
