//! One frame through all stages, in memory.

use std::sync::Arc;

use jrdb_calibration::FloorConfig;
use jrdb_graph::GraphConfig;
use jrdb_metrics::MetricsConfig;
use jrdb_parser::ParserConfig;
use jrdb_projection::{BaseCloud, ProjectionConfig, Scan, Sensors};
use jrdb_search::SearchConfig;
use jrdb_types::{
    Answer, Detections, Entities, FloorPlane, Image, Issue, PointCloud, Query, Question, SceneGraph,
};
use serde::{Deserialize, Serialize};

use crate::Error;
use crate::motion::Motions;
use crate::query::{read_or_report, speaks_of_time};
use crate::robot::Robot;

/// Configuration of every stage behind perception.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PipelineConfig {
    /// The floor in the cloud.
    pub floor: FloorConfig,
    /// Cloud and boxes to entities.
    pub projection: ProjectionConfig,
    /// Entities to a graph.
    pub graph: GraphConfig,
    /// English to a query.
    pub parser: ParserConfig,
    /// Graph and query to an answer.
    pub search: SearchConfig,
    /// Whether the smallest changes that change an answer are looked for; that takes many searches.
    pub sensitivity: bool,
    /// Answers to scores.
    pub metrics: MetricsConfig,
}

/// What the sensors and perception gave for one frame.
#[derive(Debug, Clone)]
pub struct FrameInput {
    /// Who is where in the image.
    pub detections: Detections,
    /// The panorama; pictures are drawn on it.
    pub image: Option<Image>,
    /// One sweep per LiDAR, in the sensors' frames.
    pub clouds: Vec<PointCloud>,
    /// The sensors and their mounts.
    pub robot: Arc<Robot>,
    /// What of the sweeps is missing.
    pub cloud_issues: Vec<Issue>,
    /// How things move, where that is known.
    pub motions: Motions,
}

/// A question, what it was read as, and what was answered.
#[derive(Debug, Clone, PartialEq)]
pub struct Asked {
    /// The question, with its truth where there is one.
    pub question: Question,
    /// What it was read as.
    pub query: Query,
    /// The answer.
    pub answer: Answer,
}

/// Every stage's output for one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameOutput {
    /// Perception's.
    pub detections: Detections,
    /// Projection's.
    pub entities: Entities,
    /// The graph stage's.
    pub graph: SceneGraph,
    /// Search's, one per question.
    pub asked: Vec<Asked>,
}

/// Projects detections with sweeps and what was missing of them, which comes first among the issues.
///
/// # Errors
/// When the detections do not fit the rig.
pub fn place(
    detections: &Detections,
    (clouds, cloud_issues): (&[PointCloud], &[Issue]),
    (robot, motions): (&Robot, &Motions),
    config: &PipelineConfig,
) -> Result<Entities, Error> {
    let fail = |source| Error::Projection { frame: detections.frame.to_string(), source };
    let scan = Scan {
        camera: robot.camera.as_deref(),
        floor: floor(clouds, robot, &config.floor),
        motions: Some(motions),
        ..Scan::new(clouds, &robot.rig)
    };
    let mut entities =
        jrdb_projection::project(detections, &scan, &config.projection).map_err(fail)?;
    entities.issues.splice(0..0, cloud_issues.iter().cloned());
    Ok(entities)
}

/// The floor under the robot, where enough of it is seen.
fn floor(clouds: &[PointCloud], robot: &Robot, config: &FloorConfig) -> Option<FloorPlane> {
    let sensors = Sensors::new(&robot.rig, robot.camera.as_deref()).ok()?;
    let cloud = BaseCloud::merge(clouds, &sensors, &mut Vec::new());
    let points: Vec<_> = (0..cloud.len()).map(|i| cloud.point(i)).collect();
    let floor = jrdb_calibration::fit_floor(&points, config).ok()?;
    let [x, y, z] = floor.normal;
    Some(FloorPlane { height_m: floor.height_m, slope: [-x / z, -y / z] })
}

/// Projects, builds the graph, and answers every question.
///
/// # Errors
/// When the detections do not fit the rig; everything else is an issue in the output.
pub fn process(
    input: &FrameInput,
    questions: &[Question],
    config: &PipelineConfig,
) -> Result<FrameOutput, Error> {
    let sweeps = (input.clouds.as_slice(), input.cloud_issues.as_slice());
    let entities = place(&input.detections, sweeps, (&input.robot, &input.motions), config)?;
    let graph = jrdb_graph::build(&entities, &config.graph);
    let asked = ask(&graph, questions, config);
    Ok(FrameOutput { detections: input.detections.clone(), entities, graph, asked })
}

/// Answers every question that one frame can answer; those that speak of time are left to [`crate::recording`].
fn ask(graph: &SceneGraph, questions: &[Question], config: &PipelineConfig) -> Vec<Asked> {
    let read = questions.iter().map(|q| (q, read_or_report(&q.text, &config.parser)));
    let of_now = read.filter(|(question, query)| !speaks_of_time(question, query));
    of_now
        .map(|(question, query)| {
            let mut answer = jrdb_search::search(graph, &query, &config.search);
            if config.sensitivity {
                answer.sensitivity = jrdb_search::sensitivity(graph, &query, &config.search);
            }
            Asked { question: question.clone(), query, answer }
        })
        .collect()
}
