//! The stage on a recording: who does what when.

mod plan;
mod track;

use std::collections::BTreeSet;

use jrdb_graph::GraphIndex;
use jrdb_types::answer::{
    Cause, Count, Possible, PropertyValue, PropertyValues, Ranked, Reply, Sighting, SlotAnswer,
    Status,
};
use jrdb_types::issue::IssueKind;
use jrdb_types::query::Property;
use jrdb_types::vocab::MatchPolicy;
use jrdb_types::{Answer, EntityId, FrameId, Issue, LateralConvention, Pattern, Query, Task};

use crate::candidates::{by_sets, candidates, deciding, in_order, presupposes};
use crate::searcher::Searcher;
use crate::status::{self, Bounds, Meant};
use crate::value::{Truth, UNBOUNDED};
use crate::{SearchConfig, World, benchmark, causes, issues, ranked, reply};
use plan::{Moment, Plan, plans};
use track::Track;

/// The answer on frames that are indexed already.
pub(crate) fn answer(
    frames: &[&GraphIndex<'_>],
    slots: Option<&[Vec<usize>]>,
    query: &Query,
    config: &SearchConfig,
) -> Answer {
    let query = &*benchmark::as_asked(query, config);
    let plans = plans(frames, slots, query, config);
    let searchers: Vec<Searcher<'_, '_>> =
        frames.iter().map(|index| Searcher::new(index, config)).collect();
    let moments: Vec<Vec<Moment<'_>>> = plans
        .iter()
        .map(|plan| plan.frames.iter().map(|&f| moment(&searchers[f], f, plan)).collect())
        .collect();
    let tracks = track::of(&searchers, &plans, &moments);
    let mut selected = select(&tracks, query, config);
    let speaks_of_time = slots.is_some() || !query.slots.is_empty();
    let mut slot_answers = if benchmark::pools(config) {
        pooled(frames, &plans, config)
    } else {
        plans
            .iter()
            .enumerate()
            .map(|(k, _)| seen(&tracks, &searchers, k, &selected, config))
            .collect()
    };
    if benchmark::pools(config) {
        selected = slot_answers.first().map_or_else(BTreeSet::new, |slot| {
            slot.seen.iter().map(|seen| seen.id.clone()).collect()
        });
    }
    let units = slot_answers.first().map_or(0, |slot| slot.seen.len());
    let count = if benchmark::pools(config) { units } else { selected.len() };
    let reply = reply(frames, &searchers, &plans, &tracks, &selected, count, query);
    if !speaks_of_time {
        slot_answers.clear();
    }
    let first = frames.first().map(|index| index.scene());
    let frame = first.map_or_else(FrameId::default, |scene| scene.frame.clone());
    let lateral = first.map_or_else(LateralConvention::default, |scene| scene.lateral);
    let is_selected = |track: &Track<'_>| selected.contains(track.id);
    let trace = tracks.iter().map(|t| t.trace(&searchers, &plans, &moments, is_selected(t)));
    let mut answer = Answer::new(frame, query, config.policy, lateral);
    answer.reply = reply;
    answer.ranking = ranking(&tracks, &selected, config);
    answer.trace = trace.collect();
    answer.slots = slot_answers;
    answer.issues = issues(&searchers, &plans, query);
    answer.selection = selected.into_iter().collect();
    if config.world == World::Open {
        let recording = Recorded { frames, searchers: &searchers, plans: &plans, tracks: &tracks };
        recording.settle(&mut answer, query, &moments);
    }
    answer
}

/// A recording whose tracks are evaluated.
struct Recorded<'r, 'i, 'a> {
    frames: &'r [&'r GraphIndex<'a>],
    searchers: &'r [Searcher<'i, 'a>],
    plans: &'r [Plan],
    tracks: &'r [Track<'a>],
}

impl Recorded<'_, '_, '_> {
    /// Gives the answer its status, with the causes and the candidates of an open one.
    fn settle(&self, answer: &mut Answer, query: &Query, moments: &[Vec<Moment<'_>>]) {
        let count = |truth| self.tracks.iter().filter(|track| track.truth == truth).count();
        let may_be_unseen = moments.iter().flatten().any(|moment| moment.meant.may_be_unseen);
        let has_no_frame = self.plans.iter().any(|plan| plan.frames.is_empty());
        let is_open = may_be_unseen || has_no_frame;
        let perhaps = if is_open { UNBOUNDED } else { count(Truth::Unknown) };
        let bounds = Bounds { sure: count(Truth::Yes), perhaps };
        let others = |than: &Pattern| self.bounds_of(than);
        let (status, reply) = status::judge(&query.task, bounds, others, &answer.reply);
        (answer.status, answer.reply) = (status, reply);
        if let (Status::Answered, Some(first)) = (status, self.searchers.first())
            && !status::is_told(first, query, &answer.reply)
        {
            answer.status = Status::Unknown;
        }
        if status::is_not_understood(query) {
            answer.status = Status::NotUnderstood;
        }
        let possible = self.tracks.iter().filter(|track| track.truth == Truth::Unknown);
        let possible = possible.map(|track| Possible {
            id: track.id.clone(),
            probability: (track.score * track.ranking).clamp(0.0, 1.0),
        });
        answer.possible = possible.collect();
        if answer.status.is_open() {
            answer.because = self.causes(query, moments, &answer.reply);
        }
    }

    /// How many others there are in the same slots.
    fn bounds_of(&self, than: &Pattern) -> Bounds {
        let slots: Vec<Vec<usize>> = self.plans.iter().map(|plan| plan.frames.clone()).collect();
        let others = Query { task: Task::Count, target: than.clone(), ..Query::default() };
        let config = self.searchers.first().map(|searcher| searcher.config).unwrap_or_default();
        match answer(self.frames, Some(&slots), &others, &config).reply {
            Reply::Number(count) => Bounds::of(count),
            _ => Bounds { sure: 0, perhaps: UNBOUNDED },
        }
    }

    /// What is unknown in any frame.
    fn causes(&self, query: &Query, moments: &[Vec<Moment<'_>>], reply: &Reply) -> Vec<Cause> {
        let each = moments.iter().flatten().flat_map(|moment| {
            causes::of(&self.searchers[moment.frame], query, &moment.meant.perhaps, reply)
        });
        each.collect::<BTreeSet<Cause>>().into_iter().collect()
    }
}

fn moment<'q>(searcher: &Searcher<'_, '_>, frame: usize, plan: &'q Plan) -> Moment<'q> {
    let evaluated = searcher.evaluate_on(&plan.pattern, candidates(searcher, &plan.pattern));
    let asked = Pattern { pick: plan.pick.clone(), ..plan.pattern.clone() };
    let meant = Meant::by(&deciding(searcher, &Task::Count), &asked);
    Moment { frame, evaluated, holds: by_sets(searcher, &asked), meant }
}

/// The tracks that are meant.
fn select(tracks: &[Track<'_>], query: &Query, config: &SearchConfig) -> BTreeSet<EntityId> {
    let matching = tracks.iter().filter(|track| track.matches).map(|track| track.id.clone());
    let matching: BTreeSet<EntityId> = matching.collect();
    let guesses = config.policy == MatchPolicy::Ranked && presupposes(&query.task);
    let is_uncertain = tracks.iter().any(|track| track.uncertain);
    if !guesses || (!is_uncertain && !matching.is_empty()) {
        return matching;
    }
    let probabilities = tracks.iter().map(|track| (track.score * track.probability, track.id));
    let chosen = ranked::best_expected_f1(probabilities.collect());
    if chosen.is_empty() { matching } else { chosen.into_iter().cloned().collect() }
}

fn ranking(
    tracks: &[Track<'_>],
    selected: &BTreeSet<EntityId>,
    config: &SearchConfig,
) -> Vec<Ranked> {
    let is_ranked = config.policy == MatchPolicy::Ranked;
    let ranked = tracks
        .iter()
        .filter(|track| selected.contains(track.id) || (is_ranked && track.ranking > 0.0));
    let ranked = ranked.map(|track| Ranked {
        id: track.id.clone(),
        bbox: track.bbox,
        probability: (track.score * track.ranking).clamp(0.0, 1.0),
    });
    in_order(ranked.collect())
}

fn pooled(frames: &[&GraphIndex<'_>], plans: &[Plan], config: &SearchConfig) -> Vec<SlotAnswer> {
    let of_slot = |plan: &Plan| {
        let frames: Vec<&GraphIndex<'_>> = plan.frames.iter().map(|&f| frames[f]).collect();
        SlotAnswer { seen: benchmark::pooled(&frames, &plan.pattern, config) }
    };
    plans.iter().map(of_slot).collect()
}

/// Who matches a slot when: of the selected, and of all where slots are independent.
fn seen(
    tracks: &[Track<'_>],
    searchers: &[Searcher<'_, '_>],
    slot: usize,
    selected: &BTreeSet<EntityId>,
    config: &SearchConfig,
) -> SlotAnswer {
    let is_free = config.order == crate::SlotOrder::Independent;
    let shown = tracks
        .iter()
        .filter(|track| selected.contains(track.id) || (is_free && track.slots[slot].matches));
    let seen = shown.flat_map(|track| {
        track.slots[slot].shown().filter_map(move |(frame, number)| {
            let node = searchers[frame].index.node(number)?;
            let frame = searchers[frame].index.scene().frame.frame;
            Some(Sighting { id: node.id.clone(), frame, bbox: node.bbox })
        })
    });
    SlotAnswer { seen: seen.collect() }
}

fn reply(
    frames: &[&GraphIndex<'_>],
    searchers: &[Searcher<'_, '_>],
    plans: &[Plan],
    tracks: &[Track<'_>],
    selected: &BTreeSet<EntityId>,
    count: usize,
    query: &Query,
) -> Reply {
    let meant = || tracks.iter().filter(|track| selected.contains(track.id));
    match &query.task {
        Task::Find => Reply::Things,
        // Of a recording these are not told.
        Task::Each { .. } => Reply::YesNo(None),
        Task::Groups => Reply::Number(Count::between(0, None)),
        Task::Choice { .. } | Task::From { .. } => Reply::Properties(Vec::new()),
        Task::Count => Reply::Number(Count::Exact(count)),
        Task::Exists(quantity) => Reply::YesNo(Some(quantity.holds(count))),
        Task::CompareCounts { order, than } => {
            let slots: Vec<Vec<usize>> = plans.iter().map(|plan| plan.frames.clone()).collect();
            let others = Query { task: Task::Count, target: (**than).clone(), ..Query::default() };
            let config = searchers.first().map(|searcher| searcher.config).unwrap_or_default();
            let others = answer(frames, Some(&slots), &others, &config).number().unwrap_or(0);
            Reply::YesNo(Some(reply::compare(count, *order, others)))
        }
        Task::Where => Reply::Properties(
            meant()
                .filter_map(|t| t.shown().next())
                .filter_map(|(f, n)| reply::place(&searchers[f], n))
                .collect(),
        ),
        Task::Which { properties, .. } => {
            let properties = meant().flat_map(|track| {
                properties.iter().map(|&property| {
                    let frames = track.all_frames().into_iter();
                    let moments =
                        frames.filter_map(|(f, n)| reply::property_of(&searchers[f], n, property));
                    over_time(track.id, property, moments)
                })
            });
            Reply::Properties(properties.collect())
        }
    }
}

/// The values in the order of time, each once until it changes by more than an answer states.
fn over_time(
    id: &EntityId,
    property: Property,
    moments: impl Iterator<Item = PropertyValues>,
) -> PropertyValues {
    let (mut values, mut last) = (Vec::new(), Vec::new());
    for moment in moments {
        let rounded: Vec<PropertyValue> =
            moment.values.iter().map(PropertyValue::rounded).collect();
        if rounded != last && !rounded.is_empty() {
            values.extend(moment.values);
            last = rounded;
        }
    }
    PropertyValues { id: id.clone(), property: Some(property), values, words: Vec::new() }
}

/// What no frame can give, and what slots there are no frames for.
fn issues(searchers: &[Searcher<'_, '_>], plans: &[Plan], query: &Query) -> Vec<Issue> {
    let mut missing = searchers.iter().map(|searcher| issues::of(searcher, query));
    let mut all = query.issues.clone();
    if let Some(first) = missing.next() {
        let rest: Vec<Vec<Issue>> = missing.collect();
        all.extend(first.into_iter().filter(|issue| rest.iter().all(|r| r.contains(issue))));
    }
    if searchers.len() == 1 && query.slots.len() > 1 {
        let message = "the question speaks of several moments, and there is only one frame";
        all.push(Issue::new(IssueKind::NotInGraph, message));
    }
    for (plan, number) in plans.iter().zip(1..) {
        if plan.frames.is_empty() {
            let message = format!("there is no frame for moment {number} of the question");
            all.push(Issue::new(IssueKind::NotInGraph, message));
        }
    }
    all
}
