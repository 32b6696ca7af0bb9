//! The walled room, and how light its surfaces are.

use serde::{Deserialize, Serialize};

use super::random::Random;

/// Height of the floor over the base frame's origin, metres (measured on real JRDB clouds: -0.88 to
/// -0.96).
pub(super) const FLOOR_M: f64 = -0.92;

/// A colour: red, green, blue, 0 to 255.
pub(super) type Color = [u8; 3];

/// What kind of place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Setting {
    /// A paved court of 24 m by 16 m under the sky; people stand, walk and sit at small tables.
    #[default]
    Plaza,
    /// A room of 14 m by 11 m with tables; most people sit.
    Cafe,
    /// A passage of 30 m by 5 m with doors; most people walk along it.
    Corridor,
}

/// Something flat on a wall: a door, a window, a board.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Panel {
    /// From where to where along the wall, metres from its left end as seen from inside.
    pub(super) along_m: [f64; 2],
    /// From where to where over the floor, metres.
    pub(super) height_m: [f64; 2],
    pub(super) color: Color,
    /// Colour of the 6 cm at its edge.
    pub(super) frame: Color,
}

/// Where a horizontal line of sight meets a wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct WallHit {
    pub(super) range_m: f64,
    /// Front, left, back, right: 0 to 3.
    pub(super) wall: usize,
    /// Metres from the wall's left end as seen from inside.
    pub(super) along_m: f64,
}

/// A rectangular room around the robot, without furniture.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Room {
    /// Back and front wall, metres in the base frame.
    pub(super) x_m: [f64; 2],
    /// Right and left wall, metres in the base frame.
    pub(super) y_m: [f64; 2],
    /// Height of the walls over the floor, metres.
    pub(super) wall_m: f64,
    pub(super) paint: Paint,
    /// Front, left, back, right.
    pub(super) panels: [Vec<Panel>; 4],
}

/// The room's colours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Paint {
    pub(super) tiles: [Color; 2],
    pub(super) tile_m: f64,
    pub(super) wall: Color,
    /// The lowest part of the wall, and how high it goes, metres.
    pub(super) plinth: (Color, f64),
    pub(super) above: Above,
}

/// What is over the walls.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Above {
    Sky,
    /// A ceiling with lamps this many decimetres apart.
    Ceiling {
        color: Color,
        lamp: Color,
        lamps_dm: u32,
    },
}

const DOOR: Color = [112, 74, 48];
const DOOR_FRAME: Color = [72, 48, 34];
const GLASS: Color = [176, 208, 226];
const GLASS_FRAME: Color = [236, 236, 232];
const BOARDS: [Color; 4] = [[196, 92, 70], [58, 110, 140], [222, 186, 92], [92, 136, 96]];
const BOARD_FRAME: Color = [60, 56, 52];

impl Room {
    /// The room of a setting; doors, windows and boards come at random.
    pub(super) fn new(setting: Setting, random: &mut Random) -> Self {
        let (x_m, y_m, wall_m, paint) = match setting {
            Setting::Plaza => ([-10.5, 13.5], [-8.5, 7.5], 3.4, PLAZA),
            Setting::Cafe => ([-5.0, 9.0], [-5.8, 5.2], 2.9, CAFE),
            Setting::Corridor => ([-13.0, 17.0], [-2.7, 2.3], 2.8, CORRIDOR),
        };
        let mut room = Self { x_m, y_m, wall_m, paint, panels: Default::default() };
        for wall in 0..room.panels.len() {
            room.panels[wall] = panels(setting, room.wall_length_m(wall), random);
        }
        room
    }

    fn wall_length_m(&self, wall: usize) -> f64 {
        let [from, to] = if wall.is_multiple_of(2) { self.y_m } else { self.x_m };
        to - from
    }

    /// Where the line of sight at this azimuth from the base frame's z axis meets a wall.
    pub(super) fn wall_at(&self, azimuth_rad: f64) -> WallHit {
        let (sin, cos) = azimuth_rad.sin_cos();
        let range_to = |wall_m: f64, slope: f64| {
            let range_m = wall_m / slope;
            if range_m > 0.0 { range_m } else { f64::INFINITY }
        };
        let ranges = [
            range_to(self.x_m[1], cos),
            range_to(self.y_m[1], sin),
            range_to(self.x_m[0], cos),
            range_to(self.y_m[0], sin),
        ];
        let wall =
            (0..4).fold(0, |best, wall| if ranges[wall] < ranges[best] { wall } else { best });
        let range_m = ranges[wall];
        let (x, y) = (range_m * cos, range_m * sin);
        let along_m = match wall {
            0 => self.y_m[1] - y,
            1 => x - self.x_m[0],
            2 => y - self.y_m[0],
            _ => self.x_m[1] - x,
        };
        WallHit { range_m, wall, along_m }
    }

    /// Whether a point is at least `margin_m` inside the walls.
    pub(super) fn holds(&self, [x, y]: [f64; 2], margin_m: f64) -> bool {
        let inside =
            |value: f64, [low, high]: [f64; 2]| (low + margin_m..=high - margin_m).contains(&value);
        inside(x, self.x_m) && inside(y, self.y_m)
    }
}

const PLAZA: Paint = Paint {
    tiles: [[186, 178, 164], [176, 168, 154]],
    tile_m: 1.0,
    wall: [206, 184, 152],
    plinth: ([142, 126, 110], 0.5),
    above: Above::Sky,
};

const CAFE: Paint = Paint {
    tiles: [[168, 132, 96], [158, 122, 88]],
    tile_m: 0.8,
    wall: [226, 214, 190],
    plinth: ([120, 88, 66], 0.95),
    above: Above::Ceiling { color: [238, 234, 226], lamp: [255, 236, 170], lamps_dm: 30 },
};

const CORRIDOR: Paint = Paint {
    tiles: [[150, 156, 160], [140, 146, 150]],
    tile_m: 0.6,
    wall: [214, 218, 212],
    plinth: ([104, 124, 132], 0.25),
    above: Above::Ceiling { color: [232, 234, 236], lamp: [255, 255, 246], lamps_dm: 36 },
};

/// Doors, windows and boards, one every few metres.
fn panels(setting: Setting, length_m: f64, random: &mut Random) -> Vec<Panel> {
    let step_m = match setting {
        Setting::Plaza => 3.2,
        Setting::Cafe => 2.8,
        Setting::Corridor => 3.0,
    };
    let count = (length_m / step_m) as usize;
    (0..count)
        .map(|index| {
            let middle_m = (index as f64 + 0.5) * length_m / count as f64;
            panel(setting, middle_m + random.about_zero(0.3), random)
        })
        .collect()
}

fn panel(setting: Setting, middle_m: f64, random: &mut Random) -> Panel {
    let door = match setting {
        Setting::Plaza => 0.25,
        Setting::Cafe => 0.15,
        Setting::Corridor => 0.5,
    };
    let (width_m, height_m, color, frame) = if random.chance(door) {
        (1.0, [0.0, 2.1], DOOR, DOOR_FRAME)
    } else if random.chance(if setting == Setting::Corridor { 0.2 } else { 0.7 }) {
        (1.5, [1.0, 2.3], GLASS, GLASS_FRAME)
    } else {
        (random.within([0.8, 1.3]), [1.2, 2.0], random.pick(&BOARDS), BOARD_FRAME)
    };
    Panel { along_m: [middle_m - width_m / 2.0, middle_m + width_m / 2.0], height_m, color, frame }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_are_where_they_should_be() {
        let room = Room::new(Setting::Plaza, &mut Random::stream(0, 0));
        let at = |degrees: f64| {
            let hit = room.wall_at(degrees.to_radians());
            (hit.wall, hit.range_m)
        };
        assert_eq!(at(0.0), (0, 13.5));
        assert_eq!((at(90.0).0, at(180.0).0, at(-90.0).0), (1, 2, 3));
        assert!((at(-90.0).1 - 8.5).abs() < 1e-9);
    }

    #[test]
    fn along_a_wall_means_to_the_right_of_who_looks_at_it() {
        let room = Room::new(Setting::Cafe, &mut Random::stream(0, 0));
        for middle in [0.0_f64, 90.0, 180.0, -90.0] {
            let left = room.wall_at((middle + 5.0).to_radians());
            let right = room.wall_at((middle - 5.0).to_radians());
            assert!(left.wall == right.wall && left.along_m < right.along_m, "{middle}");
        }
    }
}
