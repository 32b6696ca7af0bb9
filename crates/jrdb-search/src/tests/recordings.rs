//! Questions about moments.

use jrdb_types::answer::Reply;
use jrdb_types::query::{Property, Slot};
use jrdb_types::vocab::MatchPolicy;
use jrdb_types::*;

use super::graphs::{graph, id, nobody};
use super::under;
use crate::{SearchConfig, search, search_frames};

use Action::{Running, Sitting, Standing, Walking};

/// Frames in which people 1, 2 ... do one thing after another; `None` where they are not seen.
fn recording(people: &[&[Option<Action>]]) -> Vec<SceneGraph> {
    (0..people[0].len())
        .map(|frame| {
            let nodes = people.iter().zip(1..).filter_map(|(actions, number)| {
                let action = actions[frame]?;
                let mut node = nobody(id(number), "person");
                node.attributes.set_action(Belief::certain(action));
                node.bbox.x += frame as f64;
                Some(node)
            });
            let mut scene = graph(nodes.collect(), Vec::new());
            scene.frame.frame = 30 + frame as u32;
            scene
        })
        .collect()
}

fn does(during_s: Option<[f64; 2]>, action: Action) -> Slot {
    Slot { during_s, conditions: vec![Condition::has(action)] }
}

fn when(slots: Vec<Slot>) -> Query {
    Query { slots, ..Query::default() }
}

fn found(answer: &Answer) -> Vec<u32> {
    answer.selection.iter().map(|id| id.number).collect()
}

#[test]
fn one_thing_after_another_is_not_the_other_way_round() {
    let frames = recording(&[
        &[Some(Sitting), Some(Standing), Some(Standing)],
        &[Some(Standing), Some(Sitting), Some(Sitting)],
        &[Some(Standing), Some(Sitting), Some(Standing)],
    ]);
    let query = when(vec![does(None, Sitting), does(None, Standing)]);
    for policy in [MatchPolicy::Strict, MatchPolicy::Ranked] {
        let answer = search_frames(&frames, None, &query, &under(policy));
        assert_eq!(found(&answer), [1, 3], "{policy}");
        let standing: Vec<(u32, u32)> =
            answer.slots[1].seen.iter().map(|seen| (seen.id.number, seen.frame)).collect();
        assert_eq!(standing, [(1, 31), (1, 32), (3, 32)]);
    }
    let free = SearchConfig { order: crate::SlotOrder::Independent, ..under(MatchPolicy::Strict) };
    assert_eq!(found(&search_frames(&frames, None, &query, &free)), [1, 2, 3]);
}

#[test]
fn a_slot_of_seconds_is_matched_in_most_of_the_frames_one_is_seen_in() {
    let frames = recording(&[
        &[Some(Walking), Some(Walking), Some(Running), Some(Running)],
        &[Some(Walking), Some(Running), Some(Running), Some(Walking)],
        &[None, None, Some(Walking), None],
    ]);
    let query = when(vec![does(Some([0.0, 2.0 / 15.0]), Walking)]);
    let answer = search_frames(&frames, None, &query, &SearchConfig::default());
    assert_eq!(found(&answer), [1, 3]);
    let words = jrdb_render::found(&answer.trace[1].checks[0]);
    assert_eq!(words.as_deref(), Some("in 1 of 3 frames; here frame 30"));
    let given = search_frames(&frames, Some(&[vec![3, 99]]), &query, &SearchConfig::default());
    assert_eq!(found(&given), [2]);
}

#[test]
fn a_question_without_slots_is_about_the_whole_recording() {
    let frames = recording(&[&[Some(Walking); 3], &[Some(Walking), Some(Running), Some(Running)]]);
    let mut query = super::ask(vec![Condition::has(Walking)]);
    let answer = search_frames(&frames, None, &query, &SearchConfig::default());
    assert_eq!((found(&answer), answer.slots.len()), (vec![1], 0));
    query.task = Task::Which {
        properties: vec![Property::Attribute(jrdb_types::Attribute::Action)],
        in_order: true,
    };
    query.target.conditions.clear();
    let answer = search_frames(&frames, None, &query, &SearchConfig::default());
    let Reply::Properties(all) = jrdb_render::with_words(answer).reply else {
        panic!("expected values");
    };
    assert_eq!(all[1].words, ["walking", "running"]);
}

#[test]
fn the_engine_counts_boxes_and_leaves_out_what_nobody_does() {
    let frames = recording(&[&[Some(Walking); 3], &[Some(Walking), None, Some(Running)]]);
    let query = Query { task: Task::Count, ..when(vec![does(None, Walking)]) };
    let slots = [vec![0, 1, 2]];
    let engine = SearchConfig::benchmark();
    let answer = search_frames(&frames, Some(&slots), &query, &engine);
    // Everybody moves a pixel a frame: three boxes of 1, one of 2.
    assert_eq!((answer.number(), found(&answer)), (Some(4), vec![1, 2]));
    let nobody_sits = when(vec![does(None, Sitting)]);
    let answer = search_frames(&frames, Some(&slots), &nobody_sits, &engine);
    assert_eq!(answer.slots[0].seen.len(), 5);
}

#[test]
fn one_frame_cannot_hold_two_moments_and_no_frame_nothing() {
    let frames = recording(&[&[Some(Sitting)]]);
    let query = when(vec![does(None, Sitting), does(None, Standing)]);
    let answer = search(&frames[0], &query, &under(MatchPolicy::Strict));
    assert_eq!(found(&answer), [0_u32; 0]);
    assert!(answer.issues.iter().any(|issue| issue.message.contains("only one frame")));
    let late = when(vec![does(Some([5.0, 6.0]), Sitting)]);
    let answer = search_frames(&frames, None, &late, &SearchConfig::default());
    assert_eq!(answer.issues[0].message, "there is no frame for moment 1 of the question");
    let answer = search_frames(&[], None, &query, &SearchConfig::default());
    assert!(answer.selection.is_empty() && answer.trace.is_empty());
}

#[test]
fn an_uncertain_track_is_as_probable_as_its_frames() {
    let mut frames = recording(&[&[Some(Walking); 2], &[Some(Running); 2]]);
    for (frame, p) in frames.iter_mut().zip([0.9, 0.6]) {
        let belief = [(Walking, p), (Running, 1.0 - p)];
        frame.nodes[0].attributes.set_action(Belief(belief.into_iter().collect()));
    }
    let walks = when(vec![does(Some([0.0, 1.0]), Walking)]);
    let answer = search_frames(&frames, None, &walks, &SearchConfig::default());
    assert_eq!(answer.ranking.len(), 1);
    assert!((answer.ranking[0].probability - 0.75).abs() < 1e-9);
    let then = when(vec![does(None, Walking), does(None, Running)]);
    let answer = search_frames(&frames, None, &then, &SearchConfig::default());
    let order: Vec<u32> = answer.ranking.iter().map(|ranked| ranked.id.number).collect();
    assert_eq!(order, [1]);
    assert!((answer.ranking[0].probability - 0.9 * 0.4).abs() < 1e-9);
}
