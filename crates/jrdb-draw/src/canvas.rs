//! A picture that shapes and text can be drawn on.

use embedded_graphics::mono_font::{MonoFont, MonoTextStyle, ascii};
use embedded_graphics::pixelcolor::Rgb888;
use embedded_graphics::prelude::*;
use embedded_graphics::text::{Baseline, Text};
use jrdb_types::Image;
use tiny_skia::{
    FillRule, Paint, PathBuilder, Pixmap, PixmapPaint, Rect, Stroke, StrokeDash, Transform,
};

use crate::Color;

/// Size of the letters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Letters {
    /// 13 pixels high.
    Small,
    /// 20 pixels high.
    Large,
    /// 40 pixels high: readable on a whole panorama.
    Huge,
}

impl Letters {
    fn font(self) -> &'static MonoFont<'static> {
        match self {
            Self::Small => &ascii::FONT_7X13_BOLD,
            Self::Large | Self::Huge => &ascii::FONT_10X20,
        }
    }

    /// Side of the square that one pixel of the font becomes.
    fn scale(self) -> i32 {
        if self == Self::Huge { 2 } else { 1 }
    }
}

/// A picture under work. Coordinates are pixels from the top-left corner; what lies outside is clipped.
pub struct Canvas {
    pixels: Pixmap,
}

impl Canvas {
    /// A picture of one colour; at least one pixel.
    ///
    /// # Panics
    /// When the size is beyond what memory can address.
    #[must_use]
    pub fn filled(width: usize, height: usize, color: Color) -> Self {
        let size = [width, height].map(|n| u32::try_from(n.max(1)).unwrap_or(u32::MAX));
        let mut pixels = Pixmap::new(size[0], size[1]).expect("a picture's size fits the memory");
        pixels.fill(opaque(color));
        Self { pixels }
    }

    /// Lays an image with its top-left corner on `(x, y)`.
    pub fn image(&mut self, image: &Image, x: i32, y: i32) {
        let mut other = Self::filled(image.width, image.height, [0; 3]);
        for (target, source) in
            other.pixels.data_mut().chunks_exact_mut(4).zip(image.rgb.chunks_exact(3))
        {
            target[..3].copy_from_slice(source);
        }
        let paint = PixmapPaint::default();
        self.pixels.draw_pixmap(x, y, other.pixels.as_ref(), &paint, Transform::identity(), None);
    }

    /// The picture as it is now.
    #[must_use]
    pub fn to_image(&self) -> Image {
        let rgb = self.pixels.data().chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
        Image { width: self.pixels.width() as usize, height: self.pixels.height() as usize, rgb }
    }

    /// A filled rectangle; `opacity` from 0 to 1.
    pub fn fill_rect(&mut self, [x, y, w, h]: [f64; 4], color: Color, opacity: f32) {
        let ([x, y], [w, h]) = (near([x, y]), near([w, h]));
        if let Some(rect) = Rect::from_xywh(x, y, w, h) {
            self.pixels.fill_rect(rect, &paint(color, opacity), Transform::identity(), None);
        }
    }

    /// A rectangle's outline.
    pub fn rect(&mut self, [x, y, w, h]: [f64; 4], color: Color, width: f32) {
        self.line(&[[x, y], [x + w, y], [x + w, y + h], [x, y + h], [x, y]], color, width);
    }

    /// A rectangle's outline, dashed.
    pub fn dashed_rect(&mut self, [x, y, w, h]: [f64; 4], color: Color, width: f32) {
        let corners = [[x, y], [x + w, y], [x + w, y + h], [x, y + h], [x, y]];
        self.dashed_line(&corners, color, width);
    }

    /// A line through points.
    pub fn line(&mut self, points: &[[f64; 2]], color: Color, width: f32) {
        self.stroke(points, color, width, None);
    }

    /// A dashed line through points.
    pub fn dashed_line(&mut self, points: &[[f64; 2]], color: Color, width: f32) {
        self.stroke(points, color, width, StrokeDash::new(vec![3.0 * width, 2.0 * width], 0.0));
    }

    fn stroke(&mut self, points: &[[f64; 2]], color: Color, width: f32, dash: Option<StrokeDash>) {
        let Some(path) = path(points) else { return };
        let stroke = Stroke { width, dash, ..Stroke::default() };
        self.pixels.stroke_path(&path, &paint(color, 1.0), &stroke, Transform::identity(), None);
    }

    /// A filled polygon.
    pub fn polygon(&mut self, points: &[[f64; 2]], color: Color) {
        if let Some(path) = path(points) {
            let paint = paint(color, 1.0);
            self.pixels.fill_path(&path, &paint, FillRule::Winding, Transform::identity(), None);
        }
    }

    /// A circle's outline.
    pub fn circle(&mut self, [x, y]: [f64; 2], radius: f64, color: Color, width: f32) {
        let ([x, y], [radius, _]) = (near([x, y]), near([radius; 2]));
        let Some(path) = PathBuilder::from_circle(x, y, radius) else {
            return;
        };
        let stroke = Stroke { width, ..Stroke::default() };
        self.pixels.stroke_path(&path, &paint(color, 1.0), &stroke, Transform::identity(), None);
    }

    /// A filled circle.
    pub fn disc(&mut self, [x, y]: [f64; 2], radius: f64, color: Color) {
        let ([x, y], [radius, _]) = (near([x, y]), near([radius; 2]));
        let Some(path) = PathBuilder::from_circle(x, y, radius) else {
            return;
        };
        let paint = paint(color, 1.0);
        self.pixels.fill_path(&path, &paint, FillRule::Winding, Transform::identity(), None);
    }

    /// One pixel.
    pub fn dot(&mut self, [x, y]: [f64; 2], color: Color) {
        let (x, y) = (x.floor(), y.floor());
        let (width, height) = (f64::from(self.pixels.width()), f64::from(self.pixels.height()));
        if (0.0..width).contains(&x) && (0.0..height).contains(&y) {
            let at = 4 * (y as usize * self.pixels.width() as usize + x as usize);
            self.pixels.data_mut()[at..at + 3].copy_from_slice(&color);
        }
    }

    /// Text with its top-left corner on `(x, y)`; letters outside ASCII become `?`.
    pub fn text(&mut self, text: &str, at: [f64; 2], letters: Letters, color: Color) {
        let [x, y] = near(at);
        if x.is_nan() || y.is_nan() {
            return;
        }
        let style = MonoTextStyle::new(letters.font(), Rgb888::new(color[0], color[1], color[2]));
        let origin = Point::new(x as i32, y as i32);
        let mut enlarged = Enlarged { canvas: self, origin, scale: letters.scale() };
        let Ok(_) =
            Text::with_baseline(text, Point::zero(), style, Baseline::Top).draw(&mut enlarged);
    }

    /// Text on a patch of colour.
    pub fn label(&mut self, text: &str, at: [f64; 2], letters: Letters, [ink, ground]: [Color; 2]) {
        let [w, h] = text_size(text, letters);
        self.fill_rect([at[0], at[1], w + 4.0, h + 2.0], ground, 1.0);
        self.text(text, [at[0] + 2.0, at[1] + 1.0], letters, ink);
    }
}

/// Width and height of a text, pixels.
#[must_use]
pub(super) fn text_size(text: &str, letters: Letters) -> [f64; 2] {
    let size = letters.font().character_size * letters.scale().unsigned_abs();
    [text.chars().count() as f64 * f64::from(size.width), f64::from(size.height)]
}

/// A canvas on which every pixel drawn is a square.
struct Enlarged<'a> {
    canvas: &'a mut Canvas,
    origin: Point,
    scale: i32,
}

impl OriginDimensions for Enlarged<'_> {
    fn size(&self) -> Size {
        Size::new(self.canvas.pixels.width(), self.canvas.pixels.height())
    }
}

impl DrawTarget for Enlarged<'_> {
    type Color = Rgb888;
    type Error = std::convert::Infallible;

    fn draw_iter<I>(&mut self, pixels: I) -> Result<(), Self::Error>
    where
        I: IntoIterator<Item = Pixel<Rgb888>>,
    {
        for Pixel(at, color) in pixels {
            let corner = self.origin + at * self.scale;
            for (dx, dy) in (0..self.scale).flat_map(|dy| (0..self.scale).map(move |dx| (dx, dy))) {
                let pixel = [corner.x + dx, corner.y + dy].map(f64::from);
                self.canvas.dot(pixel, [color.r(), color.g(), color.b()]);
            }
        }
        Ok(())
    }
}

fn opaque(color: Color) -> tiny_skia::Color {
    tiny_skia::Color::from_rgba8(color[0], color[1], color[2], 255)
}

fn paint(color: Color, opacity: f32) -> Paint<'static> {
    let mut paint = Paint::default();
    let mut color = opaque(color);
    color.set_alpha(opacity);
    paint.set_color(color);
    paint
}

/// What is further away than this from the corner is outside every picture, pixels.
const FAR_PX: f64 = 1e6;

/// A place that arithmetic on it cannot overflow, outside the picture if the given one is.
fn near(place: [f64; 2]) -> [f32; 2] {
    place.map(|pixels| pixels.clamp(-FAR_PX, FAR_PX) as f32)
}

fn path(points: &[[f64; 2]]) -> Option<tiny_skia::Path> {
    let mut path = PathBuilder::new();
    let (first, rest) = points.split_first()?;
    let [x, y] = near(*first);
    path.move_to(x, y);
    for point in rest {
        let [x, y] = near(*point);
        path.line_to(x, y);
    }
    path.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_land_where_they_are_told_and_nothing_fails_outside() {
        let mut canvas = Canvas::filled(20, 10, [0; 3]);
        canvas.fill_rect([2.0, 2.0, 4.0, 4.0], [255, 0, 0], 1.0);
        canvas.dot([19.0, 9.0], [0, 255, 0]);
        canvas.dot([-1.0, 50.0], [0, 255, 0]);
        canvas.text("out of here é", [15.0, -5.0], Letters::Large, [1, 2, 3]);
        canvas.line(&[[f64::NAN, 0.0], [5.0, 5.0]], [9; 3], 1.0);
        let image = canvas.to_image();
        assert_eq!(image.pixel(3, 3), [255, 0, 0]);
        assert_eq!(image.pixel(19, 9), [0, 255, 0]);
        assert_eq!(image.pixel(10, 9), [0; 3]);
    }

    #[test]
    fn places_of_any_size_do_no_harm() {
        let mut canvas = Canvas::filled(20, 10, [0; 3]);
        for far in [1e9, -1e12, 1e308, f64::INFINITY, f64::NAN] {
            canvas.fill_rect([far, far, 4.0, 4.0], [9; 3], 1.0);
            canvas.rect([0.0, far, far, far], [9; 3], 1.0);
            canvas.dashed_line(&[[far, 30.0], [0.0, 30.0]], [9; 3], 1.0);
            canvas.polygon(&[[far, 40.0], [0.0, 40.0], [0.0, 44.0]], [9; 3]);
            canvas.circle([far, far], far, [9; 3], 1.0);
            canvas.disc([far, far], 3.0, [9; 3]);
            canvas.label("far away", [far, far], Letters::Huge, [[9; 3]; 2]);
        }
        assert_eq!(canvas.to_image().pixel(10, 5), [0; 3]);
    }

    #[test]
    fn an_image_comes_back_as_it_was_laid() {
        let image = Image { width: 2, height: 1, rgb: vec![1, 2, 3, 4, 5, 6] };
        let mut canvas = Canvas::filled(3, 2, [0; 3]);
        canvas.image(&image, 1, 1);
        assert_eq!(canvas.to_image().pixel(2, 1), [4, 5, 6]);
    }
}
