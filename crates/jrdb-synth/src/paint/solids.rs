//! Draws furniture: the faces of boxes in perspective, cylinders and balls by their outline.

use jrdb_projection::camera::CameraModel;
use jrdb_projection::nalgebra::{Point3, Vector2, Vector3};

use super::canvas::{Canvas, Extent};
use super::shade::shade;
use crate::furniture::Part;
use crate::robot::Panorama;
use crate::room::Color;
use crate::solid::{Shape, Solid};

/// Straight edges become curves in a panorama: corners set along each.
const EDGE_CORNERS: u32 = 6;
const ROUND_CORNERS: u32 = 28;

/// Draws the parts of one thing, farthest first, and says where.
pub(super) fn draw(
    canvas: &mut Canvas,
    camera: &Panorama,
    parts: &[Part],
    instance: u8,
) -> Option<Extent> {
    let mut parts: Vec<&Part> = parts.iter().collect();
    let range = |part: &Part| part.solid.center.xy().coords.norm();
    // What lies higher is drawn later where it is equally far: a table's top over its legs.
    parts.sort_by(|a, b| {
        let flat = |part: &Part| part.solid.half.z < part.solid.half.x.min(part.solid.half.y);
        flat(a).cmp(&flat(b)).then(range(b).total_cmp(&range(a)))
    });
    let mut brush = Brush { canvas, camera, instance, extent: None };
    for part in parts {
        brush.solid(&part.solid, part.color);
    }
    brush.extent
}

struct Brush<'a> {
    canvas: &'a mut Canvas,
    camera: &'a Panorama,
    instance: u8,
    extent: Option<Extent>,
}

impl Brush<'_> {
    fn solid(&mut self, solid: &Solid, color: Color) {
        match solid.shape {
            Shape::Block => self.block(solid, color),
            Shape::Cylinder => self.cylinder(solid, color),
            Shape::Ellipsoid => self.ball(solid, color),
        }
    }

    /// The faces that look at the camera.
    fn block(&mut self, solid: &Solid, color: Color) {
        let corner = |signs: [f64; 3]| {
            let own = Vector3::from(signs).component_mul(&solid.half);
            at_origin(own, solid)
        };
        for (axis, lightness) in [(0, 0.8), (1, 0.68), (2, 1.0)] {
            for sign in [-1.0, 1.0] {
                let mut signs = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|pair| {
                    let mut signs = [sign; 3];
                    signs[(axis + 1) % 3] = pair[0];
                    signs[(axis + 2) % 3] = pair[1];
                    corner(signs)
                });
                let mut outwards = [0.0; 3];
                outwards[axis] = sign;
                let face = corner(outwards);
                let normal = face - solid.center;
                if normal.dot(&face.coords) < 0.0 {
                    signs.reverse();
                    self.polygon(&edges(&signs), shade(color, lightness));
                }
            }
        }
    }

    fn cylinder(&mut self, solid: &Solid, color: Color) {
        let (low, high) = (solid.center.z - solid.half.z, solid.center.z + solid.half.z);
        // The sides of the outline stand where lines of sight touch the cylinder.
        let sight = solid.center.xy().coords.normalize();
        let across = Vector2::new(-sight.y, sight.x) * solid.half.x;
        let touch = |side: f64, z: f64| {
            let at = solid.center.xy().coords + across * side;
            Point3::new(at.x, at.y, z)
        };
        let rim = |z: f64| {
            (0..ROUND_CORNERS)
                .map(|index| {
                    let angle = std::f64::consts::TAU * f64::from(index) / f64::from(ROUND_CORNERS);
                    let (sin, cos) = angle.sin_cos();
                    at_origin(Vector3::new(cos * solid.half.x, sin * solid.half.y, 0.0), solid)
                        + Vector3::z() * (z - solid.center.z)
                })
                .collect::<Vec<_>>()
        };
        self.polygon(&rim(low), shade(color, 0.8));
        let outline = [touch(-1.0, low), touch(1.0, low), touch(1.0, high), touch(-1.0, high)];
        self.polygon(&outline, shade(color, 0.8));
        self.polygon(&rim(high), color);
    }

    fn ball(&mut self, solid: &Solid, color: Color) {
        let sight = solid.center.xy().coords.normalize();
        let across = Vector2::new(-sight.y, sight.x) * solid.half.x;
        let outline: Vec<Point3<f64>> = (0..ROUND_CORNERS)
            .map(|index| {
                let angle = std::f64::consts::TAU * f64::from(index) / f64::from(ROUND_CORNERS);
                let (sin, cos) = angle.sin_cos();
                let at = solid.center.xy().coords + across * cos;
                Point3::new(at.x, at.y, solid.center.z + solid.half.z * sin)
            })
            .collect();
        self.polygon(&outline, color);
    }

    fn polygon(&mut self, outline: &[Point3<f64>], color: Color) {
        let pixels = outline.iter().filter_map(|point| self.camera.pixel_from_base(point));
        let mut points: Vec<[f32; 2]> = pixels.map(|p| [p.u as f32, p.v as f32]).collect();
        unwrap_columns(&mut points, self.camera.lens.width_px as f32);
        self.canvas.polygon(&points, color, self.instance);
        for [u, v] in points {
            self.extent = Some(self.extent.map_or([u, v, u, v], |old| {
                // The first part decides on which turn of the panorama the thing is told.
                let turn = ((f32::midpoint(old[0], old[2]) - u) / self.camera.lens.width_px as f32)
                    .round();
                let u = u + turn * self.camera.lens.width_px as f32;
                [old[0].min(u), old[1].min(v), old[2].max(u), old[3].max(v)]
            }));
        }
    }
}

/// A vector in the solid's own axes as a point of the base frame.
fn at_origin(own: Vector3<f64>, solid: &Solid) -> Point3<f64> {
    let flat = Solid { center: Point3::from(own), yaw_rad: 0.0, ..*solid };
    let turned = flat.placed(Vector2::zeros(), 0.0, solid.yaw_rad).center;
    solid.center + turned.coords
}

/// The outline with further corners along its edges.
fn edges(corners: &[Point3<f64>; 4]) -> Vec<Point3<f64>> {
    let mut outline = Vec::new();
    for (index, from) in corners.iter().enumerate() {
        let to = corners[(index + 1) % corners.len()];
        for step in 0..EDGE_CORNERS {
            outline.push(from + (to - from) * (f64::from(step) / f64::from(EDGE_CORNERS)));
        }
    }
    outline
}

/// Columns moved by whole turns so that neighbours stay neighbours across the seam.
fn unwrap_columns(points: &mut [[f32; 2]], width: f32) {
    for index in 1..points.len() {
        let turns = ((points[index - 1][0] - points[index][0]) / width).round();
        points[index][0] += turns * width;
    }
}
