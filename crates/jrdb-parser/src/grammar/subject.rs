//! The subject of a yes-or-no question, and where its predicate begins: "is the tallest person |
//! sitting?"

use jrdb_types::query::{Category, Place, Quantity, RelationKind, Viewpoint};
use jrdb_types::vocab::{PairWord, Sector};
use jrdb_types::{Condition, Direction, Pattern};

use crate::lexicon::{Role, Roles};
use crate::parser::Parser;
use crate::pattern::{
    alternative, any_of, chosen, identify, join_alternative, related, set_count, split_from,
};
use crate::phrase::{After, NounGroup, Target};

/// What begins a place that may belong to the subject.
const PLACES: Roles = Roles::of(&[
    Role::At,
    Role::To,
    Role::Located,
    Role::Near,
    Role::Far,
    Role::Sector,
    Role::With,
    Role::Without,
    Role::Between,
    Role::Superlative,
]);

/// What ends a clause with a subject of its own.
const CLAUSE_ENDS: Roles =
    Roles::of(&[Role::Comma, Role::And, Role::Or, Role::Then, Role::During, Role::Is]);

/// What can begin "a woman" behind "is the tallest person".
const COMPLEMENT_START: Roles = Roles::of(&[Role::The, Role::A, Role::Noun]);

impl Parser<'_> {
    /// Reads the rest of "is the tallest person near the door sitting". Places describe the subject
    /// unless nothing follows them; then the last place is the predicate.
    pub(crate) fn predicate_of(&mut self, mut group: NounGroup) -> Target {
        self.begin_target(group.noun);
        set_count(&mut group.pattern, group.count);
        let (own, had_pick) = (group.pattern.conditions.len(), group.pattern.pick.is_some());
        let last = self.places_of_subject(&mut group.pattern);
        if self.is(Role::Who) {
            return self.finish_target(group);
        }
        group.has_places = group.pattern.conditions.len() > own;
        let mut asked = Vec::new();
        if self.is_end() || self.roles().has_any(CLAUSE_ENDS) {
            asked = split_from(&mut group.pattern.conditions, last.unwrap_or(own));
            // A pick that was read last is what is asked.
            let is_last = asked.is_empty() && last.is_some() && !had_pick;
            let pick = group.pattern.pick.take_if(|_| is_last);
            asked.extend(pick.map(|pick| chosen(pick, &group.pattern.category)));
        }
        let is_bare = asked.is_empty() && self.is_end();
        if let Some(pick) = group.pattern.pick.as_ref().filter(|_| !is_bare) {
            group.count = Some((pick.count, group.start));
            identify(&mut group.pattern);
        }
        let head = group.pattern.conditions.len();
        let is_asked = !asked.is_empty();
        group.pattern.conditions.extend(asked);
        if is_asked {
            self.alternative_places(&mut group.pattern);
        }
        self.subject_complement(&mut group.pattern);
        Target { head, ..self.finish_target(group) }
    }

    /// "or behind me" behind "in front of me": alternatives of the place that is asked.
    fn alternative_places(&mut self, pattern: &mut Pattern) {
        while self.is(Role::Or) && !self.is_noun_group_next() {
            let (checkpoint, length) = (self.checkpoint(), pattern.conditions.len());
            self.bump();
            self.skip_while(Roles::of(&[Role::Is, Role::Filler]));
            let found = self.nested(|parser| parser.conditions(pattern));
            if !found || pattern.conditions.len() != length + 1 {
                pattern.conditions.truncate(length);
                return self.rewind(checkpoint);
            }
            join_alternative(&mut pattern.conditions, length);
        }
    }

    /// Reads the places behind the subject. Returns the number of conditions before the last one.
    fn places_of_subject(&mut self, pattern: &mut Pattern) -> Option<usize> {
        let mut last = None;
        while self.is_place_of_subject() {
            let (before, had_pick) = (pattern.conditions.len(), pattern.pick.is_some());
            if self.is(Role::Superlative) && had_pick || !self.place_of_subject(pattern) {
                break;
            }
            last = Some(before);
        }
        last
    }

    /// Reads the places of one more subject, if its predicate follows: "is the man near the door and
    /// the one near the table sitting".
    pub(crate) fn places_before_predicate(&mut self, pattern: &mut Pattern) -> bool {
        let (checkpoint, own) = (self.checkpoint(), pattern.conditions.len());
        let had_pick = pattern.pick.is_some();
        let found = self.places_of_subject(pattern).is_some();
        if found && (self.is_end() || self.roles().has_any(CLAUSE_ENDS)) {
            pattern.conditions.truncate(own);
            pattern.pick.take_if(|_| !had_pick);
            self.rewind(checkpoint);
            return false;
        }
        found
    }

    fn is_place_of_subject(&self) -> bool {
        let mutual = RelationKind::Pair(PairWord::Adjacent);
        let is_beside = self.is(Role::Relation) && self.entry().relation.as_ref() == Some(&mutual);
        let is_on = self.is(Role::Implies)
            && !self.is(Role::Action)
            && self.entry().implies.iter().all(|c| matches!(c, Condition::Related(_)));
        let is_length = is_on || self.roles().has_any(Roles::of(&[Role::Number, Role::Limit]));
        is_beside || is_length || self.roles().has_any(PLACES)
    }

    fn place_of_subject(&mut self, pattern: &mut Pattern) -> bool {
        !self.is_end() && self.predicate(pattern, After::Noun)
    }

    /// "a woman", "the tallest", "a man or a woman" behind the subject of a question.
    fn subject_complement(&mut self, pattern: &mut Pattern) {
        let next = self.next_not_in(self.state.at, Roles::of(&[Role::Filler]));
        if !self.roles_at(next).has_any(COMPLEMENT_START) {
            return;
        }
        self.state.at = next;
        let checkpoint = self.checkpoint();
        if let Some(condition) = self.alternative_complements(&pattern.category) {
            pattern.conditions.push(condition);
            return;
        }
        self.rewind(checkpoint);
        let checkpoint = self.checkpoint();
        match self.complement_noun(&pattern.category) {
            Some(group) if group.pattern.category != pattern.category => self.rewind(checkpoint),
            Some(group) if group.pattern.pick.is_some() => {
                pattern.conditions.push(Condition::Is(Box::new(group.pattern)));
            }
            Some(group) => pattern.conditions.extend(group.pattern.conditions),
            None => self.rewind(checkpoint),
        }
    }

    /// A noun group in which "the one" stands for the subject's noun and so adds nothing to it.
    fn complement_noun(&mut self, subject: &Category) -> Option<NounGroup> {
        self.state.last_noun = None;
        let head = self.state.head_noun.take();
        let mut group = self.noun_group();
        self.begin_target(head);
        if let Some(group) = group.as_mut().filter(|group| group.is_pronoun) {
            group.pattern.category = subject.clone();
        }
        group
    }

    /// "a man or the one who is sitting": one condition of the subject, and not another subject.
    fn alternative_complements(&mut self, category: &Category) -> Option<Condition> {
        let is_or_ahead =
            (self.state.at..self.state.tokens.len()).any(|at| self.is_at(at, Role::Or));
        if !is_or_ahead {
            return None;
        }
        let mut alternatives = vec![self.complement(category)?];
        while self.is(Role::Or) && self.is_noun_group_next() {
            let checkpoint = self.checkpoint();
            self.bump();
            let Some(next) = self.complement(category) else {
                self.rewind(checkpoint);
                break;
            };
            alternatives.push(next);
        }
        (alternatives.len() > 1).then(|| any_of(alternatives))
    }

    /// One alternative as a condition of the subject, whose category is given.
    fn complement(&mut self, category: &Category) -> Option<Condition> {
        let group = self.complement_noun(category)?;
        let is_pronoun = group.is_pronoun;
        let pattern = self.with_modifiers(group.pattern, group.count);
        let is_bare = is_pronoun && pattern.conditions.is_empty() && pattern.pick.is_none();
        (!is_bare).then(|| alternative(pattern, category))
    }

    /// An object relative clause, whose object is the entity described: "(the woman) the man is
    /// talking to", "(which box) is the man carrying".
    pub(crate) fn object_relative(&mut self, pattern: &mut Pattern) -> bool {
        const FIRST: Roles = Roles::of(&[Role::Who, Role::Is, Role::Doing]);
        const DETERMINERS: Roles = Roles::of(&[Role::The, Role::A, Role::Number]);
        let start = self.next_not_in(self.state.at, FIRST);
        let is_that = start > self.state.at && self.is_at(start - 1, Role::The);
        let has_name = self.roles_at(start).has_any(DETERMINERS) || is_that;
        let is_negated = (self.state.at..start).any(|at| self.is_at(at, Role::Not));
        let is_plain = self.is_doer_at(start);
        if start > self.state.at + 2 || !has_name || is_negated {
            return false;
        }
        if let Some(end) = self.end_of_seen_relative(start) {
            self.push_looks(pattern, start, end);
            return true;
        }
        if !is_plain && !self.is_described_doer_at(start) {
            return false;
        }
        let checkpoint = self.checkpoint();
        self.state.at = start;
        let done = self.noun_group().and_then(|mut other| {
            if !is_plain {
                other.pattern = self.with_modifiers(other.pattern, other.count);
            }
            self.activity_of(other, &pattern.category)
        });
        match done {
            Some(done) => pattern.conditions.push(done),
            None => self.rewind(checkpoint),
        }
        self.state.at > start
    }

    /// Behind "the woman is holding hands with": a clause whose verb no table holds and that ends
    /// with a preposition. None if the clause is another one.
    fn end_of_seen_relative(&self, start: usize) -> Option<usize> {
        const REACH: usize = 6;
        const VERBS: Roles = Roles::of(&[Role::Looks, Role::Unknown]);
        let noun = self.noun_at(self.next_not_in(start, Roles::of(&[Role::The, Role::A])))?;
        let verb = noun + 2;
        let is_person = self.entry_at(noun).category == Some(Category::Person);
        let is_verb = self.roles_at(verb).has_any(VERBS) && self.word(verb).contains("ing");
        if !is_person || !self.is_at(noun + 1, Role::Is) || !is_verb {
            return None;
        }
        let ends = |at: &usize| {
            let is_last = *at >= self.state.tokens.len() || self.roles_at(*at).has_any(CLAUSE_ENDS);
            is_last && self.roles_at(at - 1).has_any(Roles::of(&[Role::With, Role::To, Role::At]))
        };
        (verb + 1..=verb + REACH).find(ends)
    }

    /// Whether a plain noun and its verb stand at a position.
    fn is_doer_at(&self, at: usize) -> bool {
        const ACTIVITIES: Roles = Roles::of(&[Role::Interaction, Role::Action, Role::Has]);
        let verb =
            |noun| self.next_not_in(noun + 1, Roles::of(&[Role::Is, Role::Filler, Role::Doing]));
        let noun = self.noun_at(self.next_not_in(at, Roles::of(&[Role::The, Role::A])));
        noun.is_some_and(|noun| self.roles_at(verb(noun)).has_any(ACTIVITIES))
    }

    /// Whether a described noun stands at a position, and its verb at the end of the clause: "the
    /// woman in white is talking to".
    fn is_described_doer_at(&self, at: usize) -> bool {
        const ENDS: Roles = Roles::of(&[Role::With, Role::To]);
        const REACH: usize = 14;
        let Some(noun) = self.noun_at(self.next_not_in(at, Roles::of(&[Role::The, Role::A])))
        else {
            return false;
        };
        if self.entry_at(noun).category != Some(Category::Person) {
            return false;
        }
        let verb = (noun + 1..noun + REACH).find(|verb| {
            let end = self.next_not_in(verb + 1, ENDS);
            let ends = end >= self.state.tokens.len() || self.roles_at(end).has_any(CLAUSE_ENDS);
            let is_verb = self.roles_at(*verb).has_any(Roles::of(&[Role::Interaction]));
            is_verb && ends && self.is_at(verb - 1, Role::Is)
        });
        let is_inner = |at: usize| self.roles_at(at).has_any(Roles::of(&[Role::Who, Role::Comma]));
        verb.is_some_and(|verb| !(noun..verb).any(is_inner))
    }

    /// The relation of the other subject to the object, which has a category and is not named
    /// again.
    fn activity_of(&mut self, other: NounGroup, category: &Category) -> Option<Condition> {
        let quantity = other.how_many();
        let mut doer = other.pattern;
        self.skip_while(Roles::of(&[Role::Is, Role::Filler, Role::Doing]));
        let entry = self.entry();
        self.bump();
        let is_person = *category == Category::Person;
        let kind = if let (Some(label), true) = (&entry.people, is_person) {
            let has_with = self.eat(Role::With) || self.eat(Role::To);
            (has_with || entry.implies.is_empty())
                .then(|| RelationKind::Interaction(label.clone()))?
        } else if is_person && entry.relation.is_some() {
            // Whoever looks at somebody has that person in front.
            let place = Place::Direction(Direction::level(Sector::Front));
            RelationKind::Placed { place, viewpoint: Viewpoint::Partner }
        } else if entry.roles.has(Role::Has) {
            RelationKind::With
        } else if !is_person && entry.roles.has(Role::Action) && self.eat(Role::At) {
            doer.conditions.extend(entry.implies.iter().cloned());
            RelationKind::With
        } else {
            let interaction = vec![RelationKind::Interaction(entry.object.clone()?)];
            let with = Pattern::of(category.clone());
            doer.conditions.push(related(interaction, with, Quantity::SOME));
            RelationKind::With
        };
        let ends = self.is_end() || self.roles().has_any(CLAUSE_ENDS);
        ends.then(|| related(vec![kind], doer, quantity))
    }
}
