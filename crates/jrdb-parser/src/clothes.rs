//! Colours of clothes: "in red", "wearing a blue jacket and black trousers", "without a white shirt".

use jrdb_types::issue::IssueKind;
use jrdb_types::query::Category;
use jrdb_types::vocab::Color;
use jrdb_types::{AttributeValue, Condition, Pattern};

use crate::joined::{all_of, any_of, join, split_from};
use crate::lexicon::{Garment, Role, Roles};
use crate::noun::BEFORE_NOUN;
use crate::parser::Parser;

/// What may stand before clothes.
pub(crate) const CLOTHES_START: Roles =
    Roles::of(&[Role::At, Role::Deed, Role::With, Role::Has, Role::Without]);

/// Words before a colour that say nothing of it.
const ARTICLES: Roles = Roles::of(&[Role::The, Role::A, Role::His]);

/// What may stand between colours, and between clothes.
const JOINTS: Roles = Roles::of(&[Role::Comma, Role::And, Role::Or, Role::Slash]);

/// So many words at most may stand between an article, a colour and a piece of clothing.
const STRAYS_MAX: usize = 2;

impl Parser<'_> {
    /// Reads what is said of the colours of the subject's clothes. A colour of any other thing is left for others to read.
    pub(crate) fn clothes(&mut self, pattern: &mut Pattern) -> bool {
        let is_worn = self.entry().object.as_deref() == Some("wearing");
        let is_in = self.is(Role::At) && self.word(self.at).eq_ignore_ascii_case("in");
        let is_had = self.roles().has_any(Roles::of(&[Role::With, Role::Has, Role::Without]));
        if !is_worn && !is_in && !is_had {
            return false;
        }
        let (mark, start) = (self.mark(), pattern.conditions.len());
        let is_without = self.is(Role::Without);
        self.at += 1;
        // "With red" is no clothes, "in red" and "wearing red" are.
        if !self.garment(pattern, !is_had) {
            self.reset(mark);
            return false;
        }
        while self.roles().has_any(JOINTS) {
            let (mark, length) = (self.mark(), pattern.conditions.len());
            let is_or = self.is(Role::Or);
            self.skip(JOINTS);
            if !self.garment(pattern, false) {
                self.reset(mark);
                break;
            }
            if is_or && length > start {
                join(&mut pattern.conditions, length, true);
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
        let (mark, at) = (self.mark(), self.at);
        let garment = self.entry().garment.filter(|_| self.is_at(at + 1, Role::Is));
        self.at += 2;
        let is_not = self.is_at(at + 1, Role::Not) || self.take(Role::Not);
        let (colors, _) = self.colors();
        let Some(garment) = garment.filter(|_| !colors.is_empty()) else {
            self.reset(mark);
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

    /// "black" of "the black car", which is no race: steps over it with an issue.
    pub(crate) fn color_of_thing(&mut self) -> bool {
        if !self.is(Role::Color) || !self.is(Role::Says) {
            return false;
        }
        let next = self.after(self.at + 1, BEFORE_NOUN);
        let is_person =
            |category: &Category| matches!(category, Category::Person | Category::Anything);
        if self.entry_at(next).category.as_ref().is_none_or(is_person) {
            return false;
        }
        let message = "colours of things are not known here, not used".into();
        self.report(IssueKind::NotInGraph, self.at, self.at + 1, message);
        self.at += 1;
        true
    }

    /// "a red or white shirt", "a black leather jacket"; "dark blue" alone where it `may_be_bare`.
    fn garment(&mut self, pattern: &mut Pattern, may_be_bare: bool) -> bool {
        let (mark, start) = (self.mark(), self.at);
        self.skip(ARTICLES);
        let is_bare = self.at == start && may_be_bare;
        let is_colored = self.strays_before(Role::Color);
        let (colors, is_and) = self.colors();
        let is_named = is_colored && self.strays_before(Role::Garment);
        let garment = self.entry().garment.filter(|_| is_named);
        if !is_colored || garment.is_none() && (!is_bare || self.is_something_else()) {
            self.reset(mark);
            return false;
        }
        if let Some(garment) = garment {
            self.report_garment(garment, start, self.at);
            self.at += 1;
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

    /// Steps over a few words that nobody knows before one of a role, and reports them; whether there is one.
    fn strays_before(&mut self, role: Role) -> bool {
        let found = (self.at..=self.at + STRAYS_MAX).find(|at| self.is_at(*at, role));
        let Some(found) = found else { return false };
        let are_strays = (self.at..found).all(|at| {
            self.roles_at(at).has_any(Roles::of(&[Role::Unknown, Role::Lacks, Role::Stranger]))
        });
        while are_strays && self.at < found {
            self.report_unused();
        }
        are_strays
    }

    /// Colours with joints between, and whether one of the joints is "and".
    fn colors(&mut self) -> (Vec<Color>, bool) {
        let (mut colors, mut is_and) = (Vec::new(), false);
        while let Some(color) = self.entry().color {
            colors.push(color);
            self.at += 1;
            let next = self.after(self.at, JOINTS);
            if !self.is_at(next, Role::Color) {
                break;
            }
            is_and |= self.is(Role::And);
            self.at = next;
        }
        (colors, is_and)
    }

    /// Whether the colours are those of something that is named behind them.
    fn is_something_else(&self) -> bool {
        self.roles().has_any(Roles::of(&[Role::Noun, Role::One, Role::Unknown, Role::Lacks]))
    }

    /// Says how a piece of clothing is read, whose kind nobody checks; the word at `at` names it, what is said of it begins at `start`.
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
                return self.report(IssueKind::NotInGraph, start, at + 1, message);
            }
        };
        let message = format!("\"{word}\" read as whatever is worn {place}");
        self.report(IssueKind::Ambiguous, at, at + 1, message);
    }
}

/// The conditions of which one must hold.
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
