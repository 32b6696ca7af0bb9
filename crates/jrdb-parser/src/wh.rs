//! Questions that begin with a question word: "how far", "which", "what is the man doing", "who".

use jrdb_types::issue::IssueKind;
use jrdb_types::query::{Category, Property, Quantity, RelationKind, Task};
use jrdb_types::{Attribute, Pattern};

use crate::lexicon::{Role, Roles};
use crate::noun::Thing;
use crate::parser::Parser;
use crate::place::related;
use crate::question::{COPULA, Target};
use crate::subject::identify;

impl Parser<'_> {
    /// "how far is the man", "which direction is he in".
    pub(crate) fn how(&mut self) -> (Task, Pattern) {
        let properties: Vec<Property> = self.entry().asks.into_iter().collect();
        self.at += 1;
        self.skip(Roles::of(&[Role::Side, Role::To, Role::Of, Role::Filler]));
        self.skip(COPULA);
        let thing = self.target_thing();
        if properties == [Property::Distance] {
            self.far_from();
        }
        self.drop_stranded();
        let mut thing = thing;
        let is_deed = self.roles().has_any(Roles::of(&[Role::Action, Role::Deed]));
        if thing.pattern.pick.is_some() && is_deed {
            identify(&mut thing.pattern);
        }
        let target = self.finish(thing);
        (Task::Which { properties, in_order: false }, target.pattern)
    }

    /// "from the table" behind "how far is the man": only distances from the robot are told.
    fn far_from(&mut self) {
        self.skip(Roles::of(&[Role::Side]));
        let start = self.at;
        let to = self.is(Role::To) || self.is_at(self.at.wrapping_sub(1), Role::To);
        self.at += usize::from(self.is(Role::To));
        let from = if to { self.party() } else { None };
        if from.is_some_and(|from| from.category != Category::Robot) {
            let message = "only distances from the robot are told, this is not used".into();
            self.report(IssueKind::NotInGraph, start, self.at, message);
        }
    }

    /// Takes "in" off the end of "which direction is the man in": it belongs to the question word.
    fn drop_stranded(&mut self) -> bool {
        const STRANDED: Roles = Roles::of(&[Role::At, Role::To, Role::With]);
        let last = self.tokens.len().wrapping_sub(1);
        let found = last > self.at.wrapping_sub(1)
            && self.roles_at(last).has_any(STRANDED)
            && !self.roles_at(last).has(Role::Deed);
        if found {
            self.drop_last();
        }
        found
    }

    pub(crate) fn which(&mut self) -> (Task, Pattern) {
        let is_what = self.is(Role::What);
        self.at += 1;
        let is_of = self.is(Role::Of);
        self.skip(Roles::of(&[Role::Of, Role::Filler]));
        while self.lacks() {}
        if self.is(Role::Asks) {
            return self.properties();
        }
        if self.roles().has_any(Roles::of(&[Role::Is, Role::Doing])) && !self.is(Role::Not) {
            self.skip(COPULA);
            let next = self.after(self.at, Roles::of(&[Role::The]));
            if self.is_at(next, Role::Asks) {
                return self.properties();
            }
            if self.roles().has_any(Roles::of(&[Role::Where, Role::Count])) {
                return self.deeper(Self::asked);
            }
            if is_what && !self.is(Role::Superlative) {
                if let Some(thing) = self.thing() {
                    return self.what_is(thing);
                }
                if self.is(Role::Him) {
                    let thing = self.target_thing();
                    return self.what_is(thing);
                }
            }
        } else if let Some(mut thing) = self.thing() {
            // "Of the two men" tells how many there are, not how many are chosen.
            let among = thing.count.take_if(|_| is_of);
            let target = self.finish(thing);
            self.report_count(&target);
            if target.pattern.pick.is_none() {
                self.report_count(&Target { count: among, ..target.clone() });
            }
            return (Task::Find, target.pattern);
        }
        let category = if is_what { Category::Anything } else { Category::Person };
        let thing = Thing { pattern: Pattern::of(category), ..Thing::default() };
        (Task::Find, self.finish(thing).pattern)
    }

    /// "what is the man doing", "what is the man holding", "what is the object near the door".
    fn what_is(&mut self, thing: Thing) -> (Task, Pattern) {
        if self.is(Role::Possessive) && self.is_at(self.at + 1, Role::Asks) {
            self.at += 1;
            let (properties, in_order) = self.property_list();
            return (Task::Which { properties, in_order }, self.finish(thing).pattern);
        }
        let is_up_to = self.tokens.last().is_some_and(|last| last.entry.limit.is_some());
        if is_up_to && !self.is_end() {
            self.drop_last();
            self.asks_doing = true;
        }
        let label = self.last_deed();
        let is_stranded = self.drop_stranded();
        let mut pattern = self.finish(thing).pattern;
        if label.is_some() && pattern.pick.is_some() {
            identify(&mut pattern);
        }
        let is_deed = label.is_some();
        if let Some(label) = label {
            let kinds = vec![RelationKind::Interaction(label.clone())];
            let object = Pattern::of(Category::Object);
            pattern.conditions.push(related(kinds, object, Quantity::SOME));
        }
        let property = match pattern.category {
            _ if self.asks_doing => Property::Attribute(Attribute::Action),
            _ if is_deed => Property::ObjectInteraction,
            Category::Person if is_stranded => Property::ObjectsAround,
            Category::Person => Property::Attribute(Attribute::Action),
            _ => Property::Category,
        };
        (Task::Which { properties: vec![property], in_order: false }, pattern)
    }

    /// Takes "holding" off the end of "what is the man next to the door holding": it is the man's.
    fn last_deed(&mut self) -> Option<&'static String> {
        let last = self.tokens.last().filter(|_| !self.is_end())?.entry;
        let label = last.object.as_ref()?;
        self.drop_last();
        Some(label)
    }

    /// Takes "talking" off the end of "who is the man talking".
    fn last_done_together(&mut self) -> Option<&'static String> {
        let last = self.tokens.last().filter(|_| !self.is_end())?.entry;
        let label = last.people.as_ref()?;
        self.drop_last();
        Some(label)
    }

    /// "the genders, ages and actions of the persons who are sitting", "gender is the man".
    pub(crate) fn properties(&mut self) -> (Task, Pattern) {
        self.skip(Roles::of(&[Role::The]));
        let (properties, in_order) = self.property_list();
        let is_place = matches!(properties[..], [Property::Distance | Property::Direction]);
        self.skip(Roles::of(&[Role::Of, Role::At]));
        if is_place {
            self.told_to();
        }
        self.skip(COPULA);
        self.drop_stranded();
        let thing = self.target_thing();
        let target = self.finish(thing);
        (Task::Which { properties, in_order }, target.pattern)
    }

    /// "to the man", "from me to the man", "between the man and the door" behind "the distance".
    fn told_to(&mut self) {
        let start = self.at;
        while self.take(Role::To) {
            if self.robot().is_none() {
                return;
            }
        }
        if self.take(Role::Between) {
            if self.robot().is_some() && self.take(Role::And) {
                return;
            }
            let message = "only distances from the robot are told, not between two things".into();
            self.report(IssueKind::NotInGraph, start, self.at, message);
        }
    }

    fn property_list(&mut self) -> (Vec<Property>, bool) {
        let mut properties = Vec::new();
        while let Some(property) = self.entry().asks {
            properties.push(property);
            self.at += 1;
            if self.take(Role::Relative) {
                self.take(Role::To);
                self.robot();
            }
            let next = self.after(self.at, Roles::of(&[Role::Comma, Role::And, Role::The]));
            if self.is_at(next, Role::Asks) {
                self.at = next;
            }
        }
        (properties, self.take(Role::Order))
    }

    pub(crate) fn who(&mut self) -> (Task, Pattern) {
        self.at += 1;
        let had_is = self.is(Role::Is) && !self.is(Role::Not);
        if had_is {
            self.skip(COPULA);
        }
        if self.is_end() || had_is && self.sees() {
            return (Task::Find, Pattern::default());
        }
        let thing = if had_is && !self.is(Role::Far) && !self.is(Role::Sector) {
            self.thing()
        } else {
            None
        };
        let Some(thing) = thing.filter(|_| !self.is_told_of_him(self.at)) else {
            return self.who_does();
        };
        let done = if self.drop_stranded() { self.last_done_together() } else { None };
        let mut target = self.finish(thing);
        if let Some(label) = done {
            // "who is the man talking to": somebody who does it with him.
            let kinds = vec![RelationKind::Interaction(label.clone())];
            let partner = std::mem::take(&mut target.pattern);
            target.pattern.conditions.push(related(kinds, partner, Quantity::SOME));
        }
        self.report_count(&target);
        (Task::Find, target.pattern)
    }

    /// Steps over "are you looking at": the robot looks at all.
    fn sees(&mut self) -> bool {
        let is_sight = self.entry_at(self.at + 1).object.as_deref() == Some("looking at");
        let found = self.is(Role::Robot) && is_sight;
        self.at += if found { 2 } else { 0 };
        found
    }

    /// "who is sitting", "who has a bag".
    fn who_does(&mut self) -> (Task, Pattern) {
        (Task::Find, self.finish(Thing::default()).pattern)
    }
}
