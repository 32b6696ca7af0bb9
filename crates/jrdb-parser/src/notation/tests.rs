//! Notation there and back.

use jrdb_types::query::*;
use jrdb_types::vocab::*;
use jrdb_types::{AttributeValue, Query};
use proptest::prelude::*;

use super::{read, write};

#[test]
fn every_construct_is_written_as_it_is_read() {
    let texts = [
        "find person",
        "find thing[direction=left]",
        "count person[child, female, White, going up, middle-aged]",
        "exists >=2 person[male]",
        "exists \"trash_bin\"",
        "exists =0 object",
        "more person[male] than person[female]",
        "fewer person than \"a \\\"quoted\\\" \\\\ thing\"",
        "which age, social-interaction in order of person[sitting]",
        "where person[with: \"bag\"]",
        "find person[distance=very close, direction=up front left, metres ..3, metres 2..4.5, metres 1.., degrees -60+-15]",
        "find person[at direction=left & at distance=close: person[child]]",
        "find person[has direction=right: >=2 person, seen direction=front: \"table\"]",
        "find person[looks \"striped shirt\", #4, height 1.8.., speed ..0.5, nearer to robot than to \"door\"]",
        "each all [sitting, not male] of person[female]",
        "each none [walking] of person",
        "each most [walking] of person",
        "each half [walking] of person",
        "choice [male, female] of person[#3]",
        "distance of person from \"table\"",
        "direction of person[male] from person[female]",
        "groups person[group >=2]",
        "find person[male] command \"follow\"",
        "find person command \"take\" \"this\" to \"the kitchen\"",
        "which height, speed, facing of person",
        "find person[next to: robot, in front of: person, facing each other: 2..3 person]",
        "find person[does \"walking together\": person, between robot: \"door\", with: =0 \"bag\"]",
        "find person[not sitting, (sitting or standing), (not male and child), group =1, group <=3, group 2..4]",
        "find person[(or sitting), (and), (and not sitting)]",
        "find person[more height than person[male], less distance to robot than person]",
        "find person[is person[male]{most height}]{least distance to \"door\"{least age} rank 2 count 3}",
        "find person{most from left}",
        "find person[male] slot 0.13..0.4 {sitting} slot {standing, distance=far} slot {}",
    ];
    for text in texts {
        let query = read(text).unwrap_or_else(|error| panic!("{text}: {error}"));
        assert_eq!(write(&query), text);
    }
}

#[test]
fn who_is_more_comes_first() {
    let query = read("more person[male] than person[female]").unwrap();
    assert_eq!(query.target.conditions, [Condition::has(Gender::Male)]);
    let Task::CompareCounts { order: Order::Most, than } = query.task else { panic!() };
    assert_eq!(than.conditions, [Condition::has(Gender::Female)]);
}

#[test]
fn errors_say_where_and_what_was_expected() {
    let cases = [
        (
            "",
            "expected find, count, where, exists, which, more, fewer, each, choice, distance, direction, groups, found the end at byte 0",
        ),
        (
            "find persn",
            "expected person, object, thing, robot or a quoted class, found \"persn\" at byte 5",
        ),
        ("find person[tall]", "expected a condition, found \"tall\" at byte 12"),
        ("find person[male", "expected \"]\", found the end at byte 16"),
        (
            "find person[(male or female and child)]",
            "expected \")\", or the same of \"or\" and \"and\" throughout, found \"child\" at byte 32",
        ),
        (
            "find person[(male)]",
            "expected \"or\" or \"and\" in the brackets, found \"]\" at byte 18",
        ),
        ("find person[distance=near]", "expected a distance word, found \"near\" at byte 21"),
        ("find person{most height rank 1.5}", "expected a whole number, found \"1.5\" at byte 29"),
        ("find person {", "expected least or most, found the end at byte 13"),
        (
            "find \"bag",
            "expected person, object, thing, robot or a quoted class, found \"\\\"bag\" at byte 5",
        ),
        ("find person person", "expected the end, found \"person\" at byte 12"),
    ];
    for (text, message) in cases {
        assert_eq!(read(text).unwrap_err().to_string(), message, "{text}");
    }
}

#[test]
fn too_many_levels_are_an_error() {
    let deep = format!("find person[{}sitting]", "not ".repeat(10_000));
    assert!(read(&deep).unwrap_err().to_string().contains("at most 60 levels"));
}

fn any_of<T: Copy + std::fmt::Debug + 'static>(all: &'static [T]) -> impl Strategy<Value = T> {
    prop::sample::select(all)
}

fn number() -> impl Strategy<Value = f64> {
    (-10_000_i32..10_000).prop_map(|n| f64::from(n) / 100.0)
}

fn any_place() -> impl Strategy<Value = Place> {
    let direction = (any_of(Sector::ALL), any_of(Elevation::ALL))
        .prop_map(|(sector, elevation)| Place::Direction(Direction { sector, elevation }));
    let ends = (prop::option::of(number()), prop::option::of(number()));
    prop_oneof![
        any_of(DistanceWord::ALL).prop_map(Place::Distance),
        direction,
        ends.prop_map(|(min, max)| Place::Metres(Interval { min, max })),
        (number(), number()).prop_map(|(center, half_width)| Place::Degrees { center, half_width }),
    ]
}

fn quantity() -> impl Strategy<Value = Quantity> {
    (0..5_u32, prop::option::of(0..5_u32)).prop_map(|(at_least, more)| Quantity {
        at_least,
        at_most: more.map(|more| at_least + more),
    })
}

fn category() -> impl Strategy<Value = Category> {
    prop_oneof![
        Just(Category::Person),
        Just(Category::Object),
        Just(Category::Anything),
        Just(Category::Robot),
        "[ -~é]{0,8}".prop_map(Category::Class),
    ]
}

fn order() -> impl Strategy<Value = Order> {
    prop_oneof![Just(Order::Least), Just(Order::Most)]
}

fn measure(pattern: BoxedStrategy<Pattern>) -> impl Strategy<Value = Measure> {
    prop_oneof![
        Just(Measure::FromLeft),
        Just(Measure::Height),
        Just(Measure::Age),
        Just(Measure::Speed),
        pattern.prop_map(|things| Measure::DistanceTo(Box::new(things))),
    ]
}

fn kind(pattern: BoxedStrategy<Pattern>) -> impl Strategy<Value = RelationKind> {
    let viewpoint =
        prop_oneof![Just(Viewpoint::Subject), Just(Viewpoint::Partner), Just(Viewpoint::Robot)];
    prop_oneof![
        (any_place(), viewpoint)
            .prop_map(|(place, viewpoint)| RelationKind::Placed { place, viewpoint }),
        any_of(PairWord::ALL).prop_map(RelationKind::Pair),
        "[a-z \"\\\\]{0,8}".prop_map(RelationKind::Interaction),
        Just(RelationKind::With),
        pattern.prop_map(|other| RelationKind::Between(Box::new(other))),
    ]
}

fn condition(pattern: BoxedStrategy<Pattern>, depth: u32) -> BoxedStrategy<Condition> {
    let leaf = prop_oneof![
        any_of(Age::ALL).prop_map(Condition::has),
        any_of(Gender::ALL).prop_map(Condition::has),
        any_of(Race::ALL).prop_map(Condition::has),
        any_of(Action::ALL).prop_map(Condition::has),
        any_of(Color::ALL).prop_map(|c| Condition::has(AttributeValue::upper_color(c))),
        any_of(Color::ALL).prop_map(|c| Condition::has(AttributeValue::lower_color(c))),
        any_place().prop_map(Condition::FromRobot),
        quantity().prop_map(Condition::GroupSize),
    ];
    if depth == 0 {
        return leaf.boxed();
    }
    let kinds = prop::collection::vec(kind(pattern.clone()), 1..3);
    let related = (kinds, pattern.clone(), quantity());
    let compared = (measure(pattern.clone()), order(), pattern.clone());
    let inner = condition(pattern.clone(), depth - 1);
    let parts = prop::collection::vec(inner.clone(), 0..3);
    prop_oneof![
        4 => leaf,
        2 => related.prop_map(|(kinds, partner, quantity)| Condition::Related(Related { kinds, partner, quantity })),
        1 => compared.prop_map(|(measure, order, than)| Condition::Compared(Compared { measure, order, than: Box::new(than) })),
        1 => pattern.prop_map(|things| Condition::Is(Box::new(things))),
        1 => inner.prop_map(|c| Condition::Not(Box::new(c))),
        1 => parts.clone().prop_map(Condition::Any),
        1 => parts.prop_map(Condition::All),
    ]
    .boxed()
}

fn pattern(depth: u32) -> BoxedStrategy<Pattern> {
    let inner = if depth == 0 { Just(Pattern::default()).boxed() } else { pattern(depth - 1) };
    let conditions = prop::collection::vec(condition(inner.clone(), depth), 0..4);
    let picked = (measure(inner), order(), 1..4_u32, 1..4_u32)
        .prop_map(|(measure, order, rank, count)| Pick { measure, order, rank, count });
    (category(), conditions, prop::option::of(picked))
        .prop_map(|(category, conditions, pick)| Pattern { category, conditions, pick })
        .boxed()
}

fn task() -> impl Strategy<Value = Task> {
    let properties =
        prop::collection::vec(prop::sample::select(Property::all().collect::<Vec<_>>()), 1..4);
    prop_oneof![
        Just(Task::Find),
        Just(Task::Count),
        Just(Task::Where),
        quantity().prop_map(Task::Exists),
        (properties, any::<bool>())
            .prop_map(|(properties, in_order)| Task::Which { properties, in_order }),
        (order(), pattern(1))
            .prop_map(|(order, than)| Task::CompareCounts { order, than: Box::new(than) }),
    ]
}

fn slot() -> impl Strategy<Value = Slot> {
    let during = prop::option::of(prop::array::uniform2(number()));
    (during, prop::collection::vec(condition(pattern(0), 1), 0..3))
        .prop_map(|(during_s, conditions)| Slot { during_s, conditions })
}

proptest! {
    #[test]
    fn any_query_survives_notation_and_json(
        task in task(), target in pattern(2), slots in prop::collection::vec(slot(), 0..3),
    ) {
        let query = Query { task, target, slots, ..Query::default() };
        let text = write(&query);
        prop_assert!(!text.contains('\n'));
        let back = read(&text).map_err(|error| TestCaseError::fail(format!("{text}: {error}")))?;
        prop_assert_eq!(&Query { text: String::new(), ..back }, &query, "{}", text);
        let json = serde_json::to_string(&query).unwrap();
        prop_assert_eq!(serde_json::from_str::<Query>(&json).unwrap(), query);
    }

    #[test]
    fn any_text_is_read_or_refused(text in "\\PC*") {
        let _ = read(&text);
    }

    #[test]
    fn any_string_of_pieces_is_read_or_refused(
        pieces in prop::collection::vec(
            prop::sample::select(vec!["find", "person", "[", "]", "{", "}", "(", ")", "or", "not", ":", "=", "..", "metres", "3", "\"", "-", "distance", "most", "slot", ",", "&"]),
            0..30,
        ),
    ) {
        let _ = read(&pieces.join(" "));
    }
}
