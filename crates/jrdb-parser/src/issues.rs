//! The issues of one question, collected while productions try readings and give them up.

use jrdb_types::issue::IssueKind;
use jrdb_types::{Issue, Span};

use crate::suggest::{Suggestion, suggest};
use crate::token::SUGGESTIONS_MAX;

/// Issues per question. The last one covers all that follow.
const ISSUES_MAX: usize = 64;

/// Bytes of the longest run of words that a message quotes.
const QUOTED_MAX: usize = 60;

/// What the parser did with a word that it could not use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Treatment {
    /// The word adds nothing to the query.
    NotUsed,
    /// The word names an entity, so any entity matches.
    ReadAsAnything,
    /// The word is part of a description.
    Described,
}

impl Treatment {
    fn words(self) -> &'static str {
        match self {
            Self::NotUsed => "not used",
            Self::ReadAsAnything => "read as anything",
            Self::Described => "kept as a description",
        }
    }
}

/// An append-only list of issues, cut back by a rewind. Nothing is merged before the end, so that a
/// rewind drops exactly what was reported since.
#[derive(Debug, Default)]
pub(crate) struct IssueLog {
    issues: Vec<Issue>,
    /// The misplaced words among them, whose neighbours are joined in the end.
    misplaced: Vec<Misplaced>,
    /// The words that were not used, each with the number of issues before it was reported.
    unused: Vec<(usize, Span)>,
}

#[derive(Debug, Clone, Copy)]
struct Misplaced {
    /// Index of its issue.
    index: usize,
    /// One past the last byte of the word before it.
    previous_end: Option<usize>,
}

impl IssueLog {
    /// A log that begins with the misspelled words.
    pub(crate) fn new(misspelled: Vec<Issue>) -> Self {
        Self { issues: misspelled, ..Self::default() }
    }

    pub(crate) fn len(&self) -> usize {
        self.issues.len()
    }

    pub(crate) fn truncate(&mut self, len: usize) {
        if len < self.issues.len() {
            self.issues.truncate(len);
            self.misplaced.retain(|word| word.index < len);
            self.unused.retain(|(index, _)| *index < len);
        }
    }

    pub(crate) fn push(&mut self, issue: Issue) {
        self.issues.push(issue);
    }

    /// Keeps a word that was not used, before its issue is reported.
    pub(crate) fn keep_unused(&mut self, span: Span) {
        self.unused.push((self.issues.len(), span));
    }

    /// The words that were not used.
    pub(crate) fn unused(&self) -> Vec<Span> {
        self.unused.iter().map(|(_, span)| *span).collect()
    }

    /// Reports a word that is not in the lexicon.
    pub(crate) fn push_unknown(&mut self, word: &str, span: Span, treatment: Treatment) {
        let message = format!("unknown word {word:?}, {}", treatment.words());
        self.push(Issue::at(IssueKind::UnknownWord, span, message));
    }

    /// Reports a phrase that names what a scene graph does not hold.
    pub(crate) fn push_unsupported(&mut self, what: &str, span: Span, treatment: Treatment) {
        let message = format!("{what} are not known here, {}", treatment.words());
        self.push(Issue::at(IssueKind::NotInGraph, span, message));
    }

    /// Reports a known word that fits nowhere.
    pub(crate) fn push_misplaced(&mut self, span: Span, previous_end: Option<usize>) {
        self.misplaced.push(Misplaced { index: self.issues.len(), previous_end });
        self.push(Issue::at(IssueKind::MisplacedWord, span, ""));
    }

    /// The issues by position in the text, merged and with suggestions.
    pub(crate) fn finish(self, text: &str) -> Vec<Issue> {
        if self.issues.is_empty() {
            return self.issues;
        }
        let is_final = self.misplaced.is_empty() && self.issues.len() <= ISSUES_MAX;
        let mut issues = if is_final { self.issues } else { self.merged(text) };
        add_suggestions(&mut issues, text);
        issues.sort_by_key(|issue| issue.span);
        issues
    }

    fn merged(self, text: &str) -> Vec<Issue> {
        let mut merged = Vec::new();
        let mut misplaced = self.misplaced.into_iter().peekable();
        for (index, issue) in self.issues.into_iter().enumerate() {
            match misplaced.next_if(|word| word.index == index).zip(issue.span) {
                Some((word, span)) => push_misplaced(&mut merged, text, span, word.previous_end),
                None => push(&mut merged, issue),
            }
        }
        merged
    }
}

/// Appends an issue, or widens the last one when there are too many.
fn push(issues: &mut Vec<Issue>, issue: Issue) {
    match (issues.len() >= ISSUES_MAX, issues.last_mut(), issue.span) {
        (true, Some(last), Some(new)) => {
            last.message = "too many words that were not understood".into();
            let span = last.span.unwrap_or(new);
            last.span = Some(Span { start: span.start.min(new.start), end: new.end.max(span.end) });
        }
        _ => issues.push(issue),
    }
}

/// Appends a misplaced word, or joins it to the misplaced word directly before it.
fn push_misplaced(
    issues: &mut Vec<Issue>,
    text: &str,
    mut span: Span,
    previous_end: Option<usize>,
) {
    if issues.len() >= ISSUES_MAX {
        return push(issues, Issue::at(IssueKind::MisplacedWord, span, ""));
    }
    let last = issues.last_mut().filter(|last| last.kind == IssueKind::MisplacedWord);
    let is_next = |last: Span| Some(last.end) == previous_end;
    let last = last.filter(|last| last.span.is_some_and(is_next));
    if let Some(Span { start, .. }) = last.as_ref().and_then(|last| last.span) {
        span.start = start;
    }
    let words = text.get(span.start..span.end).filter(|words| words.len() <= QUOTED_MAX);
    let message = match words {
        Some(words) => format!("{words:?} fits nowhere here, not used"),
        None => "these words fit nowhere here, not used".into(),
    };
    match last {
        Some(last) => (last.span, last.message) = (Some(span), message),
        None => push(issues, Issue::at(IssueKind::MisplacedWord, span, message)),
    }
}

/// Adds the nearest known words to the first unknown words; the look-up is slow.
fn add_suggestions(issues: &mut [Issue], text: &str) {
    let unknown = issues.iter_mut().filter(|issue| issue.kind == IssueKind::UnknownWord);
    for issue in unknown.take(SUGGESTIONS_MAX) {
        let word = issue.span.and_then(|span| text.get(span.start..span.end));
        let known = word.and_then(suggest).map(Suggestion::word);
        issue.suggestion = known.filter(|known| word != Some(known)).map(str::to_owned);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_back_log_does_not_keep_what_was_joined_to_an_earlier_word() {
        let mut log = IssueLog::default();
        log.push_misplaced(Span { start: 0, end: 2 }, None);
        let len = log.len();
        log.push_misplaced(Span { start: 3, end: 6 }, Some(2));
        log.truncate(len);
        let issues = log.finish("of the man");
        assert_eq!(issues.len(), 1);
        assert_eq!(issues[0].message, "\"of\" fits nowhere here, not used");
    }

    #[test]
    fn neighbours_are_one_issue_and_others_are_two() {
        let mut log = IssueLog::default();
        log.push_misplaced(Span { start: 0, end: 2 }, None);
        log.push_misplaced(Span { start: 3, end: 6 }, Some(2));
        log.push_misplaced(Span { start: 11, end: 14 }, Some(10));
        let spans: Vec<_> = log.finish("of the man the").iter().filter_map(|i| i.span).collect();
        assert_eq!(spans, [Span { start: 0, end: 6 }, Span { start: 11, end: 14 }]);
    }

    #[test]
    fn the_last_of_very_many_issues_covers_the_rest() {
        let mut log = IssueLog::default();
        for start in 0..100 {
            log.push_unknown("x", Span { start, end: start + 1 }, Treatment::NotUsed);
        }
        let issues = log.finish(&"x".repeat(100));
        assert_eq!(issues.len(), ISSUES_MAX);
        assert_eq!(issues[ISSUES_MAX - 1].span, Some(Span { start: 63, end: 100 }));
    }
}
