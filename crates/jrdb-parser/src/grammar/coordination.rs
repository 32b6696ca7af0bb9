//! Noun phrases and lists of them: "the door and the table", "the tallest man or the woman next to
//! him".

use std::rc::Rc;

use jrdb_types::query::Category;
use jrdb_types::{Condition, Pattern};

use crate::grammar::noun::NOUN_START;
use crate::lexicon::{Entry, Role, Roles};
use crate::parser::Parser;
use crate::pattern::{either, set_count, truncated_antecedent};
use crate::phrase::{Partner, Scope};

/// Words that may stand between a noun and "his left".
const TO_HIM: Roles = Roles::of(&[Role::Located, Role::To, Role::At, Role::Filler, Role::Relative]);

impl Parser<'_> {
    /// The robot, a pronoun, or a noun group with its modifiers.
    pub(crate) fn noun_phrase(&mut self) -> Option<Pattern> {
        Some(self.partner()?.pattern)
    }

    fn partner(&mut self) -> Option<Partner> {
        self.skip_while(Roles::of(&[Role::Filler]));
        if let Some(pattern) = self.robot() {
            return Some(Partner { pattern, ..Partner::default() });
        }
        if self.is(Role::Him) && !self.is_noun_ahead(self.state.at + 1) {
            return self.pronoun().map(|pattern| Partner { pattern, ..Partner::default() });
        }
        let Some(group) = self.noun_group() else { return self.unknown_noun() };
        let (quantity, is_all, noun) = (group.how_many(), group.is_all, group.noun);
        let head = self.state.head_noun;
        self.state.head_noun = head.or(noun);
        let pattern = self.with_modifiers(group.pattern, group.count);
        self.state.head_noun = head;
        Some(Partner { pattern, noun, quantity, is_all })
    }

    /// "me", "the robot", "me (the robot)".
    pub(crate) fn robot(&mut self) -> Option<Pattern> {
        let next = self.next_not_in(self.state.at, Roles::of(&[Role::The]));
        if !self.is_at(next, Role::Robot) {
            return None;
        }
        self.state.at = next + 1;
        let again = self.next_not_in(self.state.at, Roles::of(&[Role::The]));
        if self.is_at(again, Role::Robot) {
            self.state.at = again + 1;
        }
        Some(Pattern::of(Category::Robot))
    }

    /// Consumes the robot if it is the only one named, which is the most common reference.
    pub(crate) fn eat_robot_alone(&mut self) -> bool {
        const JOINTS: Roles = Roles::of(&[Role::And, Role::Or]);
        let start = self.state.at;
        let found = self.robot().is_some() && !self.roles().has_any(JOINTS);
        if !found {
            self.state.at = start;
        }
        found
    }

    /// The antecedent of the pronoun at hand; reports it if there is none.
    pub(crate) fn pronoun(&mut self) -> Option<Pattern> {
        let at = self.state.at;
        self.eat_pronoun();
        let found = self.antecedent_at(at);
        if found.is_none() {
            let message = format!(
                "nobody was spoken of before that {:?} can mean; read as anybody",
                self.word(at)
            );
            self.report(jrdb_types::IssueKind::Ambiguous, at, self.state.at, message);
        }
        Some(found.unwrap_or_default())
    }

    /// The antecedent of the pronoun at a position. "It" does not stand for a person.
    pub(crate) fn antecedent_at(&self, at: usize) -> Option<Pattern> {
        let antecedent = self.state.antecedent.as_deref()?;
        if !self.is_at(at, Role::It) || antecedent.category != Category::Person {
            return Some(antecedent.clone());
        }
        let object = |condition: &Condition| match condition {
            Condition::Related(related) if related.partner.category != Category::Person => {
                Some(related.partner.clone())
            }
            _ => None,
        };
        antecedent.conditions.iter().rev().find_map(object).or_else(|| Some(antecedent.clone()))
    }

    /// Consumes "his", "his\her", "him".
    pub(crate) fn eat_pronoun(&mut self) {
        const HIS: Roles = Roles::of(&[Role::His, Role::Him]);
        self.bump();
        while self.is(Role::Slash) && self.roles_at(self.state.at + 1).has_any(HIS) {
            self.state.at += 2;
        }
    }

    /// "a zebra": an unknown noun, which is reported and read as anything but the robot.
    fn unknown_noun(&mut self) -> Option<Partner> {
        const ARTICLES: Roles = Roles::of(&[Role::The, Role::A, Role::His, Role::My]);
        const STRANGE: Roles = Roles::of(&[Role::Unknown, Role::Unsupported]);
        let next = self.next_not_in(self.state.at, ARTICLES);
        if !self.roles_at(next).has_any(STRANGE) {
            return None;
        }
        self.state.at = next;
        let pattern = self.unknown_entity();
        Some(Partner { pattern, ..Partner::default() })
    }

    /// Adds the modifiers behind a noun to its pattern, up to what describes its subject.
    pub(crate) fn with_modifiers(
        &mut self,
        mut pattern: Pattern,
        count: Option<(u32, usize)>,
    ) -> Pattern {
        let outer = std::mem::take(&mut self.state.is_closed_list);
        self.nested(|parser| parser.clauses(&mut pattern, Scope::Reduced));
        self.state.is_closed_list = outer;
        set_count(&mut pattern, count);
        pattern
    }

    /// One or more partners, all of which are needed: "the door and the table". Alternatives are
    /// one partner.
    pub(crate) fn partners(&mut self) -> Vec<Partner> {
        let start = self.state.at;
        self.eat(Role::Either);
        let mut partners: Vec<Partner> = self.nested(Self::partner).into_iter().collect();
        let mut alternatives: Vec<Pattern> = Vec::new();
        while let Some(last) = partners.last_mut() {
            let is_or = self.is(Role::Or);
            if !(is_or || self.is(Role::And)) || !self.is_more(&last.pattern) {
                break;
            }
            let Some(next) = self.next_partner(last) else { break };
            if is_or || !alternatives.is_empty() {
                alternatives.push(std::mem::take(&mut last.pattern));
            }
            if is_or {
                (last.pattern, last.noun) = (next.pattern, next.noun);
                continue;
            }
            if !alternatives.is_empty() {
                last.pattern = either(std::mem::take(&mut alternatives));
            }
            partners.push(next);
        }
        if let (Some(last), false) = (partners.last_mut(), alternatives.is_empty()) {
            alternatives.push(std::mem::take(&mut last.pattern));
            last.pattern = either(alternatives);
        }
        if partners.is_empty() {
            self.state.at = start;
        }
        if partners.iter().any(|partner| partner.is_all) {
            let message = "one of them is enough; \"every\" cannot be asked here".into();
            self.report(jrdb_types::IssueKind::Ambiguous, start, self.state.at, message);
        }
        partners
    }

    /// The partner behind the joint at hand; pronouns in it stand for the one before.
    fn next_partner(&mut self, last: &Partner) -> Option<Partner> {
        let checkpoint = self.checkpoint();
        self.bump();
        self.resume_noun(last.noun);
        let pronoun = self.has_pronouns.then(|| Rc::new(truncated_antecedent(&last.pattern)));
        let outer = std::mem::replace(&mut self.state.antecedent, pronoun);
        let next = self.nested(Self::partner);
        self.state.antecedent = outer;
        if next.is_none() {
            self.rewind(checkpoint);
        }
        next
    }

    /// The noun that "the one" just read stands for: the last one, unless only a person does what
    /// follows.
    pub(crate) fn noun_of_one(&self) -> Option<&'static Entry> {
        let (last, at) = (self.state.last_noun, self.state.at);
        let fits = |noun: &&'static Entry| !self.is_about_person_at(at) || is_person(noun);
        last.filter(fits).or_else(|| self.state.head_noun.filter(fits))
    }

    /// The position behind "the one" that follows a joint.
    fn after_one(&self, joint: usize) -> Option<usize> {
        const DETERMINERS: Roles = Roles::of(&[Role::The, Role::All, Role::Filler]);
        let mut one = joint + 1;
        while self.roles_at(one).has_any(DETERMINERS) && !self.is_at(one, Role::One) {
            one += 1;
        }
        let is_one = self.is_at(one, Role::One) && !self.is_noun_ahead(one + 1);
        is_one.then_some(one + 1)
    }

    /// Whether "the one" behind a joint resumes the noun that the question asks for: "the
    /// woman left of the chair and the one sitting".
    pub(crate) fn is_head_resumed(&self, joint: usize) -> bool {
        let Some(head) = self.state.head_noun.filter(|_| !self.state.is_closed_list) else {
            return false;
        };
        self.after_one(joint).is_some_and(|at| is_person(head) || !self.is_about_person_at(at))
    }

    /// Whether only a person does what is said at a position: "sitting", "who".
    fn is_about_person_at(&self, at: usize) -> bool {
        const OF_PEOPLE: Roles = Roles::of(&[Role::Action, Role::Interaction, Role::Whose]);
        let roles = self.roles_at(at);
        let is_who = roles.has(Role::Who) && !roles.has_any(Roles::of(&[Role::Which, Role::The]));
        is_who || roles.has_any(OF_PEOPLE)
    }

    /// Whether another partner of the same kind begins behind the joint at hand.
    fn is_more(&self, last: &Pattern) -> bool {
        if let Some(after) = self.after_one(self.state.at) {
            let is_person = matches!(last.category, Category::Person | Category::Anything);
            return !self.is_head_resumed(self.state.at)
                && (is_person || !self.is_about_person_at(after));
        }
        let next = self.next_not_in(self.state.at + 1, Roles::of(&[Role::The, Role::A]));
        let is_robot = self.is_at(next, Role::Robot);
        let has_article = next > self.state.at + 1;
        let Some(noun) = self.noun_at(next) else { return is_robot };
        let category = self.entry_at(noun).category.as_ref();
        let is_person = |category: &Category| *category == Category::Person;
        let is_same = category.is_none_or(|c| is_person(c) == is_person(&last.category));
        let is_robots = last.category == Category::Robot;
        let is_list =
            self.is_at(next, Role::Implies) && self.is_at(self.state.at - 1, Role::Plural);
        let is_bare = has_article || noun == next || is_list;
        is_bare && (is_same || is_robots) && !self.is_next_located_by_his()
    }

    /// The position of the noun that the adjectives from `at` on lead to.
    pub(crate) fn noun_at(&self, at: usize) -> Option<usize> {
        if !self.roles_at(at).has_any(NOUN_START) || !self.is_noun_ahead(at) {
            return None;
        }
        const NAMES: Roles = Roles::of(&[Role::Noun, Role::One, Role::IdMark]);
        (at..at + 9).find(|at| self.roles_at(*at).has_any(NAMES))
    }

    /// Whether "located to his" is at a place.
    pub(crate) fn is_located_by_his_at(&self, at: usize) -> bool {
        let next = self.next_not_in(at, TO_HIM);
        next > at && self.is_at(next, Role::His)
    }

    /// Whether a noun group begins behind the joint at hand.
    pub(crate) fn is_noun_group_next(&self) -> bool {
        let start = self.state.at + 1;
        let next = self.next_not_in(
            start,
            Roles::of(&[Role::The, Role::A, Role::All, Role::No, Role::Filler]),
        );
        let is_plain = self.is_at(next, Role::IdMark)
            || self.is_at(next, Role::Noun) && !self.is_at(next, Role::Implies)
            || self.is_at(next, Role::Implies) && self.is_noun_ahead(next);
        let is_noun = (next > start || is_plain) && self.noun_at(next).is_some();
        is_noun || self.after_one(self.state.at).is_some()
    }

    /// Whether the noun group behind the joint at hand is located at "his" side.
    pub(crate) fn is_next_located_by_his(&self) -> bool {
        const LIST: Roles = Roles::of(&[
            Role::The,
            Role::A,
            Role::Implies,
            Role::Comma,
            Role::And,
            Role::Filler,
            Role::Noun,
        ]);
        let next = self.next_not_in(self.state.at + 1, LIST);
        self.is_located_by_his_at(next)
    }
}

fn is_person(noun: &Entry) -> bool {
    noun.category == Some(Category::Person)
}
