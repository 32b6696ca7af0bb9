//! Tables for documents.

use std::fmt::Write as _;

use super::{FAILED, NOTHING, change, value};
use crate::table::{Origin, Row, Table};

/// The table in Markdown: the best baseline of each column is bold, methods have their change
/// against it in percent as a superscript.
#[must_use]
pub fn markdown(table: &Table) -> String {
    let mut out = format!("**{}** ({})\n\n", table.title, table.unit.symbol());
    let columns = table.columns().map(|(category, metric)| format!(" {category}<br>{metric} |"));
    let _ = writeln!(out, "| method |{}", columns.collect::<String>());
    let _ = writeln!(out, "|---|{}", "---:|".repeat(table.columns().count()));
    for origin in Origin::ALL {
        let mut rows = table.rows_of(origin).peekable();
        if rows.peek().is_some() {
            let blank = " |".repeat(table.columns().count());
            let _ = writeln!(out, "| *{}* |{blank}", origin.words());
            rows.for_each(|row| out.push_str(&line(table, row)));
        }
    }
    table.notes.iter().for_each(|note| out.push_str(&format!("\n{note}\n")));
    out
}

fn line(table: &Table, row: &Row) -> String {
    let cells = row.cells.iter().enumerate().map(|(column, cell)| {
        let Some(cell) = cell else {
            return format!(" {} |", if row.failure.is_some() { FAILED } else { NOTHING });
        };
        let mark = table.mark(row, column);
        let bold = if mark.best_baseline { "**" } else { "" };
        let change = change(&mark).map(|change| format!(" <sup>{change}</sup>"));
        format!(" {bold}{}{bold}{} |", value(cell), change.unwrap_or_default())
    });
    let name = row.method.replace('|', "\\|");
    format!("| {name} |{}\n", cells.collect::<String>())
}
