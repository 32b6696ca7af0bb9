//! Splits a text into words, numbers and marks, and computes the keys to look words up by.

/// Numbers of what is not a word of the file. The entries of the same numbers stand for them.
pub(crate) mod special {
    /// A word of no phrase.
    pub(crate) const UNKNOWN: u16 = 0;
    /// Digits.
    pub(crate) const NUMBER: u16 = 1;
    /// A comma or semicolon.
    pub(crate) const COMMA: u16 = 2;
    /// A slash or backslash.
    pub(crate) const SLASH: u16 = 3;
    /// A dash between numbers.
    pub(crate) const DASH: u16 = 4;
    /// The end of the text.
    pub(crate) const END: u16 = 5;
    /// Their count.
    pub(crate) const COUNT: u16 = 6;
}

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

/// The class of a byte.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Class {
    Blank,
    Letter,
    Digit,
    Apostrophe,
    Comma,
    Slash,
    /// The mark before the number of a thing.
    Hash,
    /// First byte of a character outside ASCII.
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
            b'#' => Class::Hash,
            b',' | b';' => Class::Comma,
            b'/' | b'\\' => Class::Slash,
            0x80.. => Class::Wide,
            _ => Class::Blank,
        };
        byte += 1;
    }
    classes
};

/// Letters of the longest word of the lexicon.
pub(crate) const LETTERS_MAX: usize = 16;

/// The letters of a word in lower case, as one number; 0 for an empty word and for one that is too
/// long for the lexicon.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Key(u128);

impl Key {
    /// The key of the first `length` bytes of a text.
    pub(crate) fn of(text: &[u8], length: usize) -> Self {
        let mut letters = [0; LETTERS_MAX];
        if let (Some(to), Some(word)) = (letters.get_mut(..length), text.get(..length)) {
            to.copy_from_slice(word);
        }
        letters.make_ascii_lowercase();
        Self(u128::from_le_bytes(letters))
    }

    /// The key of a word from its first eight letters and the others, in lower case, each padded
    /// with zeros.
    pub(crate) fn from_halves(first: u64, second: u64) -> Self {
        Self(u128::from(second) << u64::BITS | u128::from(first))
    }

    /// Both halves combined, for hashing.
    pub(super) fn folded(self) -> u64 {
        self.0 as u64 ^ (self.0 >> u64::BITS) as u64
    }
}

/// The pieces of a text, with the keys of its words. Words are runs of letters and apostrophes, but
/// `'s` and `'re` are words of their own. A hyphen between digits is a dash; every other mark only
/// separates.
pub(crate) fn split(text: &str) -> impl Iterator<Item = (Piece, Key)> {
    let bytes = text.as_bytes();
    let mut at = 0;
    std::iter::from_fn(move || {
        loop {
            let rest = &bytes[at..];
            let start = at;
            // Nearly every separator is a single blank.
            if *rest.first()? == b' ' {
                at += 1;
                continue;
            }
            if let Some((key, length)) = plain_word(rest) {
                at += length;
                return Some((Piece { word: special::UNKNOWN, start, end: at }, key));
            }
            let (word, length) = piece(bytes, text, at);
            at += length;
            if let Some(word) = word {
                return Some((Piece { word, start, end: at }, Key::of(rest, length)));
            }
        }
    })
}

/// Bytes that are examined together; few words are longer.
const CHUNK: usize = 8;

/// A number whose bytes are all 1.
const ONES: u64 = u64::MAX / u8::MAX as u64;

/// The leading ASCII letters of some bytes, in lower case and padded with zeros, and their number.
fn letters(bytes: [u8; CHUNK]) -> (u64, usize) {
    const CASE: u8 = b'a' ^ b'A';
    const TOP: u64 = ONES * 0x80;
    let lower = u64::from_le_bytes(bytes) | (ONES * u64::from(CASE));
    // The top bit of each byte is set if it is not a letter. A byte outside ASCII may spoil the
    // bytes behind it, which do not matter.
    let from_a = lower.wrapping_add(ONES * u64::from(0x80 - b'a'));
    let beyond_z = lower.wrapping_add(ONES * u64::from(0x7f - b'z'));
    let others = !(from_a & !beyond_z & !lower) & TOP;
    let length = others.trailing_zeros() / u8::BITS;
    let behind = u64::MAX.checked_shl(length * u8::BITS).unwrap_or_default();
    (lower & !behind, length as usize)
}

/// The first word of a text, if it consists of ASCII letters only.
#[inline]
fn plain_word(text: &[u8]) -> Option<(Key, usize)> {
    let (first, mut length) = letters(chunk(text));
    let mut second = 0;
    if length == CHUNK {
        let (letters, more) = letters(chunk(&text[CHUNK..]));
        (second, length) = (letters, CHUNK + more);
    }
    let behind = text.get(length).map_or(Class::Blank, |byte| CLASSES[usize::from(*byte)]);
    let ends = matches!(behind, Class::Blank | Class::Comma | Class::Slash | Class::Hash);
    let is_plain = ends && (1..=LETTERS_MAX).contains(&length);
    is_plain.then_some((Key::from_halves(first, second), length))
}

/// The first bytes of a text, with blanks behind a short one.
fn chunk(text: &[u8]) -> [u8; CHUNK] {
    text.first_chunk().copied().unwrap_or_else(|| {
        let mut chunk = [b' '; CHUNK];
        chunk.iter_mut().zip(text).for_each(|(to, from)| *to = *from);
        chunk
    })
}

/// What begins at a byte: a piece, or a separator, and its length.
fn piece(bytes: &[u8], text: &str, at: usize) -> (Option<u16>, usize) {
    match CLASSES[usize::from(bytes[at])] {
        Class::Letter => (Some(special::UNKNOWN), word_end(bytes, text, at) - at),
        Class::Digit => (Some(special::NUMBER), number_length(bytes, at)),
        Class::Hash if is_digit(bytes, at + 1) || at + 1 == bytes.len() => {
            (Some(special::UNKNOWN), 1)
        }
        Class::Hash => (None, 1),
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

/// The length of a separate `s` or `re` at a position, 0 if there is none.
fn suffix(bytes: &[u8], at: usize) -> usize {
    let length = bytes[at..].iter().take(3).take_while(|b| b.is_ascii_alphanumeric()).count();
    let letters = &bytes[at..at + length];
    let is_suffix = letters.eq_ignore_ascii_case(b"s") || letters.eq_ignore_ascii_case(b"re");
    if is_suffix { length } else { 0 }
}

/// The end of the word that continues at a position.
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
        _ if is_of_word(character) => (Some(special::UNKNOWN), word_end(bytes, text, at) - at),
        _ => (None, length),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_are_told_from_every_other_byte() {
        for byte in 0..=u8::MAX {
            let (word, length) = letters([b'Q', byte, b'z', b' ', 0xff, byte, b'a', b'a']);
            let is_letter = byte.is_ascii_alphabetic();
            assert_eq!(length, if is_letter { 3 } else { 1 }, "{byte}");
            let lower = u64::from(byte.to_ascii_lowercase()) << 8 | u64::from(b'z') << 16;
            assert_eq!(word, u64::from(b'q') | if is_letter { lower } else { 0 }, "{byte}");
        }
        assert_eq!(letters(*b"distance"), (u64::from_le_bytes(*b"distance"), 8));
    }
}
