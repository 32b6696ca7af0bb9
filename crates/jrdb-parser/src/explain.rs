//! A query in readable form: the question, the notation, and the issues underlined.

use std::fmt::Write as _;

use jrdb_types::issue::IssueKind;
use jrdb_types::{Issue, Query, Span};

use crate::notation;

/// Returns the question, its notation, and each issue under the words that it is about.
///
/// ```
/// use jrdb_parser::{explain, parse};
/// let text = "the femlae near me";
/// assert_eq!(explain(text, &parse(text)), "\
/// the femlae near me
/// = find person[female, distance=close]
///
/// the femlae near me
///     ^^^^^^ unknown word \"femlae\" read as \"female\"
/// ");
/// ```
#[must_use]
pub fn explain(text: &str, query: &Query) -> String {
    let mut out = format!("{}\n= {}\n", printable(text), notation::write(query));
    for issue in &query.issues {
        underline(&mut out, text, issue);
    }
    out
}

/// Appends the line with the issue, with carets below its words and the message behind them.
fn underline(out: &mut String, text: &str, issue: &Issue) {
    let span = issue.span.unwrap_or(Span { start: 0, end: 0 });
    let (start, end) = (boundary(text, span.start), boundary(text, span.end));
    let line_start = text[..start].rfind('\n').map_or(0, |at| at + 1);
    let line_end = text[start..].find('\n').map_or(text.len(), |at| start + at);
    let line = &text[line_start..line_end];
    let blanks = columns(&text[line_start..start]);
    let carets = columns(&text[start..end.clamp(start, line_end)]);
    let marks = "^".repeat(carets.max(usize::from(issue.span.is_some())));
    let _ = write!(out, "\n{}\n{}{marks} {}", printable(line), " ".repeat(blanks), issue.message);
    let is_in_message = issue.kind == IssueKind::MisspelledWord;
    if let Some(suggestion) = issue.suggestion.as_ref().filter(|_| !is_in_message) {
        let _ = write!(out, "; did you mean {suggestion:?}?");
    }
    out.push('\n');
}

/// The nearest byte at or before `at` where a character begins.
fn boundary(text: &str, at: usize) -> usize {
    (0..=at.min(text.len())).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0)
}

/// The text as printed: a tab or another control character is one blank wide.
fn printable(text: &str) -> String {
    text.chars().map(|c| if c.is_control() && c != '\n' { ' ' } else { c }).collect()
}

/// Width of a text in terminal columns.
fn columns(text: &str) -> usize {
    text.chars().map(width).sum()
}

/// Width of a character in columns: 0 for combining marks, 2 for wide scripts and pictures (the
/// ranges of Unicode's East Asian Width that matter in questions).
fn width(character: char) -> usize {
    match character {
        '\u{300}'..='\u{36f}'
        | '\u{200b}'..='\u{200f}'
        | '\u{20d0}'..='\u{20ff}'
        | '\u{fe00}'..='\u{fe0f}' => 0,
        '\u{1100}'..='\u{115f}'
        | '\u{2e80}'..='\u{303e}'
        | '\u{3041}'..='\u{a4cf}'
        | '\u{ac00}'..='\u{d7a3}'
        | '\u{f900}'..='\u{faff}'
        | '\u{fe30}'..='\u{fe6f}'
        | '\u{ff00}'..='\u{ff60}'
        | '\u{ffe0}'..='\u{ffe6}'
        | '\u{1f300}'..='\u{1faff}'
        | '\u{20000}'..='\u{3fffd}' => 2,
        _ => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parse;

    /// Columns where the carets of the first issue begin and end.
    fn carets(text: &str) -> (usize, usize) {
        let shown = explain(text, &parse(text));
        let line =
            shown.lines().find(|line| line.contains('^')).unwrap_or_else(|| panic!("{shown}"));
        (line.find('^').unwrap(), line.rfind('^').unwrap() + 1)
    }

    #[test]
    fn carets_stand_below_the_word() {
        assert_eq!(carets("the zzyzx"), (4, 9));
    }

    #[test]
    fn tabs_wide_and_combining_characters_do_not_shift_them() {
        assert_eq!(carets("the\tman zzyzx"), (8, 13));
        assert_eq!(carets("🙂 the zzyzx"), (7, 12));
        assert_eq!(carets("人 the man"), (0, 2));
        assert_eq!(carets("the cafe\u{301}s"), (4, 9));
    }

    #[test]
    fn only_the_line_of_the_word_is_shown() {
        let shown = explain("the man\nand the zzyzx", &parse("the man\nand the zzyzx"));
        assert!(
            shown.ends_with("\nand the zzyzx\n        ^^^^^ unknown word \"zzyzx\", not used\n"),
            "{shown}"
        );
    }

    #[test]
    fn an_issue_without_words_and_one_beyond_the_text_are_printed() {
        let mut query = parse("");
        assert!(explain("", &query).contains("the question has no words"));
        query.issues[0].span = Some(Span { start: 5, end: 900 });
        assert!(explain("人人人", &query).contains('^'));
    }
}
