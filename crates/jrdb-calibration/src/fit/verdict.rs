//! What offsets and their uncertainty come to.

use jrdb_types::calibration::{Doubt, Finding, Measure, Verdict};

use super::FitConfig;

/// Compares an offset and its uncertainty with a tolerance of the same unit.
pub(super) fn finding(measure: &Measure, tolerance: f64, config: &FitConfig) -> Finding {
    let margin = config.coverage * measure.deviation;
    let size = measure.offset.abs();
    if measure.edges < config.min_edges {
        Finding::CannotTell(Doubt::FewEdges)
    } else if measure.significance < config.min_significance {
        Finding::CannotTell(Doubt::NoMatch)
    } else if measure.at_border {
        Finding::CannotTell(Doubt::AtBorder)
    } else if margin > tolerance && size <= tolerance + margin {
        Finding::CannotTell(Doubt::Uncertain)
    } else if size > tolerance {
        Finding::Off
    } else {
        Finding::Consistent
    }
}

/// What all offsets together come to.
pub(super) fn verdict(findings: impl IntoIterator<Item = Finding>) -> Verdict {
    let worse = |verdict, finding| match (verdict, finding) {
        (Verdict::Off, _) | (_, Finding::Off) => Verdict::Off,
        (Verdict::CannotTell, _) | (_, Finding::CannotTell(_)) => Verdict::CannotTell,
        _ => Verdict::Consistent,
    };
    findings.into_iter().fold(Verdict::Consistent, worse)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(offset: f64, deviation: f64) -> Finding {
        let measure =
            Measure { offset, deviation, edges: 500, significance: 9.0, at_border: false };
        finding(&measure, 0.05, &FitConfig::default())
    }

    #[test]
    fn an_offset_is_judged_by_its_size_when_it_is_certain() {
        assert_eq!(found(-0.04, 0.01), Finding::Consistent);
        assert_eq!(found(-0.06, 0.01), Finding::Off);
    }

    #[test]
    fn an_uncertain_offset_is_off_only_when_it_is_far_off() {
        assert_eq!(found(0.08, 0.04), Finding::CannotTell(Doubt::Uncertain));
        assert_eq!(found(0.0, 0.04), Finding::CannotTell(Doubt::Uncertain));
        assert_eq!(found(0.14, 0.04), Finding::Off);
    }

    #[test]
    fn what_is_off_outweighs_what_is_unknown() {
        let unknown = Finding::CannotTell(Doubt::FewEdges);
        assert_eq!(verdict([Finding::Consistent, unknown]), Verdict::CannotTell);
        assert_eq!(verdict([Finding::Off, unknown]), Verdict::Off);
        assert_eq!(verdict([Finding::Consistent]), Verdict::Consistent);
    }
}
