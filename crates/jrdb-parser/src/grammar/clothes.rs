//! Clothes: their colours ("in red", "wearing a blue jacket and black trousers", "without a white
//! shirt"), and worn things that are attributes of their wearer.

use jrdb_types::issue::IssueKind;
use jrdb_types::query::Category;
use jrdb_types::vocab::Color;
use jrdb_types::{AttributeValue, Condition, Pattern};

use crate::lexicon::{Garment, Role, Roles};
use crate::parser::Parser;
use crate::pattern::{all_of, any_of, join_alternative, split_from};

/// What may stand before clothes.
pub(crate) const CLOTHES_START: Roles = Roles::of(&[
    Role::At,
    Role::Interaction,
    Role::With,
    Role::Has,
    Role::Without,
    Role::Color,
    Role::Wholly,
]);

/// Words without meaning before a colour.
const ARTICLES: Roles = Roles::of(&[Role::The, Role::A, Role::His]);

/// What may stand between colours, and between clothes.
const JOINTS: Roles = Roles::of(&[Role::Comma, Role::And, Role::Or, Role::Slash]);

/// Words that may stand between an article, a colour and a piece of clothing.
const BETWEEN: Roles = Roles::of(&[Role::Unknown, Role::Unsupported, Role::Common, Role::Looks]);

/// How many of them.
const BETWEEN_MAX: usize = 2;

/// What is said before clothes.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Lead {
    /// "wearing": anything may follow.
    Wearing,
    /// "in": clothes or a bare colour.
    In,
    /// "with", "has": things may follow that are not worn.
    Having,
    /// Nothing: a colour and a piece of clothing.
    Bare,
}

impl Parser<'_> {
    /// Clothes of the subject. Colours of anything else are left to other productions.
    pub(crate) fn clothes(&mut self, pattern: &mut Pattern) -> bool {
        let Some(lead) = self.clothes_lead() else { return false };
        let (checkpoint, start) = (self.checkpoint(), pattern.conditions.len());
        let is_without = self.is(Role::Without);
        self.is_wholly = lead == Lead::Wearing && self.is(Role::Wholly);
        if lead != Lead::Bare {
            self.bump();
            self.skip_while(Roles::of(&[Role::Filler]));
        }
        if !self.one_worn(pattern, lead) {
            self.rewind(checkpoint);
            return false;
        }
        self.more_worn(pattern, start, lead);
        if is_without && pattern.conditions.len() > start {
            let worn = all_of(split_from(&mut pattern.conditions, start));
            pattern.conditions.push(Condition::Not(Box::new(worn)));
        }
        true
    }

    /// "hat", "glasses" behind a noun, in telegram style.
    pub(crate) fn bare_worn(&mut self, pattern: &mut Pattern) -> bool {
        self.worn_thing(pattern) || self.described(pattern)
    }

    fn clothes_lead(&self) -> Option<Lead> {
        let is_in = || {
            let word = self.word(self.state.at);
            ["in", "inside"].iter().any(|lead| word.eq_ignore_ascii_case(lead))
        };
        if self.entry().object.as_deref() == Some("wearing") {
            Some(Lead::Wearing)
        } else if self.is(Role::At) && is_in() {
            Some(Lead::In)
        } else if self.roles().has_any(Roles::of(&[Role::With, Role::Has, Role::Without])) {
            Some(Lead::Having)
        } else if self.roles().has_any(Roles::of(&[Role::Color, Role::Wholly])) {
            Some(Lead::Bare)
        } else {
            None
        }
    }

    /// ", a white hat and jeans" behind clothes.
    fn more_worn(&mut self, pattern: &mut Pattern, start: usize, lead: Lead) {
        while self.roles().has_any(JOINTS) || self.is(Role::With) && lead != Lead::Having {
            let (checkpoint, length) = (self.checkpoint(), pattern.conditions.len());
            let is_or = self.is(Role::Or);
            self.skip_while(JOINTS);
            let next = if self.clothes_lead().is_some_and(|lead| lead != Lead::Bare) {
                self.bump();
                Lead::Having
            } else if lead == Lead::Having {
                Lead::Having
            } else {
                Lead::Bare
            };
            let found = self.one_worn(pattern, next)
                || next == Lead::Bare && self.is_worn_alone() && self.described(pattern);
            let found = found || lead == Lead::Having && self.one_more_thing(pattern);
            if !found {
                self.rewind(checkpoint);
                break;
            }
            if is_or && length > start {
                join_alternative(&mut pattern.conditions, length);
            }
        }
    }

    /// "a bicycle" behind "with a helmet and".
    fn one_more_thing(&mut self, pattern: &mut Pattern) -> bool {
        let noun = self.noun_at(self.next_not_in(self.state.at, ARTICLES));
        let is_thing = |at: usize| matches!(self.entry_at(at).category, Some(Category::Class(_)));
        let one = if noun.is_some_and(is_thing) { self.one_possession(pattern) } else { None };
        let found = one.is_some();
        pattern.conditions.extend(one);
        found
    }

    /// Whether only something that is worn is named next: "gloves" behind "a helmet and".
    fn is_worn_alone(&self) -> bool {
        let next = self.next_not_in(self.state.at, ARTICLES.and(BETWEEN));
        self.is_at(next, Role::Garment)
    }

    /// A worn thing, a garment, or the description of either.
    fn one_worn(&mut self, pattern: &mut Pattern, lead: Lead) -> bool {
        if !self.is(Role::No) || self.is(Role::Noun) {
            return self.one_item(pattern, lead);
        }
        let (start, length) = (self.state.at, pattern.conditions.len());
        self.bump();
        if !self.one_item(pattern, lead) {
            self.state.at = start;
            return false;
        }
        let worn = all_of(split_from(&mut pattern.conditions, length));
        pattern.conditions.push(Condition::Not(Box::new(worn)));
        true
    }

    fn one_item(&mut self, pattern: &mut Pattern, lead: Lead) -> bool {
        self.worn_thing(pattern)
            || self.garment(pattern, lead)
            || lead != Lead::Bare && self.described(pattern)
            || lead == Lead::Wearing && self.worn_words(pattern)
            || lead == Lead::Having && self.had_words(pattern)
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
        let worn = self.worn_in(garment, &colors, at, self.state.at);
        pattern.conditions.push(if is_not { Condition::Not(Box::new(worn)) } else { worn });
        true
    }

    /// A worn thing that is an attribute of its wearer. Its colour is described.
    fn worn_thing(&mut self, pattern: &mut Pattern) -> bool {
        let start = self.next_not_in(self.state.at, ARTICLES);
        let named = self.next_not_in(start, BETWEEN.and(Roles::of(&[Role::Color, Role::Shade])));
        let Some(worn) = self.entry_at(named).worn.clone() else { return false };
        if named > start + BETWEEN_MAX + 1 {
            return false;
        }
        let at = self.state.at;
        self.state.at = named + 1;
        self.eat(Role::On);
        pattern.conditions.push(*worn);
        if named > start {
            let end = self.state.at;
            self.state.at = at;
            self.push_looks(pattern, start, named + 1);
            self.state.at = end;
        }
        true
    }

    /// "a red or white shirt", "a black leather jacket"; "dark blue" alone behind "in" and
    /// "wearing".
    fn garment(&mut self, pattern: &mut Pattern, lead: Lead) -> bool {
        let (checkpoint, start) = (self.checkpoint(), self.state.at);
        let is_something = self.eat(Role::Something);
        let mut is_wholly = self.wholly() || self.is_wholly;
        self.skip_while(ARTICLES);
        let has_article = self.state.at > start && !is_wholly && !is_something;
        let before = self.behind_some(Self::is_color_at);
        let Some(before) = before else {
            self.rewind(checkpoint);
            return false;
        };
        let described = self.state.at;
        self.state.at = before;
        let (colors, is_and) = self.colors();
        self.eat(Role::Coloured);
        is_wholly |= self.is(Role::Wholly) && !self.is(Role::All) && self.wholly();
        let named = self
            .behind_some(|parser, at| parser.is_at(at, Role::Garment))
            .filter(|_| !colors.is_empty());
        let anaphor =
            self.is(Role::One) && !self.is(Role::The) && self.state.last_garment.is_some();
        let garment = match named {
            Some(at) => self.entry_at(at).garment,
            None if anaphor => self.state.last_garment,
            None => None,
        };
        let is_bare =
            is_wholly || is_something || !has_article && matches!(lead, Lead::Wearing | Lead::In);
        let is_bare =
            is_bare && (is_wholly && !self.is(Role::Garment) || !self.is_something_else());
        if colors.is_empty() || garment.is_none() && !is_bare {
            self.rewind(checkpoint);
            return false;
        }
        let first = if described < before { described } else { before };
        let Some(garment) = garment else {
            let colors: Vec<_> = colors.into_iter().collect();
            self.bare_colors(pattern, &colors, is_and, is_wholly);
            self.eat(Role::On);
            return true;
        };
        let at = named.unwrap_or(self.state.at);
        self.state.at = at + 1;
        self.eat(Role::On);
        self.state.last_garment = Some(garment);
        if garment == Garment::Other
            || described < before
            || named.is_some_and(|at| self.is_at(at.wrapping_sub(1), Role::Looks))
        {
            let end = self.state.at;
            if garment != Garment::Other {
                let worn = self.worn_in(garment, &colors, at, at + 1);
                pattern.conditions.push(worn);
            }
            self.push_looks(pattern, first, at + 1);
            self.state.at = end;
            return true;
        }
        let worn = self.worn_in(garment, &colors, at, at + 1);
        pattern.conditions.push(worn);
        true
    }

    /// "all" or "entirely" before a colour.
    fn wholly(&mut self) -> bool {
        let found = self.is(Role::Wholly) && !self.is_at(self.state.at + 1, Role::The);
        if found {
            self.skip_while(Roles::of(&[Role::Wholly, Role::At]));
        }
        found
    }

    /// "in red", "all in black": colours of whatever is worn.
    fn bare_colors(
        &mut self,
        pattern: &mut Pattern,
        colors: &[Color],
        is_and: bool,
        is_wholly: bool,
    ) {
        let each = |color: &Color| worn(Garment::Any, *color);
        if is_wholly && colors.len() == 1 {
            pattern.conditions.extend(colors.iter().flat_map(each));
        } else if is_and {
            pattern.conditions.extend(colors.iter().map(each).map(any_of));
        } else {
            pattern.conditions.push(any_of(colors.iter().flat_map(each).collect()));
        }
    }

    /// The position of a fitting word behind a few words that may stand before it.
    fn behind_some(&self, fits: impl Fn(&Self, usize) -> bool) -> Option<usize> {
        (self.state.at..=self.state.at + BETWEEN_MAX)
            .take_while(|at| *at == self.state.at || self.roles_at(at - 1).has_any(BETWEEN))
            .find(|at| fits(self, *at))
    }

    /// Colours with joints between them, and whether one of the joints is "and". Shades are read
    /// as the colours that they belong to, and reported.
    pub(crate) fn colors(&mut self) -> (Vec<Color>, bool) {
        let (mut colors, mut is_and) = (Vec::new(), false);
        loop {
            let start = self.state.at;
            self.state.at = self.next_color();
            let Some(color) = self.entry().color else {
                self.state.at = start;
                break;
            };
            self.report_shade(start, color);
            colors.push(color);
            self.bump();
            let next = self.next_not_in(self.state.at, JOINTS);
            if next > self.state.at + 1 || !self.is_color_at(next) {
                break;
            }
            is_and |= self.is(Role::And);
            self.state.at = next;
        }
        (colors, is_and)
    }

    /// The position behind "dark" and "light".
    fn next_color(&self) -> usize {
        let mut at = self.state.at;
        while self.is_at(at, Role::Shade) && !self.is_at(at, Role::Color) {
            at += 1;
        }
        let is_shade = self.is_at(at, Role::Shade) && self.is_at(at + 1, Role::Color);
        at + usize::from(is_shade)
    }

    fn is_color_at(&self, at: usize) -> bool {
        let shade = self.is_at(at, Role::Shade) && self.is_at(at + 1, Role::Color);
        self.is_at(at, Role::Color) || shade
    }

    fn report_shade(&mut self, start: usize, color: Color) {
        let end = self.state.at + 1;
        if end > start + 1 || self.is(Role::Shade) {
            let span = self.span(start, end);
            let words = &self.text[span.start..span.end];
            let message = format!("{words:?} read as {color}");
            self.report(IssueKind::Ambiguous, start, end, message);
        }
    }

    /// Whether the colours belong to a noun behind them that is not clothing.
    fn is_something_else(&self) -> bool {
        self.roles().has_any(Roles::of(&[
            Role::Noun,
            Role::One,
            Role::Unknown,
            Role::Unsupported,
            Role::Looks,
            Role::Garment,
        ]))
    }

    /// The condition that a piece of clothing has one of the colours; the word at `at` names it.
    pub(crate) fn worn_in(
        &mut self,
        garment: Garment,
        colors: &[Color],
        at: usize,
        end: usize,
    ) -> Condition {
        let word = self.word(at);
        let place = match garment {
            Garment::Upper => "above the waist",
            Garment::Lower => "below the waist",
            Garment::Any => "above or below the waist",
            Garment::Other => return self.looks(self.span(at.min(end - 1), end)),
        };
        let message = format!("\"{word}\" read as whatever is worn {place}");
        self.report(IssueKind::Ambiguous, at, at + 1, message);
        any_of(colors.iter().flat_map(|color| worn(garment, *color)).collect())
    }
}

/// Conditions, one of which must hold.
pub(crate) fn worn(garment: Garment, color: Color) -> Vec<Condition> {
    let [upper, lower] = [AttributeValue::upper_color(color), AttributeValue::lower_color(color)]
        .map(Condition::has);
    match garment {
        Garment::Upper => vec![upper],
        Garment::Lower => vec![lower],
        Garment::Any => vec![upper, lower],
        Garment::Other => Vec::new(),
    }
}
