//! Tables as text, Markdown, LaTeX and CSV.

mod csv;
mod latex;
mod markdown;
mod text;

pub use csv::csv;
pub use latex::latex;
pub use markdown::markdown;
pub use text::text;

use std::cmp::Ordering;

use crate::table::{Cell, Mark};

/// What stands in a cell without a value.
const NOTHING: &str = "-";
/// What stands in the first cell of a method that failed.
const FAILED: &str = "failed";

/// A value with half the width of its interval: `16.53 ±1.20`.
fn value(cell: &Cell) -> String {
    let value = number(cell.value);
    cell.half_width().map_or_else(|| value.clone(), |half| format!("{value} ±{half:.2}"))
}

/// A number with two decimals; of small ones two digits.
fn number(value: f64) -> String {
    const SMALL: f64 = 0.1;
    if value != 0.0 && value.abs() < SMALL { format!("{value:.4}") } else { format!("{value:.2}") }
}

/// Whether a change goes up or down, as far as one decimal tells.
fn direction(percent: f64) -> Ordering {
    const SHOWN: f64 = 0.05;
    if percent.abs() < SHOWN { Ordering::Equal } else { percent.total_cmp(&0.0) }
}

/// A change with its sign as a triangle, as the paper prints it: `▲35.7`.
fn change(mark: &Mark) -> Option<String> {
    let percent = mark.change_percent?;
    let sign = match direction(percent) {
        Ordering::Less => '▼',
        Ordering::Equal => '=',
        Ordering::Greater => '▲',
    };
    Some(format!("{sign}{:.1}", percent.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::{Origin, Role, Row, Table, Unit};

    fn row(method: &str, role: Role, origin: Origin, cells: &[Option<Cell>]) -> Row {
        Row { method: method.into(), role, origin, cells: cells.to_vec(), failure: None }
    }

    fn example() -> Table {
        let plain = |percent| Some(Cell::plain(percent));
        let sure = Some(Cell { value: 40.0, interval: Some([37.5, 42.5]) });
        let failed = Row {
            failure: Some("no weights".into()),
            ..row("broken", Role::Method, Origin::Measured, &[None, None, None, None])
        };
        Table {
            title: "Ages, and more".into(),
            unit: Unit::Percent,
            categories: vec!["age".into(), "gender-age-race-distance-SR/robot".into()],
            metrics: vec!["mAP".into(), "mIoU".into()],
            rows: vec![
                row(
                    "printed_1",
                    Role::Baseline,
                    Origin::Quoted,
                    &[plain(9.0), plain(8.0), None, None],
                ),
                row(
                    "weak",
                    Role::Baseline,
                    Origin::Measured,
                    &[plain(20.0), plain(30.0), plain(1.0), None],
                ),
                row("mine", Role::Method, Origin::Measured, &[sure, plain(15.0), plain(1.0), None]),
                failed,
            ],
            notes: vec!["A note.".into()],
        }
    }

    #[test]
    fn a_table_is_written_for_terminals_documents_papers_and_programs() {
        insta::assert_snapshot!("text", text(&example()));
        insta::assert_snapshot!("markdown", markdown(&example()));
        insta::assert_snapshot!("latex", latex(&example()));
        insta::assert_snapshot!("csv", csv(&example()));
    }
}
