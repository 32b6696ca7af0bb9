//! Questions that begin with a question word: "how far", "which", "what is the man doing", "who".

use jrdb_types::issue::IssueKind;
use jrdb_types::query::{Category, Property, Quantity, RelationKind, Task};
use jrdb_types::vocab::PairWord;
use jrdb_types::{Attribute, Pattern};

use crate::grammar::question::COPULA;
use crate::lexicon::{Role, Roles};
use crate::parser::Parser;
use crate::pattern::{identify, related};
use crate::phrase::{NounGroup, Target};

impl Parser<'_> {
    /// "how far is the man", "which direction is he in".
    pub(crate) fn how(&mut self) -> (Task, Pattern) {
        let mut properties: Vec<Property> = self.entry().asks.into_iter().collect();
        let is_apart = self.is(Role::Apart);
        self.bump();
        self.skip_while(Roles::of(&[Role::Side, Role::To, Role::Of, Role::Filler]));
        self.skip_while(COPULA);
        if is_apart {
            return self.apart();
        }
        if properties == [Property::Direction] && self.drop_facing() {
            properties = vec![Property::Facing];
        }
        let mut group = self.target_noun_group();
        if properties == [Property::Distance]
            && let Some(partner) = self.far_from(&mut group)
        {
            return from(partner, group.pattern);
        }
        self.drop_stranded_preposition();
        let is_activity = self.roles().has_any(Roles::of(&[Role::Action, Role::Interaction]));
        if group.pattern.pick.is_some() && is_activity {
            identify(&mut group.pattern);
        }
        let target = self.finish_target(group);
        (Task::Which { properties, in_order: false }, target.pattern)
    }

    /// "from the table" behind "how far is the man": the table. The distance from the robot is told
    /// anyway.
    fn far_from(&mut self, group: &mut NounGroup) -> Option<Pattern> {
        let checkpoint = self.checkpoint();
        let target = self.with_modifiers(group.pattern.clone(), group.count);
        self.skip_while(Roles::of(&[Role::Side]));
        let to = self.is(Role::To) || self.is_at(self.state.at.wrapping_sub(1), Role::To);
        self.state.at += usize::from(self.is(Role::To));
        let from = if to { self.noun_phrase() } else { None };
        match from {
            Some(from) => {
                group.pattern = target;
                let is_robot = from.category == Category::Robot;
                if is_robot { None } else { Some(self.rest_of(from)) }
            }
            _ => {
                self.rewind(checkpoint);
                None
            }
        }
    }

    /// Clauses behind the second of two things.
    fn rest_of(&mut self, pattern: Pattern) -> Pattern {
        let group = NounGroup { pattern, ..NounGroup::default() };
        self.finish_target(group).pattern
    }

    /// "the man and the woman" behind "how far apart are".
    fn apart(&mut self) -> (Task, Pattern) {
        let Some(group) = self.noun_group() else { return self.how_far_of_nobody() };
        let first = self.with_modifiers(group.pattern, group.count);
        if self.eat(Role::And) {
            let second = self.noun_group().map(|group| self.rest_of(group.pattern));
            return from(second.unwrap_or_else(|| first.clone()), first);
        }
        let target = self.rest_of(first);
        from(target.clone(), target)
    }

    fn how_far_of_nobody(&mut self) -> (Task, Pattern) {
        let target = self.target().pattern;
        (Task::Which { properties: vec![Property::Distance], in_order: false }, target)
    }

    /// Cuts "facing" and "walking" off the end of "which way is the man facing".
    fn drop_facing(&mut self) -> bool {
        let mut last = self.state.tokens.len().wrapping_sub(1);
        if self.roles_at(last).has_any(Roles::of(&[Role::To, Role::At])) {
            last = last.wrapping_sub(1);
        }
        let entry = self.entry_at(last);
        let is_facing = entry.relation == Some(RelationKind::Pair(PairWord::Facing));
        let is_look =
            ["looking", "look", "turned", "pointing", "facing", "headed", "moving", "going"]
                .iter()
                .any(|word| self.word(last).eq_ignore_ascii_case(word));
        let is_way = entry.roles.has(Role::Action) && !entry.roles.has(Role::Noun);
        let found = last > self.state.at && (is_facing || is_look || is_way);
        if found {
            self.state.tokens = &self.state.tokens[..last];
        }
        found
    }

    /// Cuts "in" off the end of "which direction is the man in": it belongs to the question word.
    fn drop_stranded_preposition(&mut self) -> bool {
        const STRANDED: Roles = Roles::of(&[Role::At, Role::To, Role::With]);
        let last = self.state.tokens.len().wrapping_sub(1);
        let found = last > self.state.at.wrapping_sub(1)
            && self.roles_at(last).has_any(STRANDED)
            && !self.roles_at(last).has(Role::Interaction);
        if found {
            self.drop_last();
        }
        found
    }

    pub(crate) fn which(&mut self) -> (Task, Pattern) {
        let is_what = self.is(Role::What);
        self.bump();
        let is_of = self.is(Role::Of);
        self.skip_while(Roles::of(&[Role::Of, Role::Filler]));
        if is_of && self.is(Role::Him) {
            // "which of them": of those that were spoken of, or are seen.
            self.eat_pronoun();
            let pattern = self.discourse.as_deref().cloned().unwrap_or_default();
            let group = NounGroup { pattern, ..NounGroup::default() };
            return (Task::Find, self.finish_target(group).pattern);
        }
        while self.eat_unsupported() {}
        if self.is(Role::Asks) {
            return self.properties();
        }
        if self.roles().has_any(Roles::of(&[Role::Is, Role::Doing])) && !self.is(Role::Not) {
            self.skip_while(COPULA);
            let next = self.next_not_in(self.state.at, Roles::of(&[Role::The]));
            if self.is_at(next, Role::Asks) {
                return self.properties();
            }
            if self.roles().has_any(Roles::of(&[Role::Where, Role::Count])) {
                return self.nested(Self::question_form);
            }
            if is_what && !self.is(Role::Superlative) {
                if let Some(group) = self.noun_group() {
                    return self.what_is(group);
                }
                if self.is(Role::Him) {
                    let group = self.target_noun_group();
                    return self.what_is(group);
                }
            }
        } else if let Some(mut group) = self.noun_group() {
            // In "of the two men" the number counts all candidates, not those to select.
            let among = group.count.take_if(|_| is_of);
            let target = self.finish_target(group);
            self.report_count(&target);
            if target.pattern.pick.is_none() {
                self.report_count(&Target { count: among, ..target.clone() });
            }
            return (Task::Find, target.pattern);
        }
        let category = if is_what { Category::Anything } else { Category::Person };
        let group = NounGroup { pattern: Pattern::of(category), ..NounGroup::default() };
        (Task::Find, self.finish_target(group).pattern)
    }

    /// "what is the man doing", "what is the man holding", "what is the object near the door".
    fn what_is(&mut self, group: NounGroup) -> (Task, Pattern) {
        if self.is(Role::Possessive) && self.is_at(self.state.at + 1, Role::Asks) {
            self.bump();
            let (properties, in_order) = self.property_list();
            return (Task::Which { properties, in_order }, self.finish_target(group).pattern);
        }
        let is_up_to = self.state.tokens.last().is_some_and(|last| last.entry.limit.is_some());
        if is_up_to && !self.is_end() {
            self.drop_last();
            self.state.asks_doing = true;
        }
        if self
            .state
            .tokens
            .last()
            .is_some_and(|last| last.entry.object.as_deref() == Some("wearing"))
        {
            return self.worn_by(group);
        }
        let label = self.last_interaction();
        let is_stranded = self.drop_stranded_preposition();
        let mut pattern = self.finish_target(group).pattern;
        if label.is_some() && pattern.pick.is_some() {
            identify(&mut pattern);
        }
        let is_activity = label.is_some();
        if let Some(label) = label {
            let kinds = vec![RelationKind::Interaction(label.clone())];
            let object = Pattern::of(Category::Object);
            pattern.conditions.push(related(kinds, object, Quantity::SOME));
        }
        let property = match pattern.category {
            _ if self.state.asks_doing => Property::Attribute(Attribute::Action),
            _ if is_activity => Property::ObjectInteraction,
            Category::Person if is_stranded => Property::ObjectsAround,
            Category::Person => Property::Attribute(Attribute::Action),
            _ => Property::Category,
        };
        (Task::Which { properties: vec![property], in_order: false }, pattern)
    }

    /// Cuts "holding" off the end of "what is the man next to the door holding": its subject is the
    /// man.
    fn last_interaction(&mut self) -> Option<&'static String> {
        let last = self.state.tokens.last().filter(|_| !self.is_end())?.entry;
        let label = last.object.as_ref()?;
        self.drop_last();
        Some(label)
    }

    /// Cuts "talking" off the end of "who is the man talking".
    fn last_people_interaction(&mut self) -> Option<&'static String> {
        let last = self.state.tokens.last().filter(|_| !self.is_end())?.entry;
        let label = last.people.as_ref()?;
        self.drop_last();
        Some(label)
    }

    /// "the genders, ages and actions of the persons who are sitting", "gender is the man".
    pub(crate) fn properties(&mut self) -> (Task, Pattern) {
        self.skip_while(Roles::of(&[Role::The]));
        let (properties, in_order) = self.property_list();
        let is_place = matches!(properties[..], [Property::Distance | Property::Direction]);
        self.skip_while(Roles::of(&[Role::Of, Role::At]));
        if is_place && let Some(asked) = self.between_two(properties[0]) {
            return asked;
        }
        if is_place {
            self.distance_endpoints();
        }
        self.skip_while(COPULA);
        self.drop_stranded_preposition();
        let group = self.target_noun_group();
        let target = self.finish_target(group);
        (Task::Which { properties, in_order }, target.pattern)
    }

    /// "between the man and the door", "from the man to the door" behind "the distance".
    fn between_two(&mut self, property: Property) -> Option<(Task, Pattern)> {
        if !self.roles().has_any(Roles::of(&[Role::Between, Role::To])) {
            return None;
        }
        let checkpoint = self.checkpoint();
        self.bump();
        let first = self.noun_phrase();
        let is_joined = self.eat(Role::And) || self.eat(Role::To);
        let second = if is_joined { self.noun_phrase() } else { None };
        let robot = |pattern: &Pattern| pattern.category == Category::Robot;
        match (first, second) {
            (Some(first), Some(second)) if !robot(&first) && !robot(&second) => {
                let partner = Box::new(self.rest_of(second));
                Some((Task::From { property, partner }, first))
            }
            _ => {
                self.rewind(checkpoint);
                None
            }
        }
    }

    /// "to the man", "from me to the man", "between the man and the door" behind "the distance".
    fn distance_endpoints(&mut self) {
        let start = self.state.at;
        while self.eat(Role::To) {
            if self.robot().is_none() {
                return;
            }
        }
        if self.eat(Role::Between) {
            if self.robot().is_some() && self.eat(Role::And) {
                return;
            }
            let message = "only distances from the robot are told, not between two things".into();
            self.report(IssueKind::NotInGraph, start, self.state.at, message);
        }
    }

    fn property_list(&mut self) -> (Vec<Property>, bool) {
        let mut properties = Vec::new();
        while let Some(property) = self.entry().asks {
            properties.push(property);
            self.bump();
            if self.eat(Role::Relative) {
                self.eat(Role::To);
                self.robot();
            }
            let next =
                self.next_not_in(self.state.at, Roles::of(&[Role::Comma, Role::And, Role::The]));
            if self.is_at(next, Role::Asks) {
                self.state.at = next;
            }
        }
        (properties, self.eat(Role::Order))
    }

    pub(crate) fn who(&mut self) -> (Task, Pattern) {
        self.bump();
        if self.is(Role::All) && self.is_at(self.state.at + 1, Role::Is) {
            self.bump();
        }
        if self.is(Role::Other) {
            self.bump();
            return self.who_else();
        }
        let had_is = self.is(Role::Is) && !self.is(Role::Not);
        if had_is {
            self.skip_while(COPULA);
        }
        if self.is_end() || had_is && self.sees() {
            return (Task::Find, Pattern::default());
        }
        let is_those = self.roles().has_any(Roles::of(&[Role::Him, Role::The]))
            && self.discourse.is_some()
            && self.entry().category.is_none();
        let is_alone = self.state.at + 1 == self.state.tokens.len();
        if had_is && is_those && (is_alone || self.is(Role::Him)) {
            let group = self.target_noun_group();
            return self.who_is(group);
        }
        let group = if had_is && !self.is(Role::Far) && !self.is(Role::Sector) {
            self.noun_group()
        } else {
            None
        };
        let Some(group) = group.filter(|_| !self.is_located_by_his_at(self.state.at)) else {
            return self.who_does();
        };
        self.who_is(group)
    }

    /// "the man talking to" behind "who is".
    fn who_is(&mut self, group: NounGroup) -> (Task, Pattern) {
        let done =
            if self.drop_stranded_preposition() { self.last_people_interaction() } else { None };
        let mut target = self.finish_target(group);
        if let Some(label) = done {
            // "who is the man talking to" asks for his partner.
            let kinds = vec![RelationKind::Interaction(label.clone())];
            let partner = std::mem::take(&mut target.pattern);
            target.pattern.conditions.push(related(kinds, partner, Quantity::SOME));
        }
        self.report_count(&target);
        (Task::Find, target.pattern)
    }

    /// "who else": anybody but those spoken of before.
    fn who_else(&mut self) -> (Task, Pattern) {
        let mut pattern = Pattern::default();
        self.not_those(&mut pattern);
        let group = NounGroup { pattern, ..NounGroup::default() };
        (Task::Find, self.finish_target(group).pattern)
    }

    /// Skips "are you looking at": the robot sees everything.
    fn sees(&mut self) -> bool {
        let is_sight = self.entry_at(self.state.at + 1).object.as_deref() == Some("looking at");
        let found = self.is(Role::Robot) && is_sight;
        self.state.at += if found { 2 } else { 0 };
        found
    }

    /// "who is sitting", "who has a bag".
    fn who_does(&mut self) -> (Task, Pattern) {
        (Task::Find, self.finish_target(NounGroup::default()).pattern)
    }
}

/// The distance of one thing from another.
fn from(partner: Pattern, target: Pattern) -> (Task, Pattern) {
    (Task::From { property: Property::Distance, partner: Box::new(partner) }, target)
}
