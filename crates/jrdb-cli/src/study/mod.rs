//! A study: several methods on the same questions, and the tables that come of it.

mod error_budget;
mod files;
mod recording;
mod result;
mod slices;
mod truth;

use result::MethodRun;
pub use result::{StudyResult, budget_text};
use slices::Asked;
use truth::{Facts, Labelled, Truth};

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use jrdb_metrics::{BootstrapConfig, MetricsConfig};
use jrdb_models::loader::EngineOptions;
use jrdb_models::parameters::parameters;
use jrdb_pipeline::PipelineConfig;
use jrdb_study::{Method, MethodResult, Paper, Plan, Table, TablePlan};
use jrdb_types::{FrameId, Questions, Scores};

use crate::interrupt::Interrupt;
use crate::questions::read_all;
use crate::run::metrics_config;
use crate::run_options::RunOptions;
use crate::source::{FrameSource, RobotOptions, Source, list_frames};
use crate::{Error, answers, run_folder};

/// How a study is run, besides what its plan says.
#[derive(Debug, Clone, Default)]
pub struct StudyOptions {
    /// The plan.
    pub plan: PathBuf,
    /// Folder for its results.
    pub out: PathBuf,
    /// The root of a JRDB tree, instead of the plan's.
    pub dataset: Option<PathBuf>,
    /// Files of questions, instead of the plan's.
    pub questions: Vec<PathBuf>,
    /// How to choose an engine for models, and where they are.
    pub engine: EngineOptions,
    /// Worker threads; one per core when absent. The tables do not depend on it.
    pub threads: Option<usize>,
    /// Ends the study before the next recording.
    pub interrupt: Interrupt,
}

/// What a study does next, for whoever watches it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Step<'a> {
    /// The method.
    pub method: &'a str,
    /// The recording, or what else is being done.
    pub what: String,
}

/// Whether the paper has a category.
fn is_printed(category: &str) -> bool {
    let paper = Paper::printed();
    paper.tables.iter().any(|table| table.categories.iter().any(|name| name == category))
}

/// A study, ready to run.
pub struct Study<'o> {
    options: &'o StudyOptions,
    plan: Plan,
    sources: Vec<Source>,
    questions: Questions,
    questions_digest: String,
}

impl<'o> Study<'o> {
    /// Reads the plan and finds its recordings.
    ///
    /// # Errors
    /// When the plan is not one, or a recording that it names is not there.
    pub fn open(options: &'o StudyOptions) -> Result<Self, Error> {
        let path = &options.plan;
        let text = std::fs::read_to_string(path).map_err(|e| Error::file("read", path, e))?;
        let plan = Plan::from_yaml(&text)
            .map_err(|error| Error::Usage(format!("{}: {error}", path.display())))?;
        let (sources, questions, questions_digest) = Default::default();
        let mut study = Self { options, plan, sources, questions, questions_digest };
        study.take_paths()?;
        study.sources = study.find_sources()?;
        study.questions = study.read_questions()?;
        study.check_categories()?;
        study.questions_digest = answers::questions_digest(&study.questions.questions);
        Ok(study)
    }

    /// Puts the paths that the options name in place of the plan's.
    fn take_paths(&mut self) -> Result<(), Error> {
        let absolute = |path: &PathBuf| {
            let absolute = std::path::absolute(path).map_err(|e| Error::file("read", path, e))?;
            Ok::<_, Error>(absolute.display().to_string())
        };
        let data = &mut self.plan.data;
        if let Some(root) = &self.options.dataset {
            if data.dataset.is_none() {
                let expected = "a plan with data.dataset beside --dataset, found scenes";
                return Err(Error::Usage(format!("expected {expected}")));
            }
            data.dataset = Some(absolute(root)?);
        }
        if !self.options.questions.is_empty() {
            let paths = self.options.questions.iter().map(absolute);
            data.questions = paths.collect::<Result<_, _>>()?;
        }
        Ok(())
    }

    /// Whether every category of a table is one of a question or of the paper.
    fn check_categories(&self) -> Result<(), Error> {
        let asked: BTreeSet<&str> =
            self.questions.questions.iter().map(|question| question.category.as_str()).collect();
        for table in &self.plan.tables {
            let unknown = |name: &&String| !asked.contains(name.as_str()) && !is_printed(name);
            if let Some(name) = table.categories.iter().find(unknown) {
                let known: Vec<&str> = asked.into_iter().collect();
                let (title, known) = (&table.title, known.join(", "));
                return Err(Error::Usage(format!(
                    "table {title:?}: expected categories of the questions ({known}), found {name:?}"
                )));
            }
        }
        Ok(())
    }

    /// How many steps there are: each recording of each method, and the error budget.
    ///
    /// # Errors
    /// When a recording has no frames.
    pub fn step_count(&self) -> Result<usize, Error> {
        let frames = self.frame_sources()?;
        let recordings: BTreeSet<&str> = frames.iter().map(|f| f.id.sequence.as_str()).collect();
        let steps = |method: &Method| if method.answers.is_empty() { recordings.len() } else { 1 };
        let budget = usize::from(self.plan.error_budget.is_some());
        Ok(self.plan.methods.iter().map(steps).sum::<usize>() + budget)
    }

    /// Runs what is missing, and writes the tables. A method that fails is a row that says so.
    ///
    /// # Errors
    /// When results cannot be written, another process writes into the folder, or the study is
    /// interrupted.
    pub fn execute(&self, mut on_step: impl FnMut(&Step<'_>)) -> Result<StudyResult, Error> {
        let _lock = run_folder::lock(&self.options.out)?;
        let (mut results, mut failures) = (Vec::new(), Vec::new());
        let sources = self.frame_sources()?;
        let truth = Truth::open(&sources, &self.options.engine);
        let frames = sources.iter().map(|frame| (&frame.id, frame)).collect();
        let labelled = Labelled { frames, truth: &truth };
        let facts = truth.facts(&self.frames_asked_about(&labelled));
        for method in &self.plan.methods {
            let (result, failed) = self.method(method, &labelled, &facts, &mut on_step)?;
            failures.extend(failed.map(|why| (method.name.clone(), why)));
            results.push(result);
        }
        let measured: Vec<(&Method, &MethodResult)> =
            self.plan.methods.iter().zip(&results).collect();
        let plans = self.table_plans(&results);
        let tables: Vec<Table> =
            plans.iter().map(|plan| jrdb_study::table(plan, &measured)).collect();
        let budget = self.budget(&mut on_step)?;
        let parameters = self.parameters();
        let result = StudyResult { failures, tables, parameters, budget };
        files::write_study(&self.options.out, &self.plan, &result)?;
        Ok(result)
    }

    /// The parameters of the models that the methods use, as far as their files are there.
    fn parameters(&self) -> Table {
        let counted = parameters(&self.options.engine.models);
        let backbones = counted.map(|report| report.backbones).unwrap_or_default();
        let count = |method: &Method| {
            let source = method.perception.as_ref()?;
            let backbone = backbones.iter().find(|one| one.name == *source)?;
            let is_complete = backbone.missing.is_empty();
            is_complete.then(|| (method.name.clone(), backbone.count.parameters as f64 / 1e9))
        };
        let counts: Vec<_> = self.plan.methods.iter().filter_map(count).collect();
        jrdb_study::parameter_table(&counts)
    }

    /// The frames that questions are about.
    fn frames_asked_about<'s>(&self, labelled: &Labelled<'s>) -> Vec<&'s FrameSource> {
        let asked: BTreeSet<&FrameId> =
            self.questions.questions.iter().map(|question| &question.frame).collect();
        asked.iter().filter_map(|id| labelled.frames.get(*id).copied()).collect()
    }

    /// The scores of one method, or why it has none; and what failed.
    fn method(
        &self,
        method: &Method,
        labelled: &Labelled<'_>,
        facts: &Facts,
        on_step: &mut impl FnMut(&Step<'_>),
    ) -> Result<(MethodResult, Option<String>), Error> {
        let run = match method.answers.is_empty() {
            true => self.recordings(method, labelled, on_step),
            false => {
                on_step(&Step { method: &method.name, what: "answers".into() });
                self.answers_of(method).map(MethodRun::of_scores)
            }
        };
        match run {
            Ok(MethodRun { mut scores, failed, placements }) => {
                scores.protocol.questions_digest = Some(self.questions_digest.clone());
                let intervals = jrdb_metrics::intervals(&scores, &self.bootstrap());
                scores.intervals = Some(intervals.clone());
                files::write_scores(&self.options.out, &method.name, &scores)?;
                let asked = Asked { questions: &self.questions.questions, facts };
                let slices = slices::table(&method.name, asked, &scores);
                files::write_slices(&self.options.out, &method.name, &slices, &scores)?;
                if !placements.is_empty() {
                    files::write_places(&self.options.out, &method.name, &placements)?;
                }
                Ok((MethodResult::Scored(Box::new(scores), intervals), failed))
            }
            Err(error) if self.options.interrupt.came().is_some() => Err(error),
            Err(error) => {
                let why = jrdb_types::with_causes(&error);
                Ok((MethodResult::Failed(why.clone()), Some(why)))
            }
        }
    }

    fn bootstrap(&self) -> BootstrapConfig {
        let jrdb_study::Intervals { draws, seed } = self.plan.intervals;
        BootstrapConfig { draws, seed }
    }

    /// The tables of the plan; without any, one of all categories.
    fn table_plans(&self, results: &[MethodResult]) -> Vec<TablePlan> {
        if !self.plan.tables.is_empty() {
            return self.plan.tables.clone();
        }
        let scored = results.iter().filter_map(|result| match result {
            MethodResult::Scored(scores, _) => Some(scores.as_ref()),
            MethodResult::Failed(_) => None,
        });
        let names: BTreeSet<&String> = scored.flat_map(|scores| scores.categories.keys()).collect();
        vec![TablePlan::of_all(&self.plan.title, names.into_iter().cloned())]
    }

    /// The options of a run of one method, without its recordings.
    fn run_options(&self, method: &Method) -> Result<RunOptions, Error> {
        let mut options = RunOptions {
            frames: self.frames()?,
            engine: self.options.engine.clone(),
            threads: self.options.threads,
            interrupt: self.options.interrupt.clone(),
            baseline: method.detector_alone,
            questions: self.question_files(),
            ..RunOptions::default()
        };
        if let Some(perception) = &method.perception {
            options.perception = perception.parse()?;
        }
        options.config.search.policy = method.policy;
        options.config.projection.localizer = method.localizer;
        options.config.metrics.iou = self.plan.iou;
        Ok(options)
    }

    fn question_files(&self) -> Vec<PathBuf> {
        self.plan.data.questions.iter().map(|path| self.path(path)).collect()
    }

    fn frames(&self) -> Result<Option<std::ops::Range<u32>>, Error> {
        let Some(text) = &self.plan.data.frames else { return Ok(None) };
        let ends = text.split_once("..").and_then(|(a, b)| Some(a.parse().ok()?..b.parse().ok()?));
        let range = ends.filter(|range: &std::ops::Range<u32>| range.start < range.end);
        let expected = || format!("data: expected frames A..B with A < B, found {text:?}");
        range.map(Some).ok_or_else(|| Error::Usage(expected()))
    }

    /// A path of the plan: relative to the plan's folder.
    fn path(&self, path: &str) -> PathBuf {
        self.options.plan.parent().unwrap_or_else(|| Path::new("")).join(path)
    }

    fn find_sources(&self) -> Result<Vec<Source>, Error> {
        let data = &self.plan.data;
        let Some(root) = &data.dataset else {
            return Ok(data.scenes.iter().map(|scene| Source::Scene(self.path(scene))).collect());
        };
        let root = self.path(root);
        let lists = data.sequences.iter().map(|text| match text.strip_prefix('@') {
            Some(list) => format!("@{}", self.path(list).display()),
            None => text.clone(),
        });
        let names = crate::source::sequence_names(&root, &lists.collect::<Vec<_>>())?;
        Ok(names.into_iter().map(|name| Source::Sequence { root: root.clone(), name }).collect())
    }

    /// The questions about the frames of the study.
    fn read_questions(&self) -> Result<Questions, Error> {
        let frames = self.frame_sources()?;
        let frames: BTreeSet<&FrameId> = frames.iter().map(|frame| &frame.id).collect();
        let mut asked = self.all_questions()?;
        asked.questions.retain(|question| frames.contains(&question.frame));
        Ok(asked)
    }

    fn all_questions(&self) -> Result<Questions, Error> {
        let files = self.question_files();
        if !files.is_empty() {
            return read_all(&files);
        }
        let own = self.sources.iter().map(Source::own_questions);
        let own = own.collect::<Result<Vec<_>, _>>()?.into_iter();
        Ok(Questions { questions: own.flat_map(|own| own.questions).collect() })
    }

    /// How answers of other programs are judged: as those of the runs.
    fn metrics(&self) -> Result<MetricsConfig, Error> {
        let mut config = PipelineConfig::default();
        config.metrics.iou = self.plan.iou;
        Ok(metrics_config(&config, self.frame_sources()?[0].robot.image()))
    }

    fn frame_sources(&self) -> Result<Vec<FrameSource>, Error> {
        list_frames(&self.sources, self.frames()?.as_ref(), &RobotOptions::default())
    }

    /// The judgements of the answers of another program.
    fn answers_of(&self, method: &Method) -> Result<Scores, Error> {
        let specs: Vec<String> =
            method.answers.iter().map(|spec| self.path(spec).display().to_string()).collect();
        let metrics = self.metrics()?;
        let loaded = answers::load_answers(&specs)?;
        let matched = answers::match_answers(&self.questions.questions, loaded)?;
        Ok(matched.scores(&metrics))
    }
}
