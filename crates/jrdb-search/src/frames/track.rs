//! One thing over the frames of a recording.

use std::collections::BTreeMap;
use std::sync::Arc;

use jrdb_types::answer::{CandidateTrace, Check, Criterion, Finding, Unit};
use jrdb_types::{EntityId, PixelBox};

use super::plan::{Moment, Plan};
use crate::config::SlotOrder;
use crate::place;
use crate::searcher::Searcher;
use crate::value::Truth;

/// What a track came to.
pub(super) struct Track<'g> {
    pub(super) id: &'g EntityId,
    pub(super) bbox: PixelBox,
    pub(super) score: f64,
    pub(super) slots: Vec<InSlot>,
    /// Whether every slot is matched, in order where that is demanded.
    pub(super) matches: bool,
    /// The same, where it is known.
    pub(super) truth: Truth,
    pub(super) probability: f64,
    pub(super) ranking: f64,
    pub(super) uncertain: bool,
}

/// What a track came to in one slot.
#[derive(Default)]
pub(super) struct InSlot {
    /// Place of the moment in the slot, frame, number, whether it matches, probabilities as believed and for ranking.
    seen: Vec<SeenAt>,
    pub(super) matches: bool,
    /// Frame from which on it counts, by the order of the slots.
    from: usize,
}

struct SeenAt {
    moment: usize,
    frame: usize,
    number: usize,
    holds: bool,
    /// The same, where it is known.
    truth: Truth,
    probabilities: [f64; 2],
    uncertain: bool,
}

impl InSlot {
    /// Frames and numbers that show the match; those it is seen in where it is only a guess.
    pub(super) fn shown(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let counts = |seen: &&SeenAt| seen.holds && seen.frame >= self.from;
        let any = self.seen.iter().any(|seen| counts(&seen));
        let shown = self.seen.iter().filter(move |seen| !any || counts(seen));
        shown.map(|seen| (seen.frame, seen.number))
    }

    /// The frame that tells most: the first match, else the most probable.
    fn best(&self) -> Option<&SeenAt> {
        self.seen.iter().find(|seen| seen.holds && seen.frame >= self.from).or_else(|| {
            self.seen.iter().reduce(|best, next| {
                if next.probabilities[0] > best.probabilities[0] { next } else { best }
            })
        })
    }

    fn matched(&self) -> usize {
        self.seen.iter().filter(|seen| seen.holds).count()
    }
}

/// Every thing of the asked kind in the frames of any slot, sorted by id.
pub(super) fn of<'g>(
    searchers: &[Searcher<'_, 'g>],
    plans: &[Plan],
    moments: &[Vec<Moment<'_>>],
) -> Vec<Track<'g>> {
    let mut slots: BTreeMap<&'g EntityId, Vec<InSlot>> = BTreeMap::new();
    for (slot, moments) in moments.iter().enumerate() {
        for (place, moment) in moments.iter().enumerate() {
            let index = searchers[moment.frame].index;
            for number in moment.evaluated.kind.iter() {
                let Some(id) = index.id(number) else { continue };
                let slots = slots.entry(id).or_insert_with(|| {
                    std::iter::repeat_with(InSlot::default).take(plans.len()).collect()
                });
                let verdict = &moment.evaluated.verdicts[number];
                slots[slot].seen.push(SeenAt {
                    moment: place,
                    frame: moment.frame,
                    number,
                    holds: moment.holds.contains(number),
                    truth: moment.meant.truth(number),
                    probabilities: [verdict.probability, verdict.ranking],
                    uncertain: verdict.uncertain,
                });
            }
        }
    }
    slots.into_iter().filter_map(|(id, slots)| track(searchers, plans, id, slots)).collect()
}

fn track<'g>(
    searchers: &[Searcher<'_, 'g>],
    plans: &[Plan],
    id: &'g EntityId,
    mut slots: Vec<InSlot>,
) -> Option<Track<'g>> {
    let order = searchers.first()?.config.order;
    let truth = truth(&slots, plans, order);
    for (slot, plan) in slots.iter_mut().zip(plans) {
        let matched = slot.matched();
        slot.matches = matched > 0 && (!plan.lasts || 2 * matched > slot.seen.len());
    }
    let in_order = order == SlotOrder::Independent || put_in_order(&mut slots);
    let matches = in_order && slots.iter().all(|slot| slot.matches);
    let shown = slots.iter().find_map(InSlot::best)?;
    let node = searchers[shown.frame].index.node(shown.number)?;
    let [probability, ranking] =
        [0, 1].map(|which| probability(&slots, plans, order, searchers.len(), which));
    let uncertain = slots.iter().flat_map(|slot| &slot.seen).any(|seen| seen.uncertain);
    let (bbox, score) = (node.bbox, node.score);
    Some(Track { id, bbox, score, slots, matches, truth, probability, ranking, uncertain })
}

/// Whether a track matches for sure, or may match if all that is unknown of it were so.
fn truth(slots: &[InSlot], plans: &[Plan], order: SlotOrder) -> Truth {
    let matches = |least: Truth| {
        let counts = |seen: &&SeenAt| seen.truth >= least;
        let mut from = 0;
        slots.iter().zip(plans).all(|(slot, plan)| {
            let matched = slot.seen.iter().filter(counts).count();
            let in_turn = slot.seen.iter().filter(|seen| counts(seen) && seen.frame >= from);
            let first = in_turn.map(|seen| seen.frame).min();
            from = first.map_or(from, |frame| frame + 1);
            let is_in_turn = order == SlotOrder::Independent || first.is_some();
            is_in_turn && matched > 0 && (!plan.lasts || 2 * matched > slot.seen.len())
        })
    };
    match [Truth::Yes, Truth::Unknown].map(matches) {
        [true, _] => Truth::Yes,
        [false, may] => Truth::of(may).min(Truth::Unknown),
    }
}

/// Gives every slot the earliest moment after the one before; whether there is one for each.
fn put_in_order(slots: &mut [InSlot]) -> bool {
    let mut from = 0;
    for slot in slots {
        slot.from = from;
        let first = slot.seen.iter().filter(|seen| seen.holds && seen.frame >= from);
        match first.map(|seen| seen.frame).min() {
            Some(frame) => from = frame + 1,
            None => return false,
        }
    }
    true
}

/// Probability that every slot is matched: over a lasting slot the mean of its frames; any moments are the most probable
/// ones, one after the other where that is demanded.
fn probability(
    slots: &[InSlot],
    plans: &[Plan],
    order: SlotOrder,
    frames: usize,
    which: usize,
) -> f64 {
    // By frame: the most probable way to have matched all slots so far before it.
    let mut before = vec![1.0; frames + 1];
    for (slot, plan) in slots.iter().zip(plans) {
        let each = || slot.seen.iter().map(|seen| (seen.frame, seen.probabilities[which]));
        let factor = match (plan.lasts, order) {
            (true, _) => each().map(|(_, p)| p).sum::<f64>() / slot.seen.len().max(1) as f64,
            (false, SlotOrder::Independent) => each().map(|(_, p)| p).fold(0.0, f64::max),
            (false, SlotOrder::Enforced) => {
                let mut after = vec![0.0; frames + 1];
                for (frame, p) in each() {
                    after[frame + 1] = before[frame] * p;
                }
                for frame in 1..after.len() {
                    after[frame] = f64::max(after[frame], after[frame - 1]);
                }
                before = after;
                1.0
            }
        };
        before.iter_mut().for_each(|p| *p *= factor);
    }
    before.last().copied().unwrap_or(0.0)
}

impl Track<'_> {
    /// Where it is shown, slot by slot.
    pub(super) fn shown(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.slots.iter().flat_map(InSlot::shown)
    }

    /// Every frame of any slot that it is seen in, in the order of time.
    pub(super) fn all_frames(&self) -> BTreeMap<usize, usize> {
        let seen = self.slots.iter().flat_map(|slot| &slot.seen);
        seen.map(|seen| (seen.frame, seen.number)).collect()
    }

    /// One check for every slot, with the conditions in the frame that tells most.
    pub(super) fn trace(
        &self,
        searchers: &[Searcher<'_, '_>],
        plans: &[Plan],
        moments: &[Vec<Moment<'_>>],
        selected: bool,
    ) -> CandidateTrace {
        let (mut passed_attributes, mut passed_relations) = (true, true);
        let mut checks = Vec::new();
        for (number, (slot, plan)) in self.slots.iter().zip(plans).enumerate() {
            let mut check = slot_check(slot, plan, number + 1);
            if let Some(best) = slot.best() {
                let evaluated = &moments[number][best.moment].evaluated;
                let verdict = &evaluated.verdicts[best.number];
                passed_attributes &= verdict.passed_attributes;
                passed_relations &= verdict.passed_relations;
                check.parts = searchers[best.frame].checks(best.number, evaluated);
                let frame = searchers[best.frame].index.scene().frame.frame;
                check.finding = Some(Finding::Frames {
                    matched: slot.matched(),
                    seen: slot.seen.len(),
                    shown: Some(frame),
                });
            } else {
                (passed_attributes, passed_relations) = (false, false);
            }
            checks.push(check);
        }
        CandidateTrace {
            id: self.id.clone(),
            selected,
            passed_attributes,
            passed_relations,
            checks,
        }
    }
}

fn slot_check(slot: &InSlot, plan: &Plan, number: usize) -> Check {
    let (matched, seen) = (slot.matched(), slot.seen.len());
    let needed = if plan.lasts { seen / 2 + 1 } else { 1 };
    let of_slot = |which: usize| {
        let each = slot.seen.iter().map(|seen| seen.probabilities[which]);
        if plan.lasts { each.sum::<f64>() / seen.max(1) as f64 } else { each.fold(0.0, f64::max) }
    };
    let bounds = place::interval(needed as f64, f64::INFINITY);
    Check {
        criterion: Criterion::Slot { slot: Arc::clone(&plan.slot), number },
        finding: (seen > 0).then_some(Finding::Frames { matched, seen, shown: None }),
        holds: slot.matches,
        probability: of_slot(0),
        measured: (seen > 0).then(|| place::measured(matched as f64, Unit::Count, bounds)),
        ..Check::default()
    }
}
