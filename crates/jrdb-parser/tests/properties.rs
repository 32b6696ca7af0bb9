//! Properties: the benchmark's grammar is read exactly, and every text is read without a fault.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]

use jrdb_parser::{explain, notation, parse, understood};
use jrdb_types::{Action, Age, DistanceWord, Gender, Race};
use proptest::prelude::*;

/// A part of a sentence and what it means.
#[derive(Debug, Clone)]
struct Part {
    words: String,
    meaning: String,
}

fn part(words: impl Into<String>, meaning: impl Into<String>) -> Part {
    Part { words: words.into(), meaning: meaning.into() }
}

fn word_of(words: &'static [&'static str]) -> impl Strategy<Value = &'static str> {
    prop::sample::select(words)
}

const SECTORS: &[&str] =
    &["front", "front left", "left", "back left", "back", "back right", "right", "front right"];

/// Labels of JRDB-Social in the benchmark's words, and as in the data set.
const DEEDS: &[(&str, &str)] = &[
    ("chatting", "conversation"),
    ("walking toward", "walking toward each other"),
    ("hugging", "hugging"),
    ("shaking hand", "shaking hand"),
    ("walking", "walking together"),
    ("sitting", "sitting together"),
    ("going upstairs", "going upstairs together"),
    ("looking at robot", "looking at robot together"),
    ("interaction with door", "interaction with door together"),
    ("holding sth", "holding sth together"),
];

const OBJECTS: &[(&str, &str)] = &[
    ("bag", "bag"),
    ("machine", "machines"),
    ("picture_frame", "picture_frames"),
    ("bicycle/scooter", "bicycle/scooter"),
    ("pole/trafficcone", "pole/trafficcone"),
    ("skateboard/segway/hoverboard", "skateboard/segway/hoverboard"),
];

/// `a`, `a and b`, `a, b and c`.
fn list(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [only] => only.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

fn vocabulary<T: ToString + Copy + std::fmt::Debug>(
    all: &'static [T],
) -> impl Strategy<Value = Option<String>> {
    prop::option::of(prop::sample::select(all).prop_map(|word| word.to_string()))
}

fn people() -> impl Strategy<Value = Vec<String>> {
    (vocabulary(Age::ALL), vocabulary(Gender::ALL), vocabulary(Race::ALL))
        .prop_map(|(age, gender, race)| [age, gender, race].into_iter().flatten().collect())
}

/// "a child, female and Black person".
fn somebody() -> impl Strategy<Value = Part> {
    people().prop_map(|words| {
        let meaning =
            if words.is_empty() { String::new() } else { format!("[{}]", words.join(", ")) };
        part(format!("a {} person", list(&words)).replace("  ", " "), format!("person{meaning}"))
    })
}

fn deed() -> impl Strategy<Value = Part> {
    (prop::sample::select(DEEDS), somebody()).prop_map(|((words, label), who)| {
        part(format!("{words} with {}", who.words), format!("does \"{label}\": {}", who.meaning))
    })
}

fn beside() -> impl Strategy<Value = Part> {
    (somebody(), word_of(SECTORS), word_of(&["very close", "close"])).prop_map(
        |(who, side, far)| {
            part(
                format!("{} located to his\\her {side} and {far} distance", who.words),
                format!("has direction={side} & has distance={far}: {}", who.meaning),
            )
        },
    )
}

fn object() -> impl Strategy<Value = Part> {
    let verbs =
        ["holding", "looking at", "working", "handling/manipulating", "talking on", "riding"];
    let thing = prop::option::of(prop::sample::select(OBJECTS));
    (prop::sample::select(verbs.to_vec()), thing).prop_map(|(verb, thing)| match thing {
        Some((words, class)) => {
            part(format!("{verb} a {words}"), format!("does \"{verb}\": \"{class}\""))
        }
        None => part(verb, format!("does \"{verb}\": object")),
    })
}

/// Predicates behind "who is", in the benchmark's order.
fn fragment() -> impl Strategy<Value = Vec<Part>> {
    let action = prop::option::of(prop::sample::select(Action::ALL))
        .prop_map(|action| action.map(|a| part(a.to_string(), a.to_string())));
    let far = prop::option::of(prop::sample::select(DistanceWord::ALL)).prop_map(|far| {
        far.map(|far| part(format!("located to {far} distance"), format!("distance={far}")))
    });
    let side = prop::option::of(word_of(SECTORS)).prop_map(|side| {
        side.map(|s| part(format!("{s} relative to me(robot)"), format!("direction={s}")))
    });
    let social = (prop::option::of(deed()), prop::option::of(beside()), prop::option::of(object()));
    (action, far, side, social).prop_map(|(action, far, side, (deed, beside, object))| {
        // Two relations to the same described person are written as one, which `sentences.query`
        // covers.
        let partner = |p: &Part| p.meaning.rsplit_once(": ").map(|(_, who)| who.to_owned());
        let same = deed.as_ref().and_then(partner) == beside.as_ref().and_then(partner);
        let beside = beside.filter(|_| deed.is_none() || !same);
        [action, far, side, deed, beside, object].into_iter().flatten().collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn the_benchmark_s_sentences_mean_what_they_say(
        who in people(), said in fragment(), many in any::<bool>(), count in any::<bool>(),
    ) {
        let (noun, is) = if many { ("persons", "are") } else { ("person", "is") };
        let verb = if count { "Count" } else { "Find" };
        let fragments: Vec<String> = said.iter().map(|part| part.words.clone()).collect();
        let clause = if said.is_empty() { String::new() } else { format!(" who {is} {}", list(&fragments)) };
        let text = format!("{verb} {} {noun}{clause}", list(&who)).replace("  ", " ");
        let mut meanings = who.clone();
        meanings.extend(said.iter().map(|part| part.meaning.clone()));
        let inside = if meanings.is_empty() { String::new() } else { format!("[{}]", meanings.join(", ")) };
        let query = parse(&text);
        prop_assert_eq!(&query.issues, &[], "{}", text);
        prop_assert_eq!(notation::write(&query), format!("{} person{inside}", verb.to_lowercase()), "{}", text);
    }

    #[test]
    fn two_moments_are_two_slots(first in fragment(), second in fragment(), end in 1_u32..90) {
        let words = |said: &[Part]| list(&said.iter().map(|p| p.words.clone()).collect::<Vec<_>>());
        let inside = |said: &[Part]| said.iter().map(|p| p.meaning.clone()).collect::<Vec<_>>().join(", ");
        prop_assume!(!first.is_empty() && !second.is_empty());
        let text = format!("Find person who is {} and then {} during 0 to {end} seconds", words(&first), words(&second));
        let query = parse(&text);
        prop_assert_eq!(&query.issues, &[], "{}", text);
        let expected = format!("find person slot {{{}}} slot 0..{end} {{{}}}", inside(&first), inside(&second));
        prop_assert_eq!(notation::write(&query), expected, "{}", text);
    }

    #[test]
    fn any_text_is_read_and_spans_cut_it_at_characters(text in "\\PC{0,80}") {
        let query = parse(&text);
        for span in query.issues.iter().filter_map(|issue| issue.span) {
            prop_assert!(text.get(span.start..span.end).is_some());
        }
        let _ = (explain(&text, &query), understood(&query));
    }

    #[test]
    fn every_unknown_word_is_in_an_issue(
        words in prop::collection::vec(prop::sample::select(vec![
            "find", "the", "man", "zzxyq", "left", "of", "qqwpt", "who", "is", "and", "sitting", "vvkjx", "table",
        ]), 1..30),
    ) {
        let text = words.join(" ");
        let issues = parse(&text).issues;
        for (at, _) in text.char_indices().filter(|(at, _)| {
            ["zzxyq", "qqwpt", "vvkjx"].iter().any(|word| text[*at..].starts_with(word))
        }) {
            let is_told = |span: jrdb_types::Span| span.start <= at && at + 5 <= span.end;
            prop_assert!(issues.iter().filter_map(|i| i.span).any(is_told), "{} at {}", text, at);
        }
    }

    #[test]
    fn any_order_of_known_words_is_read(words in prop::collection::vec(prop::sample::select(vec![
        "find", "the", "left", "of", "a", "person", "who", "is", "and", ",", "young", "close", "his\\her", "to", "me",
        "with", "sitting", "front", "distance", "has", "up", "chatting", "relative", "object", "not", "or", "between",
        "3", "m", "two", "than", "taller", "closest", "him", "except", "neither", "either", "during", "then", "seconds",
        "table", "holding", "next to", "facing", "each other", "second", "from", "more", "what", "how far", "doing",
        "'s", "those", "all", "no", "within", "at least", "group of", "without", "whose", "men", "red", "o'clock",
    ]), 0..60)) {
        let text = words.join(" ");
        let query = parse(&text);
        prop_assert_eq!(&query.text, &text);
        let back = notation::read(&notation::write(&query)).unwrap();
        prop_assert_eq!(notation::write(&back), notation::write(&query), "{}", text);
    }

    #[test]
    fn case_and_blanks_do_not_matter(extra in "[ \t\n]{1,4}") {
        let plain = "find young , white and male person who is located to close distance";
        let loud = plain.to_uppercase().replace(' ', &extra);
        prop_assert_eq!(parse(plain).target, parse(&loud).target);
    }
}

#[test]
fn long_texts_take_no_long_time() {
    let start = std::time::Instant::now();
    for text in [
        "left of a man who is ",
        "xqzj wvk ",
        "and a man ",
        "not ",
        "next to him and ",
        "find ",
        "or near ",
    ] {
        let query = parse(&text.repeat(20_000));
        serde_json::to_string(&query).unwrap();
    }
    // A quadratic parser takes minutes for these; the limit is far above what a slow machine needs.
    assert!(start.elapsed().as_secs() < 30, "{:?}", start.elapsed());
}

#[test]
fn what_is_said_again_and_again_is_read_beside_and_not_inside_what_was_said_before() {
    for text in [
        "people in white shirts or black jackets",
        "people at the door or white foo at the door",
        "sitting near the door or standing bar ",
        "man's ",
        "near a woman's man's man's ",
    ] {
        let query = parse(&text.repeat(200));
        let again = notation::read(&notation::write(&query)).unwrap();
        assert_eq!(notation::write(&again), notation::write(&query), "{text}");
    }
}

#[test]
fn nothing_is_understood_of_an_empty_or_foreign_text() {
    for text in ["", "  ", "?!", "où est la gare", "男の人を探して", "xqz wvk"] {
        assert!(!understood(&parse(text)), "{text}");
        assert!(!parse(text).issues.is_empty(), "{text}");
    }
    for text in ["find", "the man", "zebra near me", "who"] {
        assert!(understood(&parse(text)), "{text}");
    }
}
