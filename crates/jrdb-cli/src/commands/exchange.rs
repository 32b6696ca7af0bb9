//! `jrdb exchange`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use anyhow::Result;
use clap::Args;
use jrdb_cli::Error;
use jrdb_cli::output::write;
use jrdb_cli::questions::FrameQuestions;
use jrdb_cli::source::{FrameSource, list_frames};
use jrdb_dataset::PngCompression;
use jrdb_models::Perception;
use jrdb_parser::ParserConfig;
use jrdb_perception::exchange::{Exchange, FIND, Request, whole_question};
use jrdb_perception::exchange_phrase::ask_phrase;
use jrdb_perception::image::crop;
use jrdb_perception::prompts::Topic;
use jrdb_perception::{Perceive, PerceptionError, Subject, View};
use jrdb_pipeline::Pipeline;
use jrdb_types::detection::PERSON;
use jrdb_types::{Detection, Detections, FrameId, Image};

use super::args::{PerceptionArgs, SourceArgs};
use super::print::say;

/// File with the lines, in the folder.
const FILE: &str = "exchange.jsonl";

#[derive(Debug, Args)]
pub(crate) struct ExchangeArgs {
    #[command(flatten)]
    source: SourceArgs,
    #[command(flatten)]
    perception: PerceptionArgs,
    /// Ask for people and things, too, instead of taking those of --perception
    #[arg(long)]
    find: bool,
    /// Ask each question of these files as a whole instead: the requests of a baseline
    #[arg(long, value_name = "FILE", conflicts_with = "find")]
    questions: Vec<PathBuf>,
    /// Ask of every person whether this phrase is true, "striped shirt" say; may be repeated
    #[arg(long, value_name = "PHRASE", conflicts_with_all = ["find", "questions"])]
    looks: Vec<String>,
    /// A crop is larger than its box by this part of it on each side
    #[arg(long, default_value_t = 0.1, value_name = "PART")]
    margin: f64,
    /// Folder for exchange.jsonl and pictures
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

pub(crate) fn exchange(args: &ExchangeArgs) -> Result<ExitCode> {
    let source = &args.source;
    let frames = list_frames(&source.sources()?, source.frames.as_ref(), &source.robot())?;
    let lines = lines(&frames, args)?;
    let mut text = String::new();
    for line in &lines {
        text.push_str(&serde_json::to_string(line)?);
        text.push('\n');
    }
    write(&args.out.join(FILE), text.as_bytes())?;
    let open = lines.iter().filter(|line| line.reply.is_none()).count();
    let file = args.out.join(FILE);
    let file = file.display();
    say(&format!(
        "{} lines, {open} of them without a reply, are in {file}; with replies: --perception replay:{file}\n",
        lines.len()
    ))?;
    Ok(ExitCode::SUCCESS)
}

/// The lines about all frames. Perception is opened only where it has something to say.
fn lines(frames: &[FrameSource], args: &ExchangeArgs) -> Result<Vec<Exchange>> {
    if !args.questions.is_empty() {
        return Ok(whole_questions(frames, args)?);
    }
    let mut lines = Vec::new();
    if args.find {
        for frame in frames {
            lines.extend(find(frame, &args.out)?);
        }
        return Ok(lines);
    }
    let perception = Arc::new(args.perception.open(frames)?);
    perception.notes().iter().for_each(|note| eprintln!("{note}"));
    for frame in frames {
        lines.extend(of(frame, &perception, args)?);
    }
    Ok(lines)
}

/// Asks what is in the panorama.
fn find(frame: &FrameSource, out: &Path) -> Result<Vec<Exchange>, Error> {
    let Some(image) = panorama(frame, out)? else { return Ok(Vec::new()) };
    Ok(vec![about(frame, image, FIND.into(), None)])
}

/// Asks every question about a frame as a whole.
fn whole_questions(frames: &[FrameSource], args: &ExchangeArgs) -> Result<Vec<Exchange>, Error> {
    let (sources, parser) = (args.source.sources()?, ParserConfig::default());
    let asked = FrameQuestions::gather(frames, &[], &args.questions, &sources, &parser)?;
    let mut lines = Vec::new();
    for (frame, questions) in frames.iter().zip(asked.per_frame) {
        let Some(image) = panorama(frame, &args.out)? else { continue };
        lines.extend(questions.into_iter().map(|asked| {
            let text = asked.question.text;
            about(frame, image.clone(), whole_question(&text), Some(text))
        }));
    }
    Ok(lines)
}

/// Writes the panorama; its name in the folder, or none where it cannot be read.
fn panorama(frame: &FrameSource, out: &Path) -> Result<Option<String>, Error> {
    let Ok(image) = frame.image() else { return Ok(None) };
    let name = format!("{}.png", stem(&frame.id));
    picture(&out.join(&name), &image)?;
    Ok(Some(name))
}

/// A line that asks about the whole panorama.
fn about(frame: &FrameSource, image: String, prompt: String, sentence: Option<String>) -> Exchange {
    let frame = frame.id.clone();
    let (bbox, topic, looks, labels) = (None, None, None, Vec::new());
    let request =
        Request { frame, image: Some(image), bbox, topic, looks, prompt, sentence, labels };
    Exchange { request, reply: None }
}

/// Records what perception gives, and asks for what it does not know of people.
fn of(
    frame: &FrameSource,
    perception: &Arc<Perception>,
    args: &ExchangeArgs,
) -> Result<Vec<Exchange>, Error> {
    let (robot, shared) = (frame.robot.clone(), perception.clone());
    let read = frame.image_only();
    let detections = Pipeline::sharing(robot, shared, Arc::default()).perceive(&read)?;
    let mut lines = Exchange::record(&detections, &Topic::ALL);
    lines.extend(looks(&detections, read.pixels(), perception, &args.looks)?);
    let Some(image) = read.pixels() else { return Ok(lines) };
    let mut last = None;
    let mut number = 0;
    for line in lines.iter_mut().filter(|line| line.reply.is_none()) {
        let Some(bbox) = line.request.bbox else { continue };
        if last != Some(bbox) {
            (last, number) = (Some(bbox), number + 1);
        }
        let name = format!("{}_{number:03}.png", stem(&frame.id));
        if let Some(cut) = crop(image, &bbox, args.margin, frame.robot.image().into()) {
            picture(&args.out.join(&name), &cut)?;
            line.request.image = Some(name);
        }
    }
    Ok(lines)
}

/// Asks whether phrases are true of the people, with the answers of perception that can be asked.
fn looks(
    detections: &Detections,
    image: Option<&Image>,
    perception: &Perception,
    phrases: &[String],
) -> Result<Vec<Exchange>, Error> {
    let phrases: Vec<&str> = phrases.iter().map(String::as_str).collect();
    let (frame, view) = (&detections.frame, View { geometry: detections.image, image });
    let people = detections.detections.iter().filter(|one| one.category == PERSON);
    let about = |detection: &Detection| {
        let subject = Subject { frame, view, detection };
        let told = match perception.phrase_model() {
            Some(model) => model.weigh(&subject, &phrases)?,
            None => vec![None; phrases.len()],
        };
        let lines = phrases.iter().zip(told);
        Ok(lines
            .filter_map(|(phrase, told)| ask_phrase(frame, detection, phrase, told))
            .collect::<Vec<_>>())
    };
    Ok(people.map(about).collect::<Result<Vec<_>, PerceptionError>>()?.concat())
}

fn stem(frame: &FrameId) -> String {
    format!("{}_{:06}", frame.sequence, frame.frame)
}

fn picture(path: &Path, image: &Image) -> Result<(), Error> {
    write(path, &jrdb_dataset::encode_png(image, PngCompression::Quick))
}
