//! Where the parser stands in a question, and the elementary operations of the grammar.
//!
//! A production looks at the words ahead, consumes some of them, and changes the [`State`]. It
//! takes a [`Checkpoint`] before it tries a reading and rewinds to it when the reading fails.

use std::rc::Rc;

use jrdb_types::issue::IssueKind;
use jrdb_types::query::{Category, Slot};
use jrdb_types::{Condition, Issue, Pattern, Span};

use crate::config::ParserConfig;
use crate::issues::{IssueLog, Treatment};
use crate::lexicon::{Entry, Garment, LEXICON, Role, Roles, special};
use crate::pattern::truncated_antecedent;
use crate::token::{Token, Tokens, tokenize};
use crate::unread::{phrase, phrases};

/// How deep "left of a man who is left of a man who …" may nest. Each entity inside another takes
/// two levels, so queries stay well within what the notation accepts.
const DEPTH_MAX: u32 = 16;

/// Words that add nothing where they do not fit.
const FUNCTION_WORDS: Roles = Roles::of(&[
    Role::The,
    Role::A,
    Role::Filler,
    Role::Is,
    Role::Doing,
    Role::Of,
    Role::Comma,
    Role::And,
    Role::Slash,
    Role::Dash,
    Role::To,
    Role::Who,
    Role::Which,
    Role::What,
    Role::Exists,
    Role::Find,
]);

/// "his" and "him".
const PRONOUNS: Roles = Roles::of(&[Role::His, Role::Him]);

/// The words of a question, the state of the parser, and what it has produced so far.
pub(crate) struct Parser<'t> {
    pub(crate) text: &'t str,
    pub(crate) config: &'t ParserConfig,
    pub(crate) state: State<'t>,
    /// What was spoken of in the sentences before: what "it", "the one" and "the other" stand for.
    pub(crate) discourse: Option<Rc<Pattern>>,
    /// The text may hold a pronoun, so antecedents must be kept.
    pub(crate) has_pronouns: bool,
    /// The text holds "'s", so a noun may name the owner of what follows.
    pub(crate) has_possessives: bool,
    /// The word where nesting was too deep. A rewind keeps it: the production that stopped there
    /// fails, and the reason must be reported all the same.
    too_deep: Option<usize>,
    /// The question says from where everything is seen.
    pub(crate) is_viewed: bool,
    /// "dressed entirely in" was read: the colour is of everything that is worn.
    pub(crate) is_wholly: bool,
    issues: IssueLog,
    slots: Vec<Slot>,
}

/// Everything that productions change while they read, except for what they append to.
#[derive(Clone)]
pub(crate) struct State<'t> {
    /// The words that are left to the grammar: a stranded preposition is cut off the end.
    pub(crate) tokens: &'t [Token],
    pub(crate) at: usize,
    /// What "him" can mean besides the partners of the entity that the clause describes.
    pub(crate) antecedent: Option<Rc<Pattern>>,
    /// The last noun: what "the one" stands for, where no list resumes an earlier noun.
    pub(crate) last_noun: Option<&'static Entry>,
    /// The noun of what the question asks for: what "and the one" resumes.
    pub(crate) head_noun: Option<&'static Entry>,
    /// The last piece of clothing: what "blue ones" stands for.
    pub(crate) last_garment: Option<Garment>,
    /// The time of the slot that is being read.
    pub(crate) during: Option<[f64; 2]>,
    /// How many subjects are asked about together: "are the man and the woman sitting".
    pub(crate) subjects: Option<u32>,
    depth: u32,
    pub(crate) is_timed: bool,
    /// "doing" was read: the question asks for actions.
    pub(crate) asks_doing: bool,
    /// A yes-or-no question, which is about all subjects that are joined with "and".
    pub(crate) asks_several: bool,
    /// The partner of a walk is being read: "towards the door" behind it is where both go.
    pub(crate) is_walk: bool,
    /// "between" or "except" is being read: "and the one" is one more of its entities.
    pub(crate) is_closed_list: bool,
}

/// The complete state of a parser at one word, to return to.
pub(crate) struct Checkpoint<'t> {
    state: State<'t>,
    issues: usize,
    slots: usize,
}

impl<'t> Parser<'t> {
    /// A parser at the start of a text with its phrases and misspelled words.
    pub(crate) fn new(
        text: &'t str,
        config: &'t ParserConfig,
        tokens: &'t [Token],
        misspelled: Vec<Issue>,
    ) -> Self {
        let state = State {
            tokens,
            at: 0,
            antecedent: None,
            last_noun: None,
            head_noun: None,
            last_garment: None,
            during: None,
            subjects: None,
            depth: 0,
            is_timed: false,
            asks_doing: false,
            asks_several: false,
            is_walk: false,
            is_closed_list: false,
        };
        let (issues, slots) = (IssueLog::new(misspelled), Vec::new());
        let all = tokens.iter().fold(Roles::default(), |all, token| all.and(token.roles));
        Self {
            text,
            config,
            state,
            discourse: None,
            has_pronouns: all.has_any(PRONOUNS) && has_pronouns(tokens),
            has_possessives: all.has(Role::Possessive),
            too_deep: None,
            is_viewed: false,
            is_wholly: false,
            issues,
            slots,
        }
    }

    /// Conditions for the words that were not used: descriptions where they can be looked at.
    pub(crate) fn unread(&self, all: &[Token]) -> Vec<Condition> {
        let looks = |span: &Span| {
            let mut own =
                all.iter().filter(|token| token.start >= span.start && token.end <= span.end);
            own.any(|token| token.roles.has(Role::Looks))
        };
        phrases(self.text, self.issues.unused(), looks)
    }

    /// Reports the unknown words of a description.
    pub(crate) fn report_described(&mut self, first: usize, end: usize) {
        for at in first..end {
            if self.is_at(at, Role::Unknown) {
                let (word, span) = (self.word(at), self.span(at, at + 1));
                self.issues.push_unknown(word, span, Treatment::Described);
            }
        }
    }

    /// The slots and the issues, at the end of the question.
    pub(crate) fn finish(mut self) -> (Vec<Slot>, Vec<Issue>) {
        if self.state.tokens.is_empty() {
            self.issues.push(Issue::new(IssueKind::UnknownWord, "the question has no words"));
        }
        if let Some(at) = self.too_deep.filter(|at| *at < self.state.tokens.len()) {
            let message =
                "too many things inside each other; the rest is read apart from them".into();
            self.report(IssueKind::Ambiguous, at, at + 1, message);
        }
        (self.slots, self.issues.finish(self.text))
    }

    pub(crate) fn checkpoint(&self) -> Checkpoint<'t> {
        let (issues, slots) = (self.issues.len(), self.slots.len());
        Checkpoint { state: self.state.clone(), issues, slots }
    }

    /// Returns to a checkpoint: the state is as it was, and later issues and slots are gone.
    pub(crate) fn rewind(&mut self, checkpoint: Checkpoint<'t>) {
        self.state = checkpoint.state;
        self.issues.truncate(checkpoint.issues);
        self.slots.truncate(checkpoint.slots);
    }

    pub(crate) fn entry_at(&self, at: usize) -> &'static Entry {
        self.state.tokens.get(at).map_or_else(|| LEXICON.entry(special::END), |token| token.entry)
    }

    pub(crate) fn entry(&self) -> &'static Entry {
        self.entry_at(self.state.at)
    }

    pub(crate) fn roles(&self) -> Roles {
        self.roles_at(self.state.at)
    }

    pub(crate) fn roles_at(&self, at: usize) -> Roles {
        self.state.tokens.get(at).map_or_else(Roles::default, |token| token.roles)
    }

    pub(crate) fn is(&self, role: Role) -> bool {
        self.roles().has(role)
    }

    pub(crate) fn is_at(&self, at: usize, role: Role) -> bool {
        self.roles_at(at).has(role)
    }

    pub(crate) fn is_end(&self) -> bool {
        self.state.at >= self.state.tokens.len()
    }

    /// Consumes the word at hand.
    pub(crate) fn bump(&mut self) {
        self.state.at += 1;
    }

    /// Consumes the word at hand if it has the role.
    pub(crate) fn eat(&mut self, role: Role) -> bool {
        let found = self.is(role);
        self.state.at += usize::from(found);
        found
    }

    /// Consumes words while they have one of the roles.
    pub(crate) fn skip_while(&mut self, roles: Roles) {
        self.state.at = self.next_not_in(self.state.at, roles);
    }

    /// The first position from `at` on whose word has none of the roles.
    pub(crate) fn next_not_in(&self, mut at: usize, roles: Roles) -> usize {
        while self.roles_at(at).has_any(roles) {
            at += 1;
        }
        at
    }

    /// Cuts the last word off the question.
    pub(crate) fn drop_last(&mut self) {
        self.state.tokens = self.state.tokens.split_last().map_or(&[], |(_, others)| others);
    }

    /// Makes a pattern what the following pronouns stand for; returns what it was before.
    pub(crate) fn set_antecedent(&mut self, pattern: &Pattern) -> Option<Rc<Pattern>> {
        self.state.antecedent.replace(Rc::new(truncated_antecedent(pattern)))
    }

    /// Makes the noun of a list what "the one" stands for in the rest of the list.
    pub(crate) fn resume_noun(&mut self, noun: Option<&'static Entry>) {
        self.state.last_noun = noun.or(self.state.last_noun);
    }

    /// Makes a noun the one that the question asks for.
    pub(crate) fn begin_target(&mut self, noun: Option<&'static Entry>) {
        self.state.head_noun = noun.or(self.state.head_noun);
        self.resume_noun(noun);
    }

    pub(crate) fn push_slot(&mut self, slot: Slot) {
        self.slots.push(slot);
    }

    /// Whether `levels` more levels fit here: three for each entity that can still be read.
    pub(crate) fn has_room(&mut self, levels: usize) -> bool {
        let has_room = levels < 3 * (DEPTH_MAX - self.state.depth) as usize;
        if !has_room {
            self.too_deep = self.too_deep.or(Some(self.state.at));
        }
        has_room
    }

    /// Runs a production one level deeper. At the deepest level it reads nothing; the position is
    /// reported in the end.
    pub(crate) fn nested<T: Default>(&mut self, read: impl FnOnce(&mut Self) -> T) -> T {
        if self.state.depth == DEPTH_MAX {
            self.too_deep = self.too_deep.or(Some(self.state.at));
            return T::default();
        }
        self.state.depth += 1;
        let found = read(self);
        self.state.depth -= 1;
        found
    }

    /// The bytes of the words from `start` to before `end`.
    pub(crate) fn span(&self, start: usize, end: usize) -> Span {
        let tokens = self.state.tokens;
        let first = tokens.get(start).map_or(self.text.len(), |token| token.start);
        let last = tokens.get(end.wrapping_sub(1)).map_or(first, |token| token.end);
        Span { start: first, end: last.max(first) }
    }

    pub(crate) fn word(&self, at: usize) -> &'t str {
        let span = self.span(at, at + 1);
        &self.text[span.start..span.end]
    }

    /// Reports that the text holds neither a target nor a form of question.
    pub(crate) fn report_not_understood(&mut self) {
        let message = "nothing of the question was understood";
        self.issues.push(Issue::new(IssueKind::NotUnderstood, message));
    }

    /// Reports an issue about the words from `start` to before `end`.
    pub(crate) fn report(&mut self, kind: IssueKind, start: usize, end: usize, message: String) {
        let issue = Issue::at(kind, self.span(start, end), message);
        self.issues.push(issue);
    }

    /// Reports words that are not used: what they say becomes a condition that is not understood.
    pub(crate) fn report_unread(
        &mut self,
        kind: IssueKind,
        start: usize,
        end: usize,
        message: String,
    ) {
        self.issues.keep_unused(self.span(start, end));
        self.report(kind, start, end, message);
    }

    /// Consumes a word that fits nowhere, and reports it.
    pub(crate) fn report_unused(&mut self) {
        self.report_word(Treatment::NotUsed);
    }

    /// Consumes the name of an unknown entity, and reports it; returns a pattern of anything that the
    /// name may mean.
    pub(crate) fn unknown_entity(&mut self) -> Pattern {
        let name = phrase(self.text, self.span(self.state.at, self.state.at + 1));
        self.report_word(Treatment::ReadAsAnything);
        Pattern { conditions: vec![name], ..Pattern::of(Category::Anything) }
    }

    fn report_word(&mut self, treatment: Treatment) {
        if self.is_end() {
            return;
        }
        let (at, entry) = (self.state.at, self.entry());
        self.bump();
        let span = self.span(at, at + 1);
        let is_content = !entry.roles.has_any(FUNCTION_WORDS) || entry.roles.has(Role::Unknown);
        if treatment == Treatment::NotUsed && is_content {
            self.issues.keep_unused(span);
        }
        if entry.roles.has(Role::Looks) && !entry.roles.has(Role::Unknown) {
            // Described in the query, which is all that can be said of it.
        } else if let Some(what) = &entry.unsupported {
            self.issues.push_unsupported(what, span, treatment);
        } else if entry.roles.has(Role::Unknown) {
            self.issues.push_unknown(self.word(at), span, treatment);
        } else {
            let previous = at.checked_sub(1).map(|previous| self.span(previous, at).end);
            self.issues.push_misplaced(span, previous);
        }
    }

    /// Consumes a word for what no scene graph holds, and reports it; false if the word at hand is
    /// not one.
    pub(crate) fn eat_unsupported(&mut self) -> bool {
        let found = self.is(Role::Unsupported);
        if found {
            self.report_unused();
        }
        found
    }
}

/// Whether the text holds a word that asks or describes, and not only words that join others.
pub(crate) fn has_known_word(text: &str) -> bool {
    const CONTENT: Roles = Roles::of(&[
        Role::Noun,
        Role::Find,
        Role::Count,
        Role::Implies,
        Role::Robot,
        Role::Who,
        Role::Which,
    ]);
    let mut tokens = Tokens::new();
    tokenize(text, &mut tokens, &mut Vec::new());
    tokens.iter().any(|token| token.roles.has_any(CONTENT))
}

/// Whether there is a pronoun other than "his" of the benchmark's "his\her", which always means the
/// subject.
fn has_pronouns(tokens: &[Token]) -> bool {
    let is_pronoun = |token: &Token| token.roles.has_any(PRONOUNS);
    let is_slash = |at: usize| tokens.get(at).is_some_and(|t| t.roles.has(Role::Slash));
    (0..tokens.len())
        .any(|at| is_pronoun(&tokens[at]) && !is_slash(at + 1) && !is_slash(at.wrapping_sub(1)))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Everything that a rewind must restore, for comparison. A new field of the state has no place
    /// to hide: the pattern names them all.
    pub(crate) fn snapshot(parser: &Parser<'_>) -> String {
        let State {
            tokens,
            at,
            antecedent,
            last_noun,
            head_noun,
            last_garment,
            during,
            subjects,
            depth,
            is_timed,
            asks_doing,
            asks_several,
            is_walk,
            is_closed_list,
        } = &parser.state;
        let nouns = [last_noun, head_noun].map(|noun| noun.map(std::ptr::from_ref));
        let flags = [is_timed, asks_doing, asks_several, is_walk, is_closed_list];
        let lists = (parser.issues.len(), parser.slots.len());
        let words = tokens.len();
        format!(
            "{words} {at} {antecedent:?} {nouns:?} {last_garment:?} {during:?} {subjects:?} {depth} {flags:?} {lists:?}"
        )
    }

    /// Runs a check on a parser at the first word of a text.
    pub(crate) fn with_parser(text: &str, check: impl FnOnce(Parser<'_>)) {
        let (mut tokens, config) = (Tokens::new(), ParserConfig::default());
        tokenize(text, &mut tokens, &mut Vec::new());
        check(Parser::new(text, &config, &tokens, Vec::new()));
    }

    #[test]
    fn a_rewind_restores_the_complete_state() {
        with_parser("the man near a chair and the one next to him", |mut parser| {
            let before = snapshot(&parser);
            let checkpoint = parser.checkpoint();
            parser.report_unused();
            parser.set_antecedent(&Pattern::default());
            parser.begin_target(Some(parser.entry()));
            parser.push_slot(Slot { during_s: None, conditions: Vec::new() });
            parser.drop_last();
            parser.state.last_garment = Some(Garment::Upper);
            parser.state.during = Some([0.0, 1.0]);
            parser.state.subjects = Some(2);
            parser.state.depth += 1;
            (parser.state.is_timed, parser.state.asks_doing) = (true, true);
            (parser.state.asks_several, parser.state.is_walk) = (true, true);
            parser.state.is_closed_list = true;
            assert_ne!(snapshot(&parser), before);
            parser.rewind(checkpoint);
            assert_eq!(snapshot(&parser), before);
        });
    }
}
