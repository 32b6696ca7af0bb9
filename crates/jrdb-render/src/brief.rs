//! An answer in a few lines: who is meant, and why.

use jrdb_types::answer::{CandidateTrace, Check, PropertyValues, Reply, Status};
use jrdb_types::{Answer, EntityId};

use crate::check::{self, asked, found_or_unknown, repeats_itself};
use crate::property;
use crate::query::command;
use crate::reply::{headline, reasons};

/// The reply in a line, then one line for each selected candidate with its conditions, at most `limit` of them.
#[must_use]
pub fn brief(answer: &Answer, limit: usize) -> Vec<String> {
    let mut lines: Vec<String> = reply(answer).lines().map(Into::into).collect();
    lines.extend(reasons(answer));
    let told = answer.command.as_ref().filter(|_| answer.status == Status::Answered);
    lines.extend(told.map(|told| format!("to {}: the action is up to the robot", command(told))));
    if answer.status.is_open() {
        return lines;
    }
    let selected: Vec<_> = answer.trace.iter().filter(|trace| trace.selected).collect();
    let shown = selected.iter().take(limit).filter(|trace| !trace.checks.is_empty());
    lines.extend(shown.map(|trace| why(trace)));
    if selected.len() > limit && !selected[0].checks.is_empty() {
        lines.push(format!("… and {} more", selected.len() - limit));
    }
    lines
}

/// A candidate's conditions in one line.
fn why(trace: &CandidateTrace) -> String {
    let checks: Vec<String> = trace.checks.iter().map(check_text).collect();
    format!("{}: {}", trace.id.short(), checks.join("; "))
}

/// `close distance from the robot (close, 1.05 m)`, `NOT age young (child)`,
/// `has a person to its left (#3: close, 1.21 m; left, +88°)`.
fn check_text(check: &Check) -> String {
    let mark = match check {
        Check { holds: true, .. } => "",
        Check { unknown: true, .. } => "UNKNOWN ",
        _ => "NOT ",
    };
    let asked = asked(check);
    if check.holds && repeats_itself(check) {
        return asked;
    }
    // What was found has each of the relations with the partner; left are the partner's own conditions.
    let is_new = |part: &&Check| part.witnesses.is_empty() || part.witnesses != check.witnesses;
    let parts = check.telling_parts().filter(is_new).map(check_text);
    let inner: Vec<String> = std::iter::once(found_or_unknown(check)).chain(parts).collect();
    let inner = inner.join("; ");
    if check.witnesses.is_empty() {
        return format!("{mark}{asked} ({inner})");
    }
    format!("{mark}{asked} ({}: {inner})", ids(&check.witnesses))
}

/// The reply, and who is meant.
fn reply(answer: &Answer) -> String {
    match &answer.reply {
        Reply::Properties(all) if answer.status == Status::Answered && !all.is_empty() => {
            all.iter().map(properties).collect::<Vec<_>>().join("\n")
        }
        _ => headline(answer),
    }
}

fn properties(of: &PropertyValues) -> String {
    let words = property::words(of);
    let words = if words.is_empty() { "unknown".into() } else { words.join("; ") };
    format!("{} {words}", of.id.short())
}

/// Ids in a line: `#1 #2`, `none`.
#[must_use]
pub fn ids(ids: &[EntityId]) -> String {
    if ids.is_empty() { "none".into() } else { check::ids(ids, " ") }
}
