//! Notation as words, numbers, quoted words and marks.

use jrdb_types::Span;

/// A piece of notation.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Kind {
    /// Letters, and hyphens between letters.
    Word,
    /// Between quotation marks, without them.
    Quoted(String),
    Number(f64),
    /// One of the marks of the grammar.
    Mark,
    /// Not notation: an unknown character, or a quotation without an end.
    Stray,
}

/// A piece with its bytes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Token {
    pub(super) kind: Kind,
    pub(super) span: Span,
}

/// Marks, each before its own prefixes.
const MARKS: [&str; 15] =
    [">=", "<=", "..", "+-", "=", "[", "]", "{", "}", "(", ")", ",", ":", "&", "#"];

/// Splits a text; blanks separate.
pub(super) fn tokenize(text: &str) -> Vec<Token> {
    let mut tokens = Vec::new();
    let mut start = 0;
    while let Some(first) = text[start..].chars().next() {
        if first.is_whitespace() {
            start += first.len_utf8();
            continue;
        }
        let (kind, length) = next(&text[start..], first);
        tokens.push(Token { kind, span: Span { start, end: start + length } });
        start += length;
    }
    tokens
}

fn next(rest: &str, first: char) -> (Kind, usize) {
    if let Some(mark) = MARKS.iter().find(|mark| rest.starts_with(**mark)) {
        return (Kind::Mark, mark.len());
    }
    if first == '"' {
        return quotation(rest);
    }
    if let Some((number, length)) = number(rest) {
        return (Kind::Number(number), length);
    }
    let length = rest.find(|c: char| !(c.is_alphabetic() || c == '-')).unwrap_or(rest.len());
    if first.is_alphabetic() { (Kind::Word, length) } else { (Kind::Stray, first.len_utf8()) }
}

fn quotation(rest: &str) -> (Kind, usize) {
    let mut words = String::new();
    let mut characters = rest.char_indices().skip(1);
    while let Some((at, character)) = characters.next() {
        match character {
            '"' => return (Kind::Quoted(words), at + 1),
            '\\' => words.extend(characters.next().map(|(_, escaped)| escaped)),
            other => words.push(other),
        }
    }
    (Kind::Stray, rest.len())
}

/// A decimal number. A full stop belongs to it only before a digit, so that `0..3` is three pieces.
fn number(rest: &str) -> Option<(f64, usize)> {
    let bytes = rest.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let sign = usize::from(bytes[0] == b'-');
    let whole = digits(sign);
    if whole == 0 {
        return None;
    }
    let mut length = sign + whole;
    if bytes.get(length) == Some(&b'.') && digits(length + 1) > 0 {
        length += 1 + digits(length + 1);
    }
    Some((rest[..length].parse().ok()?, length))
}
