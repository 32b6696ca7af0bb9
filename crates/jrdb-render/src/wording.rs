//! Conditions and patterns of the query algebra, in words.

use jrdb_types::query::{
    Category, Compared, Interval, Measure, Measures, Nearer, Order, Pick, Place, RelationKind,
    Viewpoint,
};
use jrdb_types::vocab::{PairWord, Sector};
use jrdb_types::{
    Age, AttributeValue, AttributeWording, Condition, Direction, Pattern, Quantity, Related,
};

/// A condition in words: `age young`, `close distance from the robot`.
#[must_use]
pub fn condition(condition: &Condition) -> String {
    match condition {
        Condition::Attribute(value) => attribute_value(*value),
        Condition::FromRobot(place) => from_robot(place),
        Condition::GroupSize(quantity) => group(*quantity),
        Condition::Related(related) => relation(related),
        Condition::Compared(compared) => comparison(compared),
        Condition::Nearer(Nearer { to, than }) => {
            format!("nearer to {} than to {}", pattern(to), pattern(than))
        }
        Condition::Measures(measured) => measures(measured),
        Condition::Looks(phrase) => format!("looks {:?}", phrase.words),
        Condition::Id(number) => format!("#{number}"),
        Condition::Phrase(phrase) => format!("{:?}", phrase.words),
        Condition::Is(those) => format!("is {}", pattern(those)),
        Condition::Not(inner) => format!("not {}", part(inner)),
        Condition::Any(parts) => alternatives(parts).unwrap_or_else(|| listed(parts, " or ")),
        Condition::All(parts) => listed(parts, " and "),
    }
}

/// `age young, middle-aged or elderly`: values of one attribute.
fn alternatives(parts: &[Condition]) -> Option<String> {
    let of_one = parts.windows(2).all(|two| attribute(&two[0]) == attribute(&two[1]));
    let name = attribute(parts.first()?).filter(|_| of_one)?;
    let words: Vec<String> = parts.iter().filter_map(adjective).collect();
    let (last, others) = words.split_last()?;
    let others = others.join(", ");
    Some(if others.is_empty() {
        format!("{name} {last}")
    } else {
        format!("{name} {others} or {last}")
    })
}

/// Which attribute a condition is about.
fn attribute(condition: &Condition) -> Option<&'static str> {
    let Condition::Attribute(value) = condition else { return None };
    let row = value.attribute().row();
    (row.wording == AttributeWording::Adjective).then_some(row.name)
}

/// `age young`, `red above the waist`.
fn attribute_value(value: AttributeValue) -> String {
    let row = value.attribute().row();
    match row.wording {
        AttributeWording::Adjective => format!("{} {value}", row.name),
        AttributeWording::Followed(place) => format!("{value} {place}"),
    }
}

fn part(condition: &Condition) -> String {
    match condition {
        Condition::Any(_) | Condition::All(_) | Condition::Not(_) => {
            format!("({})", self::condition(condition))
        }
        _ => self::condition(condition),
    }
}

fn listed(parts: &[Condition], with: &str) -> String {
    parts.iter().map(part).collect::<Vec<_>>().join(with)
}

fn group(quantity: Quantity) -> String {
    match quantity {
        Quantity { at_least: 1, at_most: Some(1) } => "alone".into(),
        other => format!("in a group of {}", amount(other)),
    }
}

/// A number of things: `3`, `at least 2`, `2 to 4`.
pub(crate) fn amount(quantity: Quantity) -> String {
    match (quantity.at_least, quantity.at_most) {
        (least, Some(most)) if least == most => least.to_string(),
        (0, Some(most)) => format!("at most {most}"),
        (least, Some(most)) => format!("{least} to {most}"),
        (least, None) => format!("at least {least}"),
    }
}

fn from_robot(place: &Place) -> String {
    match place {
        Place::Distance(word) => format!("{word} distance from the robot"),
        Place::Direction(word) => format!("{word} of the robot"),
        Place::Metres(interval) => format!("{} from the robot", metres(interval)),
        Place::Degrees { .. } => format!("{} of the robot's front", degrees(place)),
    }
}

/// `2 to 3 m`, `at most 3 m`.
fn metres(interval: &Interval) -> String {
    match (interval.min, interval.max) {
        (Some(min), Some(max)) => format!("{min} to {max} m"),
        (Some(min), None) => format!("at least {min} m"),
        (None, Some(max)) => format!("at most {max} m"),
        (None, None) => "any distance".into(),
    }
}

fn degrees(place: &Place) -> String {
    let Place::Degrees { center, half_width } = place else { return String::new() };
    let side = if *center < 0.0 { "right" } else { "left" };
    format!("{:.0}° ± {half_width:.0}° to the {side}", center.abs())
}

/// Relations to a partner: the first names it, the others point back at it.
fn relation(related: &Related) -> String {
    let partner = partner(related);
    let first = related.kinds.first().map(|first| kind(first, &partner));
    let rest = related.kinds.iter().skip(1).map(kind_again);
    let first = first.unwrap_or_else(|| format!("there is {partner}"));
    std::iter::once(first).chain(rest).collect::<Vec<_>>().join(", ")
}

fn partner(related: &Related) -> String {
    // Each of these words the partner once: twice at every level would double the work with the depth.
    let described = || description(&related.partner);
    match related.quantity {
        Quantity::SOME => pattern(&related.partner),
        Quantity::NONE => format!("no {}", described()),
        Quantity { at_least: 1, at_most: Some(1) } => format!("exactly one {}", described()),
        quantity => format!("{} × {}", amount(quantity), described()),
    }
}

/// One relation with a partner in words.
pub(crate) fn kind(kind: &RelationKind, partner: &str) -> String {
    match kind {
        RelationKind::Placed { place, viewpoint } => placed(place, *viewpoint, partner),
        RelationKind::Pair(word) => pair(*word, partner),
        RelationKind::Interaction(label) => interaction(label, partner),
        RelationKind::With => format!("with {partner}"),
        RelationKind::Between(other) => format!("between {partner} and {}", pattern(other)),
    }
}

fn kind_again(again: &RelationKind) -> String {
    match again {
        RelationKind::Placed { place: Place::Distance(word), .. } => format!("at {word} distance"),
        RelationKind::Placed { place: Place::Metres(interval), .. } => {
            format!("{} apart", metres(interval))
        }
        other => kind(other, "it"),
    }
}

fn pair(word: PairWord, partner: &str) -> String {
    match word {
        PairWord::Hides => format!("hiding {partner}"),
        PairWord::HiddenBy => format!("hidden by {partner}"),
        PairWord::FacingEachOther => format!("face to face with {partner}"),
        word => format!("{word} {partner}"),
    }
}

fn interaction(label: &str, partner: &str) -> String {
    match label.strip_suffix(" together") {
        Some(verb) => format!("{verb} together with {partner}"),
        None if label == "conversation" => format!("in conversation with {partner}"),
        None => format!("{label} {partner}"),
    }
}

fn placed(place: &Place, viewpoint: Viewpoint, partner: &str) -> String {
    match (place, viewpoint) {
        (Place::Distance(word), _) => format!("at {word} distance from {partner}"),
        (Place::Metres(interval), _) => format!("{} from {partner}", metres(interval)),
        (Place::Direction(word), Viewpoint::Subject) => {
            format!("has {partner} to its {word}")
        }
        (Place::Direction(word), Viewpoint::Partner) => format!("{} {partner}", side_of(*word)),
        (Place::Direction(word), Viewpoint::Robot) => {
            format!("{} {partner}, as the robot sees them", side_of(*word))
        }
        (Place::Degrees { .. }, Viewpoint::Subject) => {
            format!("has {partner} {} of its front", degrees(place))
        }
        (Place::Degrees { .. }, _) => format!("{} of the front of {partner}", degrees(place)),
    }
}

fn side_of(direction: Direction) -> String {
    match direction {
        d if d == Direction::level(Sector::Front) => "in front of".into(),
        d if d == Direction::level(Sector::Back) => "behind".into(),
        other => format!("{other} of"),
    }
}

fn measures(measured: &Measures) -> String {
    let (name, unit) = match measured.measure {
        Measure::Speed => ("speed", "m/s"),
        _ => ("height", "m"),
    };
    match (measured.within.min, measured.within.max) {
        (Some(min), Some(max)) => format!("{name} {min} to {max} {unit}"),
        (Some(min), None) => format!("{name} at least {min} {unit}"),
        (None, Some(max)) => format!("{name} at most {max} {unit}"),
        (None, None) => format!("any {name}"),
    }
}

fn comparison(compared: &Compared) -> String {
    let than = pattern(&compared.than);
    let word = match (&compared.measure, compared.order) {
        (Measure::Height, Order::Most) => "taller",
        (Measure::Height, Order::Least) => "shorter",
        (Measure::Age, Order::Most) => "older",
        (Measure::Age, Order::Least) => "younger",
        (Measure::Speed, Order::Most) => "faster",
        (Measure::Speed, Order::Least) => "slower",
        (Measure::FromLeft, Order::Least) => "farther left",
        (Measure::FromLeft, Order::Most) => "farther right",
        (Measure::DistanceTo(to), Order::Least) => {
            return format!("closer to {} than {than}", pattern(to));
        }
        (Measure::DistanceTo(to), Order::Most) => {
            return format!("farther from {} than {than}", pattern(to));
        }
    };
    format!("{word} than {than}")
}

/// A pick in words: `the 2nd from the left`, `the tallest 3`.
pub(crate) fn pick(pick: &Pick) -> String {
    let by = match (&pick.measure, pick.order) {
        (Measure::Height, Order::Most) => "tallest".into(),
        (Measure::Height, Order::Least) => "shortest".into(),
        (Measure::Age, Order::Most) => "oldest".into(),
        (Measure::Age, Order::Least) => "youngest".into(),
        (Measure::Speed, Order::Most) => "fastest".into(),
        (Measure::Speed, Order::Least) => "slowest".into(),
        (Measure::FromLeft, Order::Least) => "from the left".into(),
        (Measure::FromLeft, Order::Most) => "from the right".into(),
        (Measure::DistanceTo(to), Order::Least) => format!("nearest to {}", pattern(to)),
        (Measure::DistanceTo(to), Order::Most) => format!("farthest from {}", pattern(to)),
    };
    let place = if pick.rank <= 1 { String::new() } else { format!("{} ", ordinal(pick.rank)) };
    let first =
        if matches!(pick.measure, Measure::FromLeft) && pick.rank <= 1 { "first " } else { "" };
    let count = if pick.count == 1 { String::new() } else { format!(", {} of them", pick.count) };
    format!("the {place}{first}{by}{count}")
}

fn ordinal(number: u32) -> String {
    let ending = match (number % 10, number % 100) {
        (_, 11..=13) => "th",
        (1, _) => "st",
        (2, _) => "nd",
        (3, _) => "rd",
        _ => "th",
    };
    format!("{number}{ending}")
}

/// A pattern as a noun phrase, `a young female person`.
#[must_use]
pub fn pattern(pattern: &Pattern) -> String {
    match (&pattern.category, &pattern.pick) {
        (Category::Robot, _) => "the robot".into(),
        (_, Some(picked)) => format!("{} of the {}s", pick(picked), description(pattern)),
        _ => {
            let described = description(pattern);
            let vowel = described.starts_with(['a', 'e', 'i', 'o', 'u', 'A', 'E', 'I', 'O', 'U']);
            format!("{} {described}", if vowel { "an" } else { "a" })
        }
    }
}

/// The same without its article.
pub(crate) fn description(pattern: &Pattern) -> String {
    let (words, clauses): (Vec<_>, Vec<_>) =
        pattern.conditions.iter().partition(|c| adjective(c).is_some());
    let child = Condition::has(Age::Child);
    let is_child = words.contains(&&child) && pattern.category == Category::Person;
    let words = words.into_iter().filter(|word| !is_child || **word != child);
    let words: Vec<String> = words.filter_map(adjective).collect();
    let adjectives = if words.is_empty() { String::new() } else { format!("{} ", words.join(" ")) };
    let clauses: String =
        clauses.into_iter().map(|clause| format!(" ({})", condition(clause))).collect();
    let noun = if is_child { "child" } else { noun(&pattern.category) };
    format!("{adjectives}{noun}{clauses}")
}

pub(crate) fn noun(category: &Category) -> &str {
    match category {
        Category::Person => "person",
        Category::Object => "object",
        Category::Anything => "thing",
        Category::Class(name) => name,
        Category::Robot => "robot",
    }
}

fn adjective(condition: &Condition) -> Option<String> {
    match condition {
        Condition::Attribute(value) => {
            let is_adjective = value.attribute().row().wording == AttributeWording::Adjective;
            is_adjective.then(|| value.to_string())
        }
        Condition::Any(parts) => {
            let words: Option<Vec<String>> = parts.iter().map(adjective).collect();
            words.filter(|words| !words.is_empty()).map(|words| words.join("/"))
        }
        _ => None,
    }
}
