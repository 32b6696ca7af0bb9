//! What offsets and their uncertainty come to.

use serde::{Deserialize, Serialize};

use super::{FitConfig, Measure};

/// Why an offset says nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Doubt {
    /// The cloud shows fewer ends of surfaces in the image than [`FitConfig::min_edges`].
    FewEdges,
    /// At the best offset the image's edges are hardly stronger than elsewhere.
    NoMatch,
    /// The best offset is at the end of the range searched.
    AtBorder,
    /// The sectors of azimuth disagree by more than the tolerance.
    Uncertain,
}

/// What one offset comes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Finding {
    /// Within the tolerance.
    Consistent,
    /// Beyond the tolerance.
    Off,
    /// Neither can be said.
    CannotTell(Doubt),
}

impl Finding {
    /// Compares an offset and its uncertainty with a tolerance of the same unit.
    #[must_use]
    pub fn of(measure: &Measure, tolerance: f64, config: &FitConfig) -> Self {
        let margin = config.coverage * measure.deviation;
        let size = measure.offset.abs();
        if measure.edges < config.min_edges {
            Self::CannotTell(Doubt::FewEdges)
        } else if measure.significance < config.min_significance {
            Self::CannotTell(Doubt::NoMatch)
        } else if measure.at_border {
            Self::CannotTell(Doubt::AtBorder)
        } else if margin > tolerance && size <= tolerance + margin {
            Self::CannotTell(Doubt::Uncertain)
        } else if size > tolerance {
            Self::Off
        } else {
            Self::Consistent
        }
    }
}

/// What all offsets together come to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Everything is within its tolerance.
    Consistent,
    /// Something is beyond its tolerance.
    Off,
    /// Nothing is beyond its tolerance, but something cannot be told.
    CannotTell,
}

impl Verdict {
    pub(super) fn of(findings: impl IntoIterator<Item = Finding>) -> Self {
        let worse = |verdict, finding| match (verdict, finding) {
            (Self::Off, _) | (_, Finding::Off) => Self::Off,
            (Self::CannotTell, _) | (_, Finding::CannotTell(_)) => Self::CannotTell,
            _ => Self::Consistent,
        };
        findings.into_iter().fold(Self::Consistent, worse)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finding(offset: f64, deviation: f64) -> Finding {
        let measure =
            Measure { offset, deviation, edges: 500, significance: 9.0, at_border: false };
        Finding::of(&measure, 0.05, &FitConfig::default())
    }

    #[test]
    fn an_offset_is_judged_by_its_size_when_it_is_certain() {
        assert_eq!(finding(-0.04, 0.01), Finding::Consistent);
        assert_eq!(finding(-0.06, 0.01), Finding::Off);
    }

    #[test]
    fn an_uncertain_offset_is_off_only_when_it_is_far_off() {
        assert_eq!(finding(0.08, 0.04), Finding::CannotTell(Doubt::Uncertain));
        assert_eq!(finding(0.0, 0.04), Finding::CannotTell(Doubt::Uncertain));
        assert_eq!(finding(0.14, 0.04), Finding::Off);
    }

    #[test]
    fn what_is_off_outweighs_what_is_unknown() {
        let unknown = Finding::CannotTell(Doubt::FewEdges);
        assert_eq!(Verdict::of([Finding::Consistent, unknown]), Verdict::CannotTell);
        assert_eq!(Verdict::of([Finding::Off, unknown]), Verdict::Off);
        assert_eq!(Verdict::of([Finding::Consistent]), Verdict::Consistent);
    }
}
