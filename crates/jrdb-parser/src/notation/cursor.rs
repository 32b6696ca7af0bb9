//! The position of the reader of the notation, and its elementary operations.

use jrdb_types::Span;

use super::error::NotationError;
use super::token::{Kind, Token, tokenize};

/// Maximum depth of nested patterns and conditions.
const DEPTH_MAX: usize = 60;

pub(super) type Read<T> = Result<T, NotationError>;

/// The pieces of a text and the position among them.
pub(super) struct Reader<'a> {
    text: &'a str,
    tokens: Vec<Token>,
    pub(super) at: usize,
    depth: usize,
}

impl<'a> Reader<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Self { text, tokens: tokenize(text), at: 0, depth: 0 }
    }

    pub(super) fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.at)
    }

    pub(super) fn word_at(&self, at: usize) -> Option<&'a str> {
        let token = self.tokens.get(at).filter(|t| matches!(t.kind, Kind::Word | Kind::Mark))?;
        Some(&self.text[token.span.start..token.span.end])
    }

    pub(super) fn is(&self, word: &str) -> bool {
        self.word_at(self.at) == Some(word)
    }

    pub(super) fn takes(&mut self, word: &str) -> bool {
        let found = self.is(word);
        self.at += usize::from(found);
        found
    }

    pub(super) fn expect(&mut self, word: &str) -> Read<()> {
        if self.takes(word) { Ok(()) } else { Err(self.wanted(&format!("{word:?}"))) }
    }

    pub(super) fn wanted(&self, expected: &str) -> NotationError {
        let end = Span { start: self.text.len(), end: self.text.len() };
        let span = self.peek().map_or(end, |token| token.span);
        let word: String = self.text[span.start..span.end].chars().take(30).collect();
        let found = if self.peek().is_some() { format!("{word:?}") } else { "the end".into() };
        NotationError { expected: expected.into(), found, span }
    }

    /// The longest run of up to three words that `read` knows.
    pub(super) fn vocabulary<T>(&mut self, read: impl Fn(&str) -> Option<T>) -> Option<T> {
        for length in (1..=3).rev() {
            let words: Option<Vec<&str>> =
                (self.at..self.at + length).map(|at| self.word_at(at)).collect();
            if let Some(found) = words.and_then(|words| read(&words.join(" "))) {
                self.at += length;
                return Some(found);
            }
        }
        None
    }

    pub(super) fn number(&mut self) -> Option<f64> {
        let Some(Kind::Number(number)) = self.peek().map(|token| &token.kind) else { return None };
        let number = *number;
        self.at += 1;
        Some(number)
    }

    pub(super) fn need_number(&mut self) -> Read<f64> {
        self.number().ok_or_else(|| self.wanted("a number"))
    }

    pub(super) fn whole(&mut self) -> Read<u32> {
        let error = self.wanted("a whole number");
        let number = self.need_number()?;
        let is_whole = number >= 0.0 && number <= f64::from(u32::MAX) && number.fract() == 0.0;
        if is_whole { Ok(number as u32) } else { Err(error) }
    }

    pub(super) fn quoted(&mut self) -> Option<String> {
        let Some(Kind::Quoted(words)) = self.peek().map(|token| &token.kind) else { return None };
        let words = words.clone();
        self.at += 1;
        Some(words)
    }

    pub(super) fn nested<T>(&mut self, read: impl FnOnce(&mut Self) -> Read<T>) -> Read<T> {
        if self.depth == DEPTH_MAX {
            return Err(self.wanted(&format!("at most {DEPTH_MAX} levels")));
        }
        self.depth += 1;
        let found = read(self);
        self.depth -= 1;
        found
    }
}
