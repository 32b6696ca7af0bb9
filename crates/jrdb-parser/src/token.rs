//! The question's text as known phrases, punctuation and unknown words, each with its bytes.

use jrdb_types::Span;

use crate::lexicon::{LEXICON, Sense, Word};

/// A stretch of the question.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Token {
    pub(crate) kind: Kind,
    pub(crate) span: Span,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A phrase of the lexicon.
    Known(&'static [Sense]),
    /// A comma or semicolon.
    Comma,
    /// A slash or backslash between words.
    Slash,
    /// A word that is in no phrase, lower case.
    Unknown(String),
}

impl Token {
    pub(crate) fn is_word(&self, word: Word) -> bool {
        self.senses().contains(&Sense::Word(word))
    }

    pub(crate) fn senses(&self) -> &'static [Sense] {
        match self.kind {
            Kind::Known(senses) => senses,
            _ => &[],
        }
    }
}

/// A word of the text, or a mark.
struct Piece {
    text: String,
    span: Span,
    is_word: bool,
}

/// Splits a question: the longest phrase of the lexicon at each place; full stops, question marks and
/// brackets only separate.
pub(crate) fn tokenize(text: &str) -> Vec<Token> {
    let pieces = pieces(text);
    let mut tokens = Vec::new();
    let mut at = 0;
    while at < pieces.len() {
        let (token, length) = token_at(&pieces[at..]);
        tokens.extend(token);
        at += length;
    }
    tokens
}

fn token_at(pieces: &[Piece]) -> (Option<Token>, usize) {
    let first = &pieces[0];
    if !first.is_word {
        let kind = match first.text.as_str() {
            "," | ";" => Some(Kind::Comma),
            "/" | "\\" => Some(Kind::Slash),
            _ => None,
        };
        return (kind.map(|kind| Token { kind, span: first.span }), 1);
    }
    let words: Vec<&str> = pieces
        .iter()
        .take(LEXICON.longest)
        .take_while(|p| p.is_word)
        .map(|p| p.text.as_str())
        .collect();
    for length in (1..=words.len()).rev() {
        let senses = LEXICON.senses(&words[..length].join(" "));
        if !senses.is_empty() {
            let span = Span { start: first.span.start, end: pieces[length - 1].span.end };
            return (Some(Token { kind: Kind::Known(senses), span }), length);
        }
    }
    (Some(Token { kind: Kind::Unknown(first.text.clone()), span: first.span }), 1)
}

/// Words are runs of letters, digits and apostrophes; hyphens separate as blanks do; every other mark
/// is a piece of its own.
fn pieces(text: &str) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = Vec::new();
    let mut open = false;
    for (start, character) in text.char_indices() {
        let span = Span { start, end: start + character.len_utf8() };
        let is_word = character.is_alphanumeric() || character == '\'';
        match pieces.last_mut().filter(|_| open && is_word) {
            Some(piece) => {
                piece.text.extend(character.to_lowercase());
                piece.span.end = span.end;
            }
            None if is_word || !(character.is_whitespace() || character == '-') => {
                pieces.push(Piece { text: character.to_lowercase().collect(), span, is_word });
            }
            None => {}
        }
        open = is_word;
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(text: &str) -> Vec<String> {
        let show = |token: &Token| match &token.kind {
            Kind::Unknown(word) => format!("?{word}"),
            _ => text[token.span.start..token.span.end].to_string(),
        };
        tokenize(text).iter().map(show).collect()
    }

    #[test]
    fn the_longest_phrase_wins_and_hyphens_are_blanks() {
        assert_eq!(shown("Middle-aged, in front of"), ["Middle-aged", ",", "in front of"]);
        assert_eq!(shown("very close to"), ["very close", "to"]);
    }

    #[test]
    fn brackets_and_full_stops_only_separate() {
        assert_eq!(shown("me(robot)."), ["me", "robot"]);
        assert_eq!(shown("his\\her"), ["his", "\\", "her"]);
    }

    #[test]
    fn unknown_words_keep_their_bytes() {
        assert_eq!(shown("a zébra"), ["a", "?zébra"]);
        assert_eq!(tokenize("a zébra")[1].span, Span { start: 2, end: 8 });
    }
}
