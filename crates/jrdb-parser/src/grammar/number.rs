//! Numbers, quantities and lengths.

use jrdb_types::query::{Interval, Quantity};

use crate::lexicon::{Limit, Role, Roles};
use crate::parser::Parser;

/// Larger numbers are not counts, seconds or metres of a scene.
const NUMBER_MAX: f64 = 1e6;

/// "half".
const HALF: f64 = 0.5;

/// Lengths are rounded to a micrometre, so that six feet are 1.8288 m without further digits.
const PARTS_OF_M: f64 = 1e6;

/// "3 metres away" means within this distance of 3 metres.
pub(crate) const ABOUT_M: f64 = 0.5;

/// Words between the two ends of a range.
const TO: Roles = Roles::of(&[Role::To, Role::Dash, Role::And, Role::Or]);

impl Parser<'_> {
    /// A number in digits or words: "3", "twenty-five".
    pub(crate) fn number(&mut self) -> Option<f64> {
        if !self.is(Role::Number) {
            return None;
        }
        let (at, entry) = (self.state.at, self.entry());
        let Some(number) = entry.number else {
            let number: f64 = self.word(at).parse().ok().filter(|number| *number <= NUMBER_MAX)?;
            self.bump();
            return Some(number + self.and_a_half());
        };
        self.bump();
        let ones = self
            .entry()
            .number
            .filter(|ones| self.is(Role::Number) && number >= 20.0 && (1.0..10.0).contains(ones));
        self.state.at += usize::from(ones.is_some());
        Some(number + ones.unwrap_or(0.0) + self.and_a_half())
    }

    /// "and a half" behind a number.
    fn and_a_half(&mut self) -> f64 {
        let half = self.next_not_in(self.state.at + 1, Roles::of(&[Role::A]));
        let found = self.is(Role::And) && self.entry_at(half).number == Some(HALF);
        self.state.at = if found { half + 1 } else { self.state.at };
        if found { HALF } else { 0.0 }
    }

    /// A whole number.
    pub(crate) fn whole(&mut self) -> Option<u32> {
        let start = self.state.at;
        let number = self.number().filter(|number| number.fract() == 0.0);
        if number.is_none() {
            self.state.at = start;
        }
        number.map(|number| number as u32)
    }

    /// "exactly three", "at least 2", "3 or more", "two to four", "no". A bare number is not a
    /// quantity.
    pub(crate) fn quantity(&mut self) -> Option<Quantity> {
        const FIRST: Roles =
            Roles::of(&[Role::Limit, Role::Several, Role::No, Role::Between, Role::Number]);
        if !self.roles().has_any(FIRST) {
            return None;
        }
        let start = self.state.at;
        let quantity = self.limited().filter(|_| !self.is(Role::Unit) && !self.is(Role::Clock));
        if quantity.is_none() {
            self.state.at = start;
        }
        quantity
    }

    fn limited(&mut self) -> Option<Quantity> {
        if self.is(Role::No) && !self.is(Role::Noun) {
            self.bump();
            return Some(Quantity::NONE);
        }
        if self.eat(Role::Several) {
            return Some(Quantity::at_least(2));
        }
        if self.eat(Role::Between) || self.is(Role::Number) {
            let least = self.whole()?;
            if self.is(Role::Or) && self.is_at(self.state.at + 1, Role::More) {
                self.state.at += 2;
                return Some(Quantity::at_least(least));
            }
            if self.is(Role::Or) && self.is_at(self.state.at + 1, Role::Fewer) {
                self.state.at += 2;
                return Some(Quantity { at_least: 0, at_most: Some(least) });
            }
            if !self.roles().has_any(TO) {
                return None;
            }
            self.bump();
            return Some(Quantity { at_least: least, at_most: Some(self.whole()?) });
        }
        let limit = self.entry().limit?;
        self.bump();
        let number = self.whole()?;
        Some(match limit {
            Limit::AtMost => Quantity { at_least: 0, at_most: Some(number) },
            Limit::LessThan => Quantity { at_least: 0, at_most: Some(number.saturating_sub(1)) },
            Limit::AtLeast => Quantity::at_least(number),
            Limit::MoreThan => Quantity::at_least(number.saturating_add(1)),
            Limit::Exactly | Limit::About => Quantity::exactly(number),
        })
    }

    /// "within 3 m", "between 2 and 4 metres", "more than 5 feet", "3 m": metres.
    pub(crate) fn length(&mut self) -> Option<Interval> {
        const FIRST: Roles =
            Roles::of(&[Role::Limit, Role::Between, Role::Number, Role::A, Role::The]);
        if !self.roles().has_any(FIRST) {
            return None;
        }
        let start = self.state.at;
        let length = self.measured();
        if length.is_none() {
            self.state.at = start;
        }
        length
    }

    fn measured(&mut self) -> Option<Interval> {
        let limit = self.entry().limit;
        self.state.at += usize::from(limit.is_some());
        let is_between = limit.is_none() && self.eat(Role::Between);
        let limit = if limit == Some(Limit::About) && self.entry().limit.is_some() {
            let inner = self.entry().limit;
            self.bump();
            inner
        } else {
            limit
        };
        let is_article = self.is(Role::A) && self.is_at(self.state.at + 1, Role::Number);
        self.state.at += usize::from(is_article && limit.is_some());
        let one = self.roles().has(Role::A) && self.is_at(self.state.at + 1, Role::Unit);
        let number = if one {
            self.bump();
            1.0
        } else {
            self.number()?
        };
        let unit = self.unit();
        let is_stretch = self.roles().has_any(TO) && self.is_at(self.state.at + 1, Role::Number);
        let is_within = limit == Some(Limit::AtMost) && !self.is(Role::Or);
        let second = if is_stretch && (is_between || is_within || limit.is_none()) {
            self.bump();
            self.number()
        } else {
            None
        };
        if is_between && second.is_none() {
            return None;
        }
        let unit = self.unit().or(unit)?;
        let number = number + self.hundredths(unit);
        let metres = |number: f64| rounded_m(number * unit);
        let limit = if self.eat(Role::Radius) { Some(Limit::AtMost) } else { limit };
        if let Some(second) = second {
            let ends = [metres(number), metres(second)];
            return Some(Interval {
                min: Some(ends[0].min(ends[1])),
                max: Some(ends[0].max(ends[1])),
            });
        }
        Some(limited_length(limit, metres(number)))
    }

    /// "ninety" of "one metre ninety".
    fn hundredths(&mut self, unit: f64) -> f64 {
        let is_last =
            !self.roles_at(self.state.at + 1).has_any(Roles::of(&[Role::Unit, Role::Noun]));
        if unit != 1.0 || !self.is(Role::Number) || !is_last {
            return 0.0;
        }
        let start = self.state.at;
        match self.whole() {
            Some(more @ 10..100) => f64::from(more) / 100.0,
            _ => {
                self.state.at = start;
                0.0
            }
        }
    }

    fn unit(&mut self) -> Option<f64> {
        let unit = self.entry().unit;
        self.state.at += usize::from(unit.is_some());
        unit
    }
}

/// A length without rounding noise in its last digits.
pub(crate) fn rounded_m(metres: f64) -> f64 {
    (metres * PARTS_OF_M).round() / PARTS_OF_M
}

fn limited_length(limit: Option<Limit>, metres: f64) -> Interval {
    match limit {
        Some(Limit::AtMost | Limit::LessThan) => Interval { min: None, max: Some(metres) },
        Some(Limit::AtLeast | Limit::MoreThan) => Interval { min: Some(metres), max: None },
        Some(Limit::Exactly | Limit::About) | None => {
            Interval { min: Some((metres - ABOUT_M).max(0.0)), max: Some(metres + ABOUT_M) }
        }
    }
}
