//! Commands: "follow the man with the bag", "take this to her", "go to the bench, find the lady in
//! green and follow her". Whom the action concerns is the question; the verb is passed on.

use jrdb_types::query::{Category, Command, Quantity, RelationKind, Task};
use jrdb_types::{Condition, Pattern};

use crate::grammar::discourse::Asked;
use crate::grammar::noun::BEFORE_NOUN;
use crate::lexicon::{Role, Roles};
use crate::parser::Parser;
use crate::pattern::related;

/// What joins two actions.
const JOINTS: Roles = Roles::of(&[Role::And, Role::Comma, Role::Then, Role::Filler, Role::To]);

/// What begins the words of a speech, or what is to be done: "to wait", "that …", "about …".
const SPEECH: Roles = Roles::of(&[Role::To, Role::If, Role::Where, Role::How, Role::Count]);

/// Determiners and adjectives of whoever is meant.
const BEFORE_PERSON: Roles = BEFORE_NOUN.and(Roles::of(&[
    Role::The,
    Role::A,
    Role::All,
    Role::Filler,
    Role::IdMark,
    Role::Garment,
    Role::Number,
    Role::Interaction,
]));

/// One action of a command: the positions of its verb and behind its last word.
#[derive(Clone, Copy)]
struct Action {
    verb: usize,
    end: usize,
}

impl Parser<'_> {
    /// A command; none if the sentence begins with no verb of one.
    pub(crate) fn command(&mut self) -> Option<Asked> {
        let actions = self.actions();
        let is_find = actions.first().is_some_and(|first| !self.is_at(first.verb, Role::Command));
        let has_command = actions.iter().any(|action| self.is_at(action.verb, Role::Command));
        if !has_command || is_find && actions.len() < 2 {
            return None;
        }
        let main = *actions
            .iter()
            .find(|action| self.person_in(action).is_some())
            .or_else(|| actions.iter().find(|action| self.is_anybody_in(action)))?;
        let all = self.state.tokens;
        let mut later = actions.iter().filter(|action| action.verb > main.verb);
        let last = later.rfind(|action| self.has_pronoun_in(action)).copied();
        let told = last.filter(|last| self.is_at(last.verb, Role::Command)).unwrap_or(main);
        let places = self.places_before(&actions, main);
        let later_command = self.named(told, None, self.destination_in(told));
        let asked = self.action(main);
        let asked = asked.map(|(task, mut target, mut command)| {
            target.conditions.extend(places);
            if told.verb != main.verb {
                command = Some(later_command);
            }
            Asked { task, target, command }
        });
        self.state.tokens = all;
        self.state.at = all.len();
        asked
    }

    /// The actions of the sentence, from the word at hand on.
    fn actions(&self) -> Vec<Action> {
        let (start, end) = (self.state.at, self.state.tokens.len());
        let mut verbs = Vec::new();
        if self.roles_at(start).has_any(Roles::of(&[Role::Command, Role::Find])) {
            verbs.push(start);
        }
        if verbs.is_empty() {
            return Vec::new();
        }
        for at in start + 1..end {
            if self.begins_action(at) {
                verbs.push(at);
            }
        }
        let ends = verbs.iter().skip(1).map(|next| self.joint_before(*next)).chain([end]);
        verbs.iter().zip(ends).map(|(verb, end)| Action { verb: *verb, end }).collect()
    }

    /// Whether a verb of a command stands behind a joint.
    fn begins_action(&self, at: usize) -> bool {
        const VERBS: Roles = Roles::of(&[Role::Command, Role::Find, Role::Count]);
        const FIRM: Roles = Roles::of(&[Role::Comma, Role::Then]);
        let joint = self.joint_before(at);
        let is_joined = (joint..at)
            .any(|at| self.roles_at(at).has_any(Roles::of(&[Role::And, Role::Comma, Role::Then])));
        let roles = self.roles_at(at);
        if !roles.has_any(VERBS) || !is_joined || roles.has(Role::Noun) {
            return false;
        }
        let is_said_of_people = roles.has_any(Roles::of(&[Role::Action, Role::Interaction]));
        let is_firm = (joint..at).any(|at| self.roles_at(at).has_any(FIRM));
        !is_said_of_people || is_firm || self.is_at(at + 1, Role::Him)
    }

    /// The first of the joints before a position.
    fn joint_before(&self, at: usize) -> usize {
        let mut joint = at;
        while joint > self.state.at && self.roles_at(joint - 1).has_any(JOINTS) {
            joint -= 1;
        }
        joint
    }

    /// The first word of the first person that an action names.
    fn person_in(&self, action: &Action) -> Option<usize> {
        let is_person = |at: usize| {
            let is_noun = self.entry_at(at).category == Some(Category::Person);
            is_noun || self.is_at(at, Role::IdMark) || self.is_name_at(at)
        };
        let noun = (action.verb + 1..action.end).find(|at| is_person(*at))?;
        Some(self.group_start(noun, action.verb + 1))
    }

    /// Whether an unknown word is written as a name.
    fn is_name_at(&self, at: usize) -> bool {
        self.is_at(at, Role::Unknown) && self.word(at).starts_with(char::is_uppercase)
    }

    /// Whether an action names anybody or anything but rooms and pronouns.
    fn is_anybody_in(&self, action: &Action) -> bool {
        let named = Roles::of(&[Role::Unknown, Role::Noun, Role::Him, Role::One]);
        let is_robot = |at: usize| self.is_at(at, Role::Robot);
        (action.verb + 1..action.end).any(|at| self.roles_at(at).has_any(named) && !is_robot(at))
    }

    fn has_pronoun_in(&self, action: &Action) -> bool {
        (action.verb + 1..action.end.min(action.verb + 4)).any(|at| self.is_at(at, Role::Him))
    }

    /// The first word of the noun group of a noun.
    fn group_start(&self, noun: usize, least: usize) -> usize {
        let mut start = noun;
        while start > least
            && (self.roles_at(start - 1).has_any(BEFORE_PERSON)
                || self.is_joint_of_adjectives_at(start - 1))
            && !self.roles_at(start - 1).has_any(Roles::of(&[Role::Relation]))
        {
            start -= 1;
        }
        // What stands before the article belongs to the action.
        let article = (start..noun)
            .rev()
            .find(|at| self.roles_at(*at).has_any(Roles::of(&[Role::The, Role::A, Role::All])));
        article.unwrap_or(start)
    }

    fn is_joint_of_adjectives_at(&self, at: usize) -> bool {
        self.roles_at(at).has_any(Roles::of(&[Role::And, Role::Comma]))
            && self.is_at(at + 1, Role::Implies)
            && self.is_at(at.wrapping_sub(1), Role::Implies)
    }

    /// Reads the action that names whoever is meant.
    fn action(&mut self, action: Action) -> Option<(Task, Pattern, Option<Command>)> {
        if !self.is_at(action.verb, Role::Command) {
            self.state.tokens = &self.state.tokens[..action.end];
            self.state.at = action.verb;
            let (task, target) = self.question_form();
            self.report_rest();
            return Some((task, target, None));
        }
        let start = self.person_in(&action).unwrap_or_else(|| self.object_in(&action));
        let tail = self.tail(start, action);
        let before = self.object_words(action.verb + 1, start);
        let given = || {
            let is_given = self.is_at(tail, Role::A);
            is_given.then(|| self.words_of(tail, action.end)).flatten()
        };
        let is_speech = self.is_at(action.verb, Role::Speech);
        let said = || is_speech.then(|| self.words_of(tail, action.end)).flatten();
        let object = before.or_else(given).or_else(said);
        let destination = if is_speech { None } else { self.destination_of(tail, action.end) };
        let command = self.named(action, object, destination);
        let from = self.source(tail, action.end);
        self.state.tokens = &self.state.tokens[..tail];
        self.state.at = start;
        let target = self.target();
        self.report_rest();
        let mut pattern = target.pattern;
        pattern.conditions.extend(from);
        Some((Task::Find, pattern, Some(command)))
    }

    fn report_rest(&mut self) {
        while !self.is_end() {
            self.report_unused();
        }
    }

    /// The first word of the thing that an action names: behind the last of the prepositions.
    fn object_in(&self, action: &Action) -> usize {
        const BEFORE: Roles = Roles::of(&[
            Role::To,
            Role::At,
            Role::Near,
            Role::Relation,
            Role::Of,
            Role::Filler,
            Role::Side,
            Role::With,
            Role::Towards,
            Role::Common,
            Role::Limit,
            Role::Then,
            Role::Speech,
            Role::Sector,
            Role::Robot,
            Role::It,
        ]);
        self.next_not_in(action.verb + 1, BEFORE).min(action.end)
    }

    /// Where whoever is meant has been described: before a destination, a speech or a purpose.
    fn tail(&self, start: usize, action: Action) -> usize {
        let noun = (start..action.end)
            .find(|at| {
                const NAMED: Roles =
                    Roles::of(&[Role::Noun, Role::Unknown, Role::Him, Role::IdMark]);
                self.roles_at(*at).has_any(NAMED)
            })
            .unwrap_or(start);
        (noun + 1..action.end).find(|at| self.ends_description(*at, action)).unwrap_or(action.end)
    }

    fn ends_description(&self, at: usize, action: Action) -> bool {
        const PLACES: Roles = Roles::of(&[
            Role::Interaction,
            Role::Action,
            Role::Sector,
            Role::Superlative,
            Role::Comparative,
            Role::Relation,
            Role::Far,
            Role::Near,
            Role::Relative,
            Role::Side,
            Role::Ordinal,
            Role::Looks,
            Role::Located,
            Role::Towards,
        ]);
        const GIVEN: [&str; 6] = ["give", "offer", "hand", "bring", "serve", "show"];
        let is_speech = self.is_at(action.verb, Role::Speech);
        let roles = self.roles_at(at);
        let ends_noun =
            self.roles_at(at - 1).has_any(Roles::of(&[Role::Noun, Role::Garment, Role::Sector]));
        let verb = self.word(action.verb);
        if ends_noun && roles.has(Role::A) && GIVEN.iter().any(|v| verb.eq_ignore_ascii_case(v)) {
            return true;
        }
        if ends_noun && roles.has(Role::Unknown) && verb.eq_ignore_ascii_case("help") {
            return true;
        }
        let is_word = |word: &str| self.word(at).eq_ignore_ascii_case(word);
        if roles.has(Role::To) && (is_word("to") || is_word("from")) {
            const NAMED: Roles =
                Roles::of(&[Role::Robot, Role::The, Role::A, Role::My, Role::His, Role::Him]);
            let is_named = !is_speech || self.roles_at(at + 1).has_any(NAMED);
            let is_place = self.roles_at(at - 1).has_any(PLACES) && is_named;
            let side = self.next_not_in(at + 1, Roles::of(&[Role::The, Role::My, Role::His]));
            let is_side = self.is_at(side, Role::Sector);
            return !is_place && !is_side;
        }
        if roles.has(Role::Command) && self.is_at(at - 1, Role::Filler) {
            return true;
        }
        let says = ["that", "about", "because", "until", "so", "when", "while", "before", "after"];
        let is_said = says.iter().any(|word| is_word(word))
            && !(is_word("that") && self.is_at(at + 1, Role::Is));
        is_speech && (is_said || roles.has_any(SPEECH) || roles.has(Role::What))
            || is_word("until")
            || is_word("because")
    }

    /// The words of what is taken or said: those before the preposition of the person.
    fn object_words(&self, start: usize, end: usize) -> Option<String> {
        const EDGES: Roles = Roles::of(&[
            Role::To,
            Role::At,
            Role::Near,
            Role::Relation,
            Role::Filler,
            Role::Side,
            Role::With,
            Role::Sector,
            Role::Towards,
            Role::Limit,
            Role::Find,
        ]);
        let mut last = end;
        while last > start && self.roles_at(last - 1).has_any(EDGES) {
            last -= 1;
        }
        let first = self.next_not_in(start, EDGES).min(last);
        self.words_of(first, last)
    }

    fn words_of(&self, start: usize, end: usize) -> Option<String> {
        let span = self.span(start, end);
        let words = self.text.get(span.start..span.end).unwrap_or_default().trim();
        let says = |at: usize| {
            const SILENT: Roles = Roles::of(&[Role::Him, Role::Robot, Role::Filler]);
            let word = self.word(at);
            let is_article = ["the", "a", "an"].iter().any(|a| word.eq_ignore_ascii_case(a));
            !is_article && !self.roles_at(at).has_any(SILENT)
        };
        let is_said = (start..end).any(says);
        (end > start && is_said && !words.is_empty()).then(|| words.to_owned())
    }

    /// The destination behind whoever is meant: "to the kitchen".
    fn destination_of(&self, tail: usize, end: usize) -> Option<String> {
        let to = (tail..end).find(|at| self.word(*at).eq_ignore_ascii_case("to"))?;
        self.words_of(self.next_not_in(to, Roles::of(&[Role::To, Role::The])), end)
    }

    fn destination_in(&self, action: Action) -> Option<String> {
        self.destination_of(action.verb + 1, action.end)
    }

    /// "from the sofa to …": where whoever is meant is.
    fn source(&mut self, tail: usize, end: usize) -> Vec<Condition> {
        if tail >= end || !self.word(tail).eq_ignore_ascii_case("from") {
            return Vec::new();
        }
        let to = (tail + 1..end).find(|at| self.word(*at).eq_ignore_ascii_case("to"));
        let end = to.unwrap_or(end);
        let words = self.place_conditions(tail + 1, end);
        if !words.is_empty() {
            return words;
        }
        let all = self.state.tokens;
        self.state.tokens = &all[..end];
        self.state.at = tail + 1;
        let place = self.noun_phrase();
        self.state.tokens = all;
        let with = |place| related(vec![RelationKind::With], place, Quantity::SOME);
        place.into_iter().filter(|place| place.category != Category::Robot).map(with).collect()
    }

    /// A known thing is a relation; a room or unknown place is kept in words.
    fn place_conditions(&mut self, start: usize, end: usize) -> Vec<Condition> {
        let first = self.next_not_in(start, Roles::of(&[Role::The, Role::A, Role::To, Role::At]));
        let is_strange = (first..end)
            .any(|at| self.roles_at(at).has_any(Roles::of(&[Role::Unknown, Role::Room])));
        if first >= end || !is_strange {
            return Vec::new();
        }
        let message = "rooms and places are not known here, kept as words".to_owned();
        self.report(jrdb_types::IssueKind::NotInGraph, first, end, message);
        vec![crate::unread::phrase(self.text, self.span(first, end))]
    }

    /// The places of the actions before the main one: where whoever is meant is.
    fn places_before(&mut self, actions: &[Action], main: Action) -> Vec<Condition> {
        let before = actions.iter().filter(|action| action.verb < main.verb);
        let before: Vec<Action> = before.copied().collect();
        before.iter().flat_map(|one| self.place_conditions(one.verb + 1, one.end)).collect()
    }

    fn named(
        &self,
        action: Action,
        object: Option<String>,
        destination: Option<String>,
    ) -> Command {
        let verb = self.word(action.verb).split_whitespace().next().unwrap_or_default();
        Command { verb: verb.to_lowercase(), object, destination }
    }
}
