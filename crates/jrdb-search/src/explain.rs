//! An answer for a person to read.

use std::fmt::Write as _;

use jrdb_types::answer::{CandidateTrace, Check, Reply};
use jrdb_types::{Answer, EntityId};

use crate::{describe, found, why_not};

/// So many of those that are not selected are told of.
const MISSES: usize = 3;

/// Cells that are longer are not padded to: one long condition should not push the others' findings out of sight.
const WIDTH_MAX: usize = 44;

/// An answer with its reasons: the reply in a sentence, every selected candidate with its conditions, then the nearest misses.
///
/// At most `limit` selected ones are told of, and three misses. A line of a condition reads: whether it holds, what was asked,
/// what was found, how far that is from the bound, and with which partner. The answer's issues are not told.
#[must_use]
pub fn explain(answer: &Answer, limit: usize) -> String {
    let mut text = format!("{}\n", sentence(answer, limit));
    let (selected, others): (Vec<_>, Vec<_>) = answer.trace.iter().partition(|t| t.selected);
    let told = || selected.iter().filter(|trace| !trace.checks.is_empty());
    for trace in told().take(limit) {
        candidate(answer, trace, &mut text);
    }
    omitted(told().count(), limit, "selected", &mut text);
    let misses = nearest(answer, &others);
    if !misses.is_empty() {
        text.push_str("\nNearest misses\n");
        misses.iter().take(MISSES).for_each(|trace| miss(answer, trace, &mut text));
    }
    omitted(misses.len(), MISSES, "not selected", &mut text);
    text.truncate(text.trim_end().len());
    text.push('\n');
    text
}

fn omitted(count: usize, limit: usize, what: &str, text: &mut String) {
    if count > limit {
        let _ = writeln!(text, "  … and {} more {what}", count - limit);
    }
}

/// The reply in a sentence; when even those selected lack something, it says so.
fn sentence(answer: &Answer, limit: usize) -> String {
    let reply = reply(answer, limit);
    if is_nearest_only(answer) {
        return format!("Nothing satisfies all that was asked; what comes nearest: {reply}");
    }
    reply
}

/// Whether everything selected lacks something that was asked: the answer is what comes nearest, not what was asked for.
#[must_use]
pub fn is_nearest_only(answer: &Answer) -> bool {
    let lacks = |trace: &CandidateTrace| trace.checks.iter().any(|check| !check.holds);
    let mut selected = answer.trace.iter().filter(|trace| trace.selected).peekable();
    selected.peek().is_some() && selected.all(lacks)
}

fn reply(answer: &Answer, limit: usize) -> String {
    let some = || some(&answer.selection, limit);
    match &answer.reply {
        Reply::Number(0) => "None.".into(),
        Reply::Number(number) => format!("{number}: {}.", some()),
        Reply::YesNo(yes) => {
            let word = if *yes { "Yes" } else { "No" };
            if answer.selection.is_empty() {
                format!("{word}.")
            } else {
                format!("{word}: {}.", some())
            }
        }
        Reply::Told(told) if told.is_empty() => "Nobody of whom it could be told.".into(),
        Reply::Told(told) => {
            let lines = told.iter().map(|told| {
                let property = told.property.map(|p| format!("{} ", describe::property(p)));
                let words =
                    if told.words.is_empty() { "unknown".into() } else { told.words.join("; ") };
                format!("{}: {}{words}", told.id.short(), property.unwrap_or_default())
            });
            lines.collect::<Vec<_>>().join("\n")
        }
        Reply::Things if answer.selection.is_empty() => "Nothing matches.".into(),
        Reply::Things => format!("{}.", some()),
    }
}

/// The first of some ids.
fn some(ids: &[EntityId], limit: usize) -> String {
    match ids.split_at_checked(limit) {
        Some((first, rest)) if !rest.is_empty() => {
            format!("{} … and {} more", listed(first), rest.len())
        }
        _ => listed(ids),
    }
}

fn listed(ids: &[EntityId]) -> String {
    ids.iter().map(EntityId::short).collect::<Vec<_>>().join(", ")
}

fn probability(answer: &Answer, id: &EntityId) -> f64 {
    let ranked = answer.ranking.iter().find(|ranked| ranked.id == *id);
    ranked.map_or(0.0, |ranked| ranked.probability)
}

fn candidate(answer: &Answer, trace: &CandidateTrace, text: &mut String) {
    let _ = writeln!(text, "\n{}  p = {:.2}", trace.id.short(), probability(answer, &trace.id));
    let mut rows = Vec::new();
    trace.checks.iter().for_each(|check| rows_of(check, 0, &mut rows));
    table(&rows, text);
}

/// Those that fail least come first: by probability, then by how many conditions hold.
fn nearest<'a>(answer: &Answer, others: &[&'a CandidateTrace]) -> Vec<&'a CandidateTrace> {
    let held = |trace: &CandidateTrace| trace.checks.iter().filter(|check| check.holds).count();
    let mut misses: Vec<&CandidateTrace> =
        others.iter().copied().filter(|trace| !trace.checks.is_empty()).collect();
    let rank = |t: &CandidateTrace| (probability(answer, &t.id), held(t));
    misses.sort_by(|a, b| {
        let (a, b) = (rank(a), rank(b));
        b.0.total_cmp(&a.0).then(b.1.cmp(&a.1))
    });
    misses
}

fn miss(answer: &Answer, trace: &CandidateTrace, text: &mut String) {
    let _ = writeln!(text, "  {}  p = {:.2}", trace.id.short(), probability(answer, &trace.id));
    for line in why_not(answer, &trace.id).to_string().lines() {
        let _ = writeln!(text, "    {line}");
    }
}

/// A condition as cells: what was asked, what was found, the margin, the partner.
struct Row {
    mark: char,
    cells: [String; 4],
}

fn rows_of(check: &Check, depth: usize, rows: &mut Vec<Row>) {
    let margin = check.measured.as_ref().map(found::margin).unwrap_or_default();
    // Rounded like this, what is all but sure is sure.
    let probability = format!("p = {:.2}", check.probability);
    let is_sure = probability == "p = 1.00" || probability == "p = 0.00";
    let probability = if is_sure { String::new() } else { probability };
    let is_group = !check.parts.is_empty() && !check.witnesses.is_empty();
    let witness =
        if is_group { format!("→ {}", listed(&check.witnesses)) } else { String::new() };
    let numbers = [margin, probability];
    let numbers: Vec<String> = numbers.into_iter().filter(|words| !words.is_empty()).collect();
    rows.push(Row {
        mark: if check.holds { '✓' } else { '✗' },
        cells: [
            format!("{:width$}{}", "", check.asked, width = 2 * depth),
            check.found.clone().unwrap_or_else(|| "unknown".into()),
            numbers.join(", "),
            witness,
        ],
    });
    // A relation's only part says what it says itself, and so do alternatives of one attribute.
    let parts = check.parts.iter().filter(|part| part.found != check.found);
    parts.for_each(|part| rows_of(part, depth + 1, rows));
}

fn table(rows: &[Row], text: &mut String) {
    let width = |cell: usize| {
        let widths = rows.iter().map(|row| row.cells[cell].chars().count());
        widths.filter(|&width| width <= WIDTH_MAX).max().unwrap_or(0)
    };
    let widths = [0, 1, 2, 3].map(width);
    for row in rows {
        let mut line = format!("  {}", row.mark);
        for (cell, width) in row.cells.iter().zip(widths) {
            let _ = write!(line, " {cell:width$} ");
        }
        let _ = writeln!(text, "{}", line.trim_end());
    }
}
