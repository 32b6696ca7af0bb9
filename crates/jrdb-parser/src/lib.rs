#![doc = include_str!("../README.md")]

mod config;
mod explain;
mod grammar;
mod issues;
mod lexicon;
pub mod notation;
mod parser;
mod pattern;
mod phrase;
mod suggest;
mod token;
mod unread;

use jrdb_types::{IssueKind, Query};

pub use config::{OfPerson, ParserConfig};
pub use explain::explain;
use parser::Parser;

/// Reads an English question, as [`parse_with`] does with the default configuration.
///
/// ```
/// use jrdb_parser::{notation, parse};
/// let query = parse("How many young women are within 3 metres of me?");
/// assert_eq!(notation::write(&query), "count person[young, female, metres ..3]");
/// assert!(query.issues.is_empty());
/// ```
#[must_use]
pub fn parse(text: &str) -> Query {
    parse_with(text, &ParserConfig::default())
}

/// Reads an English question.
///
/// Never fails, and never ignores a word silently: each word that is not understood is an issue
/// with its bytes and, if a known word is similar, a suggestion. A word that is one edit from a
/// single known word is read as that word and reported.
///
/// ```
/// use jrdb_parser::{OfPerson, ParserConfig, notation, parse_with};
/// let config = ParserConfig { viewpoint: OfPerson::Robot };
/// let query = parse_with("the boy left of the woman", &config);
/// assert_eq!(notation::write(&query), "find person[child, male, seen direction=left: person[female]]");
/// ```
#[must_use]
pub fn parse_with(text: &str, config: &ParserConfig) -> Query {
    let (mut tokens, mut issues) = (token::Tokens::new(), Vec::new());
    token::tokenize(text, &mut tokens, &mut issues);
    let viewed = viewed(&mut tokens);
    let mut parser = Parser::new(text, viewed.as_ref().unwrap_or(config), &tokens, issues);
    parser.is_viewed = viewed.is_some();
    parser.question()
}

/// Reads a question that follows another: "and behind him?", "the other one", "what about the
/// women?". Pronouns stand for what the question before was about.
///
/// ```
/// use jrdb_parser::{ParserConfig, notation, parse, parse_after};
/// let before = parse("how many men are sitting?");
/// let next = parse_after("what about the women?", &ParserConfig::default(), &before);
/// assert_eq!(notation::write(&next), "count person[female, sitting]");
/// ```
#[must_use]
pub fn parse_after(text: &str, config: &ParserConfig, before: &Query) -> Query {
    let (mut tokens, mut issues) = (token::Tokens::new(), Vec::new());
    token::tokenize(text, &mut tokens, &mut issues);
    let viewed = viewed(&mut tokens);
    let mut parser = Parser::new(text, viewed.as_ref().unwrap_or(config), &tokens, issues);
    parser.is_viewed = viewed.is_some();
    parser.question_after(before)
}

/// Takes out "from where I stand" and "as the robot sees it", which say whose left is meant.
fn viewed(tokens: &mut token::Tokens) -> Option<ParserConfig> {
    let is_view = |token: &token::Token| token.roles.has(lexicon::Role::RobotView);
    if !tokens.iter().any(is_view) {
        return None;
    }
    tokens.retain(|token| !is_view(token));
    Some(ParserConfig { viewpoint: OfPerson::Robot })
}

/// Whether any part of the text was understood: whether a word states what is asked or about what.
/// False for an empty text, another language, or unknown words only.
///
/// ```
/// use jrdb_parser::{parse, understood};
/// assert!(understood(&parse("the man with the zebra")));
/// assert!(!understood(&parse("où est la gare")));
/// ```
#[must_use]
pub fn understood(query: &Query) -> bool {
    !query.issues.iter().any(|issue| issue.kind == IssueKind::NotUnderstood)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, config: &ParserConfig) -> (String, usize) {
        let query = parse_with(text, config);
        (notation::write(&query), query.issues.len())
    }

    #[test]
    fn whose_left_is_a_choice_for_people_and_none_for_tables() {
        let robot: ParserConfig = serde_json::from_str(r#"{"viewpoint": "robot"}"#).unwrap();
        let own = ParserConfig::default();
        let man = "who is left of the man?";
        assert_eq!(read(man, &own), ("find person[at direction=left: person[male]]".into(), 1));
        assert_eq!(read(man, &robot), ("find person[seen direction=left: person[male]]".into(), 0));
        let table = "who is left of the table?";
        assert_eq!(read(table, &own), read(table, &robot));
        let owned = "who is on the man's left?";
        assert_eq!(read(owned, &own), read(owned, &robot));
    }

    #[test]
    fn a_question_may_follow_another() {
        let config = ParserConfig::default();
        let mut before = parse("who is on the bench?");
        for (text, meaning) in [
            ("which of them is a woman?", "find person[with: \"bench\", female]"),
            (
                "and behind her?",
                "find person[female, at direction=back: person[with: \"bench\", female]]",
            ),
            ("the man in red", "find person[male, (upper=red or lower=red)]"),
            ("how tall is he?", "which height of person[male, (upper=red or lower=red)]"),
            (
                "who else is sitting?",
                "find person[not is person[male, (upper=red or lower=red)], sitting]",
            ),
        ] {
            before = parse_after(text, &config, &before);
            assert_eq!(notation::write(&before), meaning, "{text}");
        }
    }

    #[test]
    fn unknown_fields_of_the_configuration_are_refused() {
        assert!(serde_json::from_str::<ParserConfig>(r#"{"viewpiont": "robot"}"#).is_err());
        assert_eq!(serde_json::from_str::<ParserConfig>("{}").unwrap(), ParserConfig::default());
    }

    #[test]
    fn what_breaks_a_place_or_a_comparison_is_read_all_the_same() {
        let own = ParserConfig::default();
        let crowded = "front far 3 m left 2 o'clock close to the man";
        assert!(read(crowded, &own).0.starts_with("find person["));
        let compared = "are there more men than the tallest woman is is sitting";
        assert!(read(compared, &own).0.starts_with("more person[male"));
        let again = "sitting between the two women who are ".repeat(30);
        assert!(read(&again, &own).0.len() < 20_000);
    }

    #[test]
    fn clauses_too_deep_are_reported_and_the_rest_is_read() {
        let query = parse(&"behind a man who is ".repeat(40));
        assert!(!query.issues.is_empty());
        assert_eq!(notation::write(&query).matches("direction=back").count(), 40);
    }
}
