//! `jrdb synth`.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Result;
use clap::{Args, ValueEnum};
use jrdb_cli::Error;
use jrdb_synth::SynthConfig;

#[derive(Debug, Args)]
pub(crate) struct SynthArgs {
    /// The same seed gives the same bytes
    #[arg(long, default_value_t = 0, value_name = "N")]
    seed: u64,
    /// How many people
    #[arg(long, default_value_t = 8, value_name = "M", value_parser = clap::value_parser!(u16).range(1..=60))]
    people: u16,
    /// How many frames
    #[arg(long, default_value_t = 1, value_name = "K", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    frames: u32,
    /// What kind of place
    #[arg(long, value_enum, default_value_t)]
    setting: Setting,
    /// Name of the sequence
    #[arg(long, value_name = "NAME")]
    sequence: Option<String>,
    /// People look in more ways: striped shirts, glasses, beards, scarves, ties, … scene.json states them
    #[arg(long)]
    looks: bool,
    /// All of this from a scene.json instead
    #[arg(long, value_name = "FILE", conflicts_with_all = ["seed", "people", "frames", "setting", "sequence", "looks"])]
    config: Option<PathBuf>,
    /// Folder for the dataset
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

#[derive(Debug, Clone, Copy, Default, ValueEnum)]
enum Setting {
    /// A paved court under the sky
    #[default]
    Plaza,
    /// Tables with people who sit
    Cafe,
    /// Long and narrow, with people who walk
    Corridor,
}

impl SynthArgs {
    fn config(&self) -> Result<SynthConfig, Error> {
        let Some(path) = &self.config else {
            let plain = SynthConfig {
                seed: self.seed,
                people: self.people.into(),
                frames: self.frames,
                setting: match self.setting {
                    Setting::Plaza => jrdb_synth::Setting::Plaza,
                    Setting::Cafe => jrdb_synth::Setting::Cafe,
                    Setting::Corridor => jrdb_synth::Setting::Corridor,
                },
                sequence: self.sequence.clone().unwrap_or_else(|| self.default_sequence()),
                ..SynthConfig::default()
            };
            return Ok(if self.looks { jrdb_synth::with_looks(&plain) } else { plain });
        };
        let read = |source| Error::File { action: "read", path: path.clone(), source };
        let text = std::fs::read_to_string(path).map_err(read)?;
        let bad = |error| Error::Usage(format!("expected a scene.json in {path:?}: {error}"));
        serde_json::from_str(&text).map_err(bad)
    }
}

impl SynthArgs {
    /// Place, seed and, as in JRDB's names, the number of the recording: `plaza-7_0`.
    fn default_sequence(&self) -> String {
        let place = self.setting.to_possible_value();
        let place = place.as_ref().map_or("synth", |value| value.get_name());
        format!("{place}-{}_0", self.seed)
    }
}

pub(crate) fn synth(args: &SynthArgs) -> Result<ExitCode> {
    let config = args.config()?;
    jrdb_dataset::check_sequence_name(&config.sequence).map_err(Error::from)?;
    let world = jrdb_synth::generate(&config);
    jrdb_synth::write(&world, &args.out).map_err(Error::from)?;
    let out = args.out.display();
    let done = format!(
        "{} frames of {} are in {out}; next: jrdb run --scene {out}",
        config.frames, config.sequence
    );
    super::print::say(&format!("{done}\n"))?;
    Ok(ExitCode::SUCCESS)
}
