//! Sentences and the queries they mean.

use jrdb_types::query::{Category, RelationKind, Viewpoint};
use jrdb_types::{Condition, Pattern, Query, Span, Task};
use proptest::prelude::*;

use crate::parse;

/// A query in short: `age=young robot_distance=close [left, subject: gender=female]`.
fn shown(query: &Query) -> String {
    let task = if query.task == Task::Count { "count " } else { "" };
    format!("{task}{}", shown_pattern(&query.target))
}

fn shown_pattern(pattern: &Pattern) -> String {
    let kind = match &pattern.category {
        Category::Person => "person".to_string(),
        Category::Object => "object".to_string(),
        Category::Class(name) => name.clone(),
    };
    let words: Vec<String> = pattern.conditions.iter().map(shown_condition).collect();
    std::iter::once(kind).chain(words).collect::<Vec<_>>().join(" ")
}

fn shown_condition(condition: &Condition) -> String {
    match condition {
        Condition::Age(v) => v.to_string(),
        Condition::Gender(v) => v.to_string(),
        Condition::Race(v) => v.to_string(),
        Condition::Action(v) => v.to_string(),
        Condition::RobotDistance(v) => format!("robot-distance:{v}"),
        Condition::RobotDirection(v) => format!("robot-direction:{v}"),
        Condition::Relation(relation) => {
            let kind = match &relation.kind {
                RelationKind::Interaction { label } => label.clone(),
                RelationKind::Spatial { distance, direction, viewpoint } => {
                    let words = [distance.map(|d| d.to_string()), direction.map(|d| d.to_string())];
                    let seen = if *viewpoint == Viewpoint::Subject { "mine" } else { "theirs" };
                    let words: Vec<String> =
                        words.into_iter().flatten().chain([seen.into()]).collect();
                    words.join(", ")
                }
            };
            format!("[{kind}: {}]", shown_pattern(&relation.partner))
        }
    }
}

fn clean(text: &str) -> String {
    let query = parse(text);
    assert_eq!(query.issues, [], "{text}");
    shown(&query)
}

#[test]
fn the_paper_s_sentences() {
    let cases = [
        (
            "Find the young White male positioned at a close distance relative to me (the robot).",
            "person young White male robot-distance:close",
        ),
        (
            "Find a White male who has a female positioned to his right at a close distance.",
            "person White male [close, right, mine: person female]",
        ),
        (
            "Find a male white person who is a female positioned to his right at a close distance.",
            "person male White [close, right, mine: person female]",
        ),
        ("Find the young people", "person young"),
        ("Find the females", "person female"),
        ("young male walking", "person young male walking"),
        ("Which objects are located in front of the robot?", "object robot-direction:front"),
    ];
    for (text, meaning) in cases {
        assert_eq!(clean(text), meaning, "{text}");
    }
}

#[test]
fn left_of_a_person_is_their_own_left_and_the_reader_is_told() {
    let cases = [
        (
            "Who is positioned at the front left of an elderly person?",
            "person [front left, theirs: person elderly]",
        ),
        (
            "Who is seated to the left of the seated person?",
            "person sitting [left, theirs: person sitting]",
        ),
    ];
    for (text, meaning) in cases {
        let query = parse(text);
        assert_eq!(shown(&query), meaning, "{text}");
        assert_eq!(query.issues.len(), 1, "{text}");
        assert!(query.issues[0].message.contains("own"), "{text}");
    }
}

#[test]
fn the_benchmark_s_sentences() {
    let cases = [
        ("Find all persons", "person"),
        ("Find middle-aged, Asian and male persons", "person middle-aged Asian male"),
        (
            "Find persons who are located to moderate distance and left relative to me(robot)",
            "person robot-distance:moderate robot-direction:left",
        ),
        (
            "Find child, White and male person who is located to far distance and up right left relative to me(robot)",
            "person child White male robot-distance:far robot-direction:up front right",
        ),
        (
            "Find White person who is sitting, located to very far distance and back left relative to me(robot)",
            "person White sitting robot-distance:very far robot-direction:back left",
        ),
        (
            "Find elderly person who is bending and a young, female and White person located to his\\her back left and close distance",
            "person elderly bending [close, back left, mine: person young female White]",
        ),
        (
            "Find person who is a middle-aged and Black person located to his\\her left and very close distance",
            "person [very close, left, mine: person middle-aged Black]",
        ),
        (
            "Find persons who are a person located to his\\her back right and very close distance",
            "person [very close, back right, mine: person]",
        ),
        (
            "Count elderly, White and female person who is sitting",
            "count person elderly White female sitting",
        ),
        (
            "Find young male person who is chatting with a female person and a male person located to his/her front and close distance",
            "person young male [conversation: person female] [close, front, mine: person male]",
        ),
        (
            "Find person who is standing with a elderly, male and White person",
            "person [standing together: person elderly male White]",
        ),
        (
            "Find person who is walking toward with a child, male and Asian person",
            "person [walking toward each other: person child male Asian]",
        ),
    ];
    for (text, meaning) in cases {
        assert_eq!(clean(text), meaning, "{text}");
    }
}

#[test]
fn what_people_type() {
    let cases = [
        ("who is close to me", "person robot-distance:close"),
        ("how many women are in front of you?", "count person female robot-direction:front"),
        ("the boy behind the woman", "person child male [back, theirs: person female]"),
        ("a man near a child", "person male [close, theirs: person child]"),
        (
            "show me the seated old lady on the left",
            "person sitting elderly female robot-direction:left",
        ),
        ("people standing", "person standing"),
        ("who is near a table?", "person [close, theirs: table]"),
        ("which tables are in front of me", "table robot-direction:front"),
        (
            "the man in front of a woman who is behind a child",
            "person male [front, theirs: person female [back, theirs: person child]]",
        ),
        ("a woman with a man at her left", "person female [left, mine: person male]"),
    ];
    for (text, meaning) in cases {
        assert_eq!(shown(&parse(text)), meaning, "{text}");
    }
}

#[test]
fn unknown_words_are_reported_with_place_and_suggestion() {
    let query = parse("Find the femlae person with zebras");
    assert_eq!(shown(&query), "person");
    let issue = &query.issues[0];
    assert_eq!(issue.message, r#"unknown word "femlae", not used"#);
    assert_eq!(
        (issue.span, issue.suggestion.as_deref()),
        (Some(Span { start: 9, end: 15 }), Some("female"))
    );
    assert!(query.issues.iter().any(|i| i.message.contains("zebras")));
}

#[test]
fn a_thing_that_cannot_be_joined_is_reported_and_changes_nothing_else() {
    let query = parse("Find the man holding a bag");
    assert_eq!(shown(&query), "person male");
    let told: Vec<_> = query.issues.iter().map(|issue| issue.message.as_str()).collect();
    assert_eq!(
        told,
        [r#"unknown word "holding", not used"#, "these words fit nowhere here, not used"]
    );
    assert_eq!(query.issues[1].span, Some(Span { start: 21, end: 26 }));
}

#[test]
fn a_place_near_something_unknown_is_not_near_the_robot() {
    let query = parse("the man near a zebra");
    assert_eq!(shown(&query), "person male [close, theirs: person]");
    assert_eq!(query.issues[0].message, r#"unknown word "zebra", not used"#);
}

#[test]
fn nothing_at_all_is_an_issue() {
    for text in ["", "  ", "?!"] {
        assert_eq!(parse(text).issues[0].message, "the question has no words");
    }
}

proptest! {
    #[test]
    fn any_text_is_read_and_spans_cut_it_at_characters(text in "\\PC{0,80}") {
        for issue in parse(&text).issues {
            let span = issue.span.unwrap_or(Span { start: 0, end: 0 });
            prop_assert!(text.get(span.start..span.end).is_some());
        }
    }

    #[test]
    fn any_order_of_known_words_is_read(words in proptest::collection::vec(
        proptest::sample::select(vec![
            "find", "the", "left", "of", "a", "person", "who", "is", "and", ",", "young", "close", "his\\her",
            "to", "me", "with", "sitting", "front", "distance", "has", "up", "chatting", "relative", "object",
        ]), 0..60)) {
        let text = words.join(" ");
        let query = parse(&text);
        prop_assert_eq!(&query.text, &text);
    }

    #[test]
    fn case_and_blanks_do_not_matter(extra in "[ \t\n]{1,4}") {
        let plain = "find young , white and male person who is located to close distance";
        let loud = plain.to_uppercase().replace(' ', &extra);
        prop_assert_eq!(parse(plain).target, parse(&loud).target);
    }
}

#[test]
fn long_questions_take_no_long_time() {
    let deep = "left of a man who is ".repeat(20_000);
    let query = parse(&deep);
    assert!(!query.issues.is_empty());
    serde_json::to_string(&query).unwrap();
}
