//! The empty room as the panorama shows it: one ray per pixel.

use std::f64::consts::TAU;

use jrdb_types::Image;

use crate::robot::Panorama;
use crate::room::{Above, Color, FLOOR_M, Panel, Room, WallHit};

/// Width of the joints between tiles, of a panel's frame and of the strip between wall and plinth,
/// metres.
const JOINT_M: f64 = 0.025;
const FRAME_M: f64 = 0.06;
/// Beyond this range a joint is thinner than a pixel and left out, metres.
const JOINT_RANGE_M: f64 = 4.5;
/// A lamp in the ceiling: half its length and half its width, metres.
const LAMP_M: [f64; 2] = [0.6, 0.15];

const SKY: [Color; 3] = [[214, 230, 240], [190, 216, 236], [164, 200, 230]];

/// The picture of a room without anything in it, four rays per pixel.
pub(super) fn background(room: &Room, camera: &Panorama) -> Image {
    let (width, height) = (camera.lens.width_px as usize, camera.lens.height_px as usize);
    let mut image = Image::filled(width, height, [0; 3]);
    for column in 0..width {
        let rays = [0.25, 0.75].map(|part| {
            let azimuth_rad = TAU * (0.5 - (column as f64 + part) / width as f64);
            (room.wall_at(azimuth_rad), azimuth_rad.sin_cos())
        });
        for row in 0..height {
            let mut sum = [0_u16; 3];
            for part in [0.25, 0.75] {
                let slope = (camera.lens.horizon_px - (row as f64 + part)) / camera.lens.focal_px;
                for (hit, direction) in &rays {
                    let color = seen(room, hit, *direction, slope);
                    sum.iter_mut().zip(color).for_each(|(sum, value)| *sum += u16::from(value));
                }
            }
            let at = 3 * (row * width + column);
            image.rgb[at..at + 3].copy_from_slice(&sum.map(|sum| (sum / 4) as u8));
        }
    }
    image
}

fn seen(room: &Room, hit: &WallHit, (sin, cos): (f64, f64), slope: f64) -> Color {
    let up_m = hit.range_m * slope - FLOOR_M;
    if up_m < 0.0 {
        let range_m = FLOOR_M / slope;
        return floor(room, range_m, [range_m * cos, range_m * sin]);
    }
    if up_m <= room.wall_m {
        return wall(room, hit, up_m);
    }
    match room.paint.above {
        Above::Sky => SKY[((slope - 0.18) / 0.09).clamp(0.0, 2.0) as usize],
        Above::Ceiling { color, lamp, lamps_dm } => {
            let range_m = (FLOOR_M + room.wall_m) / slope;
            let spacing_m = f64::from(lamps_dm) / 10.0;
            let from_lamp = |metres: f64| (metres.rem_euclid(spacing_m) - spacing_m / 2.0).abs();
            let lit = from_lamp(range_m * cos) < LAMP_M[0] && from_lamp(range_m * sin) < LAMP_M[1];
            if lit { lamp } else { color }
        }
    }
}

fn floor(room: &Room, range_m: f64, [x, y]: [f64; 2]) -> Color {
    let tile_m = room.paint.tile_m;
    let joint = [x, y].iter().any(|value| value.rem_euclid(tile_m) < JOINT_M);
    if joint && range_m < JOINT_RANGE_M {
        return room.paint.tiles[1].map(|value| value - value / 8);
    }
    let odd = ((x / tile_m).floor() + (y / tile_m).floor()).rem_euclid(2.0) >= 1.0;
    room.paint.tiles[usize::from(odd)]
}

fn wall(room: &Room, hit: &WallHit, up_m: f64) -> Color {
    if let Some(color) = room.panels[hit.wall].iter().find_map(|p| on_panel(p, hit.along_m, up_m)) {
        return color;
    }
    let (plinth, plinth_m) = room.paint.plinth;
    // The side walls lie in shadow, so that the corners of the room show.
    let light = if hit.wall.is_multiple_of(2) { 0 } else { 14 };
    let base = if up_m < plinth_m { plinth } else { room.paint.wall };
    let edge = (up_m - plinth_m).abs() < FRAME_M / 2.0 || room.wall_m - up_m < FRAME_M;
    base.map(|value| value.saturating_sub(light + if edge { 30 } else { 0 }))
}

fn on_panel(panel: &Panel, along_m: f64, up_m: f64) -> Option<Color> {
    let inside = |margin: f64| {
        let [left, right] = panel.along_m;
        let [low, high] = panel.height_m;
        (left - margin..right + margin).contains(&along_m)
            && (low - margin..high + margin).contains(&up_m)
    };
    let color = if inside(0.0) { panel.color } else { panel.frame };
    inside(FRAME_M).then_some(color)
}
