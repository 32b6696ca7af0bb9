//! Superlatives and ordinals.

use jrdb_types::query::{Category, Measure, Order, Pick};

use super::{Truth, World};

impl World<'_> {
    /// Whom a pick takes whatever is true of the unknown: tried out for the two extremes of each thing, all those that
    /// could be before it being there or not.
    pub(super) fn surely_picked(&self, held: &[Truth], pick: &Pick) -> Vec<Truth> {
        let measures: Vec<Option<f64>> =
            (0..held.len()).map(|thing| self.measure(thing, &pick.measure)).collect();
        let sign = if pick.order == Order::Least { 1.0 } else { -1.0 };
        let before = |other: usize, thing: usize| {
            let key = |n: usize| Some((sign * measures[n]?, n));
            key(other).zip(key(thing)).map(|(other, thing)| other < thing)
        };
        let in_turn = |count: usize| {
            let first = pick.rank.max(1) as usize - 1;
            count >= first && count < first + pick.count as usize
        };
        let references = match &pick.measure {
            Measure::DistanceTo(pattern) if pattern.category != Category::Robot => {
                self.matches(pattern)
            }
            _ => vec![Some(false); held.len()],
        };
        // Nothing is near itself.
        let is_itself = |n: usize| measures[n].is_none() && references[n] == Some(true);
        let truth = |thing: usize| {
            if held[thing] == Some(false) || pick.count == 0 || is_itself(thing) {
                return Some(false);
            }
            let others = || {
                let may = |other: &usize| held[*other] != Some(false) && !is_itself(*other);
                self.others(thing).filter(may)
            };
            let surely =
                |other: &usize| before(*other, thing) == Some(true) && held[*other] == Some(true);
            let sure = others().filter(surely).count();
            let perhaps = others().filter(|other| before(*other, thing) != Some(false)).count();
            let turns: Vec<bool> = (sure..=perhaps).map(in_turn).collect();
            match (turns.iter().all(|turn| *turn), turns.iter().any(|turn| *turn)) {
                (_, false) => Some(false),
                (true, _) => held[thing],
                _ => None,
            }
        };
        (0..held.len()).map(truth).collect()
    }

    /// Of those that match only the picked ones still do.
    pub(super) fn picked(&self, mut held: Vec<Truth>, pick: &Pick) -> Vec<Truth> {
        let matching = (0..held.len()).filter(|thing| held[*thing] == Some(true));
        let mut order: Vec<(f64, usize)> = matching
            .filter_map(|thing| Some((self.measure(thing, &pick.measure)?, thing)))
            .collect();
        let sign = if pick.order == Order::Least { 1.0 } else { -1.0 };
        order.sort_by(|a, b| (sign * a.0).total_cmp(&(sign * b.0)).then(a.1.cmp(&b.1)));
        let first = pick.rank.max(1) as usize - 1;
        let taken: Vec<usize> =
            order.iter().skip(first).take(pick.count as usize).map(|(_, thing)| *thing).collect();
        for (thing, held) in held.iter_mut().enumerate() {
            if *held == Some(true) {
                *held = Some(taken.contains(&thing));
            }
        }
        held
    }
}
