//! Puts groups, people and furniture into the room: nobody inside a wall, a table or somebody else.

use std::collections::BTreeSet;
use std::f64::consts::{FRAC_PI_2, PI};

use jrdb_projection::nalgebra::{Rotation2, Vector2};
use jrdb_projection::relation::wrap_rad;
use jrdb_types::{Action, Age, Gender, Race};

use super::config::SynthConfig;
use super::furniture::{Furniture, Kind};
use super::person::{Look, Person, TOPS, height_m};
use super::plan::{self, EVERYWHERE, Group, Zone};
use super::random::Random;
use super::room::{Color, Room, Setting};

/// Who and what is in the room.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Cast {
    pub(super) people: Vec<Person>,
    pub(super) furniture: Vec<Furniture>,
}

/// Places that are tried for a group before it is left out; the later ones may lie anywhere, and
/// the last ones behind or in front of others.
const TRIES: usize = 900;
const TRIES_IN_ZONE: usize = 400;
const TRIES_IN_VIEW: usize = 700;

/// Space that a person needs around them, metres.
const PERSON_M: f64 = 0.36;
/// A walker's path is kept free at places this far apart, metres.
const PATH_STEP_M: f64 = 0.3;
/// Nobody walks farther than this one way, metres.
const PATH_MAX_M: f64 = 3.0;
/// Walls and robot are kept clear by this much, metres.
const WALL_M: f64 = 0.55;
const ROBOT_M: f64 = 1.1;
/// How far furniture stands from the robot, metres.
const THINGS_M: [f64; 2] = [2.6, 6.5];
const AHEAD_RAD: [f64; 2] = [-0.42, 0.42];

/// A disc on the floor that is taken.
#[derive(Debug, Clone, Copy)]
struct Disc {
    middle_m: Vector2<f64>,
    radius_m: f64,
}

/// What a person hides of the room behind them: the middle and half width of an angle, and how far
/// away.
#[derive(Debug, Clone, Copy)]
struct View {
    bearing_rad: f64,
    half_rad: f64,
}

impl View {
    fn of(disc: &Disc) -> Self {
        let range_m = disc.middle_m.norm();
        let bearing_rad = disc.middle_m.y.atan2(disc.middle_m.x);
        Self { bearing_rad, half_rad: (0.85 * disc.radius_m).atan2(range_m) }
    }

    fn overlaps(&self, other: &Self) -> bool {
        let between = wrap_rad(self.bearing_rad - other.bearing_rad).abs();
        between < self.half_rad + other.half_rad
    }
}

/// Fills the room with at most `config.people` people, and things. Whoever finds no free place
/// after many tries is left out.
pub(super) fn cast(config: &SynthConfig, room: &Room, path_seconds: f64) -> Cast {
    let mut random = Random::stream(config.seed, 2);
    let groups = plan::groups(config.setting, config.people, &mut random);
    let mut traits = Traits::new(Random::stream(config.seed, 3));
    let mut stage = Stage { room, path_seconds, random, discs: Vec::new(), views: Vec::new() };
    let mut cast = Cast::default();
    for group in &groups {
        if let Some(placed) = stage.place(group) {
            stage.enter(&placed, &mut traits, &mut cast);
        }
    }
    for (index, kind) in things(config.setting).into_iter().enumerate() {
        // The first stands ahead, so that there is something to ask for.
        let bearing_rad = if index == 0 { AHEAD_RAD } else { EVERYWHERE.bearing_rad };
        if let Some((disc, yaw_rad)) = stage.place_thing(kind, bearing_rad) {
            add_furniture(&mut cast, kind, disc.middle_m, yaw_rad);
        }
    }
    cast
}

/// What stands in the room besides the tables at which people sit.
fn things(setting: Setting) -> [Kind; 4] {
    let table = Kind::Table([0.7, 1.2]);
    match setting {
        Setting::Plaza => [Kind::Bin, Kind::Plant, Kind::Plant, table],
        Setting::Cafe => [Kind::Bin, Kind::Plant, table, Kind::Plant],
        Setting::Corridor => [Kind::Bin, Kind::Plant, Kind::Bin, Kind::Plant],
    }
}

fn add_furniture(cast: &mut Cast, kind: Kind, place_m: Vector2<f64>, yaw_rad: f64) {
    let same = cast.furniture.iter().filter(|thing| thing.id.class == kind.class()).count();
    cast.furniture.push(Furniture::new(kind, same as u32 + 1, place_m, yaw_rad));
}

/// A group with its place in the room.
struct Placed<'a> {
    group: &'a Group,
    middle_m: Vector2<f64>,
    bearing_rad: f64,
    speed_m_s: f64,
    /// What it takes up, one list per member.
    taken: Vec<Vec<Disc>>,
}

struct Stage<'a> {
    room: &'a Room,
    path_seconds: f64,
    random: Random,
    discs: Vec<Disc>,
    views: Vec<View>,
}

impl Stage<'_> {
    fn place<'a>(&mut self, group: &'a Group) -> Option<Placed<'a>> {
        (0..TRIES).find_map(|attempt| {
            let zone = if attempt < TRIES_IN_ZONE { group.zone } else { EVERYWHERE };
            let placed = self.at_random(group, zone);
            let free = placed.taken.iter().flatten().all(|disc| self.is_free(disc));
            let clear = attempt >= TRIES_IN_VIEW
                || placed.taken.iter().flatten().all(|disc| self.is_in_view(disc));
            (free && clear).then_some(placed)
        })
    }

    fn at_random<'a>(&mut self, group: &'a Group, zone: Zone) -> Placed<'a> {
        let range_m = self.random.within(zone.range_m);
        let bearing_rad = self.random.within(zone.bearing_rad);
        let speed_m_s = self.random.within([1.0, 1.4]);
        let middle_m = Rotation2::new(bearing_rad) * Vector2::new(range_m, 0.0);
        let mut placed = Placed { group, middle_m, bearing_rad, speed_m_s, taken: Vec::new() };
        for index in 0..group.members.len() {
            let taken = self.discs_of(&placed, index);
            placed.taken.push(taken);
        }
        placed
    }

    /// A person's disc and those along their path; a table belongs to the first member.
    fn discs_of(&self, placed: &Placed<'_>, index: usize) -> Vec<Disc> {
        let (start_m, heading_rad) = placed.member(index);
        let path_m = self.path_m(placed, index);
        let steps = (path_m / PATH_STEP_M).ceil() as usize;
        let ahead = Rotation2::new(heading_rad) * Vector2::new(path_m, 0.0);
        let walked = |step: usize| start_m + ahead * (step as f64 / steps.max(1) as f64);
        let mut discs: Vec<Disc> =
            (0..=steps).map(|step| Disc { middle_m: walked(step), radius_m: PERSON_M }).collect();
        if let (0, Some(table)) = (index, placed.group.table) {
            discs.push(Disc { middle_m: placed.middle_m, radius_m: table.radius_m() });
        }
        discs
    }

    fn path_m(&self, placed: &Placed<'_>, index: usize) -> f64 {
        match placed.group.members[index].action {
            Action::Walking => (placed.speed_m_s * self.path_seconds).min(PATH_MAX_M),
            _ => 0.0,
        }
    }

    fn is_free(&self, disc: &Disc) -> bool {
        let [x, y] = [disc.middle_m.x, disc.middle_m.y];
        let apart = |other: &Disc| {
            (other.middle_m - disc.middle_m).norm() >= other.radius_m + disc.radius_m
        };
        self.room.holds([x, y], WALL_M)
            && disc.middle_m.norm() >= ROBOT_M
            && self.discs.iter().all(apart)
    }

    fn is_in_view(&self, disc: &Disc) -> bool {
        let view = View::of(disc);
        !self.views.iter().any(|other| view.overlaps(other))
    }

    fn take(&mut self, discs: &[Disc]) {
        self.discs.extend(discs);
        self.views.extend(discs.iter().map(View::of));
    }

    /// Adds a placed group's people and table to the cast.
    fn enter(&mut self, placed: &Placed<'_>, traits: &mut Traits, cast: &mut Cast) {
        let first = cast.people.len() as u32 + 1;
        for (index, member) in placed.group.members.iter().enumerate() {
            let (start_m, heading_rad) = placed.member(index);
            let partner = first + 1 - index as u32;
            let number = first + index as u32;
            cast.people.push(Person {
                start_m,
                heading_rad,
                action: member.action,
                speed_m_s: if member.action == Action::Walking { placed.speed_m_s } else { 0.0 },
                path_m: self.path_m(placed, index),
                company: placed.group.company.map(|label| (partner, label)),
                ..traits.next(number)
            });
            self.take(&placed.taken[index]);
        }
        if let Some(table) = placed.group.table {
            add_furniture(cast, table, placed.middle_m, placed.bearing_rad);
        }
    }

    /// A place for a thing; the first free one, in view where possible.
    fn place_thing(&mut self, kind: Kind, bearing_rad: [f64; 2]) -> Option<(Disc, f64)> {
        let found = (0..TRIES).find_map(|attempt| {
            let bearing_rad = self.random.within(bearing_rad);
            let ahead = Vector2::new(self.random.within(THINGS_M), 0.0);
            let middle_m = Rotation2::new(bearing_rad) * ahead;
            let disc = Disc { middle_m, radius_m: kind.radius_m() };
            let clear = attempt >= TRIES_IN_ZONE || self.is_in_view(&disc);
            (self.is_free(&disc) && clear).then_some(disc)
        })?;
        self.take(&[found]);
        Some((found, self.random.pick(&[0.0, FRAC_PI_2])))
    }
}

impl Placed<'_> {
    /// Place and heading of a member in the base frame.
    fn member(&self, index: usize) -> (Vector2<f64>, f64) {
        let member = self.group.members[index];
        let offset = Rotation2::new(self.bearing_rad) * Vector2::from(member.offset_m);
        (self.middle_m + offset, wrap_rad(self.bearing_rad + member.heading_rad))
    }
}

/// Who comes next: every age, gender, race and shirt before any comes again.
struct Traits {
    random: Random,
    ages: Vec<Age>,
    genders: Vec<Gender>,
    races: Vec<Race>,
    tops: Vec<Color>,
}

impl Traits {
    fn new(random: Random) -> Self {
        let (ages, genders, races, tops) = Default::default();
        Self { random, ages, genders, races, tops }
    }

    /// A person who stands nowhere yet.
    fn next(&mut self, number: u32) -> Person {
        let random = &mut self.random;
        let age = deal(&mut self.ages, Age::ALL, random);
        let gender = deal(&mut self.genders, Gender::ALL, random);
        let race = deal(&mut self.races, Race::ALL, random);
        let top = deal(&mut self.tops, &TOPS, random);
        Person {
            number,
            age,
            gender,
            race,
            action: Action::Standing,
            height_m: height_m(age, gender, random),
            look: Look::new(age, gender, race, top, random),
            features: BTreeSet::new(),
            start_m: Vector2::zeros(),
            heading_rad: PI,
            speed_m_s: 0.0,
            path_m: 0.0,
            company: None,
        }
    }
}

/// The next card of a deck that is shuffled again when it is used up.
fn deal<T: Clone>(deck: &mut Vec<T>, all: &[T], random: &mut Random) -> T {
    if deck.is_empty() {
        *deck = random.shuffled(all);
    }
    deck.pop().expect("the vocabularies are not empty")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cast_of(seed: u64, setting: Setting) -> (Room, Cast) {
        let config = SynthConfig { seed, people: 12, frames: 3, setting, ..SynthConfig::default() };
        let room = Room::new(setting, &mut Random::stream(seed, 1));
        let cast = cast(&config, &room, 2.0 / 3.0);
        (room, cast)
    }

    #[test]
    fn nobody_is_in_a_wall_a_table_or_somebody_else() {
        for seed in 0..30 {
            for setting in [Setting::Plaza, Setting::Cafe, Setting::Corridor] {
                let (room, cast) = cast_of(seed, setting);
                assert_eq!(cast.people.len(), 12, "{setting:?} {seed}");
                for person in &cast.people {
                    let here = person.start_m;
                    assert!(room.holds([here.x, here.y], 0.5));
                    let solids = person.solids(&person.pose(0.0));
                    let others = cast.people.iter().filter(|p| p.number != person.number);
                    for other in others {
                        assert!((other.start_m - here).norm() > 0.6, "{setting:?} {seed}");
                    }
                    let trunk = solids[0].center;
                    let tables = cast.furniture.iter().flat_map(Furniture::placed);
                    assert!(tables.into_iter().all(|part| !part.solid.contains(&trunk)));
                }
            }
        }
    }

    #[test]
    fn twelve_people_are_of_every_age_gender_and_race() {
        let (_, cast) = cast_of(4, Setting::Plaza);
        let has = |test: &dyn Fn(&Person) -> bool| cast.people.iter().any(test);
        assert!(Age::ALL.iter().all(|age| has(&|p| p.age == *age)));
        assert!(Gender::ALL.iter().all(|gender| has(&|p| p.gender == *gender)));
        assert!(Race::ALL.iter().all(|race| has(&|p| p.race == *race)));
    }
}
