//! What a model of perception should see in a picture.

use jrdb_types::{Attributes, Image, PixelBox};

use super::feature::Feature;

/// A frame's picture without sweeps and questions, and who is in it.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// The panorama.
    pub image: Image,
    /// For each pixel 0, or the [`Seen::instance`] whose it is.
    pub instances: Vec<u8>,
    /// Everybody of whom a row is in the picture, in the order of their ids.
    pub people: Vec<Seen>,
}

/// A person in a [`View`].
#[derive(Debug, Clone, PartialEq)]
pub struct Seen {
    /// The number of their pixels in [`View::instances`].
    pub instance: u8,
    /// How many pixels they have, those included that others hide.
    pub pixels: usize,
    /// The whole drawing, hidden parts too, pixels.
    pub bbox: PixelBox,
    /// What is true of them, which way they face included.
    pub attributes: Attributes,
    /// What is true of their looks beyond that, sorted; some of it may not show from here ([`Feature::shows`]).
    pub features: Vec<Feature>,
}

impl Seen {
    /// Whether the picture shows that they look so, or that they do not. A head that its border cuts
    /// shows nothing.
    #[must_use]
    pub fn shows(&self, feature: Feature) -> bool {
        let (facing, action) = (self.attributes.facing.best(), self.attributes.action().best());
        let is_cut = self.bbox.y <= 0.0;
        facing.zip(action).is_some_and(|(facing, action)| feature.shows(facing, action))
            && !(is_cut && feature.is_on_the_head())
    }
}

/// A person in a part of the panorama.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InTile {
    /// The place in [`View::people`].
    pub person: usize,
    /// The part of the box that lies in the tile, pixels of the tile.
    pub bbox: PixelBox,
    /// The share of the person's pixels that are seen there, in `[0, 1]`.
    pub visible: f64,
}

impl View {
    /// The share of a person's pixels that nothing hides, in `[0, 1]`.
    #[must_use]
    pub fn visible(&self, seen: &Seen) -> f64 {
        let shown = self.instances.iter().filter(|instance| **instance == seen.instance).count();
        shown as f64 / seen.pixels.max(1) as f64
    }

    /// Everybody who is seen in the columns from `x_px` on, across the seam, in the order of their ids.
    #[must_use]
    pub fn in_tile(&self, x_px: usize, width_px: usize) -> Vec<InTile> {
        let shown = self.shown(x_px, width_px);
        let one = |(person, seen): (usize, &Seen)| {
            let start = (seen.bbox.x - x_px as f64).rem_euclid(self.image.width as f64);
            let start =
                if start >= width_px as f64 { start - self.image.width as f64 } else { start };
            let (left, right) = (start.max(0.0), (start + seen.bbox.w).min(width_px as f64));
            let bbox = PixelBox { x: left, w: right - left, ..seen.bbox };
            let pixels = shown[usize::from(seen.instance)];
            let visible = pixels as f64 / seen.pixels.max(1) as f64;
            (pixels > 0 && right > left).then_some(InTile { person, bbox, visible })
        };
        self.people.iter().enumerate().filter_map(one).collect()
    }

    /// How many pixels of each instance are in some columns.
    fn shown(&self, x_px: usize, width_px: usize) -> [usize; 256] {
        let mut shown = [0; 256];
        for row in self.instances.chunks_exact(self.image.width.max(1)) {
            for x in x_px..x_px + width_px {
                shown[usize::from(row[x % row.len()])] += 1;
            }
        }
        shown
    }
}
