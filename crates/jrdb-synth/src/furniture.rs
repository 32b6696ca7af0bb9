//! Tables, chairs, bins and plants: solids with colours, drawn and scanned alike.

use jrdb_projection::nalgebra::{Point3, Vector2, Vector3};
use jrdb_types::{Box3d, EntityId};

use super::room::{Color, FLOOR_M};
use super::solid::{Shape, Solid};

/// A part of one colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Part {
    pub(super) solid: Solid,
    pub(super) color: Color,
}

/// A labelled thing that stands in the room.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Furniture {
    pub(super) id: EntityId,
    pub(super) place_m: Vector2<f64>,
    pub(super) yaw_rad: f64,
    /// In its own frame, x ahead, y left, z up from the floor.
    parts: Vec<Part>,
}

/// What kind of thing; its word is the class of the label.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// A table so deep and so wide, metres.
    Table([f64; 2]),
    Bin,
    Plant,
}

const WOOD: Color = [146, 98, 60];
const DARK_WOOD: Color = [96, 64, 42];
const STEEL: Color = [84, 88, 96];
const BIN: Color = [58, 92, 74];
const POT: Color = [168, 92, 62];
const LEAVES: [Color; 2] = [[62, 126, 66], [82, 150, 78]];

const TABLE_M: f64 = 0.74;

impl Kind {
    /// Class of the label.
    pub(super) const fn class(self) -> &'static str {
        match self {
            Self::Table(_) => "table",
            Self::Bin => "bin",
            Self::Plant => "plant",
        }
    }

    /// Half its longer side, metres.
    pub(super) fn radius_m(self) -> f64 {
        match self {
            Self::Table([deep, wide]) => f64::max(deep, wide) / 2.0,
            Self::Bin => 0.25,
            Self::Plant => 0.4,
        }
    }

    fn parts(self) -> Vec<Part> {
        match self {
            Self::Table([deep, wide]) => table(deep / 2.0, wide / 2.0),
            Self::Bin => vec![
                part(Shape::Cylinder, [0.0; 3], [0.2, 0.2, 0.72], BIN),
                part(Shape::Cylinder, [0.0, 0.0, 0.72], [0.22, 0.22, 0.08], STEEL),
            ],
            Self::Plant => vec![
                part(Shape::Cylinder, [0.0; 3], [0.2, 0.2, 0.4], POT),
                part(Shape::Ellipsoid, [0.0, 0.0, 0.35], [0.36, 0.36, 0.75], LEAVES[0]),
                part(Shape::Ellipsoid, [0.0, 0.0, 0.75], [0.26, 0.26, 0.6], LEAVES[1]),
            ],
        }
    }
}

fn table(deep: f64, wide: f64) -> Vec<Part> {
    let mut parts = Vec::new();
    for x in [-1.0, 1.0] {
        for y in [-1.0, 1.0] {
            let at = [x * (deep - 0.05), y * (wide - 0.05), 0.0];
            parts.push(part(Shape::Block, at, [0.025, 0.025, TABLE_M - 0.04], DARK_WOOD));
        }
    }
    parts.push(part(Shape::Block, [0.0, 0.0, TABLE_M - 0.04], [deep, wide, 0.04], WOOD));
    parts
}

/// A part with its middle at `x`, `y`, its bottom at `z`, half sizes aside and its whole height.
fn part(shape: Shape, [x, y, z]: [f64; 3], [along, aside, tall]: [f64; 3], color: Color) -> Part {
    let half = Vector3::new(along, aside, tall / 2.0);
    let center = Point3::new(x, y, z + tall / 2.0);
    Part { solid: Solid { shape, center, half, yaw_rad: 0.0 }, color }
}

/// A chair that fits someone of this height who sits with the hip so high over its origin: seat and
/// legs, and the back for itself because it may hide the sitter.
pub(super) fn chair(height_m: f64, hip_m: f64) -> [Vec<Part>; 2] {
    let seat_m = hip_m - 0.055 * height_m;
    let half_m = 0.115 * height_m;
    let back_m = -0.125 * height_m;
    let mut seat = Vec::new();
    for x in [back_m, 0.1 * height_m] {
        for y in [-half_m, half_m] {
            seat.push(part(Shape::Block, [x, y, 0.0], [0.018, 0.018, seat_m], STEEL));
        }
    }
    let middle = (back_m + 0.1 * height_m) / 2.0;
    seat.push(part(Shape::Block, [middle, 0.0, seat_m], [half_m, half_m, 0.03], WOOD));
    let mut back = Vec::new();
    for y in [-half_m, half_m] {
        back.push(part(Shape::Block, [back_m, y, seat_m], [0.018, 0.018, 0.27 * height_m], STEEL));
    }
    let rail_m = seat_m + 0.17 * height_m;
    back.push(part(Shape::Block, [back_m, 0.0, rail_m], [0.015, half_m, 0.1 * height_m], WOOD));
    [seat, back]
}

/// Parts moved to a place in the room.
pub(super) fn placed(parts: &[Part], place_m: Vector2<f64>, yaw_rad: f64) -> Vec<Part> {
    let moved = |part: &Part| part.solid.placed(place_m, FLOOR_M, yaw_rad);
    parts.iter().map(|part| Part { solid: moved(part), ..*part }).collect()
}

impl Furniture {
    pub(super) fn new(kind: Kind, number: u32, place_m: Vector2<f64>, yaw_rad: f64) -> Self {
        let id = EntityId::new(kind.class(), number);
        Self { id, place_m, yaw_rad, parts: kind.parts() }
    }

    /// Its parts in the base frame.
    pub(super) fn placed(&self) -> Vec<Part> {
        placed(&self.parts, self.place_m, self.yaw_rad)
    }

    /// The label in space.
    pub(super) fn box3d(&self) -> Box3d {
        let corner =
            |part: &Part, axis: usize| part.solid.center[axis].abs() + part.solid.half[axis];
        let reach = |axis: usize| self.parts.iter().map(|p| corner(p, axis)).fold(0.0, f64::max);
        let tall_m = reach(2);
        Box3d {
            center: [self.place_m.x, self.place_m.y, FLOOR_M + tall_m / 2.0],
            size: [2.0 * reach(0), 2.0 * reach(1), tall_m],
            heading_rad: self.yaw_rad,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_label_of_a_table_is_as_large_as_the_table() {
        let table = Furniture::new(Kind::Table([0.6, 1.3]), 1, Vector2::new(3.0, 1.0), 0.5);
        let label = table.box3d();
        for (found, wanted) in label.size.iter().zip([0.6, 1.3, TABLE_M]) {
            assert!((found - wanted).abs() < 1e-9, "{label:?}");
        }
        assert_eq!(table.id.to_string(), "table:1");
        assert!((label.center[2] - label.size[2] / 2.0 - FLOOR_M).abs() < 1e-9);
    }

    #[test]
    fn nothing_reaches_below_the_floor() {
        let [seat, back] = chair(1.7, 0.45);
        let parts = [Kind::Bin, Kind::Plant, Kind::Table([0.6, 0.6])].map(Kind::parts).concat();
        for part in seat.iter().chain(&back).chain(&parts) {
            assert!(part.solid.center.z - part.solid.half.z >= -1e-9, "{part:?}");
        }
    }
}
