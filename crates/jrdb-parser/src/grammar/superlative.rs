//! Superlatives, comparatives and ordinals: "the two oldest women", "taller than the man", "second
//! from the left".

use jrdb_types::issue::IssueKind;
use jrdb_types::query::{
    Category, Compared, Interval, Measure, Measures, Nearer, Order, Pick, Place, Quantity,
    RelationKind, Viewpoint,
};
use jrdb_types::vocab::Sector;
use jrdb_types::{Condition, Pattern};

use crate::grammar::number::rounded_m;
use crate::lexicon::{Measured, Role, Roles};
use crate::parser::Parser;
use crate::pattern::push_related;
use crate::phrase::NounGroup;

/// Words that may stand between "closest" or "second" and the place that follows.
const LINK: Roles = Roles::of(&[Role::To, Role::At, Role::The, Role::Of]);

/// What begins the reference of "closest": "to the door", "the door".
const FROM: Roles = Roles::of(&[Role::To, Role::The, Role::A]);

fn measure(measured: Measured, from: Option<Pattern>) -> Measure {
    let robot = || Pattern::of(Category::Robot);
    match measured {
        Measured::Distance => Measure::DistanceTo(Box::new(from.unwrap_or_else(robot))),
        Measured::FromLeft => Measure::FromLeft,
        Measured::Height => Measure::Height,
        Measured::Age => Measure::Age,
        Measured::Speed => Measure::Speed,
    }
}

/// The middle of a stretch of metres.
fn middle(metres: &Interval) -> Option<f64> {
    metres.max.zip(metres.min).map(|(max, min)| rounded_m(f64::midpoint(min, max)))
}

impl Parser<'_> {
    /// "tallest", "closest to the door", with the rank and count read before.
    pub(crate) fn superlative(&mut self, rank: u32, count: u32) -> Option<Pick> {
        let (measured, order) = self.entry().order?;
        self.bump();
        let mut from = None;
        if measured == Measured::Distance {
            self.eat(Role::Side);
            from = self.distance_reference();
        }
        Some(Pick { measure: measure(measured, from), order, rank, count })
    }

    /// The reference "to the door" behind "closest".
    pub(crate) fn distance_reference(&mut self) -> Option<Pattern> {
        let next = self.next_not_in(self.state.at, LINK);
        if !self.roles().has_any(FROM) || self.is_at(next, Role::Sector) {
            return None;
        }
        let start = self.state.at;
        self.state.at += usize::from(self.is(Role::To));
        let found = self.nested(Self::noun_phrase);
        if found.is_none() {
            self.state.at = start;
        }
        found
    }

    /// "from the left" behind "the second person": the order of the rank.
    pub(crate) fn side_pick(&mut self, rank: u32, count: u32) -> Option<Pick> {
        let next = self.next_not_in(self.state.at, LINK);
        let sector = self.entry_at(next).sector?;
        let order = match sector {
            Sector::Left => Order::Least,
            Sector::Right => Order::Most,
            _ => return None,
        };
        if next == self.state.at || self.is_at(next + 1, Role::Of) {
            return None;
        }
        self.state.at = next + 1;
        self.skip_while(Roles::of(&[Role::Side]));
        Some(Pick { measure: Measure::FromLeft, order, rank, count })
    }

    /// "taller than the man", "closer to me than the child"; "the taller one" picks the tallest.
    pub(crate) fn comparative(&mut self, pattern: &mut Pattern) -> bool {
        let start = self.state.at;
        let Some((measured, order)) = self.entry().order.filter(|_| self.is(Role::Comparative))
        else {
            return false;
        };
        self.bump();
        self.eat(Role::Side);
        let from = if measured == Measured::Distance { self.distance_reference() } else { None };
        if !self.eat(Role::Than) {
            let pick = Pick { measure: measure(measured, from), order, rank: 1, count: 1 };
            return self.put_pick(pattern, pick, start);
        }
        if self.is(Role::To) {
            return self.nearer(pattern, from, order, start);
        }
        if let (true, Some(metres)) = (from.is_none(), self.length()) {
            return self.beyond(pattern, measured, order, metres, start);
        }
        let Some(than) = self.nested(Self::noun_phrase) else {
            self.report_unread(
                IssueKind::MisplacedWord,
                start,
                self.state.at,
                "nothing to compare with, not used".into(),
            );
            return true;
        };
        let measure = measure(measured, from);
        let compared = Compared { measure, order, than: Box::new(than) };
        pattern.conditions.push(Condition::Compared(compared));
        true
    }

    /// "to the girl" behind "nearer to me than".
    fn nearer(
        &mut self,
        pattern: &mut Pattern,
        from: Option<Pattern>,
        order: Order,
        start: usize,
    ) -> bool {
        self.bump();
        let first = from.unwrap_or_else(|| Pattern::of(Category::Robot));
        let Some(second) = self.nested(Self::noun_phrase) else {
            let message = "nothing to compare with, not used".into();
            self.report_unread(IssueKind::MisplacedWord, start, self.state.at, message);
            return true;
        };
        let (to, than) = match order {
            Order::Least => (first, second),
            Order::Most => (second, first),
        };
        let nearer = Nearer { to: Box::new(to), than: Box::new(than) };
        pattern.conditions.push(Condition::Nearer(nearer));
        true
    }

    /// "closer than 3 m": a distance from the robot; other measures are not compared with metres.
    fn beyond(
        &mut self,
        pattern: &mut Pattern,
        measured: Measured,
        order: Order,
        metres: Interval,
        start: usize,
    ) -> bool {
        if let (Measured::Height, Some(limit)) = (measured, middle(&metres)) {
            let within = match order {
                Order::Least => Interval { min: None, max: Some(limit) },
                Order::Most => Interval { min: Some(limit), max: None },
            };
            let measures = Measures { measure: Measure::Height, within };
            pattern.conditions.push(Condition::Measures(measures));
            return true;
        }
        if measured != Measured::Distance {
            let message = "only distances are compared with metres, not used".into();
            self.report_unread(IssueKind::NotInGraph, start, self.state.at, message);
            return true;
        }
        let limit = middle(&metres);
        let metres = match order {
            Order::Least => Interval { min: None, max: limit },
            Order::Most => Interval { min: limit, max: None },
        };
        let place = Place::Metres(metres);
        self.eat(Role::Side);
        match self.distance_reference().filter(|from| from.category != Category::Robot) {
            None => pattern.conditions.push(Condition::FromRobot(place)),
            Some(from) => {
                let kind = RelationKind::Placed { place, viewpoint: Viewpoint::Partner };
                push_related(pattern, vec![kind], from, Quantity::SOME);
            }
        }
        true
    }

    /// Sets the pick of a pattern; a second pick is reported.
    pub(crate) fn put_pick(&mut self, pattern: &mut Pattern, pick: Pick, start: usize) -> bool {
        if pattern.pick.is_some() {
            let message = "only one order can be asked for, this one is not used".into();
            self.report_unread(IssueKind::MisplacedWord, start, self.state.at, message);
        } else {
            pattern.pick = Some(pick);
        }
        true
    }

    /// "from the left" behind "the second person", "to the door" behind "the closest person", "of
    /// the men" behind "the tallest".
    pub(crate) fn after_noun(&mut self, group: &mut NounGroup) {
        if group.pattern.pick.is_some() {
            self.after_superlative(group);
        }
        let Some((rank, at)) = group.rank.take() else { return };
        let count = group.count.take().map_or(1, |(count, _)| count);
        let is_last = group.is_last && self.is(Role::To);
        if let Some(mut pick) = self.side_pick(rank, count) {
            if is_last {
                // "From the left" the last is the rightmost; "on the left" it is the leftmost.
                pick.order = match pick.order {
                    Order::Least => Order::Most,
                    Order::Most => Order::Least,
                };
            }
            group.pattern.pick = Some(pick);
        } else if self.is(Role::Superlative) {
            group.pattern.pick = self.superlative(rank, count);
        } else {
            let message =
                "in which order is not said: say \"from the left\" or \"tallest\"; not used";
            self.report_unread(IssueKind::MisplacedWord, at, at + 1, message.into());
        }
    }

    fn after_superlative(&mut self, group: &mut NounGroup) {
        if self.is(Role::Of) && !self.is(Role::Sector) {
            let checkpoint = self.checkpoint();
            self.bump();
            match self.nested(Self::noun_group) {
                Some(all) if all.pattern.pick.is_none() => {
                    group.pattern.category = all.pattern.category;
                    group.pattern.conditions.extend(all.pattern.conditions);
                }
                _ => self.rewind(checkpoint),
            }
        }
        let Some(pick) = &mut group.pattern.pick else { return };
        let is_default = |p: &Pattern| p.category == Category::Robot;
        if !matches!(&pick.measure, Measure::DistanceTo(from) if is_default(from)) {
            return;
        }
        self.eat(Role::Side);
        if let Some(from) = self.distance_reference() {
            pick.measure = Measure::DistanceTo(Box::new(from));
        }
    }
}
