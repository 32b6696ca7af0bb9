//! What our decode loops take beside the engine's own run time, token by token.
//!
//! ```text
//! cargo run --release -p jrdb --example decode_overhead -- [FOLDER]
//! ```
//!
//! `FOLDER` holds a Florence-2 as exported (default: the demo's). Single thread, every engine found.
#![allow(clippy::print_stdout, reason = "a program prints its table")]

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::Result;
use jrdb_models::backbone::{Graphs, florence2};
use jrdb_models::loader::{EngineChoice, EngineOptions, Loader};
use jrdb_models::profile::Profile;
use jrdb_perception::florence2::{Florence2, Task};
use jrdb_synth::practice;

/// Rounds over the tiles of a scene; the fastest counts, as the machine may be busy with other things.
const ROUNDS: usize = 7;

fn main() -> Result<()> {
    let folder =
        std::env::args().nth(1).map_or_else(|| "models/demo/florence2".into(), PathBuf::from);
    println!(
        "{:<14} {:>8} {:>14} {:>14} {:>10}",
        "engine", "tokens", "engine, us", "ours, us", "overhead"
    );
    let graphs = Graphs { folder: folder.clone(), variant: String::new() };
    for choice in [EngineChoice::Rten, EngineChoice::Ort] {
        let profile = Profile::default();
        let models = folder.clone();
        let options = EngineOptions {
            choice,
            profile: Some(profile.clone()),
            models,
            ..EngineOptions::default()
        };
        match Loader::new(&options) {
            Ok(loader) => measure(&florence2(&graphs, Path::new(""), &loader)?, &profile)?,
            Err(error) => println!("{choice:?}: {error}"),
        }
    }
    Ok(())
}

fn measure(model: &Florence2, profile: &Profile) -> Result<()> {
    let mut scene = practice(5_000_000);
    let pictures: Vec<_> = scene.tiles().into_iter().map(|x_px| scene.tile(x_px)).collect();
    let seen = pictures
        .iter()
        .map(|picture| model.see(&model.config().picture.prepare(picture)))
        .collect::<Result<Vec<_>, _>>()?;
    let prompt = model.spell(&Task::ObjectDetection)?;
    let mut best: Option<(usize, f64, f64)> = None;
    for _ in 0..ROUNDS {
        let (before, started) = (engine_s(profile), Instant::now());
        let mut tokens = 0;
        for seen in &seen {
            let sequence = model.answer(seen, &prompt, &model.config().decode)?;
            tokens += sequence.log_probs.len();
        }
        let all = started.elapsed().as_secs_f64();
        let engine = engine_s(profile) - before;
        if best.is_none_or(|(_, least, _)| all < least) {
            best = Some((tokens, all, engine));
        }
    }
    if let Some((tokens, all, engine)) = best {
        let per_token = |seconds: f64| 1e6 * seconds / tokens as f64;
        let (name, ours) = (model.engine_name(), all - engine);
        let (engine_us, ours_us) = (per_token(engine), per_token(ours));
        println!(
            "{name:<14} {tokens:>8} {engine_us:>14.1} {ours_us:>14.1} {:>9.1}%",
            100.0 * ours / engine
        );
    }
    Ok(())
}

fn engine_s(profile: &Profile) -> f64 {
    profile.spent().values().map(|spent| spent.time.as_secs_f64()).sum()
}
