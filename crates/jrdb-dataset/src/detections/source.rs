//! The file that detections are read from.

use std::path::Path;

use serde::Deserialize;

use super::entry::Target;
use crate::Error;

/// What the file should be.
pub(super) const EXPECTED: &str = "a jrdb.detections artefact, a list of them, COCO results, a COCO dataset, or \
                        JRDB's detections_2d_stitched";

/// The file, and what its detections are for.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) path: &'a Path,
    pub(super) target: Target<'a>,
}

impl Source<'_> {
    pub(super) fn json<'t, T: Deserialize<'t>>(&self, text: &'t str) -> Result<T, Error> {
        serde_json::from_str(text).map_err(|source| Error::Json {
            expected: EXPECTED,
            path: self.path.into(),
            source,
        })
    }

    pub(super) fn content(&self, expected: impl Into<String>, found: impl Into<String>) -> Error {
        Error::content(self.path, expected, found)
    }
}
