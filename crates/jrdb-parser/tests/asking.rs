//! Every example of docs/asking.md is read as the page says.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]

use jrdb_parser::{notation, parse};

#[test]
fn the_page_on_what_can_be_asked_tells_the_truth() {
    let page = include_str!("../../../docs/asking.md");
    let rows = page.lines().filter_map(|line| line.strip_prefix("| ")?.strip_suffix("` |"));
    let rows: Vec<(&str, &str)> = rows.filter_map(|row| row.split_once(" | `")).collect();
    assert!(rows.len() >= 20, "only {} examples", rows.len());
    for (english, meaning) in rows {
        assert_eq!(notation::write(&parse(english)), meaning, "{english}");
    }
}
