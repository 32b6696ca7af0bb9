//! What can go wrong between the stages.

/// Why a frame or a question could not be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
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
}

/// An error and its causes on one line; a cause that the error has already told is left out.
#[must_use]
pub fn with_causes(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(inner) = cause {
        let inner_text = inner.to_string();
        if !text.contains(&inner_text) {
            text = format!("{text}: {inner_text}");
        }
        cause = inner.source();
    }
    text
}
