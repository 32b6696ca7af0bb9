//! Which frames a slot covers, and what is asked in them.

use std::sync::Arc;

use jrdb_graph::{BitSet, GraphIndex};
use jrdb_types::query::{Pick, Slot};
use jrdb_types::{Condition, Pattern, Query};

use crate::SearchConfig;
use crate::evaluation::Evaluated;
use crate::status::Meant;

/// One slot, made ready.
pub(super) struct Plan {
    /// Target and slot together, without the pick.
    pub(super) pattern: Pattern,
    pub(super) pick: Option<Pick>,
    /// Places in the recording.
    pub(super) frames: Vec<usize>,
    /// Whether it must hold in most of the frames, or in any.
    pub(super) lasts: bool,
    pub(super) slot: Arc<Slot>,
}

/// One frame of a slot, evaluated.
pub(super) struct Moment<'q> {
    /// Place of the frame in the recording.
    pub(super) frame: usize,
    pub(super) evaluated: Evaluated<'q>,
    /// What matches, the pick included.
    pub(super) holds: BitSet,
    /// What matches for sure, what may match, and whether there may be more.
    pub(super) meant: Meant,
}

/// The slots of a question; the whole recording where it has none.
pub(super) fn plans(
    frames: &[&GraphIndex<'_>],
    given: Option<&[Vec<usize>]>,
    query: &Query,
    config: &SearchConfig,
) -> Vec<Plan> {
    let given = given.unwrap_or_default();
    let count = query.slots.len().max(given.len()).max(1);
    (0..count)
        .map(|number| {
            let slot = query.slots.get(number).cloned().unwrap_or_default();
            let (frames, lasts) = match (given.get(number), slot.during_s) {
                (Some(given), _) => {
                    (given.iter().copied().filter(|&f| f < frames.len()).collect(), true)
                }
                (None, Some(seconds)) => (during(frames, seconds, config), true),
                (None, None) => ((0..frames.len()).collect(), query.slots.is_empty()),
            };
            let asked = together(&query.target, &slot.conditions);
            let pattern = Pattern { pick: None, ..asked };
            Plan { pattern, pick: query.target.pick.clone(), frames, lasts, slot: Arc::new(slot) }
        })
        .collect()
}

/// Conditions of the target and of a slot together.
fn together(target: &Pattern, more: &[Condition]) -> Pattern {
    let conditions = target.conditions.iter().chain(more).cloned().collect();
    Pattern { conditions, ..target.clone() }
}

/// Frames from one moment to another, both included; seconds count from the first frame's number.
fn during(frames: &[&GraphIndex<'_>], [from, to]: [f64; 2], config: &SearchConfig) -> Vec<usize> {
    let number = |index: &GraphIndex<'_>| f64::from(index.scene().frame.frame);
    let first = frames.first().map_or(0.0, |index| number(index));
    let [low, high] = [from, to].map(|s| first + (s * config.frames_per_second).round());
    let covered = frames.iter().enumerate().filter(|(_, index)| {
        let number = number(index);
        number >= low && number <= high
    });
    covered.map(|(place, _)| place).collect()
}
