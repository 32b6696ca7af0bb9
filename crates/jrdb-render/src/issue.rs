//! Issues, in words.

use jrdb_types::{EntityId, Issue, Span};

/// Issues as lines: equal messages become one line with all the things that they are about, in the order of the first.
#[must_use]
pub fn notes<'a>(issues: impl IntoIterator<Item = &'a Issue>) -> Vec<String> {
    let mut merged: Vec<(&str, Vec<String>)> = Vec::new();
    for issue in issues {
        let at = merged.iter().position(|(message, _)| *message == issue.message);
        let at = at.unwrap_or_else(|| {
            merged.push((&issue.message, Vec::new()));
            merged.len() - 1
        });
        merged[at].1.extend(issue.subject.as_ref().map(EntityId::short));
    }
    let line = |(message, subjects): &(&str, Vec<String>)| {
        let colon = if subjects.is_empty() { "" } else { ": " };
        format!("note: {}{colon}{message}", subjects.join(" "))
    };
    merged.iter().map(line).collect()
}

/// An issue of a query, below a line that underlines the words of the query that it is about.
#[must_use]
pub fn query_issue(query: &str, issue: &Issue) -> String {
    let hint = issue
        .suggestion
        .as_ref()
        .map(|word| format!("; did you mean {word:?}?"))
        .unwrap_or_default();
    let marks = issue.span.and_then(|span| underline(query, span));
    let marks = marks.map(|marks| format!("{marks}\n")).unwrap_or_default();
    format!("{marks}note: {}{hint}", issue.message)
}

fn underline(query: &str, span: Span) -> Option<String> {
    let before = query.get(..span.start)?.chars().count();
    let under = query.get(span.start..span.end)?.chars().count();
    Some(format!("{}{}", " ".repeat(before), "^".repeat(under)))
}
