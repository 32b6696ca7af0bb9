//! InternVL3.5 (Wang et al. 2025): its sizes, its tiles and its way of being spoken to.

use jrdb_types::Image;
use serde::Deserialize;

use super::text_model::{TextFile, TextModel};
use crate::detector::PerceptionError;
use crate::engine::Tensor;
use crate::image::PictureConfig;
use crate::image::resize;
use crate::json::parse_json;

/// Sizes and rules of one model, from the files beside its weights.
#[derive(Debug, Clone, PartialEq)]
pub struct InternVlConfig {
    /// How one tile is prepared.
    pub picture: PictureConfig,
    /// Fewest and most tiles of a picture, without its thumbnail.
    ///
    /// The crop of a person is best seen as one tile: 60 by 150 pixels would become eleven, with
    /// eleven times the tokens.
    pub tiles: [usize; 2],
    /// Tokens of one tile.
    pub tokens_per_tile: usize,
    /// The text half.
    pub text: TextModel,
}

#[derive(Deserialize)]
struct ModelFile {
    image_seq_length: usize,
    image_token_id: u32,
    text_config: TextFile,
}

impl InternVlConfig {
    /// Reads the texts of `config.json`, `generation_config.json` and `preprocessor_config.json`.
    ///
    /// # Errors
    /// [`PerceptionError::File`] if one of them does not have the content that its name promises.
    pub fn from_json(
        config: &str,
        generation: &str,
        preprocessor: &str,
    ) -> Result<Self, PerceptionError> {
        let model: ModelFile = parse_json("config.json", config)?;
        Ok(Self {
            picture: PictureConfig::from_json(preprocessor)?,
            tiles: [1, 1],
            tokens_per_tile: model.image_seq_length,
            text: TextModel::new(&model.text_config, model.image_token_id, false, generation)?,
        })
    }

    /// The input of the vision encoder: the tiles of a picture, f32 `[tiles, 3, side, side]`.
    #[must_use]
    pub fn prepare(&self, image: &Image) -> Tensor {
        let [side_x, side_y] = [self.picture.size.width, self.picture.size.height];
        let tiles = tiles_of(image, self.tiles, [side_x, side_y], self.picture.filter());
        let prepared: Vec<_> = tiles.iter().map(|tile| self.picture.planes(tile)).collect();
        self.picture.tensor(&prepared)
    }

    /// The prompt for a picture of this many tiles and a question.
    #[must_use]
    pub fn prompt(&self, question: &str, tiles: usize) -> String {
        let image = "<IMG_CONTEXT>".repeat(tiles * self.tokens_per_tile);
        format!(
            "<|im_start|>user\n<img>{image}</img>\n{question}<|im_end|>\n<|im_start|>assistant\n"
        )
    }
}

/// Columns and rows of tiles for a picture of this size: of all grids of `fewest` to `most` tiles
/// the one nearest in shape.
///
/// Of equally near grids the larger is taken if the picture has more than half the pixels of its
/// tiles.
///
/// ```
/// use jrdb_perception::vlm::grid;
/// assert_eq!(grid([60, 150], [1, 12], [448, 448]), [2, 5]);
/// assert_eq!(grid([448, 448], [1, 12], [448, 448]), [1, 1]);
/// ```
#[must_use]
pub fn grid(size_px: [usize; 2], [fewest, most]: [usize; 2], tile_px: [usize; 2]) -> [usize; 2] {
    let allowed = |grid: &[usize; 2]| (fewest..=most).contains(&(grid[0] * grid[1]));
    let all = (1..=most).flat_map(|columns| (1..=most).map(move |rows| [columns, rows]));
    let mut grids: Vec<[usize; 2]> = all.filter(allowed).collect();
    grids.sort_by_key(|grid| grid[0] * grid[1]);
    let aspect = size_px[0] as f64 / size_px[1].max(1) as f64;
    let off = |grid: [usize; 2]| (aspect - grid[0] as f64 / grid[1] as f64).abs();
    let pixels = (size_px[0] * size_px[1]) as f64;
    let fills =
        |grid: [usize; 2]| pixels > 0.5 * (tile_px[0] * tile_px[1] * grid[0] * grid[1]) as f64;
    let nearer = |best: Option<[usize; 2]>, grid: [usize; 2]| match best {
        Some(other) if off(grid) > off(other) || off(grid) == off(other) && !fills(grid) => best,
        _ => Some(grid),
    };
    grids.into_iter().fold(None, nearer).unwrap_or([1, 1])
}

/// A picture cut into tiles, row by row, and then the whole of it if there is more than one.
#[must_use]
pub fn tiles_of(
    image: &Image,
    tiles: [usize; 2],
    tile_px: [usize; 2],
    filter: crate::image::Filter,
) -> Vec<Image> {
    let [columns, rows] = grid([image.width, image.height], tiles, tile_px);
    let large = resize(image, columns * tile_px[0], rows * tile_px[1], filter);
    let cut = |index: usize| {
        let (left, top) = (index % columns * tile_px[0], index / columns * tile_px[1]);
        let row = |y: usize| {
            let start = 3 * (y * large.width + left);
            large.rgb[start..start + 3 * tile_px[0]].iter().copied()
        };
        let rgb = (top..top + tile_px[1]).flat_map(row).collect();
        Image { width: tile_px[0], height: tile_px[1], rgb }
    };
    let mut found: Vec<Image> = (0..columns * rows).map(cut).collect();
    if found.len() > 1 {
        found.push(resize(image, tile_px[0], tile_px[1], filter));
    }
    found
}
