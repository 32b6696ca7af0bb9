//! `jrdb calib`: does the cloud fit the image?

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Result;
use clap::{Args, Subcommand};
use jrdb_calibration::{FitConfig, FitReport, LidarFit, Motion, Verdict, about, check_fit, refine};
use jrdb_cli::Error;
use jrdb_cli::calib::{
    BaseSweep, CalibFrame, GrossError, Mounts, Plant, base_sweeps, floor_lines, gross_errors,
    tilted_more, with_views,
};
use jrdb_cli::output::write;
use jrdb_cli::source::{FrameSource, RigChoice, RobotOptions, list_frames};
use jrdb_dataset::PngCompression;
use jrdb_draw::{Overlay, Strip, draw_overlay};
use jrdb_projection::nalgebra::Point3;
use jrdb_render::calibration as words;
use serde_json::json;

use super::args::SourceArgs;
use super::print::{Format, say};

/// Does the cloud fit the image, and if not, by how much
#[derive(Debug, Args)]
pub(crate) struct CalibArgs {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Yaw and height of each LiDAR against the image, and an overlay picture.
    ///
    /// An offset is the mount less the truth: +2° is a mount turned 2° too far counter-clockwise.
    /// Without --rig, JRDB's panorama is taken as the five views that it is, where the tree says them.
    /// Exit code: 0 consistent, 1 off or cannot tell, 2 bad input.
    #[command(verbatim_doc_comment)]
    Check(CheckArgs),
    /// Yaw, pitch, roll and height at which each LiDAR fits the image best, as far as the data tell
    Refine(CheckArgs),
}

#[derive(Debug, Args)]
struct CheckArgs {
    #[command(flatten)]
    source: SourceArgs,
    /// Turn the mounts by so much first: what would this error look like?
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, allow_negative_numbers = true)]
    plant_yaw_deg: f64,
    /// Raise the mounts by so much first
    #[arg(long, value_name = "METRES", default_value_t = 0.0, allow_negative_numbers = true)]
    plant_height_m: f64,
    /// Plant the error in this LiDAR only; may be given several times
    #[arg(long, value_name = "NAME")]
    plant_lidar: Vec<String>,
    /// Folder for report.json and a picture of every frame
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// json prints the report
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

pub(crate) fn calib(args: &CalibArgs) -> Result<ExitCode> {
    match &args.command {
        Command::Check(args) => check(&Job::read(args)?, args),
        Command::Refine(args) => refined(&Job::read(args)?, args),
    }
}

/// Frames, and their mounts with the planted error.
struct Job {
    frames: Vec<CalibFrame>,
    plant: Plant,
    mounts: Vec<Mounts>,
}

/// The frames, by the rig asked for. When none is, a panorama of JRDB's is taken as the views that it is made of,
/// where the tree says them: far things are drawn up to 7 rows elsewhere than by the official model.
fn frames(args: &SourceArgs) -> Result<Vec<FrameSource>> {
    let (sources, range) = (args.sources()?, args.frames.as_ref());
    if args.robot.rig.is_none() {
        let refined = RobotOptions { rig: RigChoice::JrdbRefined, ..args.robot() };
        if let Ok(frames) = list_frames(&sources, range, &refined) {
            eprintln!("note: the panorama is taken as five views (--rig jrdb-refined)");
            return Ok(frames);
        }
    }
    Ok(list_frames(&sources, range, &args.robot())?)
}

impl Job {
    fn read(args: &CheckArgs) -> Result<Self> {
        let sources = frames(&args.source)?;
        let frames: Vec<CalibFrame> =
            sources.iter().map(CalibFrame::read).collect::<Result<_, Error>>()?;
        for note in frames.iter().flat_map(|frame| &frame.notes) {
            eprintln!("note: {note}");
        }
        let plant = Plant {
            yaw_deg: args.plant_yaw_deg,
            height_m: args.plant_height_m,
            lidars: args.plant_lidar.clone(),
        };
        let mounts = frames.iter().map(|f| plant.apply(&f.mounts)).collect::<Result<_, Error>>()?;
        Ok(Self { frames, plant, mounts })
    }

    fn names(&self) -> Vec<&str> {
        self.frames.iter().map(|frame| frame.name.as_str()).collect()
    }

    fn check(&self, mounts: &[Mounts]) -> Result<FitReport, Error> {
        with_views(&self.frames, mounts, |views| check_fit(views, &FitConfig::default()))
    }

    /// What the check finds without the planted error; the difference is what it makes of the error.
    fn unplanted(&self) -> Result<Option<FitReport>, Error> {
        let mounts: Vec<Mounts> = self.frames.iter().map(|frame| frame.mounts.clone()).collect();
        (!self.plant.is_nothing()).then(|| self.check(&mounts)).transpose()
    }

    fn sweeps(&self, index: usize) -> Vec<BaseSweep> {
        base_sweeps(&self.frames[index].clouds, &self.mounts[index])
    }
}

fn check(job: &Job, args: &CheckArgs) -> Result<ExitCode> {
    let report = job.check(&job.mounts)?;
    let unplanted = job.unplanted()?;
    if report.verdict == Verdict::CannotTell {
        eprintln!(
            "note: not everything fits near the mounts; known errors are tried, which takes a while"
        );
    }
    let gross = gross_errors(&job.frames, &job.mounts, &report, &FitConfig::default())?;
    let words = gross.iter().map(gross_words).chain([words::verdict(&report)]);
    let words = words.collect::<Vec<_>>().join("; ");
    let floors: Vec<Vec<String>> =
        (0..job.frames.len()).map(|i| floor_lines(&job.sweeps(i))).collect();
    let value = json!({
        "frames": job.names(), "config": FitConfig::default(),
        "planted": job.plant, "floors": floors, "fit": report,
        "fit_without_planted_error": unplanted, "gross_errors": gross, "verdict": words,
    });
    let json = serde_json::to_string_pretty(&value)?;
    if let Some(out) = &args.out {
        write(&out.join("report.json"), json.as_bytes())?;
        let motion = |fit: &LidarFit| (fit.sensor.clone(), fit.correction());
        let is_off = report.verdict == Verdict::Off;
        let corrections: Vec<_> = report.lidars.iter().map(motion).collect();
        draw(job, out, &words, if is_off { &corrections } else { &[] })?;
    }
    match args.format {
        Format::Json => say(&(json + "\n"))?,
        Format::Text => {
            let mut text: String = floors.concat().into_iter().map(|line| line + "\n").collect();
            text += &words::fit(&report);
            if let Some(unplanted) = &unplanted {
                text += &recovered(&job.plant, &report, unplanted);
            }
            say(&format!("{text}verdict: {words}\n"))?;
        }
    }
    let code = if report.verdict == Verdict::Consistent { 0 } else { 1 };
    Ok(ExitCode::from(code))
}

/// A gross error in words.
fn gross_words(found: &GrossError) -> String {
    let GrossError { sensor, error, yaw_significance, height_significance } = found;
    format!(
        "{sensor}: probably {error}; without that it fits the image (yaw {yaw_significance:.1} sigma, height \
         {height_significance:.1} sigma)"
    )
}

/// What the check made of the planted error, one line per LiDAR.
fn recovered(plant: &Plant, with: &FitReport, without: &FitReport) -> String {
    let line = |(with, without): (&LidarFit, &LidarFit)| {
        let [yaw, height] =
            if plant.concerns(&with.sensor) { [plant.yaw_deg, plant.height_m] } else { [0.0, 0.0] };
        let found_yaw = (with.yaw_rad.offset - without.yaw_rad.offset).to_degrees();
        let found_height = with.height_m.offset - without.height_m.offset;
        format!(
            "{:16} planted {yaw:+.2}° {height:+.3} m, found against the unplanted check \
             {found_yaw:+.2}° {found_height:+.3} m\n",
            with.sensor
        )
    };
    with.lidars.iter().zip(&without.lidars).map(line).collect()
}

fn refined(job: &Job, args: &CheckArgs) -> Result<ExitCode> {
    let found = with_views(&job.frames, &job.mounts, |v| refine(v, &FitConfig::default()))?;
    let corrections: Vec<_> =
        found.lidars.iter().map(|lidar| (lidar.sensor.clone(), lidar.correction)).collect();
    let (mounted, corrected) = (job.sweeps(0), moved(job.sweeps(0), &corrections));
    let (before, after) = (floor_lines(&mounted), floor_lines(&corrected));
    let warnings = tilted_more(&mounted, &corrected);
    let value = json!({
        "frames": job.names(), "config": FitConfig::default(),
        "planted": job.plant, "floors_before": before, "floors_after": after, "warnings": warnings,
        "refinement": found,
    });
    let json = serde_json::to_string_pretty(&value)?;
    if let Some(out) = &args.out {
        write(&out.join("refinement.json"), json.as_bytes())?;
        draw(job, out, "before and after refinement", &corrections)?;
    }
    match args.format {
        Format::Json => say(&(json + "\n"))?,
        Format::Text => {
            let floors = [("before", before), ("after", after)].map(|(when, lines)| {
                lines.into_iter().map(|line| format!("{when}: {line}\n")).collect::<String>()
            });
            let warnings: String = warnings.iter().map(|w| format!("warning: {w}\n")).collect();
            say(&format!("{}{}{warnings}", words::refinement(&found), floors.concat()))?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// The sweeps with corrections applied.
fn moved(mut sweeps: Vec<BaseSweep>, corrections: &[(String, Motion)]) -> Vec<BaseSweep> {
    for sweep in &mut sweeps {
        if let Some((_, motion)) = corrections.iter().find(|(sensor, _)| *sensor == sweep.sensor) {
            let after_from_before = about(motion, &sweep.origin);
            sweep.points.iter_mut().for_each(|point| *point = after_from_before * *point);
        }
    }
    sweeps
}

/// Draws every frame, and below it the same with corrections, if there are some.
fn draw(job: &Job, out: &Path, words: &str, corrections: &[(String, Motion)]) -> Result<()> {
    for (index, frame) in job.frames.iter().enumerate() {
        let sweeps = job.sweeps(index);
        let points = |sweeps: &[BaseSweep]| -> Vec<Point3<f64>> {
            sweeps.iter().flat_map(|sweep| sweep.points.iter().copied()).collect()
        };
        let (as_mounted, corrected) = (points(&sweeps), points(&moved(sweeps, corrections)));
        let mut strips = vec![Strip { title: "as mounted", points: &as_mounted }];
        if !corrections.is_empty() {
            strips.push(Strip { title: "corrected", points: &corrected });
        }
        // The letters of pictures are ASCII.
        let title = format!("{}: {}", frame.name, words.replace('°', " deg"));
        let overlay = Overlay { title: &title, image: &frame.image, camera: frame.camera() };
        let picture = draw_overlay(&overlay, &strips);
        let name = match job.frames.len() {
            1 => "overlay.png".into(),
            _ => format!("overlay_{}.png", frame.name.replace(['/', '\\', ' '], "_")),
        };
        let png = jrdb_dataset::encode_png(&picture, PngCompression::Quick);
        write(&out.join(name), &png)?;
    }
    Ok(())
}
