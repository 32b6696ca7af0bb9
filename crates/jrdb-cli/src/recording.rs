//! Questions about time, asked of all frames of a recording.

use std::collections::BTreeMap;

use jrdb_search::Pooling;
use jrdb_types::{FrameId, Question, SceneGraph};

use crate::run::FrameResult;
use jrdb_pipeline::query::{read_or_report, speaks_of_time};
use jrdb_pipeline::{Asked, FrameOutput, PipelineConfig};

/// A question about time is asked once of every recording it is about, not of every frame.
///
/// Recordings come in the order of their names, questions in theirs. A question with frames of its own is asked where
/// its first frame is; one that was typed is asked of every recording.
pub(crate) fn ask(
    frames: &[FrameResult],
    questions: &[Vec<Question>],
    config: &PipelineConfig,
) -> Vec<Asked> {
    let mut recordings: BTreeMap<&str, Vec<(&FrameId, &FrameOutput)>> = BTreeMap::new();
    for frame in frames {
        if let Ok(output) = &frame.output {
            recordings.entry(&frame.id.sequence).or_default().push((&frame.id, output));
        }
    }
    let about = |name: &str| {
        let of_frames = frames.iter().zip(questions).filter(|(frame, _)| frame.id.sequence == name);
        let mut about: Vec<Question> = Vec::new();
        for question in of_frames.flat_map(|(_, questions)| questions) {
            let is_told =
                |told: &Question| told.text == question.text && told.slots == question.slots;
            let query = read_or_report(&question.text, &config.parser);
            if speaks_of_time(question, &query) && !about.iter().any(is_told) {
                about.push(question.clone());
            }
        }
        about
    };
    let each = recordings.iter().flat_map(|(name, outputs)| {
        let mut graphs: Vec<SceneGraph> =
            outputs.iter().map(|(_, output)| output.graph.clone()).collect();
        if config.search.pooling == Pooling::PerCondition {
            // The benchmark's engine, whose edges carry no frame.
            jrdb_graph::make_timeless(&mut graphs);
        }
        about(name)
            .into_iter()
            .map(move |question| one(question, &graphs, config))
            .collect::<Vec<_>>()
    });
    each.collect()
}

fn one(question: Question, graphs: &[SceneGraph], config: &PipelineConfig) -> Asked {
    let query = read_or_report(&question.text, &config.parser);
    let place = |number: &u32| graphs.iter().position(|graph| graph.frame.frame == *number);
    let slots: Vec<Vec<usize>> =
        question.slots.iter().map(|frames| frames.iter().filter_map(place).collect()).collect();
    let slots = (!slots.is_empty()).then_some(slots.as_slice());
    let answer = jrdb_search::search_frames(graphs, slots, &query, &config.search);
    Asked { question, query, answer }
}
