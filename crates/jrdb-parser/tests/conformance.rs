//! The questions that the benchmark's own engine generated.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]

use std::collections::BTreeMap;

use jrdb_parser::parse;
use serde_json::Value;

fn questions() -> Option<Value> {
    let default = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared");
    let shared = std::env::var("JRDB_SHARED").unwrap_or_else(|_| default.into());
    let path = format!("{shared}/goldens/jrdb_reasoning/questions.json");
    let text = std::fs::read_to_string(path).ok()?;
    Some(serde_json::from_str(&text).unwrap())
}

/// The question and its sub-questions.
fn texts(record: &Value) -> Vec<&str> {
    let subs = record["sub_questions"].as_object();
    let subs = subs.into_iter().flat_map(serde_json::Map::values);
    let subs = subs.filter_map(|value| value.as_str().or_else(|| value["question"].as_str()));
    record["question"].as_str().into_iter().chain(subs).collect()
}

#[test]
fn conformance_questions_are_understood() {
    let Some(questions) = questions() else {
        println!("skipped: no shared data");
        return;
    };
    let mut counts: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    let mut faults = Vec::new();
    for record in questions.as_array().unwrap() {
        let (clean, all) = counts.entry(record["category"].as_str().unwrap_or("")).or_default();
        for text in texts(record) {
            let issues = parse(text).issues;
            *all += 1;
            *clean += usize::from(issues.is_empty());
            faults.extend((!issues.is_empty()).then(|| format!("{text}: {:?}", issues[0].message)));
        }
    }
    for (category, (clean, all)) in &counts {
        println!("{category}: {clean} of {all}");
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
