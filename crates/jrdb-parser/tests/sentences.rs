//! Every question of `sentences.query` has the meaning and the issues that are written below it.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]

use jrdb_parser::{notation, parse};
use jrdb_types::Issue;

/// A question with its expected meaning and issues.
struct Case {
    line: usize,
    text: &'static str,
    meaning: &'static str,
    /// Words and a part of the message.
    issues: Vec<(&'static str, &'static str)>,
}

fn cases() -> Vec<Case> {
    let mut cases: Vec<Case> = Vec::new();
    for (at, line) in include_str!("sentences.query").lines().enumerate() {
        if let Some(meaning) = line.strip_prefix("  = ") {
            cases.last_mut().unwrap().meaning = meaning;
        } else if let Some(issue) = line.strip_prefix("  ! ") {
            let (words, message) = issue.rsplit_once(": ").unwrap();
            cases.last_mut().unwrap().issues.push((words, message));
        } else if !line.is_empty() && !line.starts_with("# ") {
            cases.push(Case { line: at + 1, text: line, meaning: "", issues: Vec::new() });
        }
    }
    cases
}

/// Whether the issues are the expected ones, in any order.
fn are_expected(issues: &[Issue], case: &Case) -> bool {
    let is = |issue: &Issue, (words, message): &(&str, &str)| {
        let span = issue.span.map_or("", |span| &case.text[span.start..span.end]);
        span == *words && issue.message.contains(message)
    };
    issues.len() == case.issues.len()
        && issues.iter().all(|issue| case.issues.iter().any(|e| is(issue, e)))
        && case.issues.iter().all(|e| issues.iter().any(|issue| is(issue, e)))
}

/// The difference between the reading and the expectation, if there is one.
fn fault(case: &Case) -> Option<String> {
    let query = parse(case.text);
    let expected = notation::read(case.meaning).map_err(|e| (case.line, e)).unwrap();
    // The notation leaves out where a phrase stands in the question.
    if notation::write(&query) == notation::write(&expected) && are_expected(&query.issues, case) {
        return None;
    }
    let issues: Vec<String> = query
        .issues
        .iter()
        .map(|i| format!("{:?}: {}", i.span.map_or("", |s| &case.text[s.start..s.end]), i.message))
        .collect();
    let (line, text, meaning) = (case.line, case.text, case.meaning);
    let read = notation::write(&query);
    Some(format!("{line}: {text}\n  expected {meaning}\n  read as  {read}\n  issues   {issues:?}"))
}

#[test]
fn every_question_means_what_is_written_below_it() {
    let cases = cases();
    let faults: Vec<String> = cases.iter().filter_map(fault).collect();
    println!("{} of {} questions", cases.len() - faults.len(), cases.len());
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(cases.len() >= 2000, "only {} questions", cases.len());
}
