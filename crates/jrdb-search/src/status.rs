//! Whether a question has an answer, by Kleene's three-valued logic.

use jrdb_graph::BitSet;
use jrdb_types::answer::{Count, Possible, PropertyValues, Reply, Status};
use jrdb_types::query::{Order, Share};
use jrdb_types::{Answer, Condition, IssueKind, Pattern, Query, Task};

use crate::candidates::{only_nodes, presupposes};
use crate::causes;
use crate::evaluation::Evaluated;
use crate::known::Known;
use crate::probability::of_count;
use crate::searcher::Searcher;
use crate::value::{Truth, UNBOUNDED};
use crate::{World, benchmark};

/// Who satisfies a pattern and who may.
pub(crate) struct Meant {
    /// Those that satisfy it.
    pub(crate) sure: BitSet,
    /// Those that may satisfy it.
    pub(crate) perhaps: BitSet,
    /// There may be more that the graph does not hold.
    pub(crate) may_be_unseen: bool,
}

impl Meant {
    /// Who is meant by a pattern, its pick included; only nodes are.
    pub(crate) fn by(searcher: &Searcher<'_, '_>, pattern: &Pattern) -> Self {
        let known = searcher.known_matching(pattern);
        let kind = searcher.kind(&pattern.category).into_owned();
        let (mut sure, mut perhaps) = (known.yes.clone(), known.possible(&kind));
        perhaps.subtract(&known.yes);
        only_nodes(searcher, &mut sure);
        only_nodes(searcher, &mut perhaps);
        Self { sure, perhaps, may_be_unseen: searcher.may_be_unseen(pattern) }
    }

    /// Whether a thing is meant.
    pub(crate) fn truth(&self, number: usize) -> Truth {
        match (self.sure.contains(number), self.perhaps.contains(number)) {
            (true, _) => Truth::Yes,
            (false, true) => Truth::Unknown,
            (false, false) => Truth::No,
        }
    }

    /// Whether a statement holds of all of them, of none, or of most. Of nobody it is not said.
    fn each(
        &self,
        searcher: &Searcher<'_, '_>,
        share: Share,
        asked: &[Condition],
    ) -> (Status, Reply) {
        let mut all = self.sure.clone();
        all.unite(&self.perhaps);
        let asked = Condition::All(asked.to_vec());
        let known = match share {
            Share::None => searcher.known(&asked, &all).negated(),
            _ => searcher.known(&asked, &all),
        };
        if all.is_empty() && !self.may_be_unseen {
            return (Status::Nearest, Reply::YesNo(None));
        }
        match self.share(share, &known) {
            Truth::Unknown => (Status::Unknown, Reply::YesNo(None)),
            truth => (Status::Answered, Reply::YesNo(Some(truth.holds()))),
        }
    }

    fn share(&self, share: Share, known: &Known) -> Truth {
        let count = |set: &BitSet, of: &BitSet| set.iter().filter(|n| of.contains(*n)).count();
        let (total, yes, no) =
            (self.sure.count(), count(&self.sure, &known.yes), count(&self.sure, &known.no));
        let is_open = self.may_be_unseen || total == 0;
        let others_agree = self.perhaps.iter().all(|n| known.yes.contains(n));
        let is_enough = |number: usize| match share {
            Share::All | Share::None => number == total,
            Share::Most => 2 * number > total,
            Share::Half => 2 * number >= total,
        };
        let is_strict = matches!(share, Share::All | Share::None);
        if is_strict && no > 0 {
            return Truth::No;
        }
        if is_open || !others_agree {
            return Truth::Unknown;
        }
        match (is_enough(yes), is_enough(total - no)) {
            (true, _) => Truth::Yes,
            (_, false) => Truth::No,
            _ => Truth::Unknown,
        }
    }

    fn bounds(&self) -> Bounds {
        let perhaps = if self.may_be_unseen { UNBOUNDED } else { self.perhaps.count() };
        Bounds { sure: self.sure.count(), perhaps }
    }
}

/// How many there are: at least so many, and perhaps so many more.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Bounds {
    pub(crate) sure: usize,
    pub(crate) perhaps: usize,
}

impl Bounds {
    /// The bounds of a count that was answered.
    pub(crate) fn of(count: Count) -> Self {
        match count {
            Count::Exact(number) => Self { sure: number, perhaps: 0 },
            Count::Between { at_least, at_most } => {
                let perhaps = at_most.map_or(UNBOUNDED, |most| most.saturating_sub(at_least));
                Self { sure: at_least, perhaps }
            }
        }
    }

    fn most(self) -> usize {
        self.sure.saturating_add(self.perhaps)
    }

    fn count(self) -> Count {
        let most = (self.perhaps != UNBOUNDED).then(|| self.most());
        Count::between(self.sure, most)
    }

    /// Whether there are more, or fewer, than others.
    fn compared(self, order: Order, others: Self) -> Truth {
        let (less, more) = match order {
            Order::Least => (self, others),
            Order::Most => (others, self),
        };
        if less.most() < more.sure {
            Truth::Yes
        } else if less.sure >= more.most() {
            Truth::No
        } else {
            Truth::Unknown
        }
    }
}

/// The status of a question without a number or a yes or no: those that hold are its answer.
fn of_things(bounds: Bounds) -> Status {
    match bounds {
        Bounds { sure: 0, perhaps: 0 } => Status::Nearest,
        Bounds { sure: 0, .. } => Status::Unknown,
        _ => Status::Answered,
    }
}

/// The status of a question about so many things, and its reply as far as that is a number or a yes or no.
pub(crate) fn judge(
    task: &Task,
    bounds: Bounds,
    others: impl FnOnce(&Pattern) -> Bounds,
    told: &Reply,
) -> (Status, Reply) {
    let of_truth = |truth: Truth| match truth {
        Truth::Unknown => (Status::Unknown, Reply::YesNo(None)),
        known => (Status::Answered, Reply::YesNo(Some(known.holds()))),
    };
    match task {
        Task::Find | Task::Where | Task::Which { .. } | Task::Choice { .. } | Task::From { .. } => {
            (of_things(bounds), told.clone())
        }
        Task::Groups => match told {
            Reply::Number(Count::Exact(_)) if bounds.perhaps == 0 => {
                (Status::Answered, told.clone())
            }
            _ => (Status::Unknown, Reply::Number(Count::between(0, None))),
        },
        // Decided where the things themselves are known.
        Task::Each { .. } => (Status::Unknown, Reply::YesNo(None)),
        Task::Count => {
            let is_exact = bounds.perhaps == 0;
            let status = if is_exact { Status::Answered } else { Status::Unknown };
            (status, Reply::Number(bounds.count()))
        }
        Task::Exists(quantity) => of_truth(Truth::of_count(*quantity, bounds.sure, bounds.perhaps)),
        Task::CompareCounts { order, than } => of_truth(bounds.compared(*order, others(than))),
    }
}

/// Gives the answer about one frame its status, with the causes and the candidates of an open one.
pub(crate) fn settle(
    answer: &mut Answer,
    searcher: &Searcher<'_, '_>,
    query: &Query,
    evaluated: &Evaluated<'_>,
) {
    if searcher.config.world == World::Closed {
        return settle_closed(answer, searcher, query, evaluated);
    }
    let meant = Meant::by(searcher, &query.target);
    let others = |than: &Pattern| Meant::by(searcher, than).bounds();
    let (status, reply) = match &query.task {
        Task::Each { share, asked } => meant.each(searcher, *share, asked),
        task => judge(task, meant.bounds(), others, &answer.reply),
    };
    answer.status = status;
    answer.reply = reply;
    if status == Status::Answered && !is_told(searcher, query, &answer.reply) {
        answer.status = Status::Unknown;
    }
    if is_not_understood(query) {
        answer.status = Status::NotUnderstood;
    }
    answer.possible = possible(searcher, &meant.perhaps, evaluated);
    answer.probability = probability(searcher, query, answer, evaluated);
    if answer.status.is_open() {
        answer.because = causes::of(searcher, query, &meant.perhaps, &answer.reply);
    }
}

/// The engine knows no unknown: only the nearest things are no answer.
fn settle_closed(
    answer: &mut Answer,
    searcher: &Searcher<'_, '_>,
    query: &Query,
    evaluated: &Evaluated<'_>,
) {
    let is_things = presupposes(&query.task);
    let nobody = || Meant::by(searcher, &query.target).sure.is_empty();
    if is_things && !benchmark::pools(&searcher.config) && nobody() {
        answer.status = Status::Nearest;
    }
    answer.probability = probability(searcher, query, answer, evaluated);
}

/// Whether the parser understood neither a target nor a form of question.
pub(crate) fn is_not_understood(query: &Query) -> bool {
    query.issues.iter().any(|issue| issue.kind == IssueKind::NotUnderstood)
}

fn possible(
    searcher: &Searcher<'_, '_>,
    perhaps: &BitSet,
    evaluated: &Evaluated<'_>,
) -> Vec<Possible> {
    let each = perhaps.iter().filter_map(|number| {
        let node = searcher.index.node(number)?;
        let probability = (node.score * evaluated.verdicts[number].ranking).clamp(0.0, 1.0);
        Some(Possible { id: node.id.clone(), probability })
    });
    each.collect()
}

/// Whether every property that is asked is known of one of the things, or could have been.
pub(crate) fn is_told(searcher: &Searcher<'_, '_>, query: &Query, reply: &Reply) -> bool {
    let Reply::Properties(told) = reply else { return true };
    match &query.task {
        Task::Where | Task::Choice { .. } | Task::From { .. } => {
            told.iter().any(|one| !one.values.is_empty())
        }
        Task::Which { properties, .. } => properties.iter().all(|&asked| {
            let is_asked = |one: &&PropertyValues| one.property == Some(asked);
            let mut values = told.iter().filter(is_asked);
            values.any(|one| !one.values.is_empty()) || searcher.could_be_told(asked)
        }),
        _ => true,
    }
}

/// How probable the reply is; `None` where that is open or hangs on an order.
fn probability(
    searcher: &Searcher<'_, '_>,
    query: &Query,
    answer: &Answer,
    evaluated: &Evaluated<'_>,
) -> Option<f64> {
    if answer.status != Status::Answered {
        return None;
    }
    let each = || {
        evaluated.kind.iter().map(|number| {
            let score = searcher.index.node(number).map_or(1.0, |node| node.score);
            (score * evaluated.verdicts[number].probability).clamp(0.0, 1.0)
        })
    };
    match (&query.task, &answer.reply) {
        _ if query.target.pick.is_some() => best_of(answer),
        (Task::Count, Reply::Number(Count::Exact(number))) => {
            let number = u32::try_from(*number).ok()?;
            Some(of_count(each(), number, Some(number)))
        }
        (Task::Exists(quantity), Reply::YesNo(Some(yes))) => {
            let holds = of_count(each(), quantity.at_least, quantity.at_most);
            Some(if *yes { holds } else { 1.0 - holds })
        }
        (task, _) if presupposes(task) => best_of(answer),
        _ => None,
    }
}

/// The probability of the most probable thing of the selection.
fn best_of(answer: &Answer) -> Option<f64> {
    let ranked = answer.ranking.iter().filter(|one| answer.selection.contains(&one.id));
    ranked.map(|one| one.probability).reduce(f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bounds(sure: usize, perhaps: usize) -> Bounds {
        Bounds { sure, perhaps }
    }

    #[test]
    fn bounds_are_compared_by_their_ends() {
        let more = |a, b| bounds(a, 1).compared(Order::Most, bounds(b, 1));
        assert_eq!(
            [more(4, 2), more(3, 2), more(2, 4), more(2, 3)],
            [Truth::Yes, Truth::Unknown, Truth::No, Truth::No]
        );
        let fewer = bounds(1, UNBOUNDED).compared(Order::Least, bounds(3, 0));
        assert_eq!(fewer, Truth::Unknown);
    }

    #[test]
    fn things_are_answered_by_one_that_holds_and_open_while_one_may() {
        assert_eq!(of_things(bounds(1, UNBOUNDED)), Status::Answered);
        assert_eq!(of_things(bounds(0, 1)), Status::Unknown);
        assert_eq!(of_things(bounds(0, 0)), Status::Nearest);
    }
}
