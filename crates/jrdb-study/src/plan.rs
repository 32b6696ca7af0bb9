//! What a study compares: its data, its methods, its tables.

use std::collections::BTreeSet;

use jrdb_types::Localizer;
use jrdb_types::score::{IouKind, Metric};
use jrdb_types::vocab::MatchPolicy;
use serde::{Deserialize, Deserializer, Serialize};

use crate::paper::Paper;
use crate::table::Role;

/// A study as its file describes it. Paths are relative to the file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// What the study is about, for headings.
    pub title: String,
    /// What the methods are asked.
    pub data: Data,
    /// What is compared.
    pub methods: Vec<Method>,
    /// What is shown; one table of all categories when absent.
    #[serde(default)]
    pub tables: Vec<TablePlan>,
    /// IoU on the plane (official) or on the circle.
    #[serde(default)]
    pub iou: IouKind,
    /// How intervals are found.
    #[serde(default)]
    pub intervals: Intervals,
    /// The method whose gap to perfection is split among the stages.
    #[serde(default)]
    pub error_budget: Option<String>,
}

/// Frames and questions.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Data {
    /// Scene folders, all their frames, with questions of their own.
    pub scenes: Vec<String>,
    /// The root of a JRDB tree.
    pub dataset: Option<String>,
    /// Sequences of the tree; `all` stands for every one, `@FILE` for a list.
    pub sequences: Vec<String>,
    /// Frame numbers `A..B`, B exclusive; all when absent.
    pub frames: Option<String>,
    /// A file of questions with their truth, or a list of files; the scenes' own when empty.
    #[serde(deserialize_with = "one_or_several")]
    pub questions: Vec<String>,
}

/// A text, or a list of texts.
fn one_or_several<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<String>, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Given {
        One(String),
        Several(Vec<String>),
    }
    Ok(match Given::deserialize(deserializer)? {
        Given::One(text) => vec![text],
        Given::Several(texts) => texts,
    })
}

/// One row of the tables.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Method {
    /// Its name in the tables and in the output folder.
    pub name: String,
    /// Where detections come from, as `--perception` has it.
    #[serde(default)]
    pub perception: Option<String>,
    /// Answers of another program: files, folders or globs.
    #[serde(default)]
    pub answers: Vec<String>,
    /// Whether the detector answers every question by itself.
    #[serde(default)]
    pub detector_alone: bool,
    /// How many of the asked attributes are demanded.
    #[serde(default = "ranked", rename = "match")]
    pub policy: MatchPolicy,
    /// How positions are found.
    #[serde(default)]
    pub localizer: Localizer,
    /// Whether others are compared with it; by default what answers without the pipeline is.
    #[serde(default)]
    pub role: Option<Role>,
}

fn ranked() -> MatchPolicy {
    MatchPolicy::Ranked
}

impl Method {
    /// Whether others are compared with it.
    #[must_use]
    pub fn role(&self) -> Role {
        let is_foreign = self.detector_alone || !self.answers.is_empty();
        self.role.unwrap_or(if is_foreign { Role::Baseline } else { Role::Method })
    }
}

/// One table.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TablePlan {
    /// Its title.
    pub title: String,
    /// Its categories, in order.
    pub categories: Vec<String>,
    /// Its metrics.
    #[serde(default = "headline_metrics")]
    pub metrics: Vec<Metric>,
    /// The table of the paper whose rows are quoted above the measured ones.
    #[serde(default)]
    pub quote: Option<String>,
    /// The methods that it shows; all when absent.
    #[serde(default)]
    pub methods: Vec<String>,
}

impl TablePlan {
    /// A table of the headline metrics of some categories, for all methods.
    pub fn of_all(title: impl Into<String>, categories: impl IntoIterator<Item = String>) -> Self {
        Self {
            title: title.into(),
            categories: categories.into_iter().collect(),
            metrics: headline_metrics(),
            quote: None,
            methods: Vec::new(),
        }
    }
}

fn headline_metrics() -> Vec<Metric> {
    vec![Metric::MapRanking, Metric::MiouGt]
}

/// How intervals are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Intervals {
    /// Bootstrap draws.
    pub draws: usize,
    /// Seed of the draws.
    pub seed: u64,
}

impl Default for Intervals {
    fn default() -> Self {
        Self { draws: 10_000, seed: 1 }
    }
}

/// What is wrong with a plan.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// It is no YAML of this form.
    #[error("expected a study as docs/evaluation.md describes it, found: {0}")]
    Form(String),
    /// A part of it contradicts another.
    #[error("{what}: expected {expected}, found {found}")]
    Content {
        /// Which part.
        what: String,
        /// What was expected.
        expected: String,
        /// What was found instead.
        found: String,
    },
}

fn content(
    what: impl Into<String>,
    expected: impl Into<String>,
    found: impl Into<String>,
) -> PlanError {
    PlanError::Content { what: what.into(), expected: expected.into(), found: found.into() }
}

impl Plan {
    /// Reads a plan.
    ///
    /// # Errors
    /// When it is not of this form or contradicts itself.
    pub fn from_yaml(text: &str) -> Result<Self, PlanError> {
        let plan: Self =
            serde_saphyr::from_str(text).map_err(|error| PlanError::Form(form(&error)))?;
        plan.check()?;
        Ok(plan)
    }

    fn check(&self) -> Result<(), PlanError> {
        self.check_data()?;
        self.check_methods()?;
        self.tables.iter().try_for_each(|table| self.check_table(table))
    }

    fn check_data(&self) -> Result<(), PlanError> {
        let Data { scenes, dataset, sequences, .. } = &self.data;
        match (scenes.is_empty(), dataset.is_some() && !sequences.is_empty()) {
            (true, true) | (false, false) => Ok(()),
            (true, false) => Err(content("data", "scenes, or dataset and sequences", "neither")),
            (false, true) => Err(content("data", "scenes, or dataset and sequences", "both")),
        }
    }

    fn check_methods(&self) -> Result<(), PlanError> {
        if self.methods.is_empty() {
            return Err(content("methods", "at least one", "none"));
        }
        let mut names = BTreeSet::new();
        for method in &self.methods {
            let what = || format!("method {:?}", method.name);
            if !names.insert(&method.name) {
                return Err(content(
                    "methods",
                    "names that differ",
                    format!("{:?} twice", method.name),
                ));
            }
            if !is_name(&method.name) {
                let expected =
                    "a name of letters, digits, spaces and -_.+ that begins with a letter or digit";
                return Err(content(what(), expected, format!("{:?}", method.name)));
            }
            match (&method.perception, method.answers.is_empty()) {
                (Some(_), true) => {}
                (None, false) if method.detector_alone => {
                    return Err(content(what(), "detector_alone beside perception", "answers"));
                }
                (None, false) => {}
                (Some(_), false) => return Err(content(what(), "perception or answers", "both")),
                (None, true) => return Err(content(what(), "perception or answers", "neither")),
            }
        }
        let Some(name) = &self.error_budget else { return Ok(()) };
        self.known_method("error_budget", name)?;
        let has_stages = |method: &Method| method.perception.is_some() && !method.detector_alone;
        if self.methods.iter().any(|method| method.name == *name && has_stages(method)) {
            return Ok(());
        }
        Err(content("error_budget", "a method that runs all stages", format!("{name:?}")))
    }

    fn check_table(&self, table: &TablePlan) -> Result<(), PlanError> {
        let what = format!("table {:?}", table.title);
        if table.categories.is_empty() || table.metrics.is_empty() {
            return Err(content(what, "categories and metrics", "none"));
        }
        table.methods.iter().try_for_each(|name| self.known_method(&what, name))?;
        let Some(number) = &table.quote else { return Ok(()) };
        if Paper::printed().table(number).is_none() {
            return Err(content(what, "quote: \"1\" or \"2\"", format!("{number:?}")));
        }
        if table.metrics != headline_metrics() {
            return Err(content(
                what,
                "the metrics map_ranking and miou_gt beside quoted rows",
                "others",
            ));
        }
        Ok(())
    }

    fn known_method(&self, what: &str, name: &str) -> Result<(), PlanError> {
        if self.methods.iter().any(|method| method.name == name) {
            return Ok(());
        }
        let known: Vec<&str> = self.methods.iter().map(|method| &*method.name).collect();
        Err(content(what, format!("one of the methods {}", known.join(", ")), format!("{name:?}")))
    }
}

/// Whether a name can be that of a folder on every system.
fn is_name(name: &str) -> bool {
    let allowed = |c: char| c.is_ascii_alphanumeric() || " -_.+".contains(c);
    name.chars().all(allowed)
        && name.starts_with(|c: char| c.is_ascii_alphanumeric())
        && !name.ends_with([' ', '.'])
}

/// What is wrong with the form, without the word that the reader's message begins with.
fn form(error: &serde_saphyr::Error) -> String {
    let text = error.to_string();
    text.strip_prefix("error: ").unwrap_or(&text).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAN: &str = "
title: t
data: {scenes: [a]}
methods:
  - {name: mine, answers: [a.jsonl]}
  - {name: demo, perception: demo, match: strict, localizer: mean}
tables: [{title: ages, categories: [age], quote: '1'}]
error_budget: demo
";

    fn error(old: &str, new: &str) -> String {
        assert!(PLAN.contains(old), "{old}");
        Plan::from_yaml(&PLAN.replace(old, new)).unwrap_err().to_string()
    }

    #[test]
    fn a_plan_says_what_is_compared_and_the_rest_has_its_usual_value() {
        let plan = Plan::from_yaml(PLAN).unwrap();
        assert_eq!(plan.methods[0].role(), Role::Baseline);
        assert_eq!(plan.methods[1].role(), Role::Method);
        assert_eq!(plan.methods[0].policy, MatchPolicy::Ranked);
        assert_eq!(plan.methods[1].localizer, Localizer::Mean);
        assert_eq!(plan.tables[0].metrics, [Metric::MapRanking, Metric::MiouGt]);
        assert_eq!(plan.intervals.draws, 10_000);
    }

    #[test]
    fn what_a_plan_names_must_be_there() {
        let unknown = error("error_budget: demo", "error_budget: deom");
        assert!(unknown.contains("one of the methods mine, demo, found \"deom\""), "{unknown}");
        let quote = error("quote: '1'", "quote: '3'");
        assert!(quote.contains("expected quote: \"1\" or \"2\""), "{quote}");
        let methods = error("categories: [age]", "categories: [age], methods: [ours]");
        assert!(methods.contains("table \"ages\""), "{methods}");
        assert!(error("title: t\n", "title: t\ntitel: t\n").contains("titel"));
    }

    #[test]
    fn contradictions_are_refused() {
        assert!(error("scenes: [a]", "scenes: [a], dataset: b, sequences: [c]").contains("both"));
        assert!(error("scenes: [a]", "dataset: b").contains("neither"));
        assert!(error("name: mine", "name: demo").contains("\"demo\" twice"));
        assert!(error("name: mine", "name: ../mine").contains("a name of letters"));
        assert!(error("answers: [a.jsonl]", "role: baseline").contains("neither"));
        assert!(error("perception: demo,", "perception: demo, answers: [b],").contains("both"));
        let budget = error("error_budget: demo", "error_budget: mine");
        assert!(budget.contains("a method that runs all stages"), "{budget}");
    }
}
