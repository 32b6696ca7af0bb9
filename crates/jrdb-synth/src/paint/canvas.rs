//! A panorama under work and, beside it, whose pixels are whose.

use jrdb_types::Image;
use tiny_skia::{FillRule, Paint, Path, PathBuilder, Pixmap, Transform};

use crate::room::Color;

/// The picture and its instance mask. What crosses the right edge goes on at the left one.
pub(crate) struct Canvas {
    picture: Pixmap,
    /// The instance's number in the red channel.
    mask: Pixmap,
}

/// Left, top, right and bottom, pixels; left and right are not wrapped.
pub(crate) type Extent = [f32; 4];

fn opaque(color: Color) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(color[0], color[1], color[2], 255);
    paint
}

impl Canvas {
    /// A canvas with this background and no instances.
    ///
    /// Panics when the picture has no pixels or is beyond what memory can address.
    pub(crate) fn new(background: &Image) -> Self {
        let size = [background.width, background.height].map(|n| u32::try_from(n).unwrap_or(0));
        let empty = || Pixmap::new(size[0], size[1]).expect("a panorama has a size");
        let mut picture = empty();
        let pixels = background.rgb.chunks_exact(3);
        for (target, source) in picture.data_mut().chunks_exact_mut(4).zip(pixels) {
            target.copy_from_slice(&[source[0], source[1], source[2], 255]);
        }
        Self { picture, mask: empty() }
    }

    /// Fills a path of pixels for an instance; 0 is nobody.
    pub(crate) fn fill(&mut self, path: &Path, color: Color, instance: u8) {
        let width = self.picture.width() as f32;
        let bounds = path.bounds();
        let mark = Paint { anti_alias: false, ..opaque([instance, 0, 0]) };
        for shift in [-width, 0.0, width] {
            if bounds.right() + shift > 0.0 && bounds.left() + shift < width {
                let moved = Transform::from_translate(shift, 0.0);
                self.picture.fill_path(path, &opaque(color), FillRule::Winding, moved, None);
                self.mask.fill_path(path, &mark, FillRule::Winding, moved, None);
            }
        }
    }

    /// Fills a polygon of pixels.
    pub(crate) fn polygon(&mut self, points: &[[f32; 2]], color: Color, instance: u8) {
        if let Some(path) = closed(points) {
            self.fill(&path, color, instance);
        }
    }

    /// How many pixels are an instance's.
    pub(crate) fn pixels_of(&self, instance: u8) -> usize {
        self.mask
            .data()
            .chunks_exact(4)
            .filter(|pixel| pixel[0] == instance && pixel[3] > 0)
            .count()
    }

    /// The picture, and the instance of each of its pixels.
    pub(crate) fn finish(self) -> (Image, Vec<u8>) {
        let rgb = self.picture.data().chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
        let (width, height) = (self.picture.width() as usize, self.picture.height() as usize);
        let instances = self.mask.data().chunks_exact(4).map(|pixel| pixel[0]).collect();
        (Image { width, height, rgb }, instances)
    }
}

/// A closed path through points; none when they are fewer than two or not finite.
pub(crate) fn closed(points: &[[f32; 2]]) -> Option<Path> {
    let (first, rest) = points.split_first()?;
    let mut path = PathBuilder::new();
    path.move_to(first[0], first[1]);
    for point in rest {
        path.line_to(point[0], point[1]);
    }
    path.close();
    path.finish()
}
