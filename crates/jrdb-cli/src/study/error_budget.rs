//! What each part of the truth is worth to a method: every subset of the parts is given in turn.

use jrdb_metrics::{MetricsConfig, Outcome, from_judgements};
use jrdb_models::PerceptionSource;
use jrdb_perception::Perceive;
use jrdb_pipeline::{Pipeline, PipelineConfig};
use jrdb_study::{Method, TRUTHS, Truths, Views, inject};
use jrdb_types::score::{Budget, Metric, QuestionScore};
use jrdb_types::{Detections, Localizer, Query};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;

use super::{Step, Study};
use crate::Error;
use crate::questions::{FrameQuestions, ReadQuestion};
use crate::run::metrics_config;
use crate::run_options::RunOptions;
use crate::source::{FrameSource, list_frames, open_perception};

/// The metrics whose gap is split.
const METRICS: [Metric; 3] = [Metric::Exact, Metric::MiouGt, Metric::MapRanking];
/// How many subsets there are of the parts of the truth that a frame is given: all but the last.
const VIEWS: usize = 1 << (TRUTHS.len() - 1);

/// The judgements of every subset of the truth.
type Judged = Vec<Vec<QuestionScore>>;

impl Study<'_> {
    /// The gap of the plan's method, split among the parts of the truth, by metric.
    pub(super) fn budget(
        &self,
        on_step: &mut impl FnMut(&Step<'_>),
    ) -> Result<Vec<(Metric, Budget)>, Error> {
        let named = |method: &&Method| Some(&method.name) == self.plan.error_budget.as_ref();
        let Some(method) = self.plan.methods.iter().find(named) else { return Ok(Vec::new()) };
        on_step(&Step { method: "error budget", what: method.name.clone() });
        let (judged, metrics) = self.judge_subsets(method)?;
        let scores = judged.into_iter().map(|all| from_judgements(metrics.protocol(), all));
        let overall: Vec<_> = scores.map(|scores| scores.overall).collect();
        let parts = overall.len().ilog2() as usize;
        let parts = TRUTHS[..parts].iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        let split = |metric: Metric| {
            let values: Option<Vec<f64>> = overall.iter().map(|one| metric.of(one)).collect();
            let budget = jrdb_metrics::budget(&parts, &values?);
            Some(budget.map(|budget| (metric, budget)).map_err(|e| Error::Usage(e.to_string())))
        };
        METRICS.into_iter().filter_map(split).collect()
    }

    /// The judgements of all questions, with each subset of the truth.
    fn judge_subsets(&self, method: &Method) -> Result<(Judged, MetricsConfig), Error> {
        let options = RunOptions { sources: self.sources.clone(), ..self.run_options(method)? };
        let frames = list_frames(&options.sources, options.frames.as_ref(), &options.robot)?;
        let questions = questions_about(&frames, &options)?;
        let meant = meant(&questions)?;
        let demographics = options.demographics.for_queries(questions.queries());
        let open = |source| open_perception(source, &frames, &options.engine, demographics);
        let sight = Sight {
            eyes: Arc::new(open(&options.perception)?),
            labels: Arc::new(open(&PerceptionSource::Labels)?),
            config: &options.config,
            metrics: metrics_config(&options.config, frames[0].robot.image()),
        };
        let work = frames.par_iter().zip(&questions.per_frame);
        let found = work.map(|(frame, questions)| {
            if self.options.interrupt.came().is_some() {
                return Err(Error::Usage("interrupted in the error budget".into()));
            }
            let asked = Asked { questions, meant: meant.as_ref() };
            sight.judge(frame, asked)
        });
        let found: Vec<Judged> = found.collect::<Result<_, _>>()?;
        let subsets = if meant.is_some() { 2 * VIEWS } else { VIEWS };
        let mut judged: Judged = vec![Vec::new(); subsets];
        for frame in found {
            judged.iter_mut().zip(frame).for_each(|(all, found)| all.extend(found));
        }
        Ok((judged, sight.metrics))
    }
}

/// The questions, to be judged by boxes: names differ from subset to subset.
fn questions_about(frames: &[FrameSource], options: &RunOptions) -> Result<FrameQuestions, Error> {
    let files = &options.questions;
    let (sources, parser) = (&options.sources, &options.config.parser);
    let mut questions = FrameQuestions::gather(frames, &[], files, sources, parser)?;
    questions.forget_names();
    Ok(questions)
}

/// What questions mean, by their words.
type Meant = BTreeMap<String, Query>;

/// What all questions mean, or none where one of them does not say so.
fn meant(questions: &FrameQuestions) -> Result<Option<Meant>, Error> {
    let mut meant = Meant::new();
    for ReadQuestion { question, .. } in questions.per_frame.iter().flatten() {
        let Some(notation) = &question.query else { return Ok(None) };
        let query = jrdb_parser::notation::read(notation).map_err(|error| {
            Error::Usage(format!("the query of {:?}: {error}: {notation}", question.text))
        })?;
        meant.insert(question.text.clone(), query);
    }
    Ok(Some(meant))
}

/// The questions about a frame.
#[derive(Clone, Copy)]
struct Asked<'a> {
    questions: &'a [ReadQuestion],
    /// What they mean, where it is known of all questions of the study.
    meant: Option<&'a Meant>,
}

/// What is needed to look at a frame with and without parts of the truth.
struct Sight<'s> {
    eyes: Arc<dyn Perceive>,
    labels: Arc<dyn Perceive>,
    config: &'s PipelineConfig,
    metrics: MetricsConfig,
}

impl Sight<'_> {
    /// The judgements of a frame's questions, for each subset of the truth.
    fn judge(&self, frame: &FrameSource, asked: Asked<'_>) -> Result<Judged, Error> {
        let seen = self.pipeline(frame, &self.eyes, Truths::default());
        let seen = placed(&seen.see(frame.read())?);
        let truth = self.pipeline(frame, &self.labels, Truths::default());
        let truth = truth.perceive(&frame.image_only())?;
        let views = Views { seen: &seen, truth: &truth };
        let given = |set| self.given(frame, views, Truths(set), asked);
        let found: Vec<[Vec<QuestionScore>; 2]> =
            (0..VIEWS).into_par_iter().map(given).collect::<Result<_, _>>()?;
        let (as_read, as_meant): (Judged, Judged) =
            found.into_iter().map(|[read, meant]| (read, meant)).unzip();
        // With the meaning of questions given, subsets come behind those without.
        let as_meant = if asked.meant.is_some() { as_meant } else { Vec::new() };
        Ok([as_read, as_meant].concat())
    }

    /// The judgements of questions as they were read, and as they are meant.
    fn given(
        &self,
        frame: &FrameSource,
        views: Views<'_>,
        truths: Truths,
        asked: Asked<'_>,
    ) -> Result<[Vec<QuestionScore>; 2], Error> {
        let pipeline = self.pipeline(frame, &self.eyes, truths);
        let scene = pipeline.see_detections(frame.read(), inject(views, truths))?;
        let of_now = asked.questions.iter().filter(|one| !one.speaks_of_time());
        let judge = |one: &ReadQuestion, query: &Query| {
            let answer = scene.ask_query(query);
            let outcome = Outcome { question: &one.question, answer: &answer };
            jrdb_metrics::score(outcome, &self.metrics)
        };
        let both = of_now.filter_map(|one| {
            let as_read = judge(one, &one.query)?;
            let meant = asked.meant.and_then(|meant| meant.get(&one.question.text));
            let as_meant = meant.and_then(|query| judge(one, query));
            Some((as_read.clone(), as_meant.unwrap_or(as_read)))
        });
        let (as_read, as_meant) = both.unzip();
        Ok([as_read, as_meant])
    }

    /// True positions are boxes in space that come with the detections.
    fn pipeline(&self, frame: &FrameSource, eyes: &Arc<dyn Perceive>, truths: Truths) -> Pipeline {
        let mut config = self.config.clone();
        if truths.has(Truths::POSITION) {
            config.projection.localizer = Localizer::Given;
        }
        Pipeline::sharing(frame.robot.clone(), eyes.clone(), Arc::new(config))
    }
}

/// The detections of a scene with the boxes in space that its points gave them.
fn placed(scene: &jrdb_pipeline::Scene) -> Detections {
    let mut detections = scene.detections().clone();
    for detection in &mut detections.detections {
        let entity = scene.entities().entities.iter().find(|one| one.id == detection.id);
        detection.box3d = detection.box3d.or_else(|| entity.and_then(|one| one.box3d));
    }
    detections
}
