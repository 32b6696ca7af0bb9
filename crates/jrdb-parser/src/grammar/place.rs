//! Reads the words of a place: "at a close distance to the front left of", "within 3 metres", "at
//! your 2 o'clock".

use jrdb_types::query::Place;
use jrdb_types::vocab::Elevation;
use jrdb_types::{Direction, DistanceWord, Pattern};

use crate::lexicon::{Role, Roles};
use crate::parser::Parser;
use crate::phrase::{HALF_TURN_DEG, HOUR_DEG, LocationPhrase, Partner, Reference, is_robot};

/// Words before a place.
const LEAD: Roles = Roles::of(&[
    Role::At,
    Role::To,
    Role::Located,
    Role::The,
    Role::A,
    Role::Filler,
    Role::Relative,
]);

/// What a place can begin with.
pub(crate) const LOCATION_START: Roles = Roles::of(&[
    Role::At,
    Role::To,
    Role::Located,
    Role::The,
    Role::A,
    Role::Relative,
    Role::Near,
    Role::Far,
    Role::Sector,
    Role::My,
    Role::His,
    Role::Number,
    Role::Limit,
    Role::Between,
    Role::Side,
]);

/// What can stand first in a part of a place, behind [`LEAD`].
const PART_START: Roles = Roles::of(&[
    Role::My,
    Role::His,
    Role::Noun,
    Role::Implies,
    Role::Robot,
    Role::Near,
    Role::Far,
    Role::Sector,
    Role::Number,
    Role::Limit,
    Role::Between,
    Role::Side,
]);

impl Parser<'_> {
    /// Reads a place and its reference, the entity that it is relative to.
    pub(crate) fn location_phrase(
        &mut self,
        subject: &Pattern,
        location: &mut LocationPhrase,
    ) -> bool {
        if !self.location_part(location) {
            return false;
        }
        while !location.has_reference() {
            self.reference(subject, location);
            if location.has_reference() || !self.next_location_part(location) {
                break;
            }
        }
        if location.has_reference() {
            self.trailing_distance(location);
        }
        true
    }

    /// A distance behind "his right" or "left of the woman", which belongs to the same place.
    fn trailing_distance(&mut self, location: &mut LocationPhrase) {
        let is_his = matches!(location.reference, Reference::His);
        loop {
            let joint = usize::from(is_his && self.is(Role::And));
            let start = self.next_not_in(self.state.at + joint, LEAD);
            let is_distance = self.is_at(start, Role::Far) || self.is_length(start);
            if !is_distance || self.is_noun_ahead(start + 1) {
                return;
            }
            let (checkpoint, extent) = (self.checkpoint(), location.extent());
            self.state.at += joint;
            let reference = std::mem::take(&mut location.reference);
            let fits = self.location_part(location);
            location.reference = reference;
            if !fits || self.is_reference_next() {
                location.cut_back(extent);
                return self.rewind(checkpoint);
            }
        }
    }

    fn is_length(&self, at: usize) -> bool {
        const FIRST: Roles = Roles::of(&[Role::Limit, Role::Number]);
        let next = self.next_not_in(at, FIRST);
        next > at && self.is_at(next, Role::Unit)
    }

    fn is_reference_next(&self) -> bool {
        let next = self.next_not_in(self.state.at, Roles::of(&[Role::Side, Role::Relative]));
        self.roles_at(next).has_any(Roles::of(&[Role::Of, Role::To])) && !self.is_place_at(next + 1)
    }

    /// Another part of the same place, directly or behind "and". A part with a reference of its own
    /// is another place.
    fn next_location_part(&mut self, location: &mut LocationPhrase) -> bool {
        let is_joined = self.is(Role::And);
        let start = self.state.at + usize::from(is_joined);
        if !self.roles_at(self.next_not_in(start, LEAD)).has_any(PART_START) {
            return false;
        }
        let (checkpoint, extent) = (self.checkpoint(), location.extent());
        self.state.at = start;
        let found = self.location_part(location);
        let is_own = is_joined && (self.had_of() || self.is(Role::Of) || location.has_reference());
        let is_own =
            is_own || location.bare_distance.is_some_and(|at| at >= extent.places) && is_joined;
        if !found || is_own {
            location.cut_back(extent);
            location.reference = Reference::Unsaid;
            self.rewind(checkpoint);
            return false;
        }
        true
    }

    /// Whether the word just read needs a reference behind it: "behind".
    fn had_of(&self) -> bool {
        self.state.at > 0 && self.is_at(self.state.at - 1, Role::Of)
    }

    /// One part: a direction, a distance, a length or an hour, with "my", "his" or "the man's"
    /// before a direction.
    fn location_part(&mut self, location: &mut LocationPhrase) -> bool {
        let start = self.next_not_in(self.state.at, LEAD);
        if !self.roles_at(start).has_any(PART_START) {
            return false;
        }
        let (before, extent) = (self.state.at, location.extent());
        // Everything but an owner only moves the position.
        let checkpoint = self.has_possessives.then(|| self.checkpoint());
        self.state.at = start;
        let degrees = self.degrees();
        let is_of = self.is(Role::Side) && self.is_at(self.state.at + 1, Role::Of);
        self.state.at += if is_of { 2 } else { 0 };
        self.location_owner(location);
        if self.location_value(location) && degrees.is_none_or(|d| location.turn_to_degrees(d)) {
            return true;
        }
        location.reference = Reference::Unsaid;
        location.cut_back(extent);
        match checkpoint {
            Some(checkpoint) => self.rewind(checkpoint),
            None => self.state.at = before,
        }
        false
    }

    /// "my", "his" or "the man's" before a direction.
    fn location_owner(&mut self, location: &mut LocationPhrase) {
        if self.is(Role::My) {
            self.bump();
            location.reference = Reference::Robot;
        } else if self.is(Role::His) && self.is_place_behind_his() {
            self.eat_pronoun();
            location.reference = Reference::His;
        } else if let Some(owner) = self.owner() {
            location.reference = Reference::Own(owner);
        }
    }

    /// "30 degrees" before "to the left".
    fn degrees(&mut self) -> Option<f64> {
        let start = self.next_not_in(self.state.at, Roles::of(&[Role::Limit]));
        if !self.is_at(start, Role::Number) {
            return None;
        }
        let before = self.state.at;
        self.state.at = start;
        let degrees = self.number().filter(|degrees| *degrees <= HALF_TURN_DEG);
        let found = degrees.filter(|_| self.eat(Role::Degrees));
        match found {
            Some(_) => self.skip_while(LEAD),
            None => self.state.at = before,
        }
        found
    }

    fn is_place_behind_his(&self) -> bool {
        let his = Roles::of(&[Role::His, Role::Him, Role::Slash, Role::Filler]);
        self.is_place_at(self.next_not_in(self.state.at, his))
    }

    fn is_place_at(&self, at: usize) -> bool {
        let next = self.next_not_in(at, Roles::of(&[Role::The, Role::My, Role::His, Role::Slash]));
        let roles = self.roles_at(next);
        roles.has(Role::Sector) || roles.has(Role::Far) || self.is_at(next + 1, Role::Clock)
    }

    /// "the man's", before a direction.
    fn owner(&mut self) -> Option<Pattern> {
        const FIRST: Roles = Roles::of(&[Role::Noun, Role::Implies, Role::Robot]);
        if !self.has_possessives || !self.roles().has_any(FIRST) {
            return None;
        }
        let checkpoint = self.checkpoint();
        let owner = self.robot().or_else(|| self.noun_group().map(|group| group.pattern));
        let next = self.next_not_in(self.state.at + 1, Roles::of(&[Role::Filler]));
        let is_sector = self.is_at(next, Role::Sector) || self.is_at(next + 1, Role::Clock);
        if owner.is_some() && self.is(Role::Possessive) && is_sector {
            self.bump();
            return owner;
        }
        self.rewind(checkpoint);
        None
    }

    fn location_value(&mut self, location: &mut LocationPhrase) -> bool {
        let entry = self.entry();
        let found = if entry.roles.has(Role::Near) {
            self.bump();
            location.bare_distance = Some(location.places.len());
            location.push(Place::Distance(DistanceWord::Close))
        } else if let Some(word) = entry.distance {
            self.bump();
            let is_plain = !self.is(Role::Side);
            location.bare_distance =
                is_plain.then(|| location.places.len()).or(location.bare_distance);
            location.push(Place::Distance(word))
        } else if let Some(place) = self.direction(location) {
            location.push(place)
        } else if let Some(place) = self.hour() {
            location.push(place)
        } else {
            self.length().is_some_and(|metres| location.push(Place::Metres(metres)))
        };
        if found {
            self.skip_side();
        }
        found
    }

    /// Skips words such as "side" and "away"; "away from" is left for the reference behind it.
    fn skip_side(&mut self) {
        while self.is(Role::Side) && !self.is(Role::To) || self.is_direction_word() {
            self.bump();
        }
    }

    /// "direction" of "in the left direction".
    fn is_direction_word(&self) -> bool {
        self.entry().asks == Some(jrdb_types::query::Property::Direction)
    }

    fn direction(&mut self, location: &mut LocationPhrase) -> Option<Place> {
        let entry = self.entry();
        let at = self.state.at + usize::from(entry.elevation.is_some());
        let sector = self.entry_at(at).sector?;
        if entry.elevation.is_some() || entry.sector.is_some() {
            if sector != sector.mirrored() {
                location.sided = Some(at);
            }
            self.state.at = at + 1;
            let elevation = entry.elevation.unwrap_or(Elevation::Level);
            return Some(Place::Direction(Direction { sector, elevation }));
        }
        None
    }

    fn hour(&mut self) -> Option<Place> {
        if !self.is(Role::Number) {
            return None;
        }
        let start = self.state.at;
        let hour = self.whole().filter(|hour| (1..=12).contains(hour) && self.is(Role::Clock));
        let Some(hour) = hour else {
            self.state.at = start;
            return None;
        };
        self.bump();
        self.skip_while(Roles::of(&[Role::Filler]));
        // Clockwise on the face is to the right, which is negative.
        let degrees = f64::from(hour % 12) * -HOUR_DEG;
        let center = if degrees <= -180.0 { degrees + 360.0 } else { degrees };
        Some(Place::Degrees { center: center + 0.0, half_width: HOUR_DEG / 2.0 })
    }

    /// The reference behind "of", "to", "from", "relative to".
    fn reference(&mut self, subject: &Pattern, location: &mut LocationPhrase) {
        const JOINTS: Roles = Roles::of(&[Role::Relative, Role::To, Role::Of, Role::At]);
        let had_of = self.had_of() || self.is_at(self.state.at.wrapping_sub(1), Role::Near);
        let is_joined = self.roles().has_any(Roles::of(&[Role::To, Role::Of, Role::Relative]));
        let is_another = !had_of && self.is(Role::Sector);
        if !had_of && !is_joined || is_another {
            return;
        }
        let start = self.state.at;
        if !had_of || self.roles().has_any(Roles::of(&[Role::Relative, Role::Of])) {
            let next = self.next_not_in(start, JOINTS);
            let noun = self.next_not_in(next, Roles::of(&[Role::The, Role::A]));
            if self.is_place_at(next) && !self.is_noun_ahead(noun) {
                return;
            }
            self.state.at = next;
        }
        location.reference = self.reference_noun(subject);
        if !location.has_reference() {
            self.state.at = start;
        }
    }

    fn reference_noun(&mut self, subject: &Pattern) -> Reference {
        let start = self.next_not_in(self.state.at, Roles::of(&[Role::Filler]));
        if self.is_at(start, Role::Him) && !self.is_noun_ahead(start + 1) {
            self.state.at = start;
            self.eat_pronoun();
            return Reference::Him;
        }
        if self.eat(Role::EachOther) {
            let pattern = Pattern::of(subject.category.clone());
            return Reference::Partners(vec![Partner { pattern, ..Partner::default() }]);
        }
        if !self.has_pronouns && self.eat_robot_alone() {
            return Reference::Robot;
        }
        let mut partners = self.partners_of(subject);
        match partners.len() {
            0 => Reference::Unsaid,
            1 if is_robot(&partners[0]) => {
                partners.clear();
                Reference::Robot
            }
            _ => Reference::Partners(partners),
        }
    }
}
