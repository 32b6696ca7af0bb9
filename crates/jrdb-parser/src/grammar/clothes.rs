//! Clothes: their colours ("in red", "wearing a blue jacket and black trousers", "without a white
//! shirt"), and worn things that are attributes of their wearer.

use jrdb_types::issue::IssueKind;
use jrdb_types::query::Category;
use jrdb_types::vocab::Color;
use jrdb_types::{AttributeValue, Condition, Pattern};

use crate::grammar::noun::BEFORE_NOUN;
use crate::lexicon::{Garment, Role, Roles};
use crate::parser::Parser;
use crate::pattern::{all_of, any_of, join_alternative, split_from};

/// What may stand before clothes.
pub(crate) const CLOTHES_START: Roles =
    Roles::of(&[Role::At, Role::Interaction, Role::With, Role::Has, Role::Without]);

/// Words without meaning before a colour.
const ARTICLES: Roles = Roles::of(&[Role::The, Role::A, Role::His]);

/// What may stand between colours, and between clothes.
const JOINTS: Roles = Roles::of(&[Role::Comma, Role::And, Role::Or, Role::Slash]);

/// Unknown words that may stand between an article, a colour and a piece of clothing.
const UNKNOWN_MAX: usize = 2;

/// Whether a piece of clothing must be named behind its colour.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Naming {
    Required,
    Optional,
}

impl Parser<'_> {
    /// Colours of the subject's clothes. Colours of anything else are left to other productions.
    pub(crate) fn clothes(&mut self, pattern: &mut Pattern) -> bool {
        let is_worn = self.entry().object.as_deref() == Some("wearing");
        let is_in = self.is(Role::At) && self.word(self.state.at).eq_ignore_ascii_case("in");
        let is_had = self.roles().has_any(Roles::of(&[Role::With, Role::Has, Role::Without]));
        if !is_worn && !is_in && !is_had {
            return false;
        }
        let (checkpoint, start) = (self.checkpoint(), pattern.conditions.len());
        let is_without = self.is(Role::Without);
        self.bump();
        // "In red" and "wearing red" are about clothes, "with red" is not.
        let naming = if is_had { Naming::Required } else { Naming::Optional };
        if !self.worn_thing(pattern) && !self.garment(pattern, naming) {
            self.rewind(checkpoint);
            return false;
        }
        while self.roles().has_any(JOINTS) {
            let (checkpoint, length) = (self.checkpoint(), pattern.conditions.len());
            let is_or = self.is(Role::Or);
            self.skip_while(JOINTS);
            if !self.worn_thing(pattern) && !self.garment(pattern, Naming::Required) {
                self.rewind(checkpoint);
                break;
            }
            if is_or && length > start {
                join_alternative(&mut pattern.conditions, length);
            }
        }
        if is_without && pattern.conditions.len() > start {
            let worn = all_of(split_from(&mut pattern.conditions, start));
            pattern.conditions.push(Condition::Not(Box::new(worn)));
        }
        true
    }

    /// "shirt is red" behind "whose".
    pub(crate) fn whose_clothes(&mut self, pattern: &mut Pattern) -> bool {
        let (checkpoint, at) = (self.checkpoint(), self.state.at);
        let garment = self.entry().garment.filter(|_| self.is_at(at + 1, Role::Is));
        self.state.at += 2;
        let is_not = self.is_at(at + 1, Role::Not) || self.eat(Role::Not);
        let (colors, _) = self.colors();
        let Some(garment) = garment.filter(|_| !colors.is_empty()) else {
            self.rewind(checkpoint);
            return false;
        };
        self.report_garment(garment, at, at);
        let worn: Vec<Condition> = colors.into_iter().flat_map(|c| worn(garment, c)).collect();
        if !worn.is_empty() {
            let worn = any_of(worn);
            pattern.conditions.push(if is_not { Condition::Not(Box::new(worn)) } else { worn });
        }
        true
    }

    /// Skips and reports "black" of "the black car", which is not a race.
    pub(crate) fn color_of_object(&mut self) -> bool {
        if !self.is(Role::Color) || !self.is(Role::Implies) {
            return false;
        }
        let next = self.next_not_in(self.state.at + 1, BEFORE_NOUN);
        let is_person =
            |category: &Category| matches!(category, Category::Person | Category::Anything);
        if self.entry_at(next).category.as_ref().is_none_or(is_person) {
            return false;
        }
        let message = "colours of things are not known here, not used".into();
        self.report_unread(IssueKind::NotInGraph, self.state.at, self.state.at + 1, message);
        self.bump();
        true
    }

    /// A worn thing that is an attribute of its wearer. Its colour is reported and not used.
    fn worn_thing(&mut self, pattern: &mut Pattern) -> bool {
        let start = self.state.at;
        let named = self.next_not_in(start, ARTICLES);
        if !self.roles_at(named).has_any(Roles::of(&[Role::Worn, Role::Color])) {
            return false;
        }
        let checkpoint = self.checkpoint();
        self.skip_while(ARTICLES);
        let (colors, _) = self.colors();
        let Some(worn) = self.entry().worn.clone() else {
            self.rewind(checkpoint);
            return false;
        };
        if !colors.is_empty() {
            let message = format!(
                "the colour of \"{}\" is not known here, not used",
                self.word(self.state.at)
            );
            self.report_unread(IssueKind::NotInGraph, start, self.state.at, message);
        }
        self.bump();
        pattern.conditions.push(*worn);
        true
    }

    /// "a red or white shirt", "a black leather jacket"; "dark blue" alone where naming is
    /// optional.
    fn garment(&mut self, pattern: &mut Pattern, naming: Naming) -> bool {
        let (checkpoint, start) = (self.checkpoint(), self.state.at);
        self.skip_while(ARTICLES);
        let is_bare = self.state.at == start && naming == Naming::Optional;
        let is_colored = self.skip_unknown_before(Role::Color);
        let (colors, is_and) = self.colors();
        let is_named = is_colored && self.skip_unknown_before(Role::Garment);
        let garment = self.entry().garment.filter(|_| is_named);
        if !is_colored || garment.is_none() && (!is_bare || self.is_something_else()) {
            self.rewind(checkpoint);
            return false;
        }
        if let Some(garment) = garment {
            self.report_garment(garment, start, self.state.at);
            self.bump();
        }
        let worn = colors.into_iter().map(|color| worn(garment.unwrap_or(Garment::Any), color));
        if is_and && garment.is_none() {
            pattern.conditions.extend(worn.map(any_of));
        } else {
            let worn: Vec<Condition> = worn.flatten().collect();
            pattern.conditions.extend((!worn.is_empty()).then(|| any_of(worn)));
        }
        true
    }

    /// Consumes and reports a few unknown words before one of a role; false if there is no such
    /// word.
    fn skip_unknown_before(&mut self, role: Role) -> bool {
        let found = (self.state.at..=self.state.at + UNKNOWN_MAX).find(|at| self.is_at(*at, role));
        let Some(found) = found else { return false };
        let are_unknown = (self.state.at..found).all(|at| {
            self.roles_at(at).has_any(Roles::of(&[Role::Unknown, Role::Unsupported, Role::Common]))
        });
        while are_unknown && self.state.at < found {
            self.report_unused();
        }
        are_unknown
    }

    /// Colours with joints between them, and whether one of the joints is "and".
    fn colors(&mut self) -> (Vec<Color>, bool) {
        let (mut colors, mut is_and) = (Vec::new(), false);
        while let Some(color) = self.entry().color {
            colors.push(color);
            self.bump();
            let next = self.next_not_in(self.state.at, JOINTS);
            if !self.is_at(next, Role::Color) {
                break;
            }
            is_and |= self.is(Role::And);
            self.state.at = next;
        }
        (colors, is_and)
    }

    /// Whether the colours belong to a noun behind them that is not clothing.
    fn is_something_else(&self) -> bool {
        self.roles().has_any(Roles::of(&[Role::Noun, Role::One, Role::Unknown, Role::Unsupported]))
    }

    /// Reports how a piece of clothing is read, since its kind is not checked. The word at `at`
    /// names it; its description begins at `start`.
    fn report_garment(&mut self, garment: Garment, start: usize, at: usize) {
        let word = self.word(at);
        let place = match garment {
            Garment::Upper => "above the waist",
            Garment::Lower => "below the waist",
            Garment::Any => "above or below the waist",
            Garment::Other => {
                let message = format!(
                    "\"{word}\": only clothes above and below the waist are known here, not used"
                );
                return self.report_unread(IssueKind::NotInGraph, start, at + 1, message);
            }
        };
        let message = format!("\"{word}\" read as whatever is worn {place}");
        self.report(IssueKind::Ambiguous, at, at + 1, message);
    }
}

/// Conditions, one of which must hold.
fn worn(garment: Garment, color: Color) -> Vec<Condition> {
    let [upper, lower] = [AttributeValue::upper_color(color), AttributeValue::lower_color(color)]
        .map(Condition::has);
    match garment {
        Garment::Upper => vec![upper],
        Garment::Lower => vec![lower],
        Garment::Any => vec![upper, lower],
        Garment::Other => Vec::new(),
    }
}
