//! A text as words, and the words as known phrases.

use jrdb_types::issue::IssueKind;
use jrdb_types::{Issue, Span};

use smallvec::SmallVec;

use crate::lexicon::{Entry, LEXICON, Lexicon, Piece, Role, Roles, special, split};
use crate::suggest::{Suggestion, suggest};

/// Words of nearly all questions at most: these need no heap allocation.
const WORDS: usize = 32;

/// The pieces of a text.
pub(crate) type Pieces = SmallVec<[Piece; WORDS]>;

/// The phrases of a text.
pub(crate) type Tokens = SmallVec<[Token; WORDS]>;

/// A phrase of the text.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Token {
    pub(crate) entry: &'static Entry,
    /// The roles of the entry, which are read most often.
    pub(crate) roles: Roles,
    pub(crate) start: usize,
    pub(crate) end: usize,
}

/// Unknown words that are compared with the lexicon; a text with more is not a question.
pub(crate) const SUGGESTIONS_MAX: usize = 20;

/// Splits a text into the longest phrases of the lexicon. A word of no phrase is read as the single
/// known word that is one edit away, and reported.
pub(crate) fn tokenize(text: &str, tokens: &mut Tokens, issues: &mut Vec<Issue>) {
    let lexicon = &*LEXICON;
    let mut pieces = Pieces::new();
    split_known(text, &mut pieces, issues);
    let mut rest = &pieces[..];
    while let [first, behind @ ..] = rest {
        let (entry, more) = lexicon.longest(first.word, behind);
        let last = if more == 0 { first } else { &behind[more - 1] };
        let entry = lexicon.entry(entry);
        rest = &behind[more..];
        if entry.roles.has(Role::Noise) && !is_compared(entry, tokens) {
            continue;
        }
        tokens.push(Token { entry, roles: entry.roles, start: first.start, end: last.end });
    }
}

/// Whether "like" says what something looks like; elsewhere it says nothing.
fn is_compared(entry: &Entry, before: &[Token]) -> bool {
    let is_look = |token: &Token| {
        token.roles.has(Role::Common)
            || token.roles.has(Role::Looks)
            || token.entry.object.is_some()
    };
    entry.roles.has(Role::Common) && before.last().is_some_and(is_look)
}

/// Words that are often written as one, or without their apostrophe, and wrong forms of short
/// words: a closed list.
const RUN_TOGETHER: [(&str, &[&str]); 42] = [
    ("meny", &["many"]),
    ("mnay", &["many"]),
    ("hwo", &["how"]),
    ("wearin", &["wearing"]),
    ("sittin", &["sitting"]),
    ("standin", &["standing"]),
    ("walkin", &["walking"]),
    ("whos", &["who", "is"]),
    ("wheres", &["where", "is"]),
    ("whats", &["what", "is"]),
    ("hows", &["how", "is"]),
    ("theres", &["there", "is"]),
    ("thats", &["that", "is"]),
    ("hes", &["he", "is"]),
    ("shes", &["she", "is"]),
    ("theyre", &["they", "are"]),
    ("youre", &["you", "are"]),
    ("im", &["i"]),
    ("lets", &["let", "us"]),
    ("wasnt", &["wasn't"]),
    ("werent", &["weren't"]),
    ("didnt", &["didn't"]),
    ("cant", &["can't"]),
    ("nextto", &["next", "to"]),
    ("infront", &["in", "front"]),
    ("infrontof", &["in", "front", "of"]),
    ("closeto", &["close", "to"]),
    ("nearto", &["near", "to"]),
    ("leftof", &["left", "of"]),
    ("rightof", &["right", "of"]),
    ("howmany", &["how", "many"]),
    ("howfar", &["how", "far"]),
    ("alot", &["a", "lot"]),
    ("wich", &["which"]),
    ("witch", &["which"]),
    ("ther", &["there"]),
    ("thier", &["their"]),
    ("teh", &["the"]),
    ("hte", &["the"]),
    ("adn", &["and"]),
    ("waht", &["what"]),
    ("whre", &["where"]),
];

/// The known words that an unknown one consists of.
fn run_together(word: &str) -> Option<&'static [&'static str]> {
    let is_word = |known: &str| known.eq_ignore_ascii_case(word);
    RUN_TOGETHER.iter().find(|(known, _)| is_word(known)).map(|(_, words)| *words)
}

/// The pieces of a text with their numbers in the lexicon.
pub(crate) fn split_known(text: &str, pieces: &mut Pieces, issues: &mut Vec<Issue>) {
    let lexicon = &*LEXICON;
    let mut suggestions = 0;
    for (mut piece, key) in split(text) {
        if piece.word == special::UNKNOWN {
            piece.word = lexicon.number(key);
            if piece.word == special::UNKNOWN
                && let Some(words) = run_together(&text[piece.start..piece.end])
            {
                pieces.extend(words.iter().map(|word| Piece { word: lexicon.word(word), ..piece }));
                continue;
            }
            if piece.word == special::UNKNOWN {
                piece.word = respelled(lexicon, text, piece, &mut suggestions, issues);
            }
        }
        pieces.push(piece);
    }
}

/// The number of a word that is unknown as written.
#[cold]
fn respelled(
    lexicon: &Lexicon,
    text: &str,
    piece: Piece,
    suggestions: &mut usize,
    issues: &mut Vec<Issue>,
) -> u16 {
    let word = &text[piece.start..piece.end];
    let with_apostrophe =
        if word.is_ascii() { special::UNKNOWN } else { lexicon.word(&word.replace('’', "'")) };
    if with_apostrophe != special::UNKNOWN || *suggestions == SUGGESTIONS_MAX {
        return with_apostrophe;
    }
    *suggestions += 1;
    corrected(word, piece, issues)
}

/// Whether a word is written as a name: "Anna".
fn is_name(word: &str) -> bool {
    let mut letters = word.chars();
    letters.next().is_some_and(char::is_uppercase) && letters.all(char::is_lowercase)
}

fn corrected(word: &str, piece: Piece, issues: &mut Vec<Issue>) -> u16 {
    if piece.start > 0 && is_name(word) {
        return special::UNKNOWN;
    }
    let Some(Suggestion::Only(known)) = suggest(word) else { return special::UNKNOWN };
    let span = Span { start: piece.start, end: piece.end };
    let message = format!("unknown word {word:?} read as {known:?}");
    let issue = Issue::at(IssueKind::MisspelledWord, span, message);
    issues.push(Issue { suggestion: Some(known.to_owned()), ..issue });
    LEXICON.word(known)
}

#[cfg(test)]
mod tests {
    use jrdb_types::query::Category;

    use super::*;
    use crate::lexicon::Key;

    fn shown(text: &str) -> Vec<&str> {
        let mut tokens = Tokens::new();
        tokenize(text, &mut tokens, &mut Vec::new());
        tokens.iter().map(|t| &text[t.start..t.end]).collect()
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
        let mut tokens = Tokens::new();
        tokenize("the femlae person", &mut tokens, &mut issues);
        assert!(!tokens[1].entry.implies.is_empty());
        assert_eq!(issues[0].message, r#"unknown word "femlae" read as "female""#);
        assert_eq!(issues[0].span, Some(Span { start: 4, end: 10 }));
    }

    fn entry(phrase: &str) -> &'static Entry {
        let mut pieces = Pieces::new();
        split_known(phrase, &mut pieces, &mut Vec::new());
        let (entry, more) = LEXICON.longest(pieces[0].word, &pieces[1..]);
        assert_eq!(more + 1, pieces.len(), "{phrase}");
        LEXICON.entry(entry)
    }

    #[test]
    fn a_phrase_may_mean_several_things() {
        assert_eq!(entry("girl").implies.len(), 2);
        assert!(entry("her").roles.has(Role::His) && entry("her").roles.has(Role::Him));
    }

    #[test]
    fn the_longest_phrase_wins_whatever_its_case_and_joints() {
        assert!(entry("In  Front-of").roles.has(Role::Of));
        assert_eq!(
            entry("Bicycle/Scooter").category,
            Some(Category::Class("bicycle/scooter".into()))
        );
        assert_eq!(entry("picture_frame").category, Some(Category::Class("picture_frames".into())));
    }

    #[test]
    fn a_word_is_separated_from_what_stands_behind_it() {
        let man = LEXICON.word("man");
        assert_ne!(man, special::UNKNOWN);
        for text in ["MAN", "man, who", "Man at the door with a bag"] {
            assert_eq!(LEXICON.number(Key::of(text.as_bytes(), 3)), man, "{text}");
        }
        assert_ne!(LEXICON.word("CounterClockwise"), special::UNKNOWN);
        for word in ["", "manners", "counterclockwises"] {
            assert_eq!(LEXICON.word(word), special::UNKNOWN, "{word}");
        }
    }
}
