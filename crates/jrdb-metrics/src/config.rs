//! How answers are judged.

use jrdb_types::score::{IouKind, Protocol};
use serde::{Deserialize, Serialize};

/// How answers are judged.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MetricsConfig {
    /// IoU on the plane (official) or on the circle.
    pub iou: IouKind,
    /// Circumference of the panorama, pixels. Without it IoU is planar whatever `iou` says, and
    /// [`Protocol::iou`] tells so.
    pub period_px: Option<f64>,
    /// Least IoU of a match.
    pub match_iou: f64,
    /// A digest of the whole set of questions, repeated in [`Protocol::questions_digest`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub questions_digest: Option<String>,
}

impl Default for MetricsConfig {
    /// As the JRDB-Reasoning evaluator: on the plane, a match from 0.5.
    fn default() -> Self {
        Self { iou: IouKind::Planar, period_px: None, match_iou: 0.5, questions_digest: None }
    }
}

impl MetricsConfig {
    /// The rules that answers are judged by under this configuration.
    ///
    /// ```
    /// use jrdb_metrics::MetricsConfig;
    /// use jrdb_types::score::IouKind;
    /// let mut config = MetricsConfig { iou: IouKind::Circular, ..MetricsConfig::default() };
    /// assert_eq!(config.protocol().iou, IouKind::Planar);
    /// config.period_px = Some(3760.0);
    /// assert_eq!(config.protocol().iou, IouKind::Circular);
    /// ```
    #[must_use]
    pub fn protocol(&self) -> Protocol {
        let period_px = self.circle_px();
        Protocol {
            version: Protocol::VERSION,
            iou: if period_px.is_some() { IouKind::Circular } else { IouKind::Planar },
            period_px,
            match_iou: self.match_iou,
            questions_digest: self.questions_digest.clone(),
        }
    }

    pub(crate) fn circle_px(&self) -> Option<f64> {
        self.period_px.filter(|period| self.iou == IouKind::Circular && *period > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_setting_is_refused() {
        let error = serde_json::from_str::<MetricsConfig>(r#"{"iuo": "planar"}"#).unwrap_err();
        assert!(error.to_string().contains("unknown field `iuo`"));
    }
}
