//! A text as words, and the words as known phrases.

use jrdb_types::issue::IssueKind;
use jrdb_types::{Issue, Span};

use crate::lexicon::{Entry, LEXICON, Roles, special};
use crate::suggest::{Suggestion, suggest};

/// A word, a number or a mark of the text.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Piece {
    /// Its number in the lexicon, or one of [`special`].
    pub(crate) word: u16,
    /// First byte.
    pub(crate) start: usize,
    /// One past the last byte.
    pub(crate) end: usize,
}

/// A phrase of the text.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Token {
    pub(crate) entry: &'static Entry,
    /// The entry's: looked at more often than all else of it.
    pub(crate) roles: Roles,
    pub(crate) start: usize,
    pub(crate) end: usize,
}

/// How many unknown words are compared with the lexicon; a text with more is no question.
pub(crate) const SUGGESTIONS_MAX: usize = 20;

/// What a byte is to the text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Class {
    Blank,
    Letter,
    Digit,
    Apostrophe,
    Comma,
    Slash,
    /// First byte of a character beyond ASCII.
    Wide,
}

const CLASSES: [Class; 256] = {
    let mut classes = [Class::Blank; 256];
    let mut byte = 0;
    while byte < 256 {
        classes[byte] = match byte as u8 {
            b'a'..=b'z' | b'A'..=b'Z' | b'&' => Class::Letter,
            b'0'..=b'9' => Class::Digit,
            b'\'' => Class::Apostrophe,
            b',' | b';' => Class::Comma,
            b'/' | b'\\' => Class::Slash,
            0x80.. => Class::Wide,
            _ => Class::Blank,
        };
        byte += 1;
    }
    classes
};

/// Splits a text into phrases, the longest of the lexicon at each place. Words of no phrase are read as the one known
/// word that is one edit away, and reported.
pub(crate) fn tokenize(text: &str, issues: &mut Vec<Issue>) -> Vec<Token> {
    let pieces = pieces(text, issues);
    let mut tokens = Vec::with_capacity(pieces.len());
    let mut at = 0;
    while at < pieces.len() {
        let (entry, length) = LEXICON.longest(&pieces[at..]);
        let (start, end) = (pieces[at].start, pieces[at + length - 1].end);
        let entry = LEXICON.entry(entry);
        tokens.push(Token { entry, roles: entry.roles, start, end });
        at += length;
    }
    tokens
}

/// The pieces of a text with their numbers in the lexicon.
pub(crate) fn pieces(text: &str, issues: &mut Vec<Issue>) -> Vec<Piece> {
    let mut suggestions = 0;
    let mut pieces = Vec::with_capacity(text.len() / 5 + 4);
    for mut piece in split(text) {
        if piece.word == special::UNKNOWN {
            let word = &text[piece.start..piece.end];
            piece.word = LEXICON.first_word(&text.as_bytes()[piece.start..], word.len());
            if piece.word == special::UNKNOWN && !word.is_ascii() {
                piece.word = LEXICON.word(&word.replace('’', "'"));
            }
            if piece.word == special::UNKNOWN && suggestions < SUGGESTIONS_MAX {
                suggestions += 1;
                piece.word = corrected(word, piece, issues);
            }
        }
        pieces.push(piece);
    }
    pieces
}

fn corrected(word: &str, piece: Piece, issues: &mut Vec<Issue>) -> u16 {
    let Some(Suggestion::Only(known)) = suggest(word) else { return special::UNKNOWN };
    let span = Span { start: piece.start, end: piece.end };
    let message = format!("unknown word {word:?} read as {known:?}");
    let issue = Issue::at(IssueKind::MisspelledWord, span, message);
    issues.push(Issue { suggestion: Some(known.to_owned()), ..issue });
    LEXICON.word(known)
}

/// The pieces of a text. Words are runs of letters and apostrophes, but `'s` and `'re` are words of their own;
/// a hyphen between digits is a dash; every other mark only separates.
pub(crate) fn split(text: &str) -> impl Iterator<Item = Piece> {
    let bytes = text.as_bytes();
    let mut at = 0;
    std::iter::from_fn(move || {
        while at < bytes.len() {
            // Nearly every separator is one.
            if bytes[at] == b' ' {
                at += 1;
                continue;
            }
            let start = at;
            let (word, length) = piece(bytes, text, at);
            at += length;
            if let Some(word) = word {
                return Some(Piece { word, start, end: at });
            }
        }
        None
    })
}

/// What begins at a byte: a piece, or a separator, and its length.
fn piece(bytes: &[u8], text: &str, at: usize) -> (Option<u16>, usize) {
    match CLASSES[usize::from(bytes[at])] {
        Class::Letter => (Some(special::UNKNOWN), word_length(bytes, text, at)),
        Class::Digit => (Some(special::NUMBER), number_length(bytes, at)),
        Class::Comma => (Some(special::COMMA), 1),
        Class::Slash => (Some(special::SLASH), 1),
        Class::Apostrophe if at == 0 || is_letter(bytes, at - 1) => match suffix(bytes, at + 1) {
            0 => (None, 1),
            length => (Some(special::UNKNOWN), 1 + length),
        },
        Class::Blank if bytes[at] == b'-' && is_digit(bytes, at.wrapping_sub(1)) => {
            (is_digit(bytes, at + 1).then_some(special::DASH), 1)
        }
        Class::Wide => wide(bytes, text, at),
        Class::Blank | Class::Apostrophe => (None, 1),
    }
}

fn is_letter(bytes: &[u8], at: usize) -> bool {
    bytes.get(at).is_some_and(|byte| CLASSES[usize::from(*byte)] == Class::Letter)
}

fn is_digit(bytes: &[u8], at: usize) -> bool {
    bytes.get(at).is_some_and(u8::is_ascii_digit)
}

/// The length of the `s` or `re` that stands alone here, 0 when something else does.
fn suffix(bytes: &[u8], at: usize) -> usize {
    let length = bytes[at..].iter().take(3).take_while(|b| b.is_ascii_alphanumeric()).count();
    let letters = &bytes[at..at + length];
    let is_suffix = letters.eq_ignore_ascii_case(b"s") || letters.eq_ignore_ascii_case(b"re");
    if is_suffix { length } else { 0 }
}

/// Bytes that are looked at together; few words are longer.
const CHUNK: usize = 16;

/// How many ASCII letters and digits a text begins with, as far as its first [`CHUNK`] tells; 0 when it is shorter.
fn plain_length(bytes: &[u8]) -> usize {
    let Some(mut first) = bytes.first_chunk::<CHUNK>().copied() else { return 0 };
    for byte in &mut first {
        *byte = if byte.is_ascii_alphanumeric() { u8::MAX } else { 0 };
    }
    (u128::from_le_bytes(first).trailing_ones() / u8::BITS) as usize
}

fn word_length(bytes: &[u8], text: &str, start: usize) -> usize {
    let plain = plain_length(&bytes[start..]);
    let is_whole = bytes.get(start + plain) == Some(&b' ');
    if is_whole { plain } else { word_end(bytes, text, start + plain) - start }
}

/// Where the word ends that goes on at a place, if it does.
fn word_end(bytes: &[u8], text: &str, mut at: usize) -> usize {
    while at < bytes.len() {
        at += match CLASSES[usize::from(bytes[at])] {
            Class::Letter | Class::Digit => 1,
            Class::Apostrophe if is_letter(bytes, at + 1) && suffix(bytes, at + 1) == 0 => 1,
            Class::Wide => match text[at..].chars().next() {
                Some('’') if suffix(bytes, at + 3) > 0 => break,
                Some(wide) if wide == '’' || is_of_word(wide) => wide.len_utf8(),
                _ => break,
            },
            _ => break,
        };
    }
    at
}

fn number_length(bytes: &[u8], start: usize) -> usize {
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let whole = digits(start);
    let point = start + whole;
    let has_point = bytes.get(point) == Some(&b'.') && is_digit(bytes, point + 1);
    if has_point { whole + 1 + digits(point + 1) } else { whole }
}

/// Letters and digits of any script, and the marks that combine with them.
fn is_of_word(character: char) -> bool {
    character.is_alphanumeric() || matches!(character, '\u{300}'..='\u{36f}')
}

fn wide(bytes: &[u8], text: &str, at: usize) -> (Option<u16>, usize) {
    let Some(character) = text[at..].chars().next() else { return (None, 1) };
    let length = character.len_utf8();
    match character {
        '’' if at > 0 && is_letter(bytes, at - 1) && suffix(bytes, at + length) > 0 => {
            (Some(special::UNKNOWN), length + suffix(bytes, at + length))
        }
        '–' | '—' if at > 0 && is_digit(bytes, at - 1) && is_digit(bytes, at + length) => {
            (Some(special::DASH), length)
        }
        '°' => (Some(special::UNKNOWN), length),
        _ if is_of_word(character) => (Some(special::UNKNOWN), word_length(bytes, text, at)),
        _ => (None, length),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(text: &str) -> Vec<&str> {
        tokenize(text, &mut Vec::new()).iter().map(|t| &text[t.start..t.end]).collect()
    }

    #[test]
    fn the_longest_phrase_wins_and_hyphens_are_blanks() {
        assert_eq!(shown("Middle-aged, in front of"), ["Middle-aged", ",", "in front of"]);
        assert_eq!(
            shown("his\\her 3m 2-4 0.13"),
            ["his", "\\", "her", "3", "m", "2", "-", "4", "0.13"]
        );
    }

    #[test]
    fn the_possessive_is_a_word_of_its_own_with_either_apostrophe() {
        assert_eq!(shown("the man's left"), ["the", "man", "'s", "left"]);
        assert_eq!(shown("who’s isn’t 'quoted'"), ["who", "’s", "isn’t", "quoted"]);
        assert_eq!(shown("the girls' left"), ["the", "girls", "left"]);
    }

    #[test]
    fn words_of_other_scripts_keep_their_bytes() {
        assert_eq!(shown("a zébra 人 cafe\u{301}!"), ["a", "zébra", "人", "cafe\u{301}"]);
    }

    #[test]
    fn a_typo_is_read_as_the_word_meant_and_reported() {
        let mut issues = Vec::new();
        let tokens = tokenize("the femlae person", &mut issues);
        assert!(!tokens[1].entry.says.is_empty());
        assert_eq!(issues[0].message, r#"unknown word "femlae" read as "female""#);
        assert_eq!(issues[0].span, Some(Span { start: 4, end: 10 }));
    }
}
