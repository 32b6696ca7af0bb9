//! What the productions pass to each other: noun groups, partners, places.

use jrdb_types::query::{Interval, Place, Quantity, RelationKind, Share, Viewpoint};
use jrdb_types::vocab::Sector;
use jrdb_types::{Direction, DistanceWord, Pattern};

use smallvec::SmallVec;

use crate::lexicon::Entry;

/// How much of what follows describes a noun.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scope {
    /// All of it, for the target of the question.
    Top,
    /// Up to a joint that begins anew, for a partner behind "who".
    Relative,
    /// Up to a joint or a verb, for a partner.
    Reduced,
}

/// The position of a predicate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum After {
    /// Behind "who" or "is": it may be a noun.
    Verb,
    /// Behind the noun of the target.
    Noun,
    /// Behind the noun of a partner, whose relation may continue.
    Partner,
}

/// Determiners, adjectives and a noun.
#[derive(Debug, Default)]
pub(crate) struct NounGroup {
    pub(crate) pattern: Pattern,
    /// The noun, or the noun that "the one" stands for.
    pub(crate) noun: Option<&'static Entry>,
    /// "at least two", "no".
    pub(crate) quantity: Option<Quantity>,
    /// "two", with the position of the word.
    pub(crate) count: Option<(u32, usize)>,
    /// "second", with the position of the word.
    pub(crate) rank: Option<(u32, usize)>,
    /// "last": the rank counts from the other end.
    pub(crate) is_last: bool,
    /// "all", "everyone", and shares of them.
    pub(crate) is_all: bool,
    /// "all", "none of", "most".
    pub(crate) share: Option<Share>,
    /// The position of its first word.
    pub(crate) start: usize,
    /// "those" or "the one" without a noun.
    pub(crate) is_pronoun: bool,
    /// Places of the subject were read: "is the man near the door".
    pub(crate) has_places: bool,
}

impl NounGroup {
    /// How many there must be, if the number is not part of a superlative.
    pub(crate) fn how_many(&self) -> Quantity {
        let count = self.count.filter(|(count, _)| *count > 1);
        let counted = count.map(|(count, _)| Quantity::at_least(count));
        self.quantity.or(counted).unwrap_or_default()
    }
}

/// The object of a relation, and how many there must be.
#[derive(Debug, Default)]
pub(crate) struct Partner {
    pub(crate) pattern: Pattern,
    pub(crate) noun: Option<&'static Entry>,
    pub(crate) quantity: Quantity,
    /// "every chair".
    pub(crate) is_all: bool,
}

/// One of several coordinated nouns, with its clauses.
pub(crate) struct Part {
    pub(crate) pattern: Pattern,
    pub(crate) noun: Option<&'static Entry>,
    /// Number of conditions from the noun group.
    pub(crate) head: usize,
    /// Position of its first word.
    pub(crate) start: usize,
    /// Position of the first word behind its noun.
    pub(crate) after_noun: usize,
    /// Places of the subject were read: "is the man near the door".
    pub(crate) has_places: bool,
    /// "and" precedes it, not "or".
    pub(crate) is_joined: bool,
}

/// What a question asks for, with its number.
#[derive(Clone, Default)]
pub(crate) struct Target {
    pub(crate) pattern: Pattern,
    pub(crate) quantity: Option<Quantity>,
    pub(crate) count: Option<(u32, usize)>,
    /// "all", "none of", "most".
    pub(crate) share: Option<Share>,
    /// Number of conditions from the noun group.
    pub(crate) head: usize,
}

/// Degrees between two hours of a clock.
pub(crate) const HOUR_DEG: f64 = 30.0;

/// The largest angle to one side, in degrees.
pub(crate) const HALF_TURN_DEG: f64 = 180.0;

/// "near" an entity, in metres: the benchmark's "close" and "very close".
const NEAR_M: f64 = DistanceWord::Close.bounds_m().1;

/// "far from" an entity, in metres: the benchmark's "far" and "very far".
const FAR_M: f64 = DistanceWord::Far.bounds_m().0;

/// Parts of one place at most.
const PLACES_MAX: usize = 4;

/// A place: directions and distances, and what they are relative to.
#[derive(Debug, Default)]
pub(crate) struct LocationPhrase {
    pub(crate) places: SmallVec<[Place; PLACES_MAX]>,
    /// Index of the distance given without the word "distance": "near".
    pub(crate) bare_distance: Option<usize>,
    /// Position of the word "left" or "right".
    pub(crate) sided: Option<usize>,
    /// What the place is relative to.
    pub(crate) reference: Reference,
}

/// How much of a place was read, to return to.
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

    /// The relations to the entity that the places are relative to. A distance is the same from
    /// both sides: it goes with the partner, or with the subject that has the partner.
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

    /// Drops what was read since. The caller resets the reference.
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

    /// Turns the side read last into an angle to that side; false if the last part is not a side.
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

    /// Applies the meaning of bare "near" and "far" beside an entity: "near a table" is at most 1.5
    /// m from it.
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

/// What a place is relative to.
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
    Partners(Vec<Partner>),
}

pub(crate) fn is_robot(partner: &Partner) -> bool {
    partner.pattern.category == jrdb_types::query::Category::Robot
}

pub(crate) fn is_distance(place: &Place) -> bool {
    matches!(place, Place::Distance(_) | Place::Metres(_))
}
