//! Configuration of everything behind perception.

use jrdb_calibration::FloorConfig;
use jrdb_graph::GraphConfig;
use jrdb_metrics::MetricsConfig;
use jrdb_parser::ParserConfig;
use jrdb_projection::ProjectionConfig;
use jrdb_search::SearchConfig;
use serde::{Deserialize, Serialize};

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
