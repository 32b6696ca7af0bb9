//! Reads `lexicon.txt`.

use jrdb_types::query::{Measure, Order, Task};
use jrdb_types::vocab::{Color, Elevation, Sector};
use jrdb_types::{Attribute, Condition, DistanceWord, Pattern, Query};

use super::entry::{Entry, Garment, Limit, Measured};
use super::piece::{self, Piece, special};
use super::role::Role;
use super::table::Lexicon;
use crate::notation;

/// Reads the whole file; the error is the faulty line.
pub(super) fn read(text: &'static str) -> Result<Lexicon, String> {
    let mut lexicon = Lexicon::new();
    for line in text.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
        let (phrases, meanings) = line.split_once(" -> ").ok_or(line)?;
        for phrase in phrases.split(", ") {
            let pieces = piece::split(phrase).map(|(piece, _)| lexicon.piece(phrase, piece));
            let numbers: Vec<u16> = pieces.collect::<Option<_>>().ok_or(line)?;
            if numbers.is_empty() {
                return Err(line.to_owned());
            }
            let entry = lexicon.phrase(&numbers);
            if meanings.starts_with("thing ") {
                entry.roles.insert(if is_plural(phrase) { Role::Plural } else { Role::Singular });
            }
            for meaning in meanings.split("; ") {
                add(entry, meaning).ok_or(line)?;
            }
        }
    }
    Ok(lexicon)
}

impl Lexicon {
    fn piece(&mut self, phrase: &'static str, piece: Piece) -> Option<u16> {
        if piece.word < special::COUNT && piece.word != special::UNKNOWN {
            return Some(piece.word);
        }
        self.intern(&phrase[piece.start..piece.end])
    }
}

/// Whether a noun is plural by its ending. Exceptions are marked `word plural` in the file.
fn is_plural(noun: &str) -> bool {
    let has_s = noun.ends_with('s') && !noun.ends_with("ss");
    has_s || ["men", "people", "folk", "children"].iter().any(|end| noun.ends_with(end))
}

/// Adds one meaning, such as `implies walking`; none if it is malformed.
fn add(entry: &mut Entry, meaning: &str) -> Option<()> {
    let (kind, value) = meaning.split_once(' ')?;
    let role = match kind {
        "thing" => {
            let pattern = pattern(value)?;
            entry.category = Some(pattern.category);
            entry.implies.extend(pattern.conditions);
            Role::Noun
        }
        "implies" => {
            let condition = condition(value)?;
            if is_action(&condition) {
                entry.roles.insert(Role::Action);
            }
            entry.implies.push(condition);
            Role::Implies
        }
        "relation" => {
            let Condition::Related(mut related) = condition(&format!("{value}: person"))? else {
                return None;
            };
            entry.relation_too = related.kinds.drain(1..).next();
            entry.relation = related.kinds.pop();
            Role::Relation
        }
        "people" => put(&mut entry.people, Some(value.to_owned()), Role::Interaction)?,
        "object" => put(&mut entry.object, Some(value.to_owned()), Role::Interaction)?,
        "distance" => put(&mut entry.distance, DistanceWord::from_word(value), Role::Far)?,
        "sector" => put(&mut entry.sector, Sector::from_word(value), Role::Sector)?,
        "elevation" => put(&mut entry.elevation, Elevation::from_word(value), Role::Sector)?,
        "number" => put(&mut entry.number, value.parse().ok(), Role::Number)?,
        "ordinal" => put(&mut entry.number, value.parse().ok(), Role::Ordinal)?,
        "unit" => put(&mut entry.unit, value.parse().ok(), Role::Unit)?,
        "limit" => put(&mut entry.limit, limit(value), Role::Limit)?,
        "least" => put(&mut entry.order, order(value, Order::Least), Role::Superlative)?,
        "most" => put(&mut entry.order, order(value, Order::Most), Role::Superlative)?,
        "less" => put(&mut entry.order, order(value, Order::Least), Role::Comparative)?,
        "more" => put(&mut entry.order, order(value, Order::Most), Role::Comparative)?,
        "asks" => put(&mut entry.asks, property(value), Role::Asks)?,
        "unsupported" => put(&mut entry.unsupported, Some(value.to_owned()), Role::Unsupported)?,
        "color" => put(&mut entry.color, Color::from_word(value), Role::Color)?,
        "shade" => {
            entry.roles.insert(Role::Color);
            put(&mut entry.color, Color::from_word(value), Role::Shade)?
        }
        "worn" => put(&mut entry.worn, condition(value).map(Box::new), Role::Worn)?,
        "garment" => put(&mut entry.garment, garment(value), Role::Garment)?,
        "word" => Role::from_word(value)?,
        _ => return None,
    };
    entry.roles.insert(role);
    Some(())
}

fn put<T>(field: &mut Option<T>, value: Option<T>, role: Role) -> Option<Role> {
    *field = Some(value?);
    Some(role)
}

fn is_action(condition: &Condition) -> bool {
    match condition {
        Condition::Attribute(value) => value.attribute() == Attribute::Action,
        Condition::Any(parts) => parts.iter().all(is_action),
        _ => false,
    }
}

fn pattern(text: &str) -> Option<Pattern> {
    Some(notation::read(&format!("find {text}")).ok()?.target)
}

fn condition(text: &str) -> Option<Condition> {
    pattern(&format!("person[{text}]"))?.conditions.pop()
}

fn property(text: &str) -> Option<jrdb_types::query::Property> {
    let Query { task: Task::Which { properties, .. }, .. } =
        notation::read(&format!("which {text} of person")).ok()?
    else {
        return None;
    };
    properties.first().copied()
}

fn order(text: &str, order: Order) -> Option<(Measured, Order)> {
    let measured = match pattern(&format!("person{{most {text}}}"))?.pick?.measure {
        Measure::DistanceTo(_) => Measured::Distance,
        Measure::FromLeft => Measured::FromLeft,
        Measure::Height => Measured::Height,
        Measure::Age => Measured::Age,
        Measure::Speed => Measured::Speed,
    };
    Some((measured, order))
}

fn limit(text: &str) -> Option<Limit> {
    Some(match text {
        "at most" => Limit::AtMost,
        "less than" => Limit::LessThan,
        "at least" => Limit::AtLeast,
        "more than" => Limit::MoreThan,
        "exactly" => Limit::Exactly,
        "about" => Limit::About,
        _ => return None,
    })
}

fn garment(text: &str) -> Option<Garment> {
    Some(match text {
        "upper" => Garment::Upper,
        "lower" => Garment::Lower,
        "any" => Garment::Any,
        "other" => Garment::Other,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_of_the_file_is_read() {
        assert_eq!(read(include_str!("lexicon.txt")).err(), None);
    }

    #[test]
    fn a_line_at_fault_is_named() {
        for line in [
            "cat thing animal",
            "counterintelligence -> word common",
            "cat -> implies tall",
            "cat -> word purr",
            "cat -> legs 4",
        ] {
            assert_eq!(read(line).err().as_deref(), Some(line));
        }
    }
}
