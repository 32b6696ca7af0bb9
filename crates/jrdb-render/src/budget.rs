//! What each kind of error costs, and whether probabilities are what they say, in words.

use jrdb_types::score::{Budget, Confusion, Reliability};

/// A budget of errors: what each part of the truth is worth, and the gap that the shares add up to.
#[must_use]
pub fn budget(of: &Budget) -> String {
    let mut text = format!("{:<24} {:>8} {:>10} {:>8}\n", "given", "alone", "cumulative", "share");
    let largest = of.shares.iter().map(|share| share.shapley.abs()).fold(0.0, f64::max);
    for share in &of.shares {
        let (alone, cumulative, shapley) = (share.alone, share.cumulative, share.shapley);
        let (name, bar) = (&share.truth, bar(shapley, largest));
        let line = format!("{name:<24} {alone:>+8.3} {cumulative:>+10.3} {shapley:>+8.3} {bar}");
        text += &format!("{}\n", line.trim_end());
    }
    let (without, with_all, gap) = (of.without, of.with_all, of.gap());
    text + &format!("from {without:.3} to {with_all:.3}: the shares add up to {gap:+.3}\n")
}

/// A bar as long as a share; the largest has so many characters. A loss is drawn lighter.
fn bar(share: f64, largest: f64) -> String {
    const LONGEST: f64 = 30.0;
    let length = if largest > 0.0 { (share.abs() / largest * LONGEST).round() } else { 0.0 };
    let character = if share < 0.0 { "░" } else { "█" };
    character.repeat(length as usize)
}

/// Stated probabilities beside the share that is right, a line for each bin with candidates.
#[must_use]
pub fn reliability(of: &Reliability) -> String {
    let mut text = format!("{:<14} {:>6} {:>8} {:>6}\n", "probability", "count", "stated", "right");
    for bin in of.bins.iter().filter(|bin| bin.count > 0) {
        let (stated, right) = (bin.probability, bin.right);
        let range = format!("{:.3} to {:.3}", bin.from, bin.to);
        text += &format!("{range:<14} {:>6} {stated:>8.3} {right:>6.3}\n", bin.count);
    }
    text + &format!("expected calibration error {:.3}\n", of.calibration_error)
}

/// What was taken for what: a line for each pair.
#[must_use]
pub fn confusion(of: &Confusion) -> String {
    let said = |(truth, row): (&String, &std::collections::BTreeMap<String, usize>)| {
        let line =
            |(said, count): (&String, &usize)| format!("{truth} taken for {said}: {count}\n");
        row.iter().map(line).collect::<String>()
    };
    of.counts.iter().map(said).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_types::score::{ReliabilityBin, Share};
    use std::collections::BTreeMap;

    #[test]
    fn a_budget_is_a_table_whose_shares_add_up() {
        let share = |truth: &str, alone, cumulative, shapley| {
            let truth = truth.into();
            Share { truth, alone, cumulative, shapley }
        };
        let shares = vec![share("attributes", 0.1, 0.1, 0.2), share("position", 0.1, 0.3, 0.2)];
        insta::assert_snapshot!(budget(&Budget { without: 0.5, with_all: 0.9, shares }));
    }

    #[test]
    fn bins_without_candidates_are_not_shown() {
        let bin = |count, from, to, probability, right| ReliabilityBin {
            from,
            to,
            count,
            probability,
            right,
        };
        let bins = vec![bin(0, 0.0, 0.5, 0.0, 0.0), bin(4, 0.5, 1.0, 0.9, 0.75)];
        insta::assert_snapshot!(reliability(&Reliability { calibration_error: 0.15, bins }));
    }

    #[test]
    fn each_pair_of_words_has_a_line() {
        let row = BTreeMap::from([("left".into(), 5), ("right".into(), 2)]);
        let of = Confusion { counts: BTreeMap::from([("left".into(), row)]) };
        assert_eq!(confusion(&of), "left taken for left: 5\nleft taken for right: 2\n");
    }
}
