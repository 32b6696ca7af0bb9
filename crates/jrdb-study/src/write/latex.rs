//! Tables for papers.

use std::cmp::Ordering;
use std::fmt::Write as _;

use super::{FAILED, NOTHING, direction, number};
use crate::table::{Cell, Mark, Origin, Row, Table};

/// The table in LaTeX, with the packages `booktabs` and `amssymb`: the best baseline of each column
/// is bold, methods have their change against it in percent as a superscript.
#[must_use]
pub fn latex(table: &Table) -> String {
    let columns = table.columns().count();
    let mut out = format!(
        "% \\usepackage{{booktabs,amssymb}}\n\\begin{{tabular}}{{l{}}}\n\\toprule\n",
        "r".repeat(columns)
    );
    let per = table.metrics.len();
    let heads = table
        .categories
        .iter()
        .map(|c| format!(" & \\multicolumn{{{per}}}{{c}}{{{}}}", escaped(c)));
    let _ = writeln!(out, "{} \\\\", heads.collect::<String>());
    let metrics = table.columns().map(|(_, metric)| format!(" & {}", escaped(metric)));
    let _ = writeln!(out, "Method{} \\\\", metrics.collect::<String>());
    for origin in Origin::ALL {
        let mut rows = table.rows_of(origin).peekable();
        if rows.peek().is_some() {
            let words = origin.words();
            let _ = writeln!(
                out,
                "\\midrule\n\\multicolumn{{{}}}{{l}}{{\\emph{{{words}}}}} \\\\",
                columns + 1
            );
            rows.for_each(|row| out.push_str(&line(table, row)));
        }
    }
    out.push_str("\\bottomrule\n\\end{tabular}\n");
    table.notes.iter().for_each(|note| out.push_str(&format!("% {note}\n")));
    out
}

fn line(table: &Table, row: &Row) -> String {
    let cells = row.cells.iter().enumerate().map(|(column, cell)| match cell {
        Some(found) => format!(" & {}", cell_text(found, &table.mark(row, column))),
        None if row.failure.is_some() => format!(" & {FAILED}"),
        None => format!(" & {NOTHING}"),
    });
    format!("{}{} \\\\\n", escaped(&row.method), cells.collect::<String>())
}

fn cell_text(cell: &Cell, mark: &Mark) -> String {
    let value = number(cell.value);
    let value = if mark.best_baseline { format!("\\textbf{{{value}}}") } else { value };
    let half = cell.half_width().map(|half| format!(" $\\pm$ {half:.2}")).unwrap_or_default();
    let change = mark.change_percent.map(|percent| {
        let sign = match direction(percent) {
            Ordering::Less => "\\blacktriangledown",
            Ordering::Equal => "=",
            Ordering::Greater => "\\blacktriangle",
        };
        format!("\\textsuperscript{{${sign}$ {:.1}}}", percent.abs())
    });
    format!("{value}{half}{}", change.unwrap_or_default())
}

/// A text whose characters LaTeX does not take for commands.
fn escaped(text: &str) -> String {
    text.chars().fold(String::new(), |mut out, c| {
        match c {
            '\\' => out.push_str("\\textbackslash{}"),
            '~' => out.push_str("\\textasciitilde{}"),
            '^' => out.push_str("\\textasciicircum{}"),
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => out.extend(['\\', c]),
            c => out.push(c),
        }
        out
    })
}
