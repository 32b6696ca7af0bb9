//! Draws scenes and cuts them into what the demo models are trained and measured on, as `.npy` files.
//!
//! ```text
//! cargo run --release -p jrdb --example demo_data -- OUT [--seed N] [--scenes N] [--side PX] [--crop PX] [--jitter PART] [--turns N] [--looks dealt|natural]
//! ```
//!
//! Every scene gives `turns` rounds of ten tiles, each round turned by a random angle, and a crop of everybody. Files:
//! `tiles` u8 `[T, side, side, 3]`; `boxes` f32 `[B, 7]` (tile, x0, y0, x1, y1 in parts of the tile, visible share, rows);
//! `crops` u8 `[C, crop, crop, 3]`; `labels` i64 `[C, 7]` (gender, age, race, action, facing as places in their vocabularies, visible
//! percent, rows); `looks` i64 `[C, F]` (for each of `Feature::ALL` 1, 0, or -1 where the crop cannot show it). With `--looks dealt` the
//! people of the scenes look in many more ways, and nothing is said of the gender of men with long hair.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use jrdb_perception::image::{Filter, resize};
use jrdb_synth::{Feature, InTile, Seen, TILE_PX, View, practice, practice_with_looks};
use jrdb_types::Gender;
use jrdb_types::PixelBox;

fn main() -> Result<()> {
    let options = Options::parse(&std::env::args().skip(1).collect::<Vec<_>>())?;
    let (side, small) = (options.side, options.crop);
    std::fs::create_dir_all(&options.out)?;
    let (mut tiles, mut boxes, mut crops, mut labels) = (vec![], vec![], vec![], vec![]);
    let mut looks = vec![];
    let draw = if options.dealt { practice_with_looks } else { practice };
    for index in 0..options.scenes {
        let mut scene = draw(options.seed + index);
        let starts: Vec<usize> = (0..options.turns).flat_map(|_| scene.tiles()).collect();
        for x_px in starts {
            let number = tiles.len() / (side * side * 3);
            tiles.extend(resize(&scene.tile(x_px), side, side, Filter::Bicubic).rgb);
            let people = scene.view.in_tile(x_px, TILE_PX);
            boxes.extend(people.iter().flat_map(|one| row(one, number, scene.view.image.height)));
        }
        for (person, picture) in scene.crops(options.jitter) {
            crops.extend(resize(&picture, small, small, Filter::Bicubic).rgb);
            labels.extend(label(&scene.view, person));
            looks.extend(Feature::ALL.map(|feature| look(&scene.view.people[person], feature)));
        }
    }
    let file = |name: &str| options.out.join(format!("{name}.npy"));
    let floats: Vec<u8> = boxes.iter().flat_map(|value: &f32| value.to_le_bytes()).collect();
    let bytes =
        |values: &[i64]| values.iter().flat_map(|one| one.to_le_bytes()).collect::<Vec<u8>>();
    write(&file("tiles"), "|u1", &[tiles.len() / (side * side * 3), side, side, 3], &tiles)?;
    write(&file("boxes"), "<f4", &[boxes.len() / 7, 7], &floats)?;
    write(&file("crops"), "|u1", &[crops.len() / (small * small * 3), small, small, 3], &crops)?;
    write(&file("labels"), "<i8", &[labels.len() / 7, 7], &bytes(&labels))?;
    let shape = [looks.len() / Feature::ALL.len(), Feature::ALL.len()];
    write(&file("looks"), "<i8", &shape, &bytes(&looks))
}

fn row(one: &InTile, tile: usize, height_px: usize) -> [f32; 7] {
    let (across, up) = (TILE_PX as f64, height_px as f64);
    let PixelBox { x, y, w, h } = one.bbox;
    [tile as f64, x / across, y / up, (x + w) / across, (y + h) / up, one.visible, h]
        .map(|value| value as f32)
}

/// Places of somebody's attributes in their vocabularies, the visible share in percent, and the rows; -1 for what is not known.
fn label(view: &View, person: usize) -> [i64; 7] {
    let seen = &view.people[person];
    let of = &seen.attributes;
    // Of a man with long hair the drawing does not tell the gender.
    let gender = of.gender().best();
    let gender =
        gender.filter(|g| *g == Gender::Female || !seen.features.contains(&Feature::LongHair));
    [
        gender.map_or(-1, |value| value as i64),
        of.age().best().map_or(-1, |value| value as i64),
        of.race().best().map_or(-1, |value| value as i64),
        of.action().best().map_or(-1, |value| value as i64),
        of.facing.best().map_or(-1, |value| value as i64),
        (100.0 * view.visible(seen)) as i64,
        seen.bbox.h as i64,
    ]
}

/// 1 where somebody looks so, 0 where not, -1 where the picture cannot show it.
fn look(seen: &Seen, feature: Feature) -> i64 {
    if seen.shows(feature) { i64::from(seen.features.contains(&feature)) } else { -1 }
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
    dealt: bool,
}

impl Options {
    fn parse(arguments: &[String]) -> Result<Self> {
        let Some((out, flags)) = arguments.split_first() else { bail!("expected a folder") };
        let mut options = Self {
            out: out.into(),
            seed: 0,
            scenes: 10,
            side: 160,
            crop: 112,
            jitter: 0.0,
            turns: 1,
            dealt: false,
        };
        for flag in flags.chunks(2) {
            match flag {
                [name, value] if name == "--seed" => options.seed = value.parse()?,
                [name, value] if name == "--scenes" => options.scenes = value.parse()?,
                [name, value] if name == "--side" => options.side = value.parse()?,
                [name, value] if name == "--crop" => options.crop = value.parse()?,
                [name, value] if name == "--jitter" => options.jitter = value.parse()?,
                [name, value] if name == "--turns" => options.turns = value.parse()?,
                [name, value] if name == "--looks" => options.dealt = value == "dealt",
                other => bail!(
                    "expected --seed, --scenes, --side, --crop, --jitter, --turns or --looks and a value, found {other:?}"
                ),
            }
        }
        Ok(options)
    }
}
