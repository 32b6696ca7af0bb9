//! One line per number, for other programs.

use std::fmt::Write as _;

use crate::table::{Origin, Role, Table, Unit};

/// The table as comma-separated values, one line per cell.
///
/// Columns: table, origin, role, method, category, metric, unit, value, low, high, best_baseline,
/// change_percent, failure. Numbers have all their digits; what is absent is empty.
#[must_use]
pub fn csv(table: &Table) -> String {
    let mut out = String::from(
        "table,origin,role,method,category,metric,unit,value,low,high,best_baseline,change_percent,\
         failure\n",
    );
    for row in &table.rows {
        for (column, (category, metric)) in table.columns().enumerate() {
            let (cell, mark) = (row.cells.get(column).copied().flatten(), table.mark(row, column));
            let number = |value: Option<f64>| value.map(|v| v.to_string()).unwrap_or_default();
            let [low, high] = [0, 1].map(|end| number(cell.and_then(|c| Some(c.interval?[end]))));
            let fields = [
                quoted(&table.title),
                origin(row.origin).into(),
                role(row.role).into(),
                quoted(&row.method),
                quoted(category),
                quoted(metric),
                unit(table.unit).into(),
                number(cell.map(|cell| cell.value)),
                low,
                high,
                mark.best_baseline.to_string(),
                number(mark.change_percent),
                quoted(row.failure.as_deref().unwrap_or_default()),
            ];
            let _ = writeln!(out, "{}", fields.join(","));
        }
    }
    out
}

fn origin(origin: Origin) -> &'static str {
    match origin {
        Origin::Quoted => "quoted",
        Origin::Measured => "measured",
    }
}

fn role(role: Role) -> &'static str {
    match role {
        Role::Baseline => "baseline",
        Role::Method => "method",
    }
}

fn unit(unit: Unit) -> &'static str {
    match unit {
        Unit::Percent => "percent",
        Unit::Billions => "billions",
        Unit::Mixed => "as_named",
    }
}

/// A text in quotation marks where a comma, a line or a quotation mark makes that necessary.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.into()
    }
}
