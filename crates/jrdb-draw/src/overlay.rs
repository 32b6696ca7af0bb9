//! A cloud on its panorama: what fits lies on the thing it is a point of.

use jrdb_projection::CameraModel;
use jrdb_projection::nalgebra::Point3;
use jrdb_types::Image;

use crate::canvas::{Letters, text_size};
use crate::{BLACK, Canvas, Color, WHITE};

/// Height of the strip with title and legend, pixels.
const HEAD_PX: usize = 64;
/// Height of the strip with the title of one overlay, pixels.
const TITLE_PX: usize = 26;
/// How far the image is darkened, so that points stand out.
const DARKENED: f32 = 0.45;
/// Radius of a point, pixels.
const POINT_PX: f64 = 1.7;
/// Points nearer than this have the first colour, metres.
const NEAREST_M: f64 = 1.0;
/// Points farther than this have the last colour, metres.
const FARTHEST_M: f64 = 16.0;
/// A point is hidden when another in its cell is nearer by this factor.
const HIDDEN_FACTOR: f64 = 1.3;
/// Width and height of a cell in which a nearer point hides others, pixels: about the distance of
/// neighbouring points of a 16-beam LiDAR's ring, and of its rings.
const CELL_PX: [f64; 2] = [5.0, 20.0];
/// Colours from near to far.
const COLORS: [Color; 6] = [
    [255, 60, 60],
    [255, 165, 40],
    [250, 240, 70],
    [80, 230, 100],
    [60, 190, 255],
    [170, 120, 255],
];
/// Ranges that the legend names, metres.
const LEGEND_M: [f64; 5] = [1.0, 2.0, 4.0, 8.0, 16.0];

/// What an overlay is drawn on.
#[derive(Clone, Copy)]
pub struct Overlay<'a> {
    /// What is shown, and what came of it.
    pub title: &'a str,
    /// The panorama.
    pub image: &'a Image,
    /// Its camera.
    pub camera: &'a dyn CameraModel,
}

/// One cloud on the panorama.
#[derive(Debug, Clone, Copy)]
pub struct Strip<'a> {
    /// What it is.
    pub title: &'a str,
    /// Points, base frame, metres.
    pub points: &'a [Point3<f64>],
}

/// The panorama with each cloud, one below the other, in two halves so that it can be seen without scrolling:
/// points coloured by range, nearer ones over farther ones, hidden ones left out; a legend in metres.
#[must_use]
pub fn draw_overlay(overlay: &Overlay<'_>, strips: &[Strip<'_>]) -> Image {
    let (width, height) = (overlay.image.width, overlay.image.height);
    let half = width.div_ceil(2);
    let strip_px = TITLE_PX + 2 * height;
    let mut canvas = Canvas::filled(half, HEAD_PX + strips.len() * strip_px, BLACK);
    canvas.text(overlay.title, [10.0, 6.0], Letters::Large, WHITE);
    legend(&mut canvas);
    for (index, strip) in strips.iter().enumerate() {
        let top = HEAD_PX + index * strip_px;
        canvas.text(strip.title, [10.0, top as f64 + 3.0], Letters::Large, WHITE);
        let whole = drawn(overlay, strip.points);
        for (part, left) in [0, half].into_iter().enumerate() {
            let y = top + TITLE_PX + part * height;
            canvas.image(&columns(&whole, left, half), 0, y as i32);
        }
    }
    canvas.to_image()
}

/// `count` columns of an image from the `left`-th on; black where it ends.
fn columns(image: &Image, left: usize, count: usize) -> Image {
    let mut part = Image::filled(count, image.height, [0; 3]);
    let kept = count.min(image.width - left);
    let (from, to) =
        (image.rgb.chunks_exact(3 * image.width), part.rgb.chunks_exact_mut(3 * count));
    for (source, target) in from.zip(to) {
        target[..3 * kept].copy_from_slice(&source[3 * left..3 * (left + kept)]);
    }
    part
}

fn drawn(overlay: &Overlay<'_>, points: &[Point3<f64>]) -> Image {
    let (width, height) = (overlay.image.width as f64, overlay.image.height as f64);
    let mut canvas = Canvas::filled(overlay.image.width, overlay.image.height, [0; 3]);
    canvas.image(overlay.image, 0, 0);
    canvas.fill_rect([0.0, 0.0, width, height], [0; 3], DARKENED);
    let seen = |point: &Point3<f64>| {
        let pixel = overlay.camera.pixel_from_base(point)?;
        let inside = (0.0..width).contains(&pixel.u) && (0.0..height).contains(&pixel.v);
        inside.then(|| Dot {
            at: [pixel.u, pixel.v],
            range_m: (point - overlay.camera.center()).norm(),
        })
    };
    let mut dots = without_hidden(points.iter().filter_map(seen).collect(), [width, height]);
    dots.sort_by(|a, b| b.range_m.total_cmp(&a.range_m));
    for dot in dots {
        canvas.disc(dot.at, POINT_PX, range_color(dot.range_m));
    }
    canvas.to_image()
}

/// A point in the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Dot {
    at: [f64; 2],
    range_m: f64,
}

/// The dots that no nearer dot of their cell hides.
fn without_hidden(dots: Vec<Dot>, size: [f64; 2]) -> Vec<Dot> {
    let across = (size[0] / CELL_PX[0]).ceil() as usize;
    let down = (size[1] / CELL_PX[1]).ceil() as usize;
    let cell = |dot: &Dot| {
        let [x, y] = [0, 1].map(|i| (dot.at[i] / CELL_PX[i]) as usize);
        y.min(down - 1) * across + x.min(across - 1)
    };
    let mut nearest = vec![f64::INFINITY; across * down];
    for dot in &dots {
        let cell = &mut nearest[cell(dot)];
        *cell = cell.min(dot.range_m);
    }
    let visible = |dot: &Dot| dot.range_m <= HIDDEN_FACTOR * nearest[cell(dot)];
    dots.into_iter().filter(visible).collect()
}

/// The colour of a range: even steps for equal ratios.
fn range_color(range_m: f64) -> Color {
    let share = (range_m / NEAREST_M).ln() / (FARTHEST_M / NEAREST_M).ln();
    let at = share.clamp(0.0, 1.0) * (COLORS.len() - 1) as f64;
    let (low, part) = (at.floor() as usize, at.fract());
    let (a, b) = (COLORS[low], COLORS[(low + 1).min(COLORS.len() - 1)]);
    [0, 1, 2].map(|i| (f64::from(a[i]) * (1.0 - part) + f64::from(b[i]) * part).round() as u8)
}

fn legend(canvas: &mut Canvas) {
    const LEFT: f64 = 10.0;
    const TOP: f64 = 36.0;
    const WIDTH: f64 = 640.0;
    for column in 0..WIDTH as usize {
        let share = column as f64 / WIDTH;
        let range_m = NEAREST_M * (FARTHEST_M / NEAREST_M).powf(share);
        canvas.fill_rect([LEFT + column as f64, TOP, 1.0, 22.0], range_color(range_m), 1.0);
    }
    for range_m in LEGEND_M {
        let text = format!("{range_m} m");
        let share = (range_m / NEAREST_M).ln() / (FARTHEST_M / NEAREST_M).ln();
        let room = WIDTH - text_size(&text, Letters::Large)[0] - 4.0;
        canvas.text(&text, [LEFT + 2.0 + share * room, TOP + 1.0], Letters::Large, BLACK);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_projection::camera::PosedCamera;
    use jrdb_types::CylindricalPanorama;

    #[test]
    fn near_is_red_far_is_violet_and_nothing_is_out_of_range() {
        assert_eq!(range_color(1.0), COLORS[0]);
        assert_eq!(range_color(0.0), COLORS[0]);
        assert_eq!(range_color(16.0), COLORS[5]);
        assert_eq!(range_color(1e9), COLORS[5]);
    }

    #[test]
    fn a_dot_behind_a_nearer_one_is_left_out() {
        let dot = |x: f64, range_m: f64| Dot { at: [x, 10.0], range_m };
        let found =
            without_hidden(vec![dot(11.0, 5.0), dot(13.0, 2.0), dot(30.0, 5.0)], [40.0, 40.0]);
        assert_eq!(found, [dot(13.0, 2.0), dot(30.0, 5.0)]);
    }

    #[test]
    fn a_point_is_drawn_where_the_camera_has_it() {
        let lens =
            CylindricalPanorama { width_px: 100, height_px: 40, focal_px: 40.0, horizon_px: 20.0 };
        let camera = PosedCamera::ahead(lens);
        let image = Image::filled(100, 40, [0; 3]);
        let overlay = Overlay { title: "", image: &image, camera: &camera };
        // Ahead is the middle column: the left edge of the lower half.
        let ahead = [Point3::new(1.0, -0.13, 0.0)];
        let picture = draw_overlay(&overlay, &[Strip { title: "", points: &ahead }]);
        assert_eq!((picture.width, picture.height), (50, HEAD_PX + TITLE_PX + 80));
        assert_eq!(picture.pixel(2, HEAD_PX + TITLE_PX + 60), range_color(1.01));
        assert_eq!(picture.pixel(25, HEAD_PX + TITLE_PX + 60), [0; 3]);
    }
}
