//! Writes the notation.

use std::fmt::Write as _;

use jrdb_types::query::{
    Category, Command, Compared, Interval, Measure, Nearer, Order, Pick, Place, Quantity, Related,
    RelationKind, Share, Slot, Task, Viewpoint,
};
use jrdb_types::{AttributeNotation, Condition, Pattern, Query};

use super::keyword;

/// Writes a query in the notation, on one line, without its text and issues.
///
/// ```
/// use jrdb_types::{Condition, Gender, Query};
/// let mut query = Query::default();
/// query.target.conditions.push(Condition::has(Gender::Female));
/// assert_eq!(jrdb_parser::notation::write(&query), "find person[female]");
/// ```
#[must_use]
pub fn write(query: &Query) -> String {
    let mut text = String::new();
    task(&mut text, &query.task);
    pattern(&mut text, &query.target);
    match &query.task {
        Task::CompareCounts { than, .. } => {
            text.push_str(" than ");
            pattern(&mut text, than);
        }
        Task::From { partner, .. } => {
            text.push_str(" from ");
            pattern(&mut text, partner);
        }
        _ => {}
    }
    for each in &query.slots {
        slot(&mut text, each);
    }
    if let Some(told) = &query.command {
        command(&mut text, told);
    }
    text
}

/// Appends formatted text, which cannot fail for a `String`.
macro_rules! put {
    ($text:expr, $($arguments:tt)*) => {{ let _ = write!($text, $($arguments)*); }};
}

fn task(text: &mut String, task: &Task) {
    match task {
        Task::Find => text.push_str("find "),
        Task::Count => text.push_str("count "),
        Task::Where => text.push_str("where "),
        Task::Exists(number) => {
            text.push_str("exists ");
            quantity(text, *number);
        }
        Task::Which { properties, in_order } => {
            let names: Vec<String> = properties.iter().map(|p| keyword(*p)).collect();
            let order = if *in_order { " in order" } else { "" };
            put!(text, "which {}{order} of ", names.join(", "));
        }
        Task::Each { share, asked } => {
            let share = match share {
                Share::All => "all",
                Share::None => "none",
                Share::Most => "most",
                Share::Half => "half",
            };
            put!(text, "each {share} [");
            list(text, asked, ", ");
            text.push_str("] of ");
        }
        Task::Choice { options } => {
            text.push_str("choice [");
            list(text, options, ", ");
            text.push_str("] of ");
        }
        Task::From { property, .. } => put!(text, "{} of ", keyword(*property)),
        Task::Groups => text.push_str("groups "),
        Task::CompareCounts { order, .. } => {
            put!(text, "{} ", if *order == Order::Most { "more" } else { "fewer" });
        }
    }
}

/// `>=2 ` with a blank behind; nothing for "some".
fn quantity(text: &mut String, quantity: Quantity) {
    if quantity != Quantity::SOME {
        number(text, quantity);
        text.push(' ');
    }
}

fn number(text: &mut String, Quantity { at_least, at_most }: Quantity) {
    match at_most {
        None => put!(text, ">={at_least}"),
        Some(most) if most == at_least => put!(text, "={most}"),
        Some(most) if at_least == 0 => put!(text, "<={most}"),
        Some(most) => put!(text, "{at_least}..{most}"),
    }
}

fn pattern(text: &mut String, pattern: &Pattern) {
    category(text, &pattern.category);
    if !pattern.conditions.is_empty() {
        text.push('[');
        list(text, &pattern.conditions, ", ");
        text.push(']');
    }
    if let Some(picked) = &pattern.pick {
        pick(text, picked);
    }
}

fn category(text: &mut String, category: &Category) {
    match category {
        Category::Person => text.push_str("person"),
        Category::Object => text.push_str("object"),
        Category::Anything => text.push_str("thing"),
        Category::Robot => text.push_str("robot"),
        Category::Class(name) => quoted(text, name),
    }
}

fn quoted(text: &mut String, words: &str) {
    text.push('"');
    for character in words.chars() {
        if matches!(character, '"' | '\\') {
            text.push('\\');
        }
        text.push(character);
    }
    text.push('"');
}

fn pick(text: &mut String, pick: &Pick) {
    text.push('{');
    text.push_str(if pick.order == Order::Most { "most " } else { "least " });
    measure(text, &pick.measure);
    if pick.rank != 1 {
        put!(text, " rank {}", pick.rank);
    }
    if pick.count != 1 {
        put!(text, " count {}", pick.count);
    }
    text.push('}');
}

fn measure(text: &mut String, measure: &Measure) {
    match measure {
        Measure::FromLeft => text.push_str("from left"),
        Measure::Height => text.push_str("height"),
        Measure::Age => text.push_str("age"),
        Measure::Speed => text.push_str("speed"),
        Measure::DistanceTo(things) => {
            text.push_str("distance to ");
            pattern(text, things);
        }
    }
}

fn list(text: &mut String, conditions: &[Condition], separator: &str) {
    for (index, each) in conditions.iter().enumerate() {
        text.push_str(if index == 0 { "" } else { separator });
        condition(text, each);
    }
}

fn condition(text: &mut String, condition: &Condition) {
    match condition {
        Condition::Attribute(value) => match value.attribute().row().notation {
            AttributeNotation::Word => put!(text, "{value}"),
            AttributeNotation::Key { key, .. } => put!(text, "{key}={value}"),
        },
        Condition::FromRobot(where_) => sector_or_distance(text, where_),
        Condition::GroupSize(size) => {
            text.push_str("group ");
            number(text, *size);
        }
        Condition::Related(related) => self::related(text, related),
        Condition::Compared(compared) => self::compared(text, compared),
        Condition::Measures(measured) => {
            measure(text, &measured.measure);
            text.push(' ');
            stretch(text, &measured.within);
        }
        Condition::Nearer(Nearer { to, than }) => {
            text.push_str("nearer to ");
            pattern(text, to);
            text.push_str(" than to ");
            pattern(text, than);
        }
        Condition::Looks(phrase) => {
            text.push_str("looks ");
            quoted(text, &phrase.words);
        }
        Condition::Id(number) => put!(text, "#{number}"),
        Condition::Phrase(phrase) => {
            text.push_str("phrase ");
            quoted(text, &phrase.words);
        }
        Condition::Is(things) => {
            text.push_str("is ");
            pattern(text, things);
        }
        Condition::Not(inner) => {
            text.push_str("not ");
            self::condition(text, inner);
        }
        Condition::Any(parts) => joined(text, parts, "or"),
        Condition::All(parts) => joined(text, parts, "and"),
    }
}

/// `(a or b)`; with fewer than two parts the word comes first: `(or a)`.
fn joined(text: &mut String, parts: &[Condition], word: &str) {
    text.push('(');
    if parts.len() < 2 {
        text.push_str(word);
        text.push_str(if parts.is_empty() { "" } else { " " });
    }
    list(text, parts, &format!(" {word} "));
    text.push(')');
}

fn sector_or_distance(text: &mut String, place: &Place) {
    match place {
        Place::Distance(word) => put!(text, "distance={word}"),
        Place::Direction(direction) => put!(text, "direction={direction}"),
        Place::Metres(interval) => {
            text.push_str("metres ");
            stretch(text, interval);
        }
        Place::Degrees { center, half_width } => put!(text, "degrees {center}+-{half_width}"),
    }
}

fn stretch(text: &mut String, Interval { min, max }: &Interval) {
    let end = |value: &Option<f64>| value.map(|value| value.to_string()).unwrap_or_default();
    put!(text, "{}..{}", end(min), end(max));
}

fn related(text: &mut String, related: &Related) {
    for (index, kind) in related.kinds.iter().enumerate() {
        text.push_str(if index == 0 { "" } else { " & " });
        relation(text, kind);
    }
    text.push_str(": ");
    quantity(text, related.quantity);
    pattern(text, &related.partner);
}

fn relation(text: &mut String, kind: &RelationKind) {
    match kind {
        RelationKind::Placed { place: where_, viewpoint } => {
            text.push_str(match viewpoint {
                Viewpoint::Subject => "has ",
                Viewpoint::Partner => "at ",
                Viewpoint::Robot => "seen ",
            });
            sector_or_distance(text, where_);
        }
        RelationKind::Pair(word) => put!(text, "{word}"),
        RelationKind::With => text.push_str("with"),
        RelationKind::Interaction(label) => {
            text.push_str("does ");
            quoted(text, label);
        }
        RelationKind::Between(other) => {
            text.push_str("between ");
            pattern(text, other);
        }
    }
}

fn compared(text: &mut String, compared: &Compared) {
    text.push_str(if compared.order == Order::Most { "more " } else { "less " });
    measure(text, &compared.measure);
    text.push_str(" than ");
    pattern(text, &compared.than);
}

fn command(text: &mut String, command: &Command) {
    text.push_str(" command ");
    quoted(text, &command.verb);
    if let Some(object) = &command.object {
        text.push(' ');
        quoted(text, object);
    }
    if let Some(destination) = &command.destination {
        text.push_str(" to ");
        quoted(text, destination);
    }
}

fn slot(text: &mut String, slot: &Slot) {
    text.push_str(" slot ");
    if let Some([from, to]) = slot.during_s {
        put!(text, "{from}..{to} ");
    }
    text.push('{');
    list(text, &slot.conditions, ", ");
    text.push('}');
}
