//! Whether two runs were judged by the same rules.

use jrdb_types::score::Protocol;

/// Two runs were judged by different rules.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("expected {field} {expected}, found {found}")]
pub struct ProtocolMismatch {
    /// The field of [`Protocol`] that differs.
    pub field: &'static str,
    /// Its value in the first run.
    pub expected: String,
    /// Its value in the other.
    pub found: String,
}

/// Names the first field in which two protocols differ.
pub(crate) fn check(expected: &Protocol, found: &Protocol) -> Result<(), ProtocolMismatch> {
    let none = || "none".to_owned();
    let number = |value: Option<f64>| value.map_or_else(none, |value| value.to_string());
    let text = |value: &Option<String>| value.clone().unwrap_or_else(none);
    let fields = |of: &Protocol| {
        [
            ("version", of.version.to_string()),
            ("iou", format!("{:?}", of.iou).to_lowercase()),
            ("period_px", number(of.period_px)),
            ("match_iou", of.match_iou.to_string()),
            ("questions_digest", text(&of.questions_digest)),
        ]
    };
    let pairs = fields(expected).into_iter().zip(fields(found));
    for ((field, expected), (_, found)) in pairs {
        if expected != found {
            return Err(ProtocolMismatch { field, expected, found });
        }
    }
    Ok(())
}
