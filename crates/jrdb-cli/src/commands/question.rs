//! How questions are read and answered: the flags that `run`, `search` and `parse` share.

use std::io::Read;

use clap::{Args, ValueEnum};
use jrdb_cli::Error;
use jrdb_graph::{GraphConfig, Hidden, Pairs};
use jrdb_parser::{OfPerson, ParserConfig};
use jrdb_pipeline::PipelineConfig;
use jrdb_search::SearchConfig;
use jrdb_types::vocab::MatchPolicy;
use jrdb_types::{EntityId, LateralConvention};

/// A question that stands for what is on standard input.
const STDIN: &str = "-";

/// Flags of the parser.
#[derive(Debug, Args)]
pub(crate) struct ReadingArgs {
    /// Whose left "left of the man" is; a table's is always as the robot sees it
    #[arg(long, value_enum, default_value_t)]
    viewpoint: Viewpoint,
}

impl ReadingArgs {
    pub(crate) fn config(&self) -> ParserConfig {
        let viewpoint = match self.viewpoint {
            Viewpoint::Own => OfPerson::Own,
            Viewpoint::Robot => OfPerson::Robot,
        };
        ParserConfig { viewpoint }
    }
}

#[derive(Debug, Clone, Copy, Default, ValueEnum)]
enum Viewpoint {
    /// The man's own left
    #[default]
    Own,
    /// The left of the two as the robot sees them
    Robot,
}

/// Flags of the search.
#[derive(Debug, Args)]
pub(crate) struct AnswerArgs {
    /// How many of the asked attributes a candidate must have
    #[arg(long = "match", value_enum, default_value_t)]
    policy: Match,
    /// engine: as the benchmark's engine answers, which made its ground truth
    #[arg(long, value_enum, default_value_t, conflicts_with = "policy")]
    semantics: Semantics,
    /// Say what keeps this person (7) or object (table:1) out of the answer
    #[arg(long, value_name = "ID", value_parser = entity)]
    pub(crate) why_not: Option<EntityId>,
    /// Say which smallest changes would change the answer
    #[arg(long)]
    pub(crate) sensitivity: bool,
}

impl AnswerArgs {
    pub(crate) fn search(&self) -> SearchConfig {
        match self.semantics {
            Semantics::Clean => SearchConfig { policy: self.policy.into(), ..Default::default() },
            Semantics::Engine => SearchConfig::benchmark(),
        }
    }

    /// Sets up the search, and for the benchmark's engine the graph and the sides, too.
    pub(crate) fn apply(&self, config: &mut PipelineConfig) {
        config.search = self.search();
        config.sensitivity = self.sensitivity;
        if matches!(self.semantics, Semantics::Engine) {
            config.projection.lateral = LateralConvention::BenchmarkMirrored;
            config.graph = GraphConfig { pairs: Pairs::Close, hidden: Hidden::LeaveOut };
        }
    }
}

#[derive(Debug, Clone, Copy, Default, ValueEnum)]
enum Semantics {
    /// One partner for all that is said of it, "then" in time, left is left
    #[default]
    Clean,
    /// Strict matching, each relation by itself, slots by themselves, left and right exchanged
    Engine,
}

/// How many of the asked attributes a candidate must have.
#[derive(Debug, Clone, Copy, Default, ValueEnum)]
pub(crate) enum Match {
    /// The paper's two phases, then the most probable
    #[default]
    Ranked,
    /// All of them
    Strict,
    /// More than half of them
    Majority,
}

impl From<Match> for MatchPolicy {
    fn from(policy: Match) -> Self {
        match policy {
            Match::Ranked => Self::Ranked,
            Match::Strict => Self::Strict,
            Match::Majority => Self::Majority,
        }
    }
}

fn entity(text: &str) -> Result<EntityId, String> {
    let number = text.trim_start_matches('#').parse().map(|n| EntityId::new("pedestrian", n));
    number.or_else(|_| {
        let expected =
            |_| format!("expected a number like 7 or an id like table:1, found {text:?}");
        text.parse().map_err(expected)
    })
}

/// The questions of a text: that of the command line is one; of standard input, for `-`, each line with words is one.
pub(crate) fn questions(text: &str) -> Result<Vec<String>, Error> {
    let whole = question(text)?;
    if text != STDIN {
        return Ok(vec![whole]);
    }
    let lines: Vec<&str> = whole.lines().filter(|line| !line.trim().is_empty()).collect();
    // A question without words is reported where it is read.
    if lines.is_empty() { Ok(vec![whole]) } else { Ok(lines.into_iter().map(Into::into).collect()) }
}

/// The one question of a text, where no more can be taken.
pub(crate) fn only_question(text: &str) -> Result<String, Error> {
    match &questions(text)?[..] {
        [one] => Ok(one.clone()),
        all => Err(Error::Usage(format!(
            "expected one question, found {} lines on standard input: ask them one by one, or with \
             jrdb run --query, which may be given several times",
            all.len()
        ))),
    }
}

/// A text from the command line, or from standard input for `-`.
fn question(text: &str) -> Result<String, Error> {
    if text != STDIN {
        return Ok(text.into());
    }
    let mut bytes = Vec::new();
    let read = std::io::stdin().lock().read_to_end(&mut bytes);
    read.map_err(|error| Error::Usage(format!("cannot read the question: {error}")))?;
    String::from_utf8(bytes)
        .map_err(|error| Error::Usage(format!("expected a question in UTF-8: {error}")))
}
