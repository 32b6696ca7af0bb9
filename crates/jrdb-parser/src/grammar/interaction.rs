//! Actions, interactions and relations: "walking with a woman", "holding a bag", "facing me", "next
//! to the door".

use jrdb_types::query::{Category, Place, Quantity, RelationKind, Viewpoint};
use jrdb_types::vocab::PairWord;
use jrdb_types::{Condition, Pattern};

use crate::lexicon::{Entry, Role, Roles};
use crate::parser::Parser;
use crate::pattern::{push_related, truncated_antecedent};
use crate::phrase::Partner;

/// Words before the object of a deed.
const OBJECT_ARTICLES: Roles = Roles::of(&[Role::The, Role::A, Role::His, Role::My]);

impl Parser<'_> {
    /// Partners of a subject, which is the antecedent of pronouns among them.
    pub(crate) fn partners_of(&mut self, subject: &Pattern) -> Vec<Partner> {
        if !self.has_pronouns || self.is(Role::Him) {
            return self.partners();
        }
        let outer = self.set_antecedent(subject);
        let partners = self.partners();
        match partners.last() {
            Some(last) => drop(self.set_antecedent(&last.pattern)),
            None => self.state.antecedent = outer,
        }
        partners
    }

    /// Partners of "between" or "except": "and the one" among them is one more of them.
    pub(crate) fn closed_list(&mut self, subject: &Pattern) -> Vec<Partner> {
        let outer = std::mem::replace(&mut self.state.is_closed_list, true);
        let partners = self.partners_of(subject);
        self.state.is_closed_list = outer;
        partners
    }

    /// What the subject does, alone or with partners.
    pub(crate) fn activity(&mut self, pattern: &mut Pattern) -> bool {
        let (entry, at) = (self.entry(), self.state.at);
        if !entry.roles.has_any(Roles::of(&[Role::Action, Role::Interaction])) {
            return false;
        }
        self.bump();
        if let Some(end) = self.end_of_gesture(at) {
            self.push_looks(pattern, at, end);
            return true;
        }
        if let Some(label) = &entry.people
            && self.with_partners(pattern, entry, label)
        {
            return true;
        }
        if entry.object.is_none() && entry.people.is_some() && self.is_unknown_object_at_hand() {
            let first = self.next_not_in(self.state.at, OBJECT_ARTICLES);
            let end = self.description_end(first).max(first + 1);
            self.push_looks(pattern, at, end);
            return true;
        }
        if let Some(label) = &entry.object {
            self.with_object(pattern, entry, label);
        } else if !entry.implies.is_empty() {
            pattern.conditions.extend(entry.implies.iter().cloned());
            if entry.relation.is_some() {
                self.relation_partners(pattern, entry);
            }
        } else if let Some(label) = &entry.people {
            self.bare_interaction(pattern, label, at);
        }
        true
    }

    /// "chatting" without a partner: with any person.
    pub(crate) fn bare_interaction(&mut self, pattern: &mut Pattern, label: &str, at: usize) {
        if label.ends_with(" together") {
            let message = format!("read as {label:?} with somebody");
            self.report(jrdb_types::IssueKind::Ambiguous, at, at + 1, message);
        }
        push_related(pattern, vec![does(label)], Pattern::default(), Quantity::SOME);
    }

    /// "walking with a woman", "talking to a man", "hugging each other".
    fn with_partners(&mut self, pattern: &mut Pattern, entry: &Entry, label: &str) -> bool {
        let start = self.state.at;
        let is_plain = entry.roles.has(Role::Interaction) && entry.implies.is_empty();
        let has_with = self.eat(Role::With) || is_plain && self.eat(Role::To);
        if self.eat(Role::EachOther) {
            push_related(pattern, vec![does(label)], Pattern::default(), Quantity::SOME);
            return true;
        }
        let is_direct = is_plain && !label.ends_with(" together");
        if !(has_with || is_direct) || !self.is_person_at_hand() {
            self.state.at = start;
            return false;
        }
        let outer = std::mem::replace(&mut self.state.is_walk, !entry.implies.is_empty());
        let partners = self.partners_of(pattern);
        self.state.is_walk = outer;
        for partner in partners {
            push_related(pattern, vec![does(label)], partner.pattern, partner.quantity);
        }
        true
    }

    /// Whether a person, "him" or the robot is named next.
    fn is_person_at_hand(&self) -> bool {
        const FIRST: Roles = Roles::of(&[
            Role::The,
            Role::A,
            Role::All,
            Role::No,
            Role::Implies,
            Role::Comma,
            Role::And,
            Role::Number,
            Role::Limit,
            Role::Superlative,
            Role::Filler,
            Role::Unknown,
            Role::Unsupported,
            Role::Ordinal,
            Role::My,
            Role::Limit,
        ]);
        let mut at = self.state.at;
        let is_his = |at: usize| self.is_at(at, Role::His) && self.is_noun_ahead(at + 1);
        while self.roles_at(at).has_any(FIRST) && !self.is_at(at, Role::Noun) || is_his(at) {
            at += 1;
            if at > self.state.at + 12 {
                return false;
            }
        }
        let is_noun = |at: usize| self.is_at(at, Role::Noun) || self.is_at(at, Role::One);
        if self.is_at(at, Role::Robot) || self.is_at(at, Role::Him) && !is_noun(at + 1) {
            return true;
        }
        let is_described = (self.state.at..at).any(|at| self.is_at(at, Role::Implies));
        if is_described && !self.is_at(at, Role::Noun) {
            return true;
        }
        let is_first_list = self.is(Role::And) || self.is(Role::Comma);
        let category = self.entry_at(at).category.as_ref();
        !is_first_list && (category == Some(&Category::Person) || self.is_at(at, Role::One))
    }

    /// "holding a bag". "Looking at" a person or the robot is the relation "facing".
    fn with_object(&mut self, pattern: &mut Pattern, entry: &'static Entry, label: &str) {
        let is_person = self.is_person_at_hand();
        if let (Some(kind), true) = (&entry.relation, is_person) {
            for partner in self.partners_of(pattern) {
                push_related(pattern, vec![kind.clone()], partner.pattern, partner.quantity);
            }
            return;
        }
        if self.is_unknown_object_at_hand() {
            let verb = self.state.at - 1;
            let first = self.next_not_in(self.state.at, OBJECT_ARTICLES);
            let end = self.description_end(first).max(first + 1);
            return self.push_looks(pattern, verb, end);
        }
        let partners =
            if self.is_object_at_hand() { self.partners_of(pattern) } else { Vec::new() };
        if partners.is_empty() {
            let object = self.unread_object();
            return push_related(pattern, vec![does(label)], object, Quantity::SOME);
        }
        for partner in partners {
            push_related(pattern, vec![does(label)], partner.pattern, partner.quantity);
        }
    }

    /// Any object; where unknown words name it, anything that they may mean.
    fn unread_object(&mut self) -> Pattern {
        const STRANGE: Roles = Roles::of(&[Role::Unknown, Role::Unsupported]);
        let mut object = Pattern::of(Category::Object);
        while self.roles().has_any(STRANGE) {
            let named = self.unknown_entity();
            object.category = named.category;
            object.conditions.extend(named.conditions);
        }
        object
    }

    /// "a balloon", "his left arm": no thing of the lexicon.
    fn is_unknown_object_at_hand(&self) -> bool {
        const STRANGE: Roles = Roles::of(&[
            Role::Unknown,
            Role::Looks,
            Role::Garment,
            Role::Color,
            Role::Shade,
            Role::Sector,
            Role::Implies,
        ]);
        let first = self.next_not_in(self.state.at, OBJECT_ARTICLES);
        let last = self.next_not_in(first, STRANGE);
        let is_strange = |at: usize| {
            self.roles_at(at).has_any(Roles::of(&[Role::Unknown, Role::Looks, Role::Garment]))
        };
        let is_noun = self.roles_at(last).has_any(Roles::of(&[Role::Noun, Role::One]));
        !is_noun && (first..last).any(is_strange) && !self.is(Role::Noun)
    }

    fn is_object_at_hand(&self) -> bool {
        let articles = Roles::of(&[Role::The, Role::A, Role::His, Role::My, Role::No]);
        let next = self.next_not_in(self.state.at, articles);
        let has_article = next > self.state.at;
        let it = self.is(Role::Him);
        it || has_article
            || self.is_noun_ahead(self.state.at) && !self.is(Role::Unknown)
            || self.is(Role::Limit)
    }

    /// "facing me", "next to the door", "facing each other".
    pub(crate) fn relation(&mut self, pattern: &mut Pattern) -> bool {
        let entry = self.entry();
        if entry.relation.is_none() || !entry.roles.has(Role::Relation) {
            return false;
        }
        let start = self.state.at;
        self.bump();
        let found = self.relation_partners(pattern, entry);
        if !found {
            self.state.at = start;
        }
        found
    }

    /// Reads the partners of a relation behind its words.
    fn relation_partners(&mut self, pattern: &mut Pattern, entry: &'static Entry) -> bool {
        let Some(kind) = &entry.relation else { return false };
        let is_mutual = *kind == RelationKind::Pair(PairWord::FacingEachOther);
        let is_away = matches!(kind, RelationKind::Placed { .. });
        let start = self.state.at;
        if self.eat(Role::EachOther) {
            let mutual = each_other(kind, entry);
            push_related(pattern, vec![mutual], Pattern::default(), Quantity::SOME);
            return true;
        }
        self.skip_while(Roles::of(&[Role::To, Role::With, Role::Filler]));
        if !entry.implies.is_empty() && self.is_side_at_hand() {
            // "walking to the right of the table" is a place and not a destination.
            self.state.at = start;
            return false;
        }
        let partners = self.partners_of(pattern);
        if partners.is_empty() {
            self.state.at = start;
            let is_both = entry.relation.is_some()
                && entry.relation_too.is_some()
                && is_away
                && entry.implies.is_empty();
            let alone = if is_mutual || is_both {
                Pattern::default()
            } else if is_away || !entry.implies.is_empty() {
                Pattern::of(Category::Robot)
            } else {
                return false;
            };
            push_related(pattern, entry.kinds(), alone, Quantity::SOME);
            return true;
        }
        for mut partner in partners {
            let mut kinds = entry.kinds();
            kinds.extend(self.side_of_pair(kind, &mut partner.pattern));
            push_related(pattern, kinds, partner.pattern, partner.quantity);
        }
        true
    }

    /// "on the right" behind "beside the lady", where somebody said from where both are seen: the
    /// side of the lady, and not of the robot.
    fn side_of_pair(&self, kind: &RelationKind, partner: &mut Pattern) -> Option<RelationKind> {
        let is_seen = self.is_viewed && *kind == RelationKind::Pair(PairWord::Adjacent);
        let is_side = |c: &mut Condition| matches!(c, Condition::FromRobot(Place::Direction(_)));
        let side = if is_seen { partner.conditions.pop_if(is_side) } else { None };
        match side {
            Some(Condition::FromRobot(place)) => {
                Some(RelationKind::Placed { place, viewpoint: Viewpoint::Robot })
            }
            _ => None,
        }
    }

    /// "the right", "his left".
    fn is_side_at_hand(&self) -> bool {
        let articles = Roles::of(&[Role::The, Role::A, Role::His, Role::My]);
        self.is_at(self.next_not_in(self.state.at, articles), Role::Sector)
    }

    /// "between the man and the door", "between two adults".
    pub(crate) fn between(&mut self, pattern: &mut Pattern) -> bool {
        let checkpoint = self.checkpoint();
        if !self.eat(Role::Between) {
            return false;
        }
        let mut ends = self.closed_list(pattern);
        let (first, second) = match ends.len() {
            2 => (ends.remove(0).pattern, ends.remove(0).pattern),
            1 if self.is(Role::And) => {
                let first = ends.remove(0).pattern;
                self.bump();
                let mut rest = self.closed_list(pattern);
                if rest.is_empty() {
                    self.rewind(checkpoint);
                    return false;
                }
                (first, rest.remove(0).pattern)
            }
            1 => {
                let only = ends.remove(0).pattern;
                (truncated_antecedent(&only), only)
            }
            _ => {
                self.rewind(checkpoint);
                return false;
            }
        };
        push_related(pattern, vec![RelationKind::Between(Box::new(second))], first, Quantity::SOME);
        true
    }

    /// Adds what an adjective implies.
    pub(crate) fn adjective_predicate(&mut self, pattern: &mut Pattern) -> bool {
        let (roles, at) = (self.roles(), self.state.at);
        if !roles.has(Role::Implies) {
            return false;
        }
        let is_race = roles.has(Role::Color);
        if is_race && !self.is_race_said_of(pattern) {
            let end = self.description_end(at).max(at + 1);
            self.push_looks(pattern, at, end);
            return true;
        }
        self.bump();
        pattern.conditions.extend(self.implied(at));
        true
    }
}

impl Parser<'_> {
    /// Whether the colour at hand is said of a person behind "is".
    fn is_race_said_of(&self, subject: &Pattern) -> bool {
        const LIST: Roles = Roles::of(&[
            Role::Implies,
            Role::Comma,
            Role::And,
            Role::Or,
            Role::Not,
            Role::Filler,
            Role::Either,
            Role::Neither,
        ]);
        let is_person = matches!(subject.category, Category::Person | Category::Anything);
        let mut before = self.state.at;
        while before > 0
            && self.roles_at(before - 1).has_any(LIST)
            && !self.is_at(before - 1, Role::Is)
        {
            before -= 1;
        }
        let is_said = before > 0
            && self.roles_at(before - 1).has_any(Roles::of(&[
                Role::Is,
                Role::Asks,
                Role::Noun,
                Role::One,
            ]));
        let is_asked = (0..before).any(|at| self.is_at(at, Role::Is));
        let ends = !self.roles_at(self.state.at + 1).has_any(Roles::of(&[
            Role::Garment,
            Role::Looks,
            Role::Color,
            Role::Worn,
        ]));
        let is_last =
            self.state.at + 1 == self.state.tokens.len() || self.is_at(self.state.at + 1, Role::Or);
        if is_person && is_last && self.state.asks_several {
            return true;
        }
        is_person && ends && is_said && (self.is_at(before.wrapping_sub(1), Role::Is) || is_asked)
    }
}

fn does(label: &str) -> RelationKind {
    RelationKind::Interaction(label.to_owned())
}

/// "walking towards each other", "facing each other".
fn each_other(kind: &RelationKind, entry: &Entry) -> RelationKind {
    match (&entry.people, kind) {
        (Some(label), _) => does(label),
        (None, RelationKind::Pair(PairWord::Facing)) => {
            RelationKind::Pair(PairWord::FacingEachOther)
        }
        (None, other) => other.clone(),
    }
}
