//! Where the parser stands in the question, and what it can see from there.

use jrdb_types::issue::IssueKind;
use jrdb_types::query::Category;
use jrdb_types::{Condition, Issue, Span, Task};

use crate::lexicon::{Sense, Word};
use crate::suggest::suggest;
use crate::token::{Kind, Token};

/// The tokens, the place among them, and what was not understood so far.
pub(crate) struct Parser {
    pub(crate) tokens: Vec<Token>,
    pub(crate) at: usize,
    pub(crate) issues: Vec<Issue>,
}

impl Parser {
    pub(crate) fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.at)
    }

    pub(crate) fn is(&self, word: Word) -> bool {
        self.peek().is_some_and(|token| token.is_word(word))
    }

    pub(crate) fn is_comma(&self) -> bool {
        self.peek().is_some_and(|token| token.kind == Kind::Comma)
    }

    /// The first sense of the token at hand that `pick` takes.
    pub(crate) fn sense<T>(&self, pick: impl Fn(&'static Sense) -> Option<T>) -> Option<T> {
        self.peek()?.senses().iter().find_map(pick)
    }

    /// Steps over the token at hand when one of its senses is picked.
    pub(crate) fn take<T>(&mut self, pick: impl Fn(&'static Sense) -> Option<T>) -> Option<T> {
        let found = self.sense(pick);
        self.at += usize::from(found.is_some());
        found
    }

    pub(crate) fn skip(&mut self, words: &[Word]) {
        while words.iter().any(|word| self.is(*word)) {
            self.at += 1;
        }
    }

    /// Whether `look` finds what it wants at hand, behind any of `words`; stays where it is.
    pub(crate) fn follows<T>(
        &mut self,
        words: &[Word],
        look: impl Fn(&mut Self) -> Option<T>,
    ) -> bool {
        let start = self.at;
        self.skip(words);
        let found = look(self).is_some();
        self.at = start;
        found
    }

    /// An issue about the tokens from `start` to before `end`, which fit nowhere.
    pub(crate) fn report_unused(&mut self, start: usize, end: usize) {
        let spans = self.tokens[start..end].iter().map(|token| token.span);
        if let Some(span) = spans.reduce(|a, b| Span { start: a.start, end: b.end }) {
            let message = "these words fit nowhere here, not used";
            self.issues.push(Issue::at(IssueKind::UnknownWord, span, message));
        }
    }

    /// Steps over a token that fits nowhere, with an issue.
    pub(crate) fn report_unknown(&mut self) {
        match self.peek().map(|token| (&token.kind, token.span)) {
            Some((Kind::Unknown(word), span)) => {
                let message = format!("unknown word {word:?}, not used");
                let suggestion = suggest(word).map(str::to_owned);
                let issue = Issue::at(IssueKind::UnknownWord, span, message);
                self.issues.push(Issue { suggestion, ..issue });
            }
            Some(_) => self.report_unused(self.at, self.at + 1),
            None => return,
        }
        self.at += 1;
    }
}

pub(crate) fn task(sense: &Sense) -> Option<Task> {
    if let Sense::Task(task) = sense { Some(*task) } else { None }
}

pub(crate) fn noun(sense: &Sense) -> Option<Category> {
    if let Sense::Noun(category) = sense { Some(category.clone()) } else { None }
}

pub(crate) fn attribute(sense: &Sense) -> Option<Condition> {
    if let Sense::Attribute(condition) = sense { Some(condition.clone()) } else { None }
}

pub(crate) fn action(sense: &Sense) -> Option<jrdb_types::Action> {
    if let Sense::Action(action) = sense { Some(*action) } else { None }
}

pub(crate) fn interaction(sense: &Sense) -> Option<String> {
    if let Sense::Interaction(label) = sense { Some(label.clone()) } else { None }
}
