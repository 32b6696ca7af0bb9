//! What is asked about clothes: "is his jacket orange?", "what colour are her trousers?", "what is
//! she wearing?".

use jrdb_types::query::{Property, Quantity, Task};
use jrdb_types::{Attribute, Condition, Pattern};

use crate::lexicon::{Garment, Role, Roles};
use crate::parser::Parser;
use crate::phrase::NounGroup;

/// Words between "what colour" and the garment.
const LINKS: Roles =
    Roles::of(&[Role::Is, Role::Of, Role::The, Role::Filler, Role::Doing, Role::His, Role::A]);

impl Parser<'_> {
    /// Whether a colour is asked for: "what colour", "the colour of".
    pub(crate) fn asked_color_at_hand(&self) -> bool {
        const BEFORE: Roles = Roles::of(&[
            Role::Which,
            Role::What,
            Role::Is,
            Role::The,
            Role::Find,
            Role::Filler,
            Role::Whose,
            Role::At,
            Role::Of,
            Role::Color,
        ]);
        let at = self.next_not_in(self.state.at, BEFORE);
        self.is_at(at, Role::Colour) && (at == self.state.at || !self.is_at(at, Role::Coloured))
    }

    /// "what colour is the boy's shirt", "what colour jacket does she have on".
    pub(crate) fn asked_color(&mut self) -> (Task, Pattern) {
        while !self.is(Role::Colour) {
            self.bump();
        }
        self.bump();
        let (garment, pattern) = self.garment_owner();
        let mut pattern = pattern;
        let properties = match garment {
            Some(Garment::Upper) => vec![Property::Attribute(Attribute::UpperColor)],
            Some(Garment::Lower) => vec![Property::Attribute(Attribute::LowerColor)],
            Some(Garment::Any) => both_colors(),
            Some(Garment::Other) | None => {
                pattern.conditions.extend(self.unknown_color());
                both_colors()
            }
        };
        (Task::Which { properties, in_order: false }, pattern)
    }

    /// The colour of hair or of a thing is in no table.
    fn unknown_color(&mut self) -> Option<Condition> {
        let word = (0..self.state.at).find(|at| self.is_at(*at, Role::Colour))?;
        let message = "only the colours of clothes above and below the waist can be told".into();
        self.report(jrdb_types::IssueKind::NotInGraph, word, word + 1, message);
        Some(crate::unread::phrase(self.text, self.span(word, word + 1)))
    }

    /// "the shirt of the boy", "the boy's shirt", "her shirt", "jacket does the man have on": what
    /// is worn, and by whom.
    fn garment_owner(&mut self) -> (Option<Garment>, Pattern) {
        let start = self.state.at;
        self.skip_while(LINKS);
        if let Some(garment) = self.entry().garment {
            self.bump();
            self.skip_while(Roles::of(&[Role::Of, Role::Doing, Role::Is, Role::Filler, Role::On]));
            self.drop_having();
            let owner = self.owner_of_garment();
            return (Some(garment), owner);
        }
        if let Some((garment, pattern)) = self.possessed_garment() {
            self.drop_having();
            return (Some(garment), pattern);
        }
        let his = (start..self.state.at).any(|at| self.is_at(at, Role::His));
        self.drop_having();
        let owner = if his { self.those_before() } else { self.target().pattern };
        (None, owner)
    }

    fn those_before(&mut self) -> Pattern {
        self.antecedent_at(self.state.at).unwrap_or_default()
    }

    fn owner_of_garment(&mut self) -> Pattern {
        let his = self.state.at >= 2 && self.is_at(self.state.at - 2, Role::His);
        if self.is_end() || his && self.is_end() {
            return self.those_before();
        }
        self.target().pattern
    }

    /// "the running boy's shirt".
    fn possessed_garment(&mut self) -> Option<(Garment, Pattern)> {
        if !self.has_possessives {
            return None;
        }
        let checkpoint = self.checkpoint();
        // "The man's jacket" is what he wears here, and no thing that is with him.
        self.has_possessives = false;
        let group = self.noun_group();
        self.has_possessives = true;
        if let Some(group) = group {
            let pattern = self.with_modifiers(group.pattern, group.count);
            if self.is(Role::Possessive) {
                let next =
                    self.next_not_in(self.state.at + 1, Roles::of(&[Role::Unknown, Role::Looks]));
                if let Some(garment) = self.entry_at(next).garment {
                    self.state.at = next + 1;
                    return Some((garment, pattern));
                }
            }
        }
        self.rewind(checkpoint);
        None
    }

    /// Cuts "have on" and "wearing" off the end.
    fn drop_having(&mut self) {
        loop {
            let last = self.state.tokens.len().wrapping_sub(1);
            let is_worn = self.entry_at(last).object.as_deref() == Some("wearing");
            let is_had = self.roles_at(last).has_any(Roles::of(&[Role::Has, Role::On])) || is_worn;
            if last == usize::MAX || last < self.state.at || !is_had {
                return;
            }
            self.drop_last();
        }
    }

    /// "the cyclist's jacket orange", "the trousers of the woman white" behind "is".
    pub(crate) fn garment_question(&mut self) -> Option<(Task, Pattern)> {
        let colors = self.trailing_colors()?;
        let start = self.next_not_in(self.state.at, Roles::of(&[Role::The, Role::His]));
        let checkpoint = self.checkpoint();
        let is_his = (self.state.at..start).any(|at| self.is_at(at, Role::His));
        let garment = self.entry_at(start).garment;
        let named = match garment {
            Some(garment) if start + 1 == colors && (is_his || self.discourse.is_some()) => {
                self.state.at = start + 1;
                Some((garment, self.those_before(), start))
            }
            Some(garment) if self.is_at(start + 1, Role::Of) => {
                self.state.at = start + 2;
                let tokens = self.state.tokens;
                self.state.tokens = &tokens[..colors];
                let owner = self.target().pattern;
                self.state.tokens = tokens;
                Some((garment, owner, start))
            }
            None => {
                let owned = self.possessed_garment();
                owned.map(|(garment, owner)| (garment, owner, self.state.at - 1))
            }
            Some(_) => None,
        };
        let Some((garment, pattern, at)) = named.filter(|_| self.state.at == colors) else {
            self.rewind(checkpoint);
            return None;
        };
        Some(self.colored(garment, pattern, at))
    }

    /// "orange", "red or blue" behind the garment and its owner.
    fn colored(&mut self, garment: Garment, mut pattern: Pattern, at: usize) -> (Task, Pattern) {
        let is_not = self.eat(Role::Not);
        let (colors, is_and) = self.colors();
        let is_choice = colors.len() > 1 && !is_and;
        if is_choice {
            let each = colors.iter().map(|color| self.worn_in(garment, &[*color], at, at + 1));
            let options = each.collect();
            return (Task::Choice { options }, pattern);
        }
        let end = self.state.at;
        let worn = self.worn_in(garment, &colors, at, end);
        let worn = if is_not { Condition::Not(Box::new(worn)) } else { worn };
        pattern.conditions.push(worn);
        (Task::Exists(Quantity::SOME), pattern)
    }

    /// The position of the colours at the end of the sentence.
    fn trailing_colors(&self) -> Option<usize> {
        const LIST: Roles =
            Roles::of(&[Role::Color, Role::Shade, Role::Or, Role::And, Role::Comma, Role::Not]);
        let end = self.state.tokens.len();
        let mut start = end;
        while start > self.state.at && self.roles_at(start - 1).has_any(LIST) {
            start -= 1;
        }
        let is_colored = (start..end).any(|at| self.is_at(at, Role::Color));
        let has_garment = (self.state.at..start).any(|at| self.is_at(at, Role::Garment));
        (is_colored && has_garment && start > self.state.at).then_some(start)
    }

    /// "wearing" at the end of "what is the man wearing": the colours of what is worn.
    pub(crate) fn worn_by(&mut self, group: NounGroup) -> (Task, Pattern) {
        self.drop_having();
        let pattern = self.finish_target(group).pattern;
        (Task::Which { properties: both_colors(), in_order: false }, pattern)
    }
}

fn both_colors() -> Vec<Property> {
    [Attribute::UpperColor, Attribute::LowerColor].map(Property::Attribute).into()
}
