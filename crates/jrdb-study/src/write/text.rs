//! Tables for a terminal.

use std::fmt::Write as _;

use super::{FAILED, NOTHING, change, value};
use crate::table::{Origin, Row, Table};

/// What stands behind the best baseline of a column.
const BEST: char = '*';

/// The table for a terminal: the best baseline of each column has a star, methods their change
/// against it in percent.
#[must_use]
pub fn text(table: &Table) -> String {
    let mut lines: Vec<Vec<String>> = vec![categories(table), metrics(table)];
    for origin in Origin::ALL {
        let mut rows = table.rows_of(origin).peekable();
        if rows.peek().is_some() {
            lines.push(vec![format!("{}:", origin.words())]);
            lines.extend(rows.map(|row| cells(table, row)));
        }
    }
    let mut out = format!("{}\n", table.title);
    let widths = widths(&lines);
    lines.iter().for_each(|line| out.push_str(&aligned(line, &widths)));
    for row in table.rows.iter().filter(|row| row.failure.is_some()) {
        let why = row.failure.as_deref().unwrap_or_default();
        let _ = writeln!(out, "{} failed: {why}", row.method);
    }
    table.notes.iter().for_each(|note| out.push_str(&format!("{note}\n")));
    out
}

/// The line of categories, each above its first metric.
fn categories(table: &Table) -> Vec<String> {
    let blank = vec![String::new(); table.metrics.len().saturating_sub(1)];
    let names =
        table.categories.iter().flat_map(|name| [vec![name.clone()], blank.clone()].concat());
    std::iter::once(String::new()).chain(names).collect()
}

fn metrics(table: &Table) -> Vec<String> {
    let names = table.columns().map(|(_, metric)| metric.to_owned());
    std::iter::once(table.unit.symbol().to_owned()).chain(names).collect()
}

fn cells(table: &Table, row: &Row) -> Vec<String> {
    let mut line = vec![format!("  {}", row.method)];
    if row.failure.is_some() {
        line.push(FAILED.into());
        return line;
    }
    line.extend(row.cells.iter().enumerate().map(|(column, cell)| {
        let Some(cell) = cell else { return NOTHING.into() };
        let mark = table.mark(row, column);
        let best = if mark.best_baseline { BEST.to_string() } else { String::new() };
        let change = change(&mark).map(|change| format!(" {change}")).unwrap_or_default();
        format!("{}{best}{change}", value(cell))
    }));
    line
}

/// The widths of the columns. A category may run over the columns of its metrics.
fn widths(lines: &[Vec<String>]) -> Vec<usize> {
    let columns = lines.iter().map(Vec::len).max().unwrap_or(0);
    let mut widths = vec![0; columns];
    for line in lines.iter().skip(1).filter(|line| line.len() > 1) {
        for (width, text) in widths.iter_mut().zip(line) {
            *width = (*width).max(text.chars().count());
        }
    }
    widen(&mut widths, &lines[0]);
    widths
}

/// Widens the last column below each heading until the heading fits.
fn widen(widths: &mut [usize], headings: &[String]) {
    let starts: Vec<usize> = (1..headings.len()).filter(|at| !headings[*at].is_empty()).collect();
    for (index, &start) in starts.iter().enumerate() {
        let end = starts.get(index + 1).copied().unwrap_or(headings.len());
        let room: usize = widths[start..end].iter().sum::<usize>() + GAP * (end - start - 1);
        widths[end - 1] += headings[start].chars().count().saturating_sub(room);
    }
}

/// Blanks between columns.
const GAP: usize = 2;

fn aligned(line: &[String], widths: &[usize]) -> String {
    let mut out = String::new();
    let mut end = 0;
    for (text, width) in line.iter().zip(widths) {
        let used = out.chars().count();
        out.push_str(&" ".repeat(usize::saturating_sub(end, used)));
        out.push_str(text);
        end += width + GAP;
    }
    format!("{}\n", out.trim_end())
}
