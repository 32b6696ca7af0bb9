//! Questions of every kind.

use jrdb_types::query::{Category, Compared, Interval, Measure, Order, Pick, Place, Viewpoint};
use jrdb_types::vocab::{Color, PairWord, Sector};
use jrdb_types::*;

use super::graphs::Random;

/// A question whose patterns are at most so deep.
pub(crate) fn random(random: &mut Random) -> Query {
    let task = match random.below(4) {
        0 => Task::Count,
        1 => Task::Exists(Quantity::at_least(2)),
        _ => Task::Find,
    };
    Query { task, target: pattern(random, 2), ..Query::default() }
}

/// A question of one condition, of whatever kind.
pub(crate) fn single(random: &mut Random) -> Query {
    let category = if random.chance(0.3) { Category::Anything } else { Category::Person };
    let inner = condition(random, 2);
    let inner = if random.chance(0.4) { Condition::Not(Box::new(inner)) } else { inner };
    let conditions = vec![inner];
    Query { target: Pattern { category, conditions, pick: None }, ..Query::default() }
}

/// A question about attributes and plain relations only.
pub(crate) fn plain(random: &mut Random) -> Query {
    let count = 1 + random.below(4);
    let mut conditions: Vec<Condition> = (0..count).map(|_| attribute(random)).collect();
    if random.chance(0.4) {
        let partner = Pattern { conditions: vec![attribute(random)], ..Pattern::default() };
        let kinds = vec![RelationKind::Placed {
            place: Place::Direction(Direction::level(random.one_of(Sector::ALL))),
            viewpoint: random.one_of(&[Viewpoint::Subject, Viewpoint::Partner]),
        }];
        conditions.push(Condition::Related(Related { kinds, partner, quantity: Quantity::SOME }));
    }
    super::ask(conditions)
}

fn pattern(random: &mut Random, depth: usize) -> Pattern {
    let category = match random.below(8) {
        0 => Category::Object,
        1 => Category::Anything,
        2 => Category::Class("bag".into()),
        _ => Category::Person,
    };
    let count = random.below(4);
    let conditions = (0..count).map(|_| condition(random, depth)).collect();
    let pick = random.chance(0.2).then(|| Pick {
        measure: measure(random, depth),
        order: order(random),
        rank: random.below(3) as u32,
        count: random.below(3) as u32,
    });
    Pattern { category, conditions, pick }
}

fn attribute(random: &mut Random) -> Condition {
    match random.below(6) {
        0 => Condition::has(random.one_of(Age::ALL)),
        1 => Condition::has(random.one_of(Gender::ALL)),
        2 => Condition::has(random.one_of(Race::ALL)),
        3 => Condition::has(AttributeValue::upper_color(random.one_of(&Color::ALL[..3]))),
        4 => Condition::has(AttributeValue::lower_color(random.one_of(&Color::ALL[..3]))),
        _ => Condition::has(random.one_of(&Action::ALL[..3])),
    }
}

fn condition(random: &mut Random, depth: usize) -> Condition {
    let deep = depth > 0;
    match random.below(12) {
        0 => Condition::FromRobot(place(random)),
        1 => Condition::GroupSize(quantity(random)),
        2..=4 if deep => Condition::Related(related(random, depth - 1)),
        5 if deep => Condition::Compared(Compared {
            measure: measure(random, depth - 1),
            order: order(random),
            than: Box::new(pattern(random, depth - 1)),
        }),
        6 if deep => Condition::Is(Box::new(pattern(random, depth - 1))),
        7 if deep => Condition::Not(Box::new(condition(random, depth - 1))),
        8 if deep => Condition::Any(vec![condition(random, depth - 1), attribute(random)]),
        9 if deep => Condition::All(vec![condition(random, depth - 1), attribute(random)]),
        _ => attribute(random),
    }
}

fn related(random: &mut Random, depth: usize) -> Related {
    let kinds = (0..1 + random.below(2)).map(|_| kind(random, depth)).collect();
    let partner = match random.below(6) {
        0 => Pattern::of(Category::Robot),
        _ => pattern(random, depth),
    };
    Related { kinds, partner, quantity: quantity(random) }
}

fn kind(random: &mut Random, depth: usize) -> RelationKind {
    match random.below(8) {
        0 => RelationKind::Pair(random.one_of(PairWord::ALL)),
        1 => RelationKind::Interaction(random.one_of(&["conversation", "holding"]).into()),
        2 => RelationKind::With,
        3 if depth > 0 => RelationKind::Between(Box::new(pattern(random, depth - 1))),
        _ => RelationKind::Placed {
            place: place(random),
            viewpoint: random.one_of(&[Viewpoint::Subject, Viewpoint::Partner, Viewpoint::Robot]),
        },
    }
}

fn place(random: &mut Random) -> Place {
    match random.below(4) {
        0 => Place::Distance(random.one_of(DistanceWord::ALL)),
        1 => Place::Direction(Direction::level(random.one_of(Sector::ALL))),
        2 => Place::Metres(Interval { min: Some(random.within(0.0, 2.0)), max: Some(4.0) }),
        _ => Place::Degrees { center: random.within(-180.0, 180.0), half_width: 60.0 },
    }
}

fn measure(random: &mut Random, depth: usize) -> Measure {
    match random.below(6) {
        0 => Measure::Age,
        1 => Measure::Speed,
        2 => Measure::FromLeft,
        3 if depth > 0 => Measure::DistanceTo(Box::new(pattern(random, depth - 1))),
        4 => Measure::DistanceTo(Box::new(Pattern::of(Category::Robot))),
        _ => Measure::Height,
    }
}

fn order(random: &mut Random) -> Order {
    random.one_of(&[Order::Least, Order::Most])
}

fn quantity(random: &mut Random) -> Quantity {
    match random.below(5) {
        0 => Quantity::NONE,
        1 => Quantity::exactly(1),
        2 => Quantity::at_least(2),
        _ => Quantity::SOME,
    }
}
