//! Search over small hand-made and random graphs.

pub(crate) mod asked;
pub(crate) mod graphs;
mod laws;
mod noise;
mod oracle;
mod recordings;
mod relations;
mod told;

use jrdb_types::vocab::MatchPolicy;
use jrdb_types::*;

use crate::{SearchConfig, search};

/// A question for people of whom all this holds.
fn ask(conditions: Vec<Condition>) -> Query {
    Query { target: Pattern { conditions, ..Pattern::default() }, ..Query::default() }
}

fn under(policy: MatchPolicy) -> SearchConfig {
    SearchConfig { policy, ..SearchConfig::default() }
}

/// Numbers of the selected ids.
fn selected(graph: &SceneGraph, query: &Query, policy: MatchPolicy) -> Vec<u32> {
    search(graph, query, &under(policy)).selection.iter().map(|id| id.number).collect()
}

fn strictly(graph: &SceneGraph, conditions: Vec<Condition>) -> Vec<u32> {
    selected(graph, &ask(conditions), MatchPolicy::Strict)
}
