//! What holds of every graph and question.

use jrdb_graph::GraphIndex;
use jrdb_types::query::Measure;
use jrdb_types::vocab::MatchPolicy;
use jrdb_types::*;
use proptest::prelude::*;

use super::graphs::{Beliefs, Random};
use jrdb_render::{explain, why_not};

use super::{asked, graphs, selected, under};
use crate::{SearchConfig, search, select};

const POLICIES: [MatchPolicy; 3] =
    [MatchPolicy::Strict, MatchPolicy::Majority, MatchPolicy::Ranked];

fn scene(seed: u64, beliefs: Beliefs) -> SceneGraph {
    graphs::random(&mut Random(seed), beliefs)
}

proptest! {
    #![proptest_config(ProptestConfig { max_global_rejects: 100_000, ..ProptestConfig::with_cases(1500) })]

    #[test]
    fn sets_and_traces_agree(seed: u64, question: u64) {
        let (scene, query) = (scene(seed, Beliefs::Mixed), asked::random(&mut Random(question)));
        let index = GraphIndex::new(&scene);
        let engine = SearchConfig::benchmark();
        for config in POLICIES.map(under).into_iter().chain([engine]) {
            let by_sets: Vec<EntityId> =
                select(&index, &query, &config).iter().filter_map(|n| index.id(n)).cloned().collect();
            let answer = search(&scene, &query, &config);
            prop_assert_eq!(&by_sets, &answer.selection, "{:?} {:?}", config.policy, query);
            let traced: Vec<EntityId> =
                answer.trace.iter().filter(|t| t.selected).map(|t| t.id.clone()).collect();
            prop_assert_eq!(by_sets, traced);
        }
    }

    #[test]
    fn ranked_equals_strict_whenever_nothing_is_uncertain_and_anything_matches(seed: u64, question: u64) {
        let (scene, query) = (scene(seed, Beliefs::Certain), asked::random(&mut Random(question)));
        let strict = selected(&scene, &query, MatchPolicy::Strict);
        let without_pick =
            Query { target: Pattern { pick: None, ..query.target.clone() }, ..query.clone() };
        let anything = selected(&scene, &without_pick, MatchPolicy::Strict);
        // A pick by the distance to others asks for those in its own right, and of them nobody may match strictly.
        let measure = query.target.pick.as_ref().map(|pick| &pick.measure);
        prop_assume!(!anything.is_empty() && !matches!(measure, Some(Measure::DistanceTo(_))));
        prop_assert_eq!(strict, selected(&scene, &query, MatchPolicy::Ranked), "{:?}", query);
    }

    #[test]
    fn what_matches_strictly_matches_by_majority(seed: u64, question: u64) {
        let (scene, query) = (scene(seed, Beliefs::Mixed), asked::plain(&mut Random(question)));
        let majority = selected(&scene, &query, MatchPolicy::Majority);
        let strict = selected(&scene, &query, MatchPolicy::Strict);
        prop_assert!(strict.iter().all(|id| majority.contains(id)));
    }

    #[test]
    fn the_order_of_nodes_and_edges_changes_no_answer(seed: u64, question: u64) {
        let (scene, query) = (scene(seed, Beliefs::Mixed), asked::random(&mut Random(question)));
        let mut turned = scene.clone();
        turned.nodes.reverse();
        turned.edges.reverse();
        for policy in POLICIES {
            prop_assert_eq!(selected(&scene, &query, policy), selected(&turned, &query, policy));
        }
    }

    #[test]
    fn the_same_question_has_the_same_answer(seed: u64, question: u64) {
        let (scene, query) = (scene(seed, Beliefs::Mixed), asked::random(&mut Random(question)));
        let answer = || search(&scene, &query, &SearchConfig::default());
        prop_assert_eq!(answer(), answer());
    }

    #[test]
    fn every_selected_one_is_ranked_and_every_candidate_explained(seed: u64, question: u64) {
        let (scene, query) = (scene(seed, Beliefs::Mixed), asked::random(&mut Random(question)));
        for policy in POLICIES {
            let answer = search(&scene, &query, &under(policy));
            for id in &answer.selection {
                prop_assert!(answer.ranking.iter().any(|ranked| ranked.id == *id));
            }
            prop_assert!(answer.ranking.iter().all(|ranked| (0.0..=1.0).contains(&ranked.probability)));
            let sorted = answer.ranking.is_sorted_by(|a, b| a.probability >= b.probability);
            prop_assert!(sorted);
            for trace in &answer.trace {
                prop_assert!(!why_not(&answer, &trace.id).is_empty());
                prop_assert_eq!(trace.checks.len() - usize::from(query.target.pick.is_some()), query.target.conditions.len());
            }
            prop_assert!(!explain(&answer, 3).is_empty());
        }
    }

    #[test]
    fn nothing_is_both_so_and_not_so(seed: u64, question: u64) {
        let scene = scene(seed, Beliefs::Mixed);
        let query = asked::plain(&mut Random(question));
        let not = |c: &Condition| Condition::Not(Box::new(c.clone()));
        for condition in &query.target.conditions {
            let so = super::strictly(&scene, vec![condition.clone()]);
            let not_so = super::strictly(&scene, vec![not(condition)]);
            prop_assert!(so.iter().all(|id| !not_so.contains(id)));
            prop_assert_eq!(super::strictly(&scene, vec![not(&not(condition))]), so);
        }
    }
}
