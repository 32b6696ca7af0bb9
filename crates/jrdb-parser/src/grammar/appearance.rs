//! How things look, in words that no table holds: "with long hair", "smiling", "a striped shirt".
//! These words become conditions that perception may decide.

use jrdb_types::query::{Category, Phrase};
use jrdb_types::{Condition, Pattern, Span};

use crate::lexicon::{Role, Roles};
use crate::parser::Parser;

/// Words that describe what can be looked at.
pub(crate) const VISIBLE: Roles =
    Roles::of(&[Role::Looks, Role::Color, Role::Shade, Role::Coloured, Role::Garment, Role::Worn]);

/// Words that belong to a description that has begun.
const CONTENT: Roles = VISIBLE.and(Roles::of(&[
    Role::Unknown,
    Role::Unsupported,
    Role::Common,
    Role::Number,
    Role::Far,
    Role::Non,
]));

/// Words that may join two parts of a description.
const LINKS: Roles = Roles::of(&[
    Role::At,
    Role::On,
    Role::Of,
    Role::To,
    Role::The,
    Role::A,
    Role::His,
    Role::With,
    Role::Without,
    Role::Near,
    Role::My,
    Role::Wholly,
    Role::Side,
]);

/// Words without meaning before a description.
const ARTICLES: Roles = Roles::of(&[Role::The, Role::A, Role::His, Role::Wholly]);

/// Words of the longest description.
const WORDS_MAX: usize = 12;

impl Parser<'_> {
    /// "long hair", "a striped shirt" behind "with" or "wearing": a description of the subject.
    pub(crate) fn described(&mut self, pattern: &mut Pattern) -> bool {
        let first = self.next_not_in(self.state.at, ARTICLES);
        let end = self.description_end(first);
        if end == first
            || self.is_thing_alone(first, end)
            || self.names_thing_at(end)
            || !self.is_visible(first, end)
        {
            return false;
        }
        self.push_looks(pattern, first, end);
        true
    }

    /// Words of no table behind "wearing": whatever is worn can be looked at.
    pub(crate) fn worn_words(&mut self, pattern: &mut Pattern) -> bool {
        let first = self.next_not_in(self.state.at, ARTICLES);
        let end = self.description_end(first);
        let found = end > first && !self.names_thing_at(end) && !self.is_thing_alone(first, end);
        if found {
            self.push_looks(pattern, first, end);
        }
        found
    }

    /// "the tray" behind "with": a thing of no table that can be looked at.
    pub(crate) fn had_words(&mut self, pattern: &mut Pattern) -> bool {
        let first = self.next_not_in(self.state.at, ARTICLES);
        let end = self.description_end(first);
        let is_camera = |at: usize| self.word(at).to_ascii_lowercase().ends_with("camera");
        if is_camera(self.state.at) {
            let at = self.state.at;
            self.push_looks(pattern, at, at + 1);
            return true;
        }
        let is_strange = (first..end).all(|at| {
            self.roles_at(at).has_any(Roles::of(&[Role::Unknown, Role::Common, Role::Unsupported]))
        });
        let is_named = (first..end).any(|at| self.is_at(at, Role::Unknown));
        let found = first > self.state.at
            && end > first
            && is_strange
            && is_named
            && !self.names_thing_at(end);
        if found {
            self.push_looks(pattern, first, end);
        }
        found
    }

    /// "jacket", which is a class of things too.
    fn is_thing_alone(&self, first: usize, end: usize) -> bool {
        end == first + 1 && self.is_at(first, Role::Noun) && self.is_at(first, Role::Garment)
    }

    /// "smiling", "reading a book": what is done or how somebody looks, behind a noun or a verb.
    pub(crate) fn deed(&mut self, pattern: &mut Pattern) -> bool {
        let start = self.state.at;
        let is_unknown = self.is_unknown_deed();
        let is_known =
            self.is(Role::Looks) && !self.roles().has_any(Roles::of(&[Role::Noun, Role::Body]));
        if !is_unknown && !is_known {
            return false;
        }
        if is_unknown {
            let end = self.named_object_end(start + 1);
            self.push_looks(pattern, start, end);
            return true;
        }
        let is_deed = self.is(Role::Deed);
        let mut end = self.description_end(start).max(start + 1);
        if is_deed {
            end = self.object_end(end);
        }
        self.push_looks(pattern, start, end);
        true
    }

    /// "helping": a verb that the lexicon does not know.
    fn is_unknown_deed(&self) -> bool {
        let word = self.word(self.state.at);
        self.is(Role::Unknown) && word.len() > 5 && word.ends_with("ing")
    }

    /// The end of "the old lady" behind such a verb.
    pub(crate) fn named_object_end(&self, at: usize) -> usize {
        const BEFORE: Roles = Roles::of(&[
            Role::The,
            Role::A,
            Role::His,
            Role::Implies,
            Role::Unknown,
            Role::Color,
            Role::Looks,
        ]);
        const REACH: usize = 4;
        let noun = self.next_not_in(at, BEFORE);
        let is_named = noun > at && noun <= at + REACH && self.is_at(noun, Role::Noun);
        if is_named { noun + 1 } else { self.description_end(at).max(at) }
    }

    /// The end of "a book" or "his left arm" behind a deed.
    fn object_end(&self, at: usize) -> usize {
        const BEFORE: Roles = Roles::of(&[
            Role::All,
            Role::The,
            Role::A,
            Role::His,
            Role::At,
            Role::To,
            Role::Implies,
            Role::Sector,
            Role::Unknown,
            Role::With,
            Role::On,
        ]);
        let thing = self.next_not_in(at, BEFORE);
        let is_thing =
            self.entry_at(thing).category.as_ref().is_some_and(|c| *c != Category::Person);
        let is_body = self.roles_at(thing).has_any(Roles::of(&[Role::Looks, Role::Garment]))
            || self.is_at(thing, Role::Side);
        let unknown = (at..thing).find(|at| self.is_at(*at, Role::Unknown));
        match thing {
            _ if unknown.is_some() && self.has_article(at, thing) => {
                unknown.map_or(at, |first| self.description_end(first).max(first + 1))
            }
            thing if thing > at + 4 => at,
            thing if is_body => self.description_end(thing).max(thing + 1),
            thing if is_thing && self.has_article(at, thing) => thing + 1,
            _ => at,
        }
    }

    fn has_article(&self, from: usize, to: usize) -> bool {
        const ARTICLES: Roles = Roles::of(&[Role::The, Role::A, Role::His]);
        to == from || self.roles_at(from).has_any(ARTICLES)
    }

    /// The end of the description that begins at a position; the position if none does.
    pub(crate) fn description_end(&self, first: usize) -> usize {
        let mut end = first;
        while end < first + WORDS_MAX {
            if self.is_part_of_description(end) {
                end += 1;
                continue;
            }
            let next = self.next_not_in(end, LINKS);
            let is_and = self.is_at(end, Role::And) && self.is_at(end.wrapping_sub(1), Role::Color);
            let next = if is_and { end + 1 } else { next };
            let is_linked = next > end && next <= end + 3 && end > first;
            let is_next = if is_and { Role::Color } else { Role::Looks };
            let goes_on = self.is_at(next, is_next) || !is_and && self.is_worn_at(next);
            if !is_linked || !goes_on || self.names_thing_at(next + 1) {
                break;
            }
            end = next + 1;
        }
        end
    }

    /// "shirt", "dark shirt": what stripes may be on.
    fn is_worn_at(&self, at: usize) -> bool {
        let garment = self.next_not_in(at, Roles::of(&[Role::Color, Role::Shade]));
        self.is_at(garment, Role::Garment)
    }

    fn is_part_of_description(&self, at: usize) -> bool {
        let roles = self.roles_at(at);
        let is_thing = roles.has(Role::Noun) && !roles.has_any(VISIBLE);
        let is_adjective = roles.has(Role::Implies)
            && !roles.has(Role::Action)
            && self.roles_at(at + 1).has_any(VISIBLE);
        let is_known = roles.has_any(Roles::of(&[Role::Action, Role::Interaction, Role::Relation]));
        !is_thing && !is_known && (roles.has_any(CONTENT) || is_adjective)
    }

    /// Whether some of the words describe what can be looked at.
    fn is_visible(&self, first: usize, end: usize) -> bool {
        (first..end).any(|at| self.roles_at(at).has_any(VISIBLE))
    }

    /// Whether the words before a position describe the thing named there.
    fn names_thing_at(&self, at: usize) -> bool {
        const BEFORE: Roles = Roles::of(&[Role::Implies, Role::Unknown]);
        let noun = self.next_not_in(at, BEFORE);
        self.is_at(noun, Role::Noun) && noun <= at + 2
            || self.is_at(at, Role::One) && !self.is_at(at, Role::The)
    }

    /// Words before a noun that say how it looks: "the white haired man", "a smiling woman", "the
    /// black car". False if the word at hand says something else.
    pub(crate) fn visible_adjective(&mut self, pattern: &mut Pattern) -> bool {
        let start = self.state.at;
        let run = Roles::of(&[
            Role::Looks,
            Role::Color,
            Role::Shade,
            Role::Coloured,
            Role::Garment,
            Role::Worn,
        ]);
        let joint = Roles::of(&[Role::And, Role::Slash]);
        let mut end = start;
        loop {
            let is_adjective = self.is_at(end, Role::Implies)
                && !self.is_at(end, Role::Action)
                && self.is_at(end + 1, Role::Looks)
                && !self.is_at(end + 1, Role::Noun);
            let is_noun = self.is_at(end, Role::Noun) && !self.roles_at(end).has_any(run);
            let is_between_colors = self.roles_at(end).has_any(joint)
                && end > start
                && self.is_at(end - 1, Role::Color)
                && self.is_at(end + 1, Role::Color);
            let is_looking = self.roles_at(end).has_any(run) && !is_noun;
            if !is_looking && !is_adjective && !is_between_colors {
                break;
            }
            end += 1;
        }
        if end == start || end > start + WORDS_MAX || !self.is_noun_ahead(end) {
            return false;
        }
        self.push_looks(pattern, start, end);
        true
    }

    /// Adds a description of the words from `first` to before `end`, and consumes them. Unknown
    /// words among them are reported.
    pub(crate) fn push_looks(&mut self, pattern: &mut Pattern, first: usize, end: usize) {
        self.report_described(first, end);
        self.state.at = end;
        pattern.conditions.push(self.looks(self.span(first, end)));
    }

    pub(crate) fn looks(&self, span: Span) -> Condition {
        let words = self.text.get(span.start..span.end).unwrap_or_default().into();
        Condition::Looks(Phrase { words, span: Some(span) })
    }

    /// What a noun or adjective implies, with its own words where the lexicon has only a place for
    /// them.
    pub(crate) fn implied(&self, at: usize) -> Vec<Condition> {
        let span = self.span(at, at + 1);
        let words = || self.text.get(span.start..span.end).unwrap_or_default().to_owned();
        let own = |condition: &Condition| match condition {
            Condition::Looks(_) => Condition::Looks(Phrase { words: words(), span: Some(span) }),
            Condition::Phrase(_) => Condition::Phrase(Phrase { words: words(), span: Some(span) }),
            other => other.clone(),
        };
        self.entry_at(at).implies.iter().map(own).collect()
    }
}
