//! Draws flat shapes given in fractions of a body's height, standing at a place in the room.

use jrdb_projection::camera::CameraModel;
use jrdb_projection::nalgebra::{Point3, Vector2};
use tiny_skia::{LineCap, LineJoin, Path, PathBuilder, Rect, Stroke, Transform};

use super::canvas::{Canvas, Extent, closed};
use crate::robot::Panorama;
use crate::room::{Color, FLOOR_M};

/// A pen at the feet of somebody: `[0, 0]` is the floor below the trunk, x grows to the right of
/// the picture and y upwards, 1 is the body's height.
pub(super) struct Pen<'a> {
    canvas: &'a mut Canvas,
    instance: u8,
    pixels_from_body: Transform,
    /// What has been drawn so far.
    extent: Option<Extent>,
}

impl<'a> Pen<'a> {
    /// A pen for somebody so tall, standing somewhere but in the robot.
    pub(super) fn new(
        canvas: &'a mut Canvas,
        camera: &Panorama,
        place_m: Vector2<f64>,
        height_m: f64,
        instance: u8,
    ) -> Option<Self> {
        let feet = camera.pixel_from_base(&Point3::new(place_m.x, place_m.y, FLOOR_M))?;
        let across =
            f64::from(camera.lens.width_px) / std::f64::consts::TAU * height_m / feet.depth_m;
        let up = camera.lens.focal_px * height_m / feet.depth_m;
        let (u, v) = (feet.u as f32, feet.v as f32);
        let pixels_from_body = Transform::from_row(across as f32, 0.0, 0.0, -up as f32, u, v);
        Some(Self { canvas, instance, pixels_from_body, extent: None })
    }

    pub(super) fn extent(&self) -> Option<Extent> {
        self.extent
    }

    fn fill(&mut self, path: Option<Path>, color: Color) {
        let Some(path) = path.and_then(|path| path.transform(self.pixels_from_body)) else {
            return;
        };
        self.canvas.fill(&path, color, self.instance);
        let Some(bounds) = path.compute_tight_bounds() else { return };
        let new = [bounds.left(), bounds.top(), bounds.right(), bounds.bottom()];
        self.extent = Some(self.extent.map_or(new, |old| {
            [old[0].min(new[0]), old[1].min(new[1]), old[2].max(new[2]), old[3].max(new[3])]
        }));
    }

    pub(super) fn polygon(&mut self, points: &[[f64; 2]], color: Color) {
        let points: Vec<[f32; 2]> = points.iter().map(|p| p.map(|value| value as f32)).collect();
        self.fill(closed(&points), color);
    }

    pub(super) fn oval(&mut self, [x, y]: [f64; 2], [across, up]: [f64; 2], color: Color) {
        let [left, right, low, high] = [x - across, x + across, y - up, y + up].map(|v| v as f32);
        let oval = Rect::from_ltrb(left, low, right, high);
        self.fill(oval.and_then(PathBuilder::from_oval), color);
    }

    /// The part of an oval between two angles, degrees counter-clockwise from the right.
    pub(super) fn pie(
        &mut self,
        [x, y]: [f64; 2],
        [across, up]: [f64; 2],
        [from, to]: [f64; 2],
        color: Color,
    ) {
        const CORNERS: u32 = 24;
        let corner = |index: u32| {
            let angle = from + (to - from) * f64::from(index) / f64::from(CORNERS);
            let (sin, cos) = angle.to_radians().sin_cos();
            [x + across * cos, y + up * sin]
        };
        let points: Vec<[f64; 2]> = (0..=CORNERS).map(corner).collect();
        self.polygon(&points, color);
    }

    /// A line with round ends.
    pub(super) fn limb(&mut self, points: &[[f64; 2]], width: f64, color: Color) {
        let mut path = PathBuilder::new();
        let Some((first, rest)) = points.split_first() else { return };
        path.move_to(first[0] as f32, first[1] as f32);
        for point in rest {
            path.line_to(point[0] as f32, point[1] as f32);
        }
        let stroke = Stroke {
            width: width as f32,
            line_cap: LineCap::Round,
            line_join: LineJoin::Round,
            ..Stroke::default()
        };
        let scale = self.pixels_from_body.sx;
        self.fill(path.finish().and_then(|path| path.stroke(&stroke, scale)), color);
    }
}
