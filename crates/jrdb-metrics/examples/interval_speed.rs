//! How long intervals, a comparison and merging take:
//! `cargo run --release -p jrdb-metrics --example interval_speed [QUESTIONS] [RECORDINGS] [DRAWS]`.
#![allow(clippy::print_stdout, reason = "an example says what it found")]

use std::time::Instant;

use jrdb_metrics::{BootstrapConfig, MetricsConfig, compare, from_judgements, intervals, merge};
use jrdb_types::score::{Candidate, MatchMask, QuestionScore, ReplyKind};
use jrdb_types::{FrameId, Scores, Status};

/// Candidates of a question, of which one is meant.
const CANDIDATES: usize = 20;
const CATEGORIES: usize = 7;
const PARTS: usize = 100;

fn main() {
    let mut numbers = std::env::args().skip(1).map_while(|number| number.parse().ok());
    let (questions, recordings) = (numbers.next().unwrap_or(10_000), numbers.next().unwrap_or(27));
    let mut config = BootstrapConfig::default();
    config.draws = numbers.next().unwrap_or(config.draws);
    let runs = [run(questions, recordings, 3), run(questions, recordings, 4)];
    let count = runs[0].questions.len();
    println!("{count} questions, {recordings} recordings, {} draws", config.draws);
    time("intervals of 12 metrics, 8 groups", || intervals(&runs[0], &config));
    time("comparison of 12 metrics, 8 groups", || compare(&runs[0], &runs[1], &config).is_ok());
    let protocol = &runs[0].protocol;
    let part = |some: &[QuestionScore]| from_judgements(protocol.clone(), some.to_vec());
    let parts: Vec<Scores> = runs[0].questions.chunks(count.div_ceil(PARTS)).map(part).collect();
    time("merging 100 parts", || merge(&parts).is_ok());
}

fn time<T>(what: &str, work: impl FnOnce() -> T) {
    let start = Instant::now();
    let _ = work();
    println!("{what}: {:.2} s", start.elapsed().as_secs_f64());
}

fn run(questions: usize, recordings: usize, skill: usize) -> Scores {
    let one = |n| question(n, n % recordings, skill);
    from_judgements(MetricsConfig::default().protocol(), (0..questions).map(one).collect())
}

fn question(number: usize, recording: usize, skill: usize) -> QuestionScore {
    let mixed = (number * 2_654_435_761) % 1_000_003;
    let is_right = (mixed + recording) % 5 < skill;
    let reached = if is_right { 4 + mixed % 7 } else { 0 };
    let candidate = |place: usize| Candidate {
        score: ((mixed * (place + 7)) % 9_973) as f64 / 9_973.0 / (place + 1) as f64,
        matches: MatchMask::of(0..if place == mixed % 3 { reached } else { 0 }),
    };
    let mut ranking: Vec<Candidate> = (0..CANDIDATES).map(candidate).collect();
    ranking.sort_by(|a, b| b.score.total_cmp(&a.score));
    let right = usize::from(is_right);
    QuestionScore {
        frame: FrameId { sequence: format!("recording {recording}"), frame: 0 },
        question_id: Some(number.to_string()),
        question: "Find them".into(),
        category: format!("category {}", mixed % CATEGORIES),
        status: Some(Status::Answered),
        reply: Some(ReplyKind::Things),
        exact: Some(is_right),
        true_positives: right,
        false_positives: 1 - right,
        false_negatives: 1 - right,
        matched_iou: 0.8 * right as f64,
        selection: vec![MatchMask::of(0..reached)],
        ranking,
        count: None,
        yes_no: None,
        words: None,
    }
}
