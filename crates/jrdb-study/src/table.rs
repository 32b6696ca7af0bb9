//! A table of results: methods in rows, categories in columns, one column for each metric of each.

use serde::{Deserialize, Serialize};

/// Where a row's numbers come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Origin {
    /// They are printed in the paper.
    Quoted,
    /// They were measured in this study.
    Measured,
}

impl Origin {
    /// Both, in the order in which a table shows them.
    pub const ALL: [Self; 2] = [Self::Quoted, Self::Measured];

    /// How a table heads its rows.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Quoted => "quoted from the paper",
            Self::Measured => "measured here",
        }
    }
}

/// What a method is compared as.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Others are compared with it.
    Baseline,
    /// It is compared with the best baseline.
    #[default]
    Method,
}

/// What the numbers of a table are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    /// Percent.
    #[default]
    Percent,
    /// Thousand millions.
    Billions,
    /// Those that the columns state.
    Mixed,
}

impl Unit {
    /// How a table states it.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Percent => "%",
            Self::Billions => "billions",
            Self::Mixed => "",
        }
    }
}

/// One result.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// The value, in the table's unit.
    pub value: f64,
    /// Its 95 % interval, in the table's unit, where there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interval: Option<[f64; 2]>,
}

impl Cell {
    /// A value without an interval.
    #[must_use]
    pub fn plain(value: f64) -> Self {
        Self { value, interval: None }
    }

    /// Half the width of the interval, in the table's unit.
    #[must_use]
    pub fn half_width(&self) -> Option<f64> {
        self.interval.map(|[low, high]| (high - low) / 2.0)
    }
}

/// The results of one method.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The method's name.
    pub method: String,
    /// Whether it is a baseline.
    pub role: Role,
    /// Where its numbers come from.
    pub origin: Origin,
    /// One cell per column, in the order of [`Table::columns`]; absent where nothing was asked.
    pub cells: Vec<Option<Cell>>,
    /// Why the method has no results, where it failed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
}

/// A table of results.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// What it shows.
    pub title: String,
    /// What its numbers are.
    #[serde(default)]
    pub unit: Unit,
    /// The categories of questions.
    pub categories: Vec<String>,
    /// The metrics shown of each category, by name.
    pub metrics: Vec<String>,
    /// One row per method.
    pub rows: Vec<Row>,
    /// What a reader has to know.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
}

/// What a cell is among the others of its column and origin.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Mark {
    /// Whether it is the best of the baselines.
    pub best_baseline: bool,
    /// Change against the best baseline, in percent of that; only of methods.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub change_percent: Option<f64>,
}

impl Table {
    /// Category and metric of every column.
    pub fn columns(&self) -> impl Iterator<Item = (&str, &str)> {
        self.categories.iter().flat_map(|category| {
            self.metrics.iter().map(move |metric| (category.as_str(), metric.as_str()))
        })
    }

    /// The rows of one origin.
    pub fn rows_of(&self, origin: Origin) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(move |row| row.origin == origin)
    }

    /// The best value among the baselines of one origin. Numbers that are quoted and
    /// numbers that are measured here are never compared: they may be about different data.
    #[must_use]
    pub fn best_baseline(&self, origin: Origin, column: usize) -> Option<f64> {
        let baselines = self.rows_of(origin).filter(|row| row.role == Role::Baseline);
        let values = baselines.filter_map(|row| Some(row.cells.get(column)?.as_ref()?.value));
        values.max_by(f64::total_cmp)
    }

    /// What the cell of a row and column is among the others.
    #[must_use]
    pub fn mark(&self, row: &Row, column: usize) -> Mark {
        let best = self.best_baseline(row.origin, column);
        let (Some(Some(cell)), Some(best)) = (row.cells.get(column), best) else {
            return Mark::default();
        };
        match row.role {
            Role::Baseline => Mark { best_baseline: cell.value == best, change_percent: None },
            Role::Method => Mark {
                best_baseline: false,
                change_percent: (best > 0.0).then(|| (cell.value / best - 1.0) * 100.0),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(method: &str, role: Role, origin: Origin, percent: f64) -> Row {
        let cells = vec![Some(Cell::plain(percent))];
        Row { method: method.into(), role, origin, cells, failure: None }
    }

    fn table(rows: Vec<Row>) -> Table {
        let (categories, metrics) = (vec!["age".into()], vec!["mAP".into()]);
        let unit = Unit::Percent;
        Table { title: "t".into(), unit, categories, metrics, rows, notes: Vec::new() }
    }

    #[test]
    fn a_method_is_compared_with_the_best_baseline_of_its_own_origin() {
        let table = table(vec![
            row("quoted best", Role::Baseline, Origin::Quoted, 90.0),
            row("weak", Role::Baseline, Origin::Measured, 10.0),
            row("best", Role::Baseline, Origin::Measured, 20.0),
            row("ours", Role::Method, Origin::Measured, 25.0),
        ]);
        let mark = |at: usize| table.mark(&table.rows[at], 0);
        assert_eq!(mark(3).change_percent, Some(25.0));
        assert_eq!([mark(1), mark(2)].map(|mark| mark.best_baseline), [false, true]);
        assert!(mark(0).best_baseline);
    }

    #[test]
    fn without_a_baseline_or_against_zero_there_is_no_change() {
        let alone = table(vec![row("ours", Role::Method, Origin::Measured, 25.0)]);
        assert_eq!(alone.mark(&alone.rows[0], 0), Mark::default());
        let zero = row("none", Role::Baseline, Origin::Measured, 0.0);
        let against_zero = table(vec![zero, alone.rows[0].clone()]);
        assert_eq!(against_zero.mark(&against_zero.rows[1], 0).change_percent, None);
    }
}
