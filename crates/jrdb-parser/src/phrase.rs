//! What the productions hand to each other: noun phrases, partners, places.

use jrdb_types::query::{Interval, Place, Quantity, RelationKind, Viewpoint};
use jrdb_types::vocab::Sector;
use jrdb_types::{Direction, DistanceWord, Pattern};

use smallvec::SmallVec;

use crate::lexicon::Entry;

/// How much of what follows belongs to a thing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scope {
    /// All of it: the thing asked for.
    Top,
    /// A partner behind "who": until a joint that begins anew.
    Relative,
    /// A partner: until a joint or a verb.
    Reduced,
}

/// What a predicate stands behind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum After {
    /// "who" or "is": it may be a noun.
    Verb,
    /// The noun of the thing asked for.
    Noun,
    /// The noun of a partner, whose relation may go on behind it.
    Partner,
}

/// A noun phrase.
#[derive(Debug, Default)]
pub(crate) struct NounGroup {
    pub(crate) pattern: Pattern,
    /// Its noun, or the one that "the one" stands for.
    pub(crate) noun: Option<&'static Entry>,
    /// "at least two", "no".
    pub(crate) quantity: Option<Quantity>,
    /// "two", with the place of the word.
    pub(crate) count: Option<(u32, usize)>,
    /// "second", with the place of the word.
    pub(crate) rank: Option<(u32, usize)>,
    /// "last": the rank is from the other end.
    pub(crate) is_last: bool,
    /// "all", "everyone".
    pub(crate) is_all: bool,
    /// The place of its first word.
    pub(crate) start: usize,
    /// "those" and nothing else.
    pub(crate) is_pronoun: bool,
}

impl NounGroup {
    /// How many there must be, where it is not the words of a choice.
    pub(crate) fn how_many(&self) -> Quantity {
        let count = self.count.filter(|(count, _)| *count > 1);
        let counted = count.map(|(count, _)| Quantity::at_least(count));
        self.quantity.or(counted).unwrap_or_default()
    }
}

/// A partner and how many of it there must be.
#[derive(Debug, Default)]
pub(crate) struct Partner {
    pub(crate) pattern: Pattern,
    pub(crate) noun: Option<&'static Entry>,
    pub(crate) quantity: Quantity,
    /// "every chair" was said.
    pub(crate) is_all: bool,
}

/// One of several things, with what is said behind its noun.
pub(crate) struct Part {
    pub(crate) pattern: Pattern,
    pub(crate) noun: Option<&'static Entry>,
    /// How many conditions stand before or in its noun.
    pub(crate) head: usize,
    /// The place of its first word, and of the first word behind its noun.
    pub(crate) start: usize,
    pub(crate) told: usize,
    /// "and" was before it.
    pub(crate) is_joined: bool,
}

/// The thing asked for, and what was said of its number.
#[derive(Clone, Default)]
pub(crate) struct Target {
    pub(crate) pattern: Pattern,
    pub(crate) quantity: Option<Quantity>,
    pub(crate) count: Option<(u32, usize)>,
    pub(crate) is_all: bool,
    /// How many conditions the noun phrase has.
    pub(crate) head: usize,
}

/// Degrees between two hours of a clock's face.
pub(crate) const HOUR_DEG: f64 = 30.0;

/// The greatest angle to one side.
pub(crate) const HALF_TURN_DEG: f64 = 180.0;

/// "near" a thing: the benchmark's "close" and "very close", metres.
const NEAR_M: f64 = DistanceWord::Close.bounds_m().1;

/// "far from" a thing: the benchmark's "far" and "very far", metres.
const FAR_M: f64 = DistanceWord::Far.bounds_m().0;

/// Things said of one place at most.
const PLACES_MAX: usize = 4;

/// What is said of a place.
#[derive(Debug, Default)]
pub(crate) struct LocationPhrase {
    pub(crate) places: SmallVec<[Place; PLACES_MAX]>,
    /// Place of the distance that was said without the word "distance": "near".
    pub(crate) bare_distance: Option<usize>,
    /// Where "left" or "right" stands.
    pub(crate) sided: Option<usize>,
    /// From where it is told.
    pub(crate) reference: Reference,
}

/// How much of a location was read, to return to.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Extent {
    pub(crate) places: usize,
    bare_distance: Option<usize>,
    sided: Option<usize>,
}

impl LocationPhrase {
    pub(crate) fn extent(&self) -> Extent {
        Extent { places: self.places.len(), bare_distance: self.bare_distance, sided: self.sided }
    }

    /// The relations to the entity that the places are relative to. A distance is the same from both
    /// sides: it goes with the partner, or with the subject that has the partner.
    pub(crate) fn kinds(&self, viewpoint: Viewpoint) -> Vec<RelationKind> {
        let of_distance = match viewpoint {
            Viewpoint::Subject => Viewpoint::Subject,
            Viewpoint::Partner | Viewpoint::Robot => Viewpoint::Partner,
        };
        let kind = |place: &Place| {
            let viewpoint = if is_distance(place) { of_distance } else { viewpoint };
            RelationKind::Placed { place: *place, viewpoint }
        };
        self.places.iter().map(kind).collect()
    }

    /// Drops what was read since; the reference is left to the caller.
    pub(crate) fn cut_back(&mut self, extent: Extent) {
        self.places.truncate(extent.places);
        (self.bare_distance, self.sided) = (extent.bare_distance, extent.sided);
    }

    pub(crate) fn push(&mut self, place: Place) -> bool {
        let has_room = self.places.len() < PLACES_MAX;
        if has_room {
            self.places.push(place);
        }
        has_room
    }

    pub(crate) fn has_reference(&self) -> bool {
        !matches!(self.reference, Reference::Unsaid)
    }

    /// Makes the side that was just read an angle to that side; false when it was no side.
    pub(crate) fn turn_to_degrees(&mut self, degrees: f64) -> bool {
        let last = self.places.last_mut().filter(|_| self.sided.is_some());
        let Some(last) = last else { return false };
        let center = match last {
            Place::Direction(Direction { sector: Sector::Left, .. }) => degrees,
            Place::Direction(Direction { sector: Sector::Right, .. })
                if degrees < HALF_TURN_DEG =>
            {
                -degrees
            }
            Place::Direction(Direction { sector: Sector::Right, .. }) => degrees,
            _ => return false,
        };
        *last = Place::Degrees { center: center + 0.0, half_width: HOUR_DEG / 2.0 };
        true
    }

    /// The places as they are meant beside a thing: "near a table" is at most 1.5 m from it, very close or close.
    pub(crate) fn apply_near_default(&mut self) {
        let Some(place) = self.bare_distance.and_then(|at| self.places.get_mut(at)) else {
            return;
        };
        match place {
            Place::Distance(DistanceWord::Close) => {
                *place = Place::Metres(Interval { min: None, max: Some(NEAR_M) });
            }
            Place::Distance(DistanceWord::Far) => {
                *place = Place::Metres(Interval { min: Some(FAR_M), max: None });
            }
            _ => {}
        }
    }
}

/// From where a place is told.
#[derive(Debug, Default)]
pub(crate) enum Reference {
    #[default]
    Unsaid,
    Robot,
    /// "his left".
    His,
    /// "behind him".
    Him,
    /// "the man's left".
    Own(Pattern),
    Things(Vec<Partner>),
}

pub(crate) fn is_robot(partner: &Partner) -> bool {
    partner.pattern.category == jrdb_types::query::Category::Robot
}

pub(crate) fn is_distance(place: &Place) -> bool {
    matches!(place, Place::Distance(_) | Place::Metres(_))
}
