//! An error with its causes on one line.

/// An error and its causes on one line. A cause whose text the error already contains is left out.
///
/// ```
/// let error = "x".parse::<u8>().unwrap_err();
/// assert_eq!(jrdb_types::with_causes(&error), "invalid digit found in string");
/// ```
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
