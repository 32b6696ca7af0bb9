//! Tables filled with what methods came to.

use jrdb_types::score::{Estimate, IntervalWarning, Intervals, Metric, Scores};

use crate::paper::Paper;
use crate::plan::{Method, TablePlan};
use crate::table::{Cell, Origin, Role, Row, Table, Unit};

/// What a method came to.
#[derive(Debug, Clone, PartialEq)]
pub enum MethodResult {
    /// Its scores with their intervals.
    Scored(Box<Scores>, Intervals),
    /// Why it has none.
    Failed(String),
}

/// The heading of a metric's column. The paper's two names stand for the two readings that this
/// project takes for its headline; the others say which they are.
#[must_use]
pub fn heading(metric: Metric) -> String {
    match metric {
        Metric::MapRanking => "mAP".into(),
        Metric::MiouGt => "mIoU".into(),
        other => other.name().into(),
    }
}

/// A table with the paper's rows, where the plan quotes them, above those measured here.
#[must_use]
pub fn table(plan: &TablePlan, measured: &[(&Method, &MethodResult)]) -> Table {
    let paper = Paper::printed();
    let printed = plan.quote.as_ref().and_then(|number| paper.table(number));
    let mut rows = printed.map_or_else(Vec::new, |printed| printed.rows_for(&plan.categories));
    let is_shown = |method: &Method| plan.methods.is_empty() || plan.methods.contains(&method.name);
    let shown = measured.iter().filter(|(method, _)| is_shown(method));
    rows.extend(shown.clone().map(|(method, result)| row(plan, method, result)));
    Table {
        title: plan.title.clone(),
        unit: Unit::Percent,
        categories: plan.categories.clone(),
        metrics: plan.metrics.iter().map(|metric| heading(*metric)).collect(),
        notes: notes(plan, &rows, shown.map(|(_, result)| *result)),
        rows,
    }
}

/// The paper's table of parameters above those counted here, in billions.
#[must_use]
pub fn parameter_table(counted: &[(String, f64)]) -> Table {
    let row = |origin| {
        move |(method, billions): (String, f64)| Row {
            method,
            role: Role::Method,
            origin,
            cells: vec![Some(Cell::plain(billions))],
            failure: None,
        }
    };
    let quoted = Paper::printed().parameters.into_iter().map(row(Origin::Quoted));
    let counted = counted.iter().cloned().map(row(Origin::Measured));
    Table {
        title: "Parameters".into(),
        unit: Unit::Billions,
        categories: vec!["parameters".into()],
        metrics: vec!["billions".into()],
        rows: quoted.chain(counted).collect(),
        notes: vec!["Counted are the weights of each model's ONNX files, shared ones once.".into()],
    }
}

fn row(plan: &TablePlan, method: &Method, result: &MethodResult) -> Row {
    let columns = plan
        .categories
        .iter()
        .flat_map(|category| plan.metrics.iter().map(move |metric| (category.as_str(), *metric)));
    let (cells, failure) = match result {
        MethodResult::Scored(scores, intervals) => (
            columns.map(|(category, metric)| cell(scores, intervals, category, metric)).collect(),
            None,
        ),
        MethodResult::Failed(why) => (columns.map(|_| None).collect(), Some(why.clone())),
    };
    Row {
        method: method.name.clone(),
        role: method.role(),
        origin: Origin::Measured,
        cells,
        failure,
    }
}

fn cell(scores: &Scores, intervals: &Intervals, category: &str, metric: Metric) -> Option<Cell> {
    let value = metric.of(scores.categories.get(category)?)?;
    let interval = estimate(intervals, category, metric).and_then(|estimate| estimate.interval);
    let percent = |value: f64| value * scale(metric);
    let interval = interval.map(|interval| [percent(interval.low), percent(interval.high)]);
    Some(Cell { value: percent(value), interval })
}

fn estimate<'i>(intervals: &'i Intervals, category: &str, metric: Metric) -> Option<&'i Estimate> {
    intervals.categories.get(category)?.iter().find(|estimate| estimate.metric == metric)
}

/// What a value is multiplied by: parts are shown in percent, errors of counts as they are.
fn scale(metric: Metric) -> f64 {
    if metric == Metric::CountError { 1.0 } else { 100.0 }
}

/// What a reader has to know about a table.
fn notes<'r>(
    plan: &TablePlan,
    rows: &[Row],
    results: impl Iterator<Item = &'r MethodResult>,
) -> Vec<String> {
    let mut notes = Vec::new();
    if rows.iter().any(|row| row.origin == Origin::Quoted) {
        notes.push(
            "Quoted numbers are those that the paper prints, about its own data. They are not \
             compared with those measured here."
                .into(),
        );
    }
    let warnings: Vec<IntervalWarning> =
        results.flat_map(|result| warnings(plan, result)).collect();
    if warnings.contains(&IntervalWarning::OneRecording) {
        notes.push("One recording gives no interval.".into());
    }
    if warnings.contains(&IntervalWarning::FewRecordings) {
        notes.push("± from fewer than ten recordings: the intervals may be too narrow.".into());
    }
    notes
}

fn warnings(plan: &TablePlan, result: &MethodResult) -> Vec<IntervalWarning> {
    let MethodResult::Scored(_, intervals) = result else { return Vec::new() };
    let cells = plan.categories.iter().flat_map(|category| {
        plan.metrics.iter().filter_map(move |metric| estimate(intervals, category, *metric))
    });
    cells.filter_map(|estimate| estimate.warning).collect()
}
