//! What a word that is not in the lexicon was probably meant to be.

use crate::lexicon::LEXICON;

/// The nearest known word within two edits (one, for words of up to four letters); the first in
/// alphabetical order on a tie.
pub(crate) fn suggest(word: &str) -> Option<&'static str> {
    let letters = word.chars().count();
    let allowed = if letters <= 4 { 1 } else { 2 };
    // Longer words are no typos of ours, and comparing them would take quadratic time.
    if letters > 24 {
        return None;
    }
    LEXICON
        .words()
        .map(|known| (edits(word, known), known))
        .filter(|(edits, _)| *edits <= allowed)
        .min()
        .map(|(_, known)| known)
}

/// Insertions, deletions, replacements and swaps of neighbours that turn one word into the other
/// (optimal string alignment).
fn edits(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut rows = vec![vec![0; b.len() + 1]; a.len() + 1];
    for (i, row) in rows.iter_mut().enumerate() {
        row[0] = i;
    }
    rows[0] = (0..=b.len()).collect();
    for i in 1..=a.len() {
        for j in 1..=b.len() {
            let replace = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut best = replace.min(rows[i - 1][j] + 1).min(rows[i][j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(rows[i - 2][j - 2] + 1);
            }
            rows[i][j] = best;
        }
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_misses_are_found_and_strangers_are_not() {
        assert_eq!(suggest("femlae"), Some("female"));
        assert_eq!(suggest("standng"), Some("standing"));
        assert_eq!(suggest("zebra"), None);
        assert_eq!(suggest(&"x".repeat(10_000)), None);
    }
}
