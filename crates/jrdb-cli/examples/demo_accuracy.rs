//! How well the demo's models see drawings that they were never trained on.
//!
//! ```text
//! cargo run --release -p jrdb --example demo_accuracy -- [--models DIR] [--seed N] [--scenes N] [--engine rten|ort]
//! ```
//!
//! Ten tiles of every scene, then the whole panoramas and the attributes of everybody who was found, then phrases about the people of
//! the same scenes with dealt looks. The models were trained on seeds below 2,800.
#![allow(clippy::print_stdout, reason = "a program prints its table")]

use std::path::PathBuf;

use anyhow::{Result, bail};
use jrdb_cli::evaluation::{described_table, found_table, on_panoramas, on_tiles};
use jrdb_cli::phrase_accuracy::{on_phrases, phrase_table, summed_up};
use jrdb_models::PerceptionOptions;
use jrdb_models::backbone::Backbone;
use jrdb_models::loader::{EngineChoice, EngineOptions};
use jrdb_synth::{Practice, practice, practice_with_looks};
use rayon::prelude::*;

fn main() -> Result<()> {
    let options = Options::parse(&std::env::args().skip(1).collect::<Vec<_>>())?;
    let backbone = Backbone::named("demo", &options.models)?;
    let engine = options.engine.clone();
    let opening = PerceptionOptions { engine, ..PerceptionOptions::default() };
    let whole = backbone.open("demo", &opening)?;
    let single = backbone.one_tile().open("demo", &opening)?;
    whole.notes.iter().for_each(|note| println!("{note}"));
    let seeds = options.seed..options.seed + options.scenes;
    println!("drawn scenes of seeds {} to {}\n", seeds.start, seeds.end - 1);
    let scenes: Vec<Practice> = seeds.into_par_iter().map(practice).collect();
    let started = std::time::Instant::now();
    let tiles = on_tiles(&scenes, &single.models)?;
    let per_tile = started.elapsed().as_secs_f64() * 1e3 / (10 * scenes.len()) as f64;
    println!("{}", found_table(&format!("{} tiles", 10 * scenes.len()), &tiles));
    let (panoramas, described) = on_panoramas(&scenes, &whole.models)?;
    println!("{}", found_table(&format!("{} panoramas", scenes.len()), &panoramas));
    println!("{}", described_table(&described));
    let seeds = options.seed..options.seed + options.scenes;
    let looking: Vec<Practice> = seeds.into_par_iter().map(practice_with_looks).collect();
    println!("{}", phrase_table(&summed_up(&on_phrases(&looking, &whole.models)?)));
    println!("{per_tile:.0} ms per tile, {} at once", rayon::current_num_threads());
    Ok(())
}

struct Options {
    models: PathBuf,
    seed: u64,
    scenes: u64,
    engine: EngineOptions,
}

impl Options {
    fn parse(arguments: &[String]) -> Result<Self> {
        let (models, engine) = (PathBuf::from("models"), EngineOptions::default());
        let mut options = Self { models, seed: 5_000_000, scenes: 60, engine };
        for flag in arguments.chunks(2) {
            match flag {
                [name, value] if name == "--models" => options.models = value.into(),
                [name, value] if name == "--seed" => options.seed = value.parse()?,
                [name, value] if name == "--scenes" => options.scenes = value.parse()?,
                [name, value] if name == "--engine" => {
                    options.engine.choice = match value.as_str() {
                        "rten" => EngineChoice::Rten,
                        "ort" => EngineChoice::Ort,
                        other => bail!("expected rten or ort after --engine, found {other:?}"),
                    };
                }
                other => bail!(
                    "expected --models, --seed, --scenes or --engine and a value, found {other:?}"
                ),
            }
        }
        options.engine.models.clone_from(&options.models);
        Ok(options)
    }
}
