//! What can go wrong between the stages.

use jrdb_types::{FrameId, Panicked, with_causes};

/// Why a frame or a question could not be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Perception failed on a frame.
    #[error("{source}")]
    Perception {
        /// Which frame.
        frame: FrameId,
        /// Why.
        source: jrdb_perception::PerceptionError,
    },
    /// A stage refused its input.
    #[error("{frame}: {source}")]
    Projection {
        /// Which frame.
        frame: String,
        /// Why.
        source: jrdb_projection::Error,
    },
    /// The rig is unusable.
    #[error("the rig is unusable: {}", with_causes(.0))]
    Rig(jrdb_projection::RigError),
    /// A question of which nothing is understood, or notation that does not fit together.
    #[error("{0}")]
    Query(String),
    /// Whole sentences were to be answered by a detector that takes none.
    #[error(
        "expected a detector that takes sentences (Florence-2, MM-Grounding-DINO or LLMDet), found none"
    )]
    NoGrounder,
    /// A part of the program panicked on a frame: a fault of the program, whatever the frame's files hold.
    #[error("{0}; please report it with the frame's files")]
    Panicked(#[from] Panicked),
}
