//! Configuration of everything behind perception.

use jrdb_calibration::FloorConfig;
use jrdb_graph::GraphConfig;
use jrdb_metrics::MetricsConfig;
use jrdb_parser::ParserConfig;
use jrdb_projection::ProjectionConfig;
use jrdb_search::SearchConfig;
use serde::{Deserialize, Serialize};

/// Configuration of every stage behind perception.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PipelineConfig {
    /// Most detections of a frame; of more, the most confident are kept and an issue says so. Relations are of pairs: 400
    /// things take 160 MB and 5 s in a debug build, 800 take 640 MB and 28 s (measured).
    pub detections_max: usize,
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

impl Default for PipelineConfig {
    /// Every stage's own default, and 300 detections: more than people and objects fit around a robot.
    fn default() -> Self {
        Self {
            detections_max: 300,
            floor: FloorConfig::default(),
            projection: ProjectionConfig::default(),
            graph: GraphConfig::default(),
            parser: ParserConfig::default(),
            search: SearchConfig::default(),
            sensitivity: false,
            metrics: MetricsConfig::default(),
        }
    }
}
