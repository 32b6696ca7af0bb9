//! Pictures to train and to measure models of perception on.

use jrdb_perception::image::{Wrap, crop};
use jrdb_types::{Image, PixelBox};

use super::random::Random;
use super::{Setting, SynthConfig, View, generate, with_looks};

/// Tiles as the demo's detector cuts panoramas: as high as they are, this wide.
pub const TILE_PX: usize = 640;
/// From one tile to the next.
const STRIDE_PX: usize = 376;
/// Once around.
const TILES: usize = 10;

/// Nobody is practised on of whom less is seen.
const VISIBLE_MIN: f64 = 0.35;
/// Crops are this much larger than a box on each side, in parts of it, before their sides are moved.
const MARGIN: f64 = 0.02;

/// A drawn scene cut into pictures. Seeds are worlds of their own: what is learned from some is measured on others.
#[derive(Debug, Clone)]
pub struct Practice {
    /// The scene.
    pub view: View,
    random: Random,
}

/// A scene of any kind with 4 to 16 people.
#[must_use]
pub fn practice(seed: u64) -> Practice {
    let (config, random) = planned(seed);
    Practice { view: generate(&config).view(0), random }
}

/// The scene of [`practice`] with looks dealt to everybody.
#[must_use]
pub fn practice_with_looks(seed: u64) -> Practice {
    let (config, random) = planned(seed);
    Practice { view: generate(&with_looks(&config)).view(0), random }
}

fn planned(seed: u64) -> (SynthConfig, Random) {
    const SPREAD: u64 = 0x2545_f491_4f6c_dd1d;
    let mut random = Random::seeded(seed.wrapping_mul(SPREAD));
    let setting = random.pick(&[Setting::Plaza, Setting::Cafe, Setting::Corridor]);
    let people = 4 + (random.unit() * 13.0) as usize;
    let config = SynthConfig { seed, people, setting, ..SynthConfig::default() };
    (config, random)
}

impl Practice {
    /// First columns of tiles once around, which begin somewhere else at every call. The last ones go on across the seam.
    pub fn tiles(&mut self) -> Vec<usize> {
        let start_px = (self.random.unit() * STRIDE_PX as f64) as usize;
        (0..TILES).map(|tile| start_px + tile * STRIDE_PX).collect()
    }

    /// The picture of a tile.
    #[must_use]
    pub fn tile(&self, x_px: usize) -> Image {
        let (x, h) = (x_px as f64, self.view.image.height as f64);
        let bbox = PixelBox { x, y: 0.0, w: TILE_PX as f64, h };
        crop(&self.view.image, &bbox, 0.0, Wrap::Circular).expect("a tile has pixels")
    }

    /// Everybody of whom enough is seen, as the place among the people of the view, with a picture. The sides of the boxes are moved at
    /// random, each by up to `jitter` of the box's size.
    pub fn crops(&mut self, jitter: f64) -> Vec<(usize, Image)> {
        let mut crops = Vec::new();
        for (person, seen) in self.view.people.iter().enumerate() {
            if self.view.visible(seen) >= VISIBLE_MIN {
                let bbox = jittered(seen.bbox, jitter, &mut self.random);
                crops.extend(
                    crop(&self.view.image, &bbox, 0.0, Wrap::Circular).map(|image| (person, image)),
                );
            }
        }
        crops
    }
}

fn jittered(bbox: PixelBox, part: f64, random: &mut Random) -> PixelBox {
    let mut side = |size: f64| size * (MARGIN + random.about_zero(part));
    let (left, right, top, bottom) = (side(bbox.w), side(bbox.w), side(bbox.h), side(bbox.h));
    PixelBox {
        x: bbox.x - left,
        y: bbox.y - top,
        w: bbox.w + left + right,
        h: bbox.h + top + bottom,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_show_everybody_somewhere_and_the_same_seed_the_same() {
        let mut scene = practice(5);
        let starts = scene.tiles();
        let whole = |person: usize| {
            starts.iter().any(|x_px| {
                let shown = scene.view.in_tile(*x_px, TILE_PX);
                let seen = &scene.view.people[person];
                shown.iter().any(|one| one.person == person && one.bbox.w == seen.bbox.w)
            })
        };
        let narrow = (0..scene.view.people.len()).filter(|&p| {
            scene.view.people[p].bbox.w < 250.0 && scene.view.visible(&scene.view.people[p]) > 0.0
        });
        assert!(narrow.into_iter().all(whole));
        assert_eq!(practice(5).tiles(), starts);
        assert_eq!(scene.tile(starts[9]).width, TILE_PX);
    }
}
