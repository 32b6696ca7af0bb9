//! Draws scenes and cuts them into what the demo models are trained and measured on, as `.npy` files.
//!
//! ```text
//! cargo run --release -p jrdb-pipeline --example demo_data -- OUT [--seed N] [--scenes N] [--side PX] [--crop PX] [--jitter PART] [--turns N]
//! ```
//!
//! Every scene gives `turns` rounds of ten tiles, each round turned by a random angle, and a crop of everybody. Files:
//! `tiles` u8 `[T, side, side, 3]`; `boxes` f32 `[B, 7]` (tile, x0, y0, x1, y1 in parts of the tile, visible share, rows);
//! `crops` u8 `[C, crop, crop, 3]`; `labels` i64 `[C, 7]` (gender, age, race, action, facing as places in their vocabularies, visible
//! percent, rows).

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use jrdb_perception::resize::{Filter, resize};
use jrdb_pipeline::synth::{Seen, Setting, SynthConfig, View, generate};
use jrdb_types::{Image, PixelBox};

/// Tiles as the robust profile cuts them: as high as the panorama, this wide, this far apart.
const TILE_PX: usize = 640;
const STRIDE_PX: usize = 376;
const TILES: usize = 10;

/// People of whom less is seen are not cropped.
const VISIBLE_MIN: f64 = 0.35;
/// Crops of unjittered boxes are this much larger on each side, in parts of the box.
const MARGIN: f64 = 0.02;

fn main() -> Result<()> {
    let options = Options::parse(std::env::args().skip(1).collect())?;
    std::fs::create_dir_all(&options.out)?;
    let (mut tiles, mut boxes, mut crops, mut labels) = (vec![], vec![], vec![], vec![]);
    for index in 0..options.scenes {
        let mut random =
            Random(options.seed.wrapping_add(index).wrapping_mul(0x2545_f491_4f6c_dd1d));
        let view = generate(&scene(options.seed + index, &mut random)).view(0);
        for _ in 0..options.turns {
            let start_px = (random.unit() * STRIDE_PX as f64) as usize;
            for tile in 0..TILES {
                let x_px = start_px + tile * STRIDE_PX;
                let number = tiles.len() / (options.side * options.side * 3);
                cut_tile(&view, x_px, options.side, &mut tiles);
                boxes.extend(
                    view.people
                        .iter()
                        .filter_map(|seen| box_in_tile(&view, seen, x_px, number))
                        .flatten(),
                );
            }
        }
        for seen in &view.people {
            if let Some(label) = label(&view, seen) {
                let bbox = jittered(seen.bbox, options.jitter, &mut random);
                crops.extend(
                    resize(&crop(&view.image, bbox), options.crop, options.crop, Filter::Bicubic)
                        .rgb,
                );
                labels.extend(label);
            }
        }
    }
    let file = |name: &str| options.out.join(format!("{name}.npy"));
    let floats: Vec<u8> = boxes.iter().flat_map(|value: &f32| value.to_le_bytes()).collect();
    let integers: Vec<u8> = labels.iter().flat_map(|value: &i64| value.to_le_bytes()).collect();
    let (side, small) = (options.side, options.crop);
    write(&file("tiles"), "|u1", &[tiles.len() / (side * side * 3), side, side, 3], &tiles)?;
    write(&file("boxes"), "<f4", &[boxes.len() / 7, 7], &floats)?;
    write(&file("crops"), "|u1", &[crops.len() / (small * small * 3), small, small, 3], &crops)?;
    write(&file("labels"), "<i8", &[labels.len() / 7, 7], &integers)
}

/// A scene of any kind with 4 to 16 people.
fn scene(seed: u64, random: &mut Random) -> SynthConfig {
    let settings = [Setting::Plaza, Setting::Cafe, Setting::Corridor];
    let setting = settings[(random.unit() * 3.0) as usize];
    let people = 4 + (random.unit() * 13.0) as usize;
    SynthConfig { seed, people, setting, ..SynthConfig::default() }
}

fn cut_tile(view: &View, x_px: usize, side: usize, tiles: &mut Vec<u8>) {
    let whole = PixelBox { x: x_px as f64, y: 0.0, w: TILE_PX as f64, h: view.image.height as f64 };
    tiles.extend(resize(&crop(&view.image, whole), side, side, Filter::Bicubic).rgb);
}

/// The part of somebody's box in a tile, if any of their pixels are there.
fn box_in_tile(view: &View, seen: &Seen, x_px: usize, tile: usize) -> Option<[f32; 7]> {
    let (width, height) = (view.image.width, view.image.height);
    let shown = (0..height)
        .flat_map(|y| (0..TILE_PX).map(move |x| (x, y)))
        .filter(|(x, y)| view.instances[y * width + (x_px + x) % width] == seen.instance)
        .count();
    let start = (seen.bbox.x - x_px as f64).rem_euclid(width as f64);
    let start = if start >= TILE_PX as f64 { start - width as f64 } else { start };
    let (left, right) = (start.max(0.0), (start + seen.bbox.w).min(TILE_PX as f64));
    if shown == 0 || right <= left {
        return None;
    }
    let (across, up) = (TILE_PX as f64, height as f64);
    let (top, bottom) = (seen.bbox.y, seen.bbox.y + seen.bbox.h);
    let visible = shown as f64 / seen.pixels.max(1) as f64;
    let row =
        [tile as f64, left / across, top / up, right / across, bottom / up, visible, bottom - top];
    Some(row.map(|value| value as f32))
}

fn label(view: &View, seen: &Seen) -> Option<[i64; 7]> {
    let shown = view.instances.iter().filter(|instance| **instance == seen.instance).count();
    let visible = shown as f64 / seen.pixels.max(1) as f64;
    let of = &seen.attributes;
    (visible >= VISIBLE_MIN).then_some([
        of.gender.best()? as i64,
        of.age.best()? as i64,
        of.race.best()? as i64,
        of.action.best()? as i64,
        of.facing.best()? as i64,
        (100.0 * visible) as i64,
        seen.bbox.h as i64,
    ])
}

/// The box with its sides moved at random, by up to `part` of its size beyond or inside [`MARGIN`].
fn jittered(bbox: PixelBox, part: f64, random: &mut Random) -> PixelBox {
    let mut side = |size: f64| size * (MARGIN + part * (2.0 * random.unit() - 1.0));
    let (left, right, top, bottom) = (side(bbox.w), side(bbox.w), side(bbox.h), side(bbox.h));
    PixelBox {
        x: bbox.x - left,
        y: bbox.y - top,
        w: bbox.w + left + right,
        h: bbox.h + top + bottom,
    }
}

/// The whole pixels of a box, across the seam, inside the image's rows.
fn crop(image: &Image, bbox: PixelBox) -> Image {
    let (top, bottom) =
        (bbox.y.floor().max(0.0), (bbox.y + bbox.h).ceil().min(image.height as f64));
    let (left, right) = (bbox.x.floor() as i64, (bbox.x + bbox.w).ceil() as i64);
    let column = |x: i64| x.rem_euclid(image.width as i64) as usize;
    let rows = top as usize..bottom as usize;
    let rgb = rows
        .clone()
        .flat_map(|y| (left..right).flat_map(move |x| image.pixel(column(x), y)))
        .collect();
    Image { width: (right - left) as usize, height: rows.len(), rgb }
}

/// Writes an array in NumPy's format, version 1.0.
fn write(path: &Path, kind: &str, shape: &[usize], data: &[u8]) -> Result<()> {
    let axes: String = shape.iter().map(|axis| format!("{axis}, ")).collect();
    let mut header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({axes}), }}");
    header.push_str(&" ".repeat((118_usize).wrapping_sub(header.len() + 1) % 64));
    header.push('\n');
    let mut file = std::fs::File::create(path).with_context(|| path.display().to_string())?;
    file.write_all(b"\x93NUMPY\x01\x00")?;
    file.write_all(&u16::try_from(header.len())?.to_le_bytes())?;
    file.write_all(header.as_bytes())?;
    Ok(file.write_all(data)?)
}

struct Options {
    out: PathBuf,
    seed: u64,
    scenes: u64,
    side: usize,
    crop: usize,
    jitter: f64,
    turns: usize,
}

impl Options {
    fn parse(arguments: Vec<String>) -> Result<Self> {
        let Some((out, flags)) = arguments.split_first() else { bail!("expected a folder") };
        let mut options = Self {
            out: out.into(),
            seed: 0,
            scenes: 10,
            side: 160,
            crop: 112,
            jitter: 0.0,
            turns: 1,
        };
        for flag in flags.chunks(2) {
            match flag {
                [name, value] if name == "--seed" => options.seed = value.parse()?,
                [name, value] if name == "--scenes" => options.scenes = value.parse()?,
                [name, value] if name == "--side" => options.side = value.parse()?,
                [name, value] if name == "--crop" => options.crop = value.parse()?,
                [name, value] if name == "--jitter" => options.jitter = value.parse()?,
                [name, value] if name == "--turns" => options.turns = value.parse()?,
                other => bail!(
                    "expected --seed, --scenes, --side, --crop, --jitter or --turns and a value, found {other:?}"
                ),
            }
        }
        Ok(options)
    }
}

/// splitmix64.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}
