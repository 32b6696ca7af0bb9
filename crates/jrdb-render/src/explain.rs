//! An answer with all its reasons.

use std::fmt::Write as _;

use jrdb_types::answer::{CandidateTrace, Check, Count, PropertyValues, Reply, Status};
use jrdb_types::{Answer, EntityId};

use crate::check::{asked, found_or_unknown, ids, margin};
use crate::reply::{headline, reasons};
use crate::{property, query, why_not};

/// How many of the candidates that are not selected are shown.
const MISSES: usize = 3;

/// Cells that are longer are not padded to: one long condition should not push the others' findings out of sight.
const WIDTH_MAX: usize = 44;

/// A probability nearer than this to 0 or 1 reads "0.00" or "1.00".
const ROUNDING: f64 = 0.005;

/// An answer with its reasons: the reply in a sentence, every selected candidate with its conditions, then the nearest misses.
///
/// At most `limit` selected candidates and three misses are shown. The line of a condition holds whether it holds, what was
/// asked, what was found, how far that is from the bound, and the partner. The answer's issues are not included.
#[must_use]
pub fn explain(answer: &Answer, limit: usize) -> String {
    let mut text = format!("{}\n", sentence(answer, limit));
    let (selected, others): (Vec<_>, Vec<_>) = answer.trace.iter().partition(|t| t.selected);
    let with_checks = || selected.iter().filter(|trace| !trace.checks.is_empty());
    for trace in with_checks().take(limit) {
        candidate(answer, trace, &mut text);
    }
    omitted(with_checks().count(), limit, "selected", &mut text);
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

/// The reply in a sentence; of an open question, why it is open.
fn sentence(answer: &Answer, limit: usize) -> String {
    match answer.status {
        Status::Answered => reply(answer, limit),
        Status::Nearest if answer.selection.is_empty() => "Nothing matches.".into(),
        Status::Nearest => {
            let nearest = some(&answer.selection, limit);
            format!("Nothing satisfies all that was asked; what comes nearest: {nearest}.")
        }
        Status::Unknown | Status::NotUnderstood => {
            let mut lines = vec![format!("{}.", capitalised(&headline(answer)))];
            lines.extend(reasons(answer).into_iter().map(|reason| format!("  {reason}")));
            lines.join("\n")
        }
    }
}

fn capitalised(text: &str) -> String {
    let mut rest = text.chars();
    rest.next().map_or_else(String::new, |first| first.to_uppercase().chain(rest).collect())
}

fn reply(answer: &Answer, limit: usize) -> String {
    let some = || some(&answer.selection, limit);
    match &answer.reply {
        Reply::Number(Count::Exact(0)) => "None.".into(),
        Reply::Number(Count::Exact(number)) => format!("{number}: {}.", some()),
        Reply::YesNo(Some(yes)) => {
            let word = if *yes { "Yes" } else { "No" };
            if answer.selection.is_empty() {
                format!("{word}.")
            } else {
                format!("{word}: {}.", some())
            }
        }
        Reply::Number(Count::Between { .. }) | Reply::YesNo(None) => {
            format!("{}.", capitalised(&headline(answer)))
        }
        Reply::Properties(all) if all.is_empty() => "Nobody of whom it could be told.".into(),
        Reply::Properties(all) => all.iter().map(properties).collect::<Vec<_>>().join("\n"),
        Reply::Things if answer.selection.is_empty() => "Nothing matches.".into(),
        Reply::Things => format!("{}.", some()),
    }
}

fn properties(of: &PropertyValues) -> String {
    let property = of.property.map(|property| format!("{} ", query::property(property)));
    let words = property::words(of);
    let words = if words.is_empty() { "unknown".into() } else { words.join("; ") };
    format!("{}: {}{words}", of.id.short(), property.unwrap_or_default())
}

/// The first of some ids.
fn some(all: &[EntityId], limit: usize) -> String {
    match all.split_at_checked(limit) {
        Some((first, rest)) if !rest.is_empty() => {
            format!("{} … and {} more", ids(first, ", "), rest.len())
        }
        _ => ids(all, ", "),
    }
}

fn probability(answer: &Answer, id: &EntityId) -> f64 {
    answer.probability(id).unwrap_or(0.0)
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
    for line in why_not::why_not(answer, &trace.id).lines() {
        let _ = writeln!(text, "    {line}");
    }
}

/// A condition as cells: what was asked, what was found, the margin, the partner.
struct Row {
    mark: char,
    cells: [String; 4],
}

fn rows_of(check: &Check, depth: usize, rows: &mut Vec<Row>) {
    let margin = check.measured.as_ref().and_then(margin);
    let is_sure = check.probability < ROUNDING || check.probability > 1.0 - ROUNDING;
    let probability = (!is_sure).then(|| format!("p = {:.2}", check.probability));
    let is_group = !check.parts.is_empty() && !check.witnesses.is_empty();
    let witness =
        if is_group { format!("→ {}", ids(&check.witnesses, ", ")) } else { String::new() };
    let numbers: Vec<String> = margin.into_iter().chain(probability).collect();
    rows.push(Row {
        mark: match check {
            Check { holds: true, .. } => '✓',
            Check { unknown: true, .. } => '?',
            _ => '✗',
        },
        cells: [
            format!("{:width$}{}", "", asked(check), width = 2 * depth),
            found_or_unknown(check),
            numbers.join(", "),
            witness,
        ],
    });
    check.telling_parts().for_each(|part| rows_of(part, depth + 1, rows));
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
