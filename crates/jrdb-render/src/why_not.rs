//! Why something is not in an answer, in words.

use jrdb_types::answer::{Reason, WhyNot};
use jrdb_types::score::Miss;
use jrdb_types::{Answer, EntityId};

use crate::check::{asked, found_or_unknown, margin};

/// Two probabilities that differ by less read the same.
const SAME: f64 = 0.005;

/// Why a thing is not in an answer: one line, or one line for each condition that fails.
///
/// ```
/// use jrdb_types::vocab::MatchPolicy;
/// use jrdb_types::{Answer, EntityId, FrameId, LateralConvention, Query};
/// let (frame, query) = (FrameId::default(), Query::default());
/// let answer = Answer::new(frame, &query, MatchPolicy::Ranked, LateralConvention::Physical);
/// let reason = jrdb_render::why_not(&answer, &EntityId::new("pedestrian", 7));
/// assert_eq!(reason, "there is no such candidate");
/// ```
#[must_use]
pub fn why_not(answer: &Answer, id: &EntityId) -> String {
    match answer.why_not(id) {
        WhyNot::Selected => "it is in the answer".into(),
        WhyNot::NoSuchThing => "there is no such candidate".into(),
        WhyNot::Outranked { probability, selected: None } => {
            format!("nothing is selected; its probability is {probability:.2}")
        }
        WhyNot::Outranked { probability, selected: Some(least) } if probability - least > -SAME => {
            "others satisfy more of what was asked".into()
        }
        WhyNot::Outranked { probability, selected: Some(least) } => {
            format!("others fit better: probability {probability:.2}, selected from {least:.2}")
        }
        WhyNot::Fails(reasons) => reasons.iter().map(reason).collect::<Vec<_>>().join("\n"),
    }
}

/// One difference between an answer and the truth, with the reason where the answer knows it: `#7 is not chosen: age young:
/// elderly (0.80)`.
///
/// ```
/// use jrdb_types::score::Miss;
/// use jrdb_types::vocab::MatchPolicy;
/// use jrdb_types::{Answer, EntityId, FrameId, LateralConvention, Query};
/// let (frame, query) = (FrameId::default(), Query::default());
/// let answer = Answer::new(frame, &query, MatchPolicy::Ranked, LateralConvention::Physical);
/// let miss = Miss::NotMeant(EntityId::new("pedestrian", 7));
/// assert_eq!(jrdb_render::miss(&miss, &answer), "#7 is not meant");
/// ```
#[must_use]
pub fn miss(miss: &Miss, answer: &Answer) -> String {
    match miss {
        Miss::NotDetected(there) => {
            format!("nothing was detected at {:.0}, {:.0} px", there.x, there.y)
        }
        Miss::NotSelected(id) => {
            format!("{} is not chosen: {}", id.short(), why_not(answer, id).replace('\n', "; "))
        }
        Miss::NotMeant(id) => format!("{} is not meant", id.short()),
    }
}

fn reason(reason: &Reason<'_>) -> String {
    let check = reason.check;
    let outside = check.measured.as_ref().filter(|measured| measured.margin < 0.0);
    let margin = outside.and_then(margin).map(|margin| format!(" ({margin})"));
    format!(
        "{:width$}{}: {}{}",
        "",
        asked(check),
        found_or_unknown(check),
        margin.unwrap_or_default(),
        width = 2 * reason.depth
    )
}
