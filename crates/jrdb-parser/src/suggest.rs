//! Suggestions for words that are not in the lexicon.

use std::cmp::Ordering;

use crate::lexicon::{LEXICON, is_english};

/// The known word nearest to an unknown one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Suggestion {
    /// One edit away, and no other word of another meaning is.
    Only(&'static str),
    /// The nearest, or the first of several: not certain enough to be used.
    Perhaps(&'static str),
}

impl Suggestion {
    /// The word, certain or not.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Only(word) | Self::Perhaps(word) => word,
        }
    }
}

/// Letters of the longest word that is looked up; longer ones are not typing errors.
const LETTERS_MAX: usize = 24;

/// Letters of the shortest word that is looked up; shorter ones are near too many words.
const LETTERS_MIN: usize = 4;

/// The known word nearest to a word, at most two edits away (one, for words of up to five letters).
pub(crate) fn suggest(word: &str) -> Option<Suggestion> {
    let word: Vec<u8> =
        word.bytes().take(LETTERS_MAX + 1).map(|b| b.to_ascii_lowercase()).collect();
    if !(LETTERS_MIN..=LETTERS_MAX).contains(&word.len()) {
        return None;
    }
    if std::str::from_utf8(&word).is_ok_and(is_english) {
        return None;
    }
    let allowed = if word.len() <= 5 { 1 } else { 2 };
    let letters = letters(&word);
    let mut nearest: Option<(Edits, &'static str)> = None;
    let mut ties = 0;
    for known in LEXICON.words() {
        if known.len().abs_diff(word.len()) > allowed || known.len() < LETTERS_MIN - 1 {
            continue;
        }
        // One edit changes the set of letters by at most two.
        let differ = letters ^ self::letters(known.as_bytes());
        if differ.count_ones() as usize > 2 * allowed {
            continue;
        }
        let count = edits(&word, known.as_bytes());
        let edits = (count, if count == 1 { slip(&word, known.as_bytes()) } else { Slip::Other });
        match nearest {
            Some((least, first)) if least == edits => {
                ties += usize::from(!LEXICON.is_same(first, known));
                nearest = Some((least, first.min(known)));
            }
            Some((least, _)) if least < edits => {}
            _ if count <= allowed => (nearest, ties) = (Some((edits, *known)), 0),
            _ => {}
        }
    }
    nearest.map(|(edits, known)| match (edits, ties) {
        ((1, _), 0) => Suggestion::Only(known),
        _ => Suggestion::Perhaps(known),
    })
}

/// How many edits, and of which kind a single one is.
type Edits = (usize, Slip);

/// What somebody did who wrote one word instead of another, the likeliest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Slip {
    /// Two letters exchanged.
    Swap,
    /// A letter left out.
    Omission,
    /// A letter too many, or another letter.
    Other,
}

fn slip(written: &[u8], meant: &[u8]) -> Slip {
    match meant.len().cmp(&written.len()) {
        Ordering::Greater => Slip::Omission,
        Ordering::Equal if letters(written) == letters(meant) => Slip::Swap,
        _ => Slip::Other,
    }
}

/// The set of letters of a word, one bit each.
fn letters(word: &[u8]) -> u32 {
    word.iter().fold(0, |letters, byte| letters | 1 << (byte & 31))
}

/// Insertions, deletions, replacements and swaps of neighbours that turn one word into the other
/// (optimal string alignment); both at most [`LETTERS_MAX`] and two bytes long.
fn edits(a: &[u8], b: &[u8]) -> usize {
    let mut rows = [[0_usize; LETTERS_MAX + 3]; 3];
    for (j, cell) in rows[0].iter_mut().enumerate() {
        *cell = j;
    }
    for i in 1..=a.len() {
        let [before, above, row] = match i % 3 {
            0 => [1, 2, 0],
            1 => [2, 0, 1],
            _ => [0, 1, 2],
        };
        rows[row][0] = i;
        for j in 1..=b.len() {
            let replace = rows[above][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut best = replace.min(rows[above][j] + 1).min(rows[row][j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(rows[before][j - 2] + 1);
            }
            rows[row][j] = best;
        }
    }
    rows[a.len() % 3][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_nearest_word_at_one_edit_is_sure() {
        assert_eq!(suggest("femlae"), Some(Suggestion::Only("female")));
        assert_eq!(suggest("Standng"), Some(Suggestion::Only("standing")));
    }

    #[test]
    fn two_edits_are_a_guess_and_strangers_are_none() {
        assert_eq!(suggest("standding1"), Some(Suggestion::Perhaps("standing")));
        assert_eq!(suggest("zebra"), None);
        assert_eq!(suggest("mna"), None);
        assert_eq!(suggest(&"x".repeat(10_000)), None);
    }

    #[test]
    fn edits_are_counted() {
        let cases =
            [("abc", "abc", 0), ("abc", "acb", 1), ("abc", "", 3), ("kitten", "sitting", 3)];
        for (a, b, count) in cases {
            assert_eq!(edits(a.as_bytes(), b.as_bytes()), count, "{a} {b}");
        }
    }
}
