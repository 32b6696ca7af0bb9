//! The words of a place: "at a close distance to the front left of", "within 3 metres", "at your 2 o'clock".

use jrdb_types::query::Place;
use jrdb_types::vocab::Elevation;
use jrdb_types::{Direction, DistanceWord, Pattern};

use crate::lexicon::{Role, Roles};
use crate::parser::Parser;
use crate::phrase::{Anchor, HALF_TURN_DEG, HOUR_DEG, Partner, Spot, is_robot};

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
pub(crate) const SPOT_START: Roles = Roles::of(&[
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

impl Parser<'_> {
    /// Reads a place and what it is told from; stays where it is when there is none.
    pub(crate) fn spot(&mut self, subject: &Pattern, spot: &mut Spot) -> bool {
        if !self.part(spot) {
            return false;
        }
        while !spot.is_anchored() {
            self.anchor(subject, spot);
            if spot.is_anchored() || !self.next_part(spot) {
                break;
            }
        }
        if spot.is_anchored() {
            self.trailing(spot);
        }
        true
    }

    /// The distance behind "his right", "left of the woman": of the same place.
    fn trailing(&mut self, spot: &mut Spot) {
        let is_his = matches!(spot.anchor, Anchor::His);
        loop {
            let mark = self.mark();
            if is_his {
                self.take(Role::And);
            }
            let start = self.after(self.at, LEAD);
            let is_distance = self.is_at(start, Role::Far) || self.is_length(start);
            if !is_distance || self.is_noun_ahead(start + 1) {
                return self.reset(mark);
            }
            let places = spot.places.len();
            let anchor = std::mem::take(&mut spot.anchor);
            let fits = self.part(spot);
            spot.anchor = anchor;
            if !fits || self.is_anchor_next() {
                spot.places.truncate(places);
                return self.reset(mark);
            }
        }
    }

    fn is_length(&self, at: usize) -> bool {
        const FIRST: Roles = Roles::of(&[Role::Limit, Role::Number]);
        let next = self.after(at, FIRST);
        next > at && self.is_at(next, Role::Unit)
    }

    fn is_anchor_next(&self) -> bool {
        let next = self.after(self.at, Roles::of(&[Role::Side, Role::Relative]));
        self.roles_at(next).has_any(Roles::of(&[Role::Of, Role::To])) && !self.is_place_at(next + 1)
    }

    /// Another part of the same place, directly or behind "and"; a part with a thing of its own is another place.
    fn next_part(&mut self, spot: &mut Spot) -> bool {
        let (mark, places) = (self.mark(), spot.places.len());
        let is_joined = self.take(Role::And);
        let found = self.part(spot);
        let is_own = is_joined && (self.had_of() || self.is(Role::Of) || spot.is_anchored());
        let is_own = is_own || spot.loose.is_some_and(|at| at >= places) && is_joined;
        if !found || is_own {
            spot.places.truncate(places);
            spot.loose = spot.loose.filter(|at| *at < places);
            spot.anchor = Anchor::Unsaid;
            self.reset(mark);
            return false;
        }
        true
    }

    /// Whether the word just read needs a thing behind it: "behind".
    fn had_of(&self) -> bool {
        self.at > 0 && self.is_at(self.at - 1, Role::Of)
    }

    /// One part: a direction, a distance, a length, an hour; with "my", "his" or "the man's" before a direction.
    fn part(&mut self, spot: &mut Spot) -> bool {
        let mark = self.mark();
        self.skip(LEAD);
        let degrees = self.degrees();
        let is_of = self.is(Role::Side) && self.is_at(self.at + 1, Role::Of);
        self.at += if is_of { 2 } else { 0 };
        if self.is(Role::My) {
            self.at += 1;
            spot.anchor = Anchor::Robot;
        } else if self.is(Role::His) && self.is_place_behind_his() {
            self.his();
            spot.anchor = Anchor::His;
        } else if let Some(owner) = self.owner() {
            spot.anchor = Anchor::Own(owner);
        }
        if self.value(spot) && degrees.is_none_or(|degrees| spot.turn(degrees)) {
            return true;
        }
        spot.anchor = Anchor::Unsaid;
        self.reset(mark);
        false
    }

    /// "30 degrees" before "to the left".
    fn degrees(&mut self) -> Option<f64> {
        let start = self.after(self.at, Roles::of(&[Role::Limit]));
        if !self.is_at(start, Role::Number) {
            return None;
        }
        let mark = self.mark();
        self.at = start;
        let degrees = self.number().filter(|degrees| *degrees <= HALF_TURN_DEG);
        let found = degrees.filter(|_| self.take(Role::Degrees));
        match found {
            Some(_) => self.skip(LEAD),
            None => self.reset(mark),
        }
        found
    }

    fn is_place_behind_his(&self) -> bool {
        let his = Roles::of(&[Role::His, Role::Him, Role::Slash, Role::Filler]);
        self.is_place_at(self.after(self.at, his))
    }

    fn is_place_at(&self, at: usize) -> bool {
        let next = self.after(at, Roles::of(&[Role::The, Role::My, Role::His, Role::Slash]));
        let roles = self.roles_at(next);
        roles.has(Role::Sector) || roles.has(Role::Far) || self.is_at(next + 1, Role::Clock)
    }

    /// "the man's", before a direction.
    fn owner(&mut self) -> Option<Pattern> {
        const FIRST: Roles = Roles::of(&[Role::Noun, Role::Says, Role::Robot]);
        if !self.roles().has_any(FIRST) {
            return None;
        }
        let mark = self.mark();
        let owner = self.robot().or_else(|| self.thing().map(|thing| thing.pattern));
        let next = self.after(self.at + 1, Roles::of(&[Role::Filler]));
        let is_sector = self.is_at(next, Role::Sector) || self.is_at(next + 1, Role::Clock);
        if owner.is_some() && self.is(Role::Possessive) && is_sector {
            self.at += 1;
            return owner;
        }
        self.reset(mark);
        None
    }

    fn value(&mut self, spot: &mut Spot) -> bool {
        let entry = self.entry();
        let found = if entry.roles.has(Role::Near) {
            self.at += 1;
            spot.loose = Some(spot.places.len());
            spot.push(Place::Distance(DistanceWord::Close))
        } else if let Some(word) = entry.distance {
            self.at += 1;
            let is_plain = !self.is(Role::Side);
            spot.loose = is_plain.then(|| spot.places.len()).or(spot.loose);
            spot.push(Place::Distance(word))
        } else if let Some(place) = self.direction(spot) {
            spot.push(place)
        } else if let Some(place) = self.hour() {
            spot.push(place)
        } else {
            self.length().is_some_and(|metres| spot.push(Place::Metres(metres)))
        };
        if found {
            self.skip_side();
        }
        found
    }

    /// Words such as "side" and "away"; "away from" is left for the thing behind it.
    fn skip_side(&mut self) {
        while self.is(Role::Side) && !self.is(Role::To) || self.is_direction_word() {
            self.at += 1;
        }
    }

    /// "direction" of "in the left direction".
    fn is_direction_word(&self) -> bool {
        self.entry().asks == Some(jrdb_types::query::Property::Direction)
    }

    fn direction(&mut self, spot: &mut Spot) -> Option<Place> {
        let entry = self.entry();
        let at = self.at + usize::from(entry.elevation.is_some());
        let sector = self.entry_at(at).sector?;
        if entry.elevation.is_some() || entry.sector.is_some() {
            if sector != sector.mirrored() {
                spot.sided = Some(at);
            }
            self.at = at + 1;
            let elevation = entry.elevation.unwrap_or(Elevation::Level);
            return Some(Place::Direction(Direction { sector, elevation }));
        }
        None
    }

    fn hour(&mut self) -> Option<Place> {
        let mark = self.mark();
        let hour = self.whole().filter(|hour| (1..=12).contains(hour) && self.is(Role::Clock));
        let Some(hour) = hour else {
            self.reset(mark);
            return None;
        };
        self.at += 1;
        self.skip(Roles::of(&[Role::Filler]));
        // Clockwise on the face is to the right, which is negative.
        let degrees = f64::from(hour % 12) * -HOUR_DEG;
        let center = if degrees <= -180.0 { degrees + 360.0 } else { degrees };
        Some(Place::Degrees { center: center + 0.0, half_width: HOUR_DEG / 2.0 })
    }

    /// The thing behind "of", "to", "from", "relative to".
    fn anchor(&mut self, subject: &Pattern, spot: &mut Spot) {
        const JOINTS: Roles = Roles::of(&[Role::Relative, Role::To, Role::Of, Role::At]);
        let mark = self.mark();
        let had_of = self.had_of() || self.is_at(self.at.wrapping_sub(1), Role::Near);
        let is_joined = self.roles().has_any(Roles::of(&[Role::To, Role::Of, Role::Relative]));
        let is_another = !had_of && self.is(Role::Sector);
        if !had_of && !is_joined || is_another {
            return;
        }
        if !had_of || self.roles().has_any(Roles::of(&[Role::Relative, Role::Of])) {
            self.skip(JOINTS);
            let start = self.after(self.at, Roles::of(&[Role::The, Role::A]));
            if self.is_place_at(self.at) && !self.is_noun_ahead(start) {
                return self.reset(mark);
            }
        }
        spot.anchor = self.anchor_thing(subject);
        if !spot.is_anchored() {
            self.reset(mark);
        }
    }

    fn anchor_thing(&mut self, subject: &Pattern) -> Anchor {
        let start = self.after(self.at, Roles::of(&[Role::Filler]));
        if self.is_at(start, Role::Him) && !self.is_noun_ahead(start + 1) {
            self.at = start;
            self.his();
            return Anchor::Him;
        }
        if self.take(Role::EachOther) {
            let pattern = Pattern::of(subject.category.clone());
            return Anchor::Things(vec![Partner { pattern, ..Partner::default() }]);
        }
        if !self.has_pronouns && self.take_robot_alone() {
            return Anchor::Robot;
        }
        let mut partners = self.partners_of(subject);
        match partners.len() {
            0 => Anchor::Unsaid,
            1 if is_robot(&partners[0]) => {
                partners.clear();
                Anchor::Robot
            }
            _ => Anchor::Things(partners),
        }
    }
}
