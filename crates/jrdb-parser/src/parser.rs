//! Where the parser stands in the question, and what it can see from there.

use jrdb_types::issue::IssueKind;
use jrdb_types::query::Slot;
use jrdb_types::{Issue, Pattern, Span};

use crate::config::ParserConfig;
use crate::lexicon::{Entry, LEXICON, Role, Roles, special};
use crate::suggest::{Suggestion, suggest};
use crate::token::{SUGGESTIONS_MAX, Token, Tokens, tokenize};

/// How deep "left of a man who is left of a man who …" may go, two for each thing inside another: well within what the
/// notation takes.
const DEPTH_MAX: usize = 16;

/// How many issues a question has at most; the last spans all that follow.
const ISSUES_MAX: usize = 64;

/// Bytes of the longest stretch of words that a message quotes.
const QUOTED_MAX: usize = 60;

/// The words, the place among them, and what was found so far.
pub(crate) struct Parser<'t> {
    pub(crate) text: &'t str,
    pub(crate) config: &'t ParserConfig,
    pub(crate) tokens: &'t [Token],
    pub(crate) at: usize,
    pub(crate) depth: usize,
    pub(crate) issues: Vec<Issue>,
    /// What "him" can mean besides the partners of the thing spoken of.
    pub(crate) antecedent: Option<Pattern>,
    /// The last noun: what "the one" stands for.
    pub(crate) last_noun: Option<&'static Entry>,
    /// Finished slots, and the time of the one that is being read.
    pub(crate) slots: Vec<Slot>,
    pub(crate) during: Option<[f64; 2]>,
    pub(crate) is_timed: bool,
    /// Something of the text may be a pronoun for a thing spoken of.
    pub(crate) has_pronouns: bool,
    /// The word where clauses were too deep inside each other.
    pub(crate) too_deep: Option<usize>,
    /// "doing" was read: the question is for actions.
    pub(crate) asks_doing: bool,
    /// It is asked whether something is so: of all things that are joined with "and".
    pub(crate) asks_several: bool,
    /// How many subjects are asked about together: "are the man and the woman sitting".
    pub(crate) subjects: Option<usize>,
    /// A partner of a walk is read: "towards the door" behind it is where both go.
    pub(crate) is_walk: bool,
}

/// A place to return to.
#[derive(Clone, Copy)]
pub(crate) struct Checkpoint {
    at: usize,
    issues: usize,
}

impl<'t> Parser<'t> {
    /// At the start of a text with its phrases and what was to be said of them.
    pub(crate) fn new(
        text: &'t str,
        config: &'t ParserConfig,
        tokens: &'t [Token],
        issues: Vec<Issue>,
    ) -> Self {
        let has_pronouns = has_pronouns(tokens);
        Self {
            text,
            config,
            tokens,
            at: 0,
            depth: 0,
            issues,
            antecedent: None,
            last_noun: None,
            slots: Vec::new(),
            during: None,
            is_timed: false,
            has_pronouns,
            too_deep: None,
            asks_doing: false,
            asks_several: false,
            subjects: None,
            is_walk: false,
        }
    }

    pub(crate) fn entry_at(&self, at: usize) -> &'static Entry {
        self.tokens.get(at).map_or_else(|| LEXICON.entry(special::END), |token| token.entry)
    }

    pub(crate) fn entry(&self) -> &'static Entry {
        self.entry_at(self.at)
    }

    pub(crate) fn roles(&self) -> Roles {
        self.roles_at(self.at)
    }

    pub(crate) fn roles_at(&self, at: usize) -> Roles {
        self.tokens.get(at).map_or_else(Roles::default, |token| token.roles)
    }

    pub(crate) fn is(&self, role: Role) -> bool {
        self.roles().has(role)
    }

    pub(crate) fn is_at(&self, at: usize, role: Role) -> bool {
        self.roles_at(at).has(role)
    }

    pub(crate) fn is_end(&self) -> bool {
        self.at >= self.tokens.len()
    }

    /// Steps over the word at hand when it has the role.
    pub(crate) fn eat(&mut self, role: Role) -> bool {
        let found = self.is(role);
        self.at += usize::from(found);
        found
    }

    pub(crate) fn skip_while(&mut self, roles: Roles) {
        self.at = self.next_not_in(self.at, roles);
    }

    /// The first place from `at` on whose word has none of the roles.
    pub(crate) fn next_not_in(&self, mut at: usize, roles: Roles) -> usize {
        while self.roles_at(at).has_any(roles) {
            at += 1;
        }
        at
    }

    /// Forgets the last word.
    pub(crate) fn drop_last(&mut self) {
        self.tokens = self.tokens.split_last().map_or(&[], |(_, others)| others);
    }

    pub(crate) fn checkpoint(&self) -> Checkpoint {
        Checkpoint { at: self.at, issues: self.issues.len() }
    }

    pub(crate) fn rewind(&mut self, checkpoint: Checkpoint) {
        self.at = checkpoint.at;
        self.issues.truncate(checkpoint.issues);
    }

    /// Whether something of so many levels may stand inside another here: three levels for each that can still be read.
    pub(crate) fn has_room(&mut self, levels: usize) -> bool {
        let has_room = levels < 3 * (DEPTH_MAX - self.depth);
        if !has_room {
            self.too_deep = self.too_deep.or(Some(self.at));
        }
        has_room
    }

    /// Runs a reader one level deeper; nothing is read at the deepest level, which is reported in the end.
    pub(crate) fn nested<T: Default>(&mut self, read: impl FnOnce(&mut Self) -> T) -> T {
        if self.depth == DEPTH_MAX {
            self.too_deep = self.too_deep.or(Some(self.at));
            return T::default();
        }
        self.depth += 1;
        let found = read(self);
        self.depth -= 1;
        found
    }

    /// The bytes of the words from `start` to before `end`.
    pub(crate) fn span(&self, start: usize, end: usize) -> Span {
        let first = self.tokens.get(start).map_or(self.text.len(), |token| token.start);
        let last = self.tokens.get(end.wrapping_sub(1)).map_or(first, |token| token.end);
        Span { start: first, end: last.max(first) }
    }

    pub(crate) fn word(&self, at: usize) -> &'t str {
        let span = self.span(at, at + 1);
        &self.text[span.start..span.end]
    }

    /// An issue about the words from `start` to before `end`.
    pub(crate) fn report(&mut self, kind: IssueKind, start: usize, end: usize, message: String) {
        let issue = Issue::at(kind, self.span(start, end), message);
        self.push_issue(issue);
    }

    fn push_issue(&mut self, issue: Issue) {
        match (self.issues.len() >= ISSUES_MAX, self.issues.last_mut(), issue.span) {
            (true, Some(last), Some(new)) => {
                last.message = "too many words that were not understood".into();
                let span = last.span.unwrap_or(new);
                last.span =
                    Some(Span { start: span.start.min(new.start), end: new.end.max(span.end) });
            }
            _ => self.issues.push(issue),
        }
    }

    /// Steps over a word that fits nowhere, with an issue.
    pub(crate) fn report_unused(&mut self) {
        if self.is_end() {
            return;
        }
        let (at, entry) = (self.at, self.entry());
        self.at += 1;
        if let Some(unsupported) = &entry.unsupported {
            return self.report(
                IssueKind::NotInGraph,
                at,
                at + 1,
                format!("{unsupported} are not known here, not used"),
            );
        }
        let span = self.span(at, at + 1);
        if self.issues.len() >= ISSUES_MAX {
            return self.push_issue(Issue::at(IssueKind::UnknownWord, span, ""));
        }
        let word = self.word(at);
        if !entry.roles.has(Role::Unknown) {
            return self.report_misplaced(at);
        }
        let message = format!("unknown word {word:?}, not used");
        let issue = Issue::at(IssueKind::UnknownWord, span, message);
        self.push_issue(issue);
    }

    /// Steps over a word that names a thing that is not known, with an issue.
    pub(crate) fn report_unknown_noun(&mut self) {
        self.report_unused();
        if let Some(issue) = self.issues.last_mut() {
            issue.message = issue.message.replace(", not used", ", read as anything");
        }
    }

    /// Adds what was probably meant to the unknown words that stay reported; looking it up is slow.
    pub(crate) fn suggest(&mut self) {
        let unknown = self.issues.iter_mut().filter(|issue| issue.kind == IssueKind::UnknownWord);
        for issue in unknown.take(SUGGESTIONS_MAX) {
            let word = issue.span.and_then(|span| self.text.get(span.start..span.end));
            let known = word.and_then(suggest).map(Suggestion::word);
            issue.suggestion = known.filter(|known| word != Some(known)).map(str::to_owned);
        }
    }

    /// A known word that fits nowhere; one issue for all such words that follow each other.
    fn report_misplaced(&mut self, at: usize) {
        let mut span = self.span(at, at + 1);
        let before = self.span(at.wrapping_sub(1), at).end;
        let last = self.issues.last_mut().filter(|last| last.kind == IssueKind::MisplacedWord);
        let last = last.filter(|last| at > 0 && last.span.is_some_and(|s| s.end == before));
        if let Some(Span { start, .. }) = last.as_ref().and_then(|last| last.span) {
            span.start = start;
        }
        let words = self.text.get(span.start..span.end).filter(|w| w.len() <= QUOTED_MAX);
        let message = match words {
            Some(words) => format!("{words:?} fits nowhere here, not used"),
            None => "these words fit nowhere here, not used".into(),
        };
        match last {
            Some(last) => (last.span, last.message) = (Some(span), message),
            None => self.push_issue(Issue::at(IssueKind::MisplacedWord, span, message)),
        }
    }

    /// Steps over something that no scene graph holds, with an issue; false when the word at hand is known.
    pub(crate) fn eat_unsupported(&mut self) -> bool {
        let found = self.is(Role::Unsupported);
        if found {
            self.report_unused();
        }
        found
    }
}

/// Whether a word of the text is one that says something, not one that only joins.
pub(crate) fn has_known_word(text: &str) -> bool {
    const TELLING: Roles = Roles::of(&[
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
    tokens.iter().any(|token| token.roles.has_any(TELLING))
}

/// Whether there is a pronoun other than "his" of the benchmark's "his\her", which is the subject's.
fn has_pronouns(tokens: &[Token]) -> bool {
    const PRONOUNS: Roles = Roles::of(&[Role::His, Role::Him]);
    let all = tokens.iter().fold(Roles::default(), |all, token| all.and(token.roles));
    if !all.has_any(PRONOUNS) {
        return false;
    }
    let is_pronoun = |token: &Token| token.roles.has_any(PRONOUNS);
    let is_slash = |at: usize| tokens.get(at).is_some_and(|t| t.roles.has(Role::Slash));
    (0..tokens.len())
        .any(|at| is_pronoun(&tokens[at]) && !is_slash(at + 1) && !is_slash(at.wrapping_sub(1)))
}
