//! The reply in a line: what is known, or why nothing is.

use jrdb_types::answer::{Count, Possible, Reply, Status};
use jrdb_types::{Answer, EntityId};

use crate::check::ids;

/// So many candidates that may be meant are named.
const POSSIBLE_MAX: usize = 12;

/// The reply in a line, with the candidates that it is about; for texts, pictures and pages alike.
///
/// ```
/// use jrdb_types::answer::{Reply, Status};
/// use jrdb_types::vocab::MatchPolicy;
/// use jrdb_types::{Answer, EntityId, FrameId, LateralConvention, Query};
/// let (frame, query) = (FrameId::default(), Query::default());
/// let mut answer = Answer::new(frame, &query, MatchPolicy::Ranked, LateralConvention::Physical);
/// answer.selection = vec![EntityId::new("pedestrian", 2)];
/// assert_eq!(jrdb_render::headline(&answer), "#2");
/// answer.status = Status::Nearest;
/// assert_eq!(jrdb_render::headline(&answer), "nobody; nearest #2");
/// (answer.status, answer.reply) = (Status::Unknown, Reply::YesNo(None));
/// assert_eq!(jrdb_render::headline(&answer), "unknown");
/// ```
#[must_use]
pub fn headline(answer: &Answer) -> String {
    match answer.status {
        Status::NotUnderstood => "not understood".into(),
        Status::Unknown => unknown(answer),
        Status::Nearest if answer.selection.is_empty() => "nobody".into(),
        Status::Nearest => format!("nobody; nearest {}", some(&answer.selection)),
        Status::Answered => answered(answer),
    }
}

/// An open reply, with the bounds of a number.
fn unknown(answer: &Answer) -> String {
    match answer.reply {
        Reply::Number(Count::Between { at_least, at_most: Some(most) }) => {
            format!("unknown: {at_least} to {most}")
        }
        Reply::Number(Count::Between { at_least, at_most: None }) if at_least > 0 => {
            format!("unknown: at least {at_least}")
        }
        _ => "unknown".into(),
    }
}

fn answered(answer: &Answer) -> String {
    let selection = || some(&answer.selection);
    match &answer.reply {
        Reply::Things | Reply::Properties(_) => selection(),
        Reply::Number(count) => format!("{}: {}", count.exact().unwrap_or_default(), selection()),
        Reply::YesNo(Some(true)) => format!("yes: {}", selection()),
        Reply::YesNo(Some(false)) => "no".into(),
        Reply::YesNo(None) => "unknown".into(),
    }
}

fn some(all: &[EntityId]) -> String {
    if all.is_empty() { "none".into() } else { ids(all, " ") }
}

/// Why a question is open, and who may be meant: a line for each cause, then one for the candidates.
pub(crate) fn reasons(answer: &Answer) -> Vec<String> {
    if !answer.status.is_open() {
        return Vec::new();
    }
    let causes = answer.because.iter().map(|cause| format!("because {}", cause.message));
    let possible = possible(&answer.possible).map(|names| format!("possible: {names}"));
    causes.chain(possible).collect()
}

/// Those that may be meant.
fn possible(all: &[Possible]) -> Option<String> {
    let mut names: Vec<String> = all.iter().take(POSSIBLE_MAX).map(|one| one.id.short()).collect();
    if all.len() > POSSIBLE_MAX {
        names.push(format!("and {} more", all.len() - POSSIBLE_MAX));
    }
    (!names.is_empty()).then(|| names.join(" "))
}
