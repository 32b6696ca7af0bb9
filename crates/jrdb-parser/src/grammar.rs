//! From tokens to a query, by recursive descent. Nothing fails: what is not understood becomes an
//! issue, and reading goes on behind it.
//!
//! ```text
//! question  = { filler } [ task ] thing clauses ;
//! thing     = { the } { attribute | action | "," | "and" } [ noun ] ;
//! clauses   = { "who" | "is" | "has" | "with" | "located" | "," | "and" | action | doing | place | other } ;
//! doing     = ( interaction | action ) "with" thing ;
//! place     = { prep | the | distance | direction | "relative" } [ anchor ] ;
//! anchor    = robot | his | ( "of" | "to" | "from" ) thing [ "who" clauses ] ;
//! other     = thing place ;             (* "a woman located to his right" *)
//! ```

use jrdb_types::issue::IssueKind;
use jrdb_types::query::{Category, RelationKind, RelationPattern, Viewpoint};
use jrdb_types::vocab::{Elevation, Sector};
use jrdb_types::{Condition, Direction, DistanceWord, Issue, Pattern, Query, Span, Task};

use crate::cursor::{Parser, action, attribute, interaction, noun, task};
use crate::lexicon::{Sense, Word};
use crate::token::{Kind, Token, tokenize};

/// Words between clauses that say nothing by themselves.
const GLUE: [Word; 7] =
    [Word::Who, Word::Is, Word::Has, Word::With, Word::Located, Word::And, Word::Filler];

/// How deep "left of a man who is left of a man who …" may go; deeper clauses are not understood.
const DEPTH_MAX: usize = 32;

/// Reads an English question.
///
/// Never fails and never drops a word in silence: words that are not understood are issues with their
/// bytes and, where one is near, the word that was probably meant.
///
/// Two readings that English leaves open are decided: a place without an anchor ("on the left", "close") is told
/// from the robot, and "left of the woman" is the woman's own left, with an issue that says so.
///
/// ```
/// let query = jrdb_parser::parse("Find the young women close to me");
/// assert_eq!(query.target.conditions.len(), 3);
/// assert!(query.issues.is_empty());
/// ```
#[must_use]
pub fn parse(text: &str) -> Query {
    let mut parser = Parser { tokens: tokenize(text), at: 0, issues: Vec::new() };
    let mut query = Query { text: text.into(), ..Query::default() };
    query.task = parser.task();
    parser.thing(&mut query.target);
    parser.clauses(&mut query.target, 0);
    if parser.tokens.is_empty() {
        parser.issues.push(Issue::new(IssueKind::UnknownWord, "the question has no words"));
    }
    query.issues = parser.issues;
    query
}

/// Where something is said to be.
#[derive(Default)]
struct Place {
    distance: Option<DistanceWord>,
    sector: Option<Sector>,
    elevation: Option<Elevation>,
    anchor: Anchor,
    /// Where the sector stands.
    span: Option<Span>,
}

/// From where a place is told.
#[derive(Default, PartialEq)]
enum Anchor {
    #[default]
    Unsaid,
    Robot,
    /// "his", "her": from the person spoken of.
    Him,
    Thing(Pattern),
}

impl Place {
    fn direction(&self) -> Option<Direction> {
        let elevation = self.elevation.unwrap_or(Elevation::Level);
        self.sector.map(|sector| Direction { sector, elevation })
    }

    fn is_empty(&self) -> bool {
        self.distance.is_none() && self.sector.is_none() && self.anchor == Anchor::Unsaid
    }

    fn relation(&self, viewpoint: Viewpoint, partner: Pattern) -> Condition {
        let (distance, direction) = (self.distance, self.direction());
        let kind = RelationKind::Spatial { distance, direction, viewpoint };
        Condition::Relation(RelationPattern { kind, partner })
    }
}

impl Parser {
    fn task(&mut self) -> Task {
        self.skip(&[Word::Filler, Word::Who, Word::Is]);
        let asked = self.take(task);
        self.skip(&[Word::Filler, Word::Who]);
        asked.unwrap_or_default()
    }

    /// Reads a noun phrase into a pattern; false when there is none at hand.
    fn thing(&mut self, pattern: &mut Pattern) -> bool {
        let start = self.at;
        self.skip(&[Word::The, Word::Filler]);
        let mut is_thing = false;
        loop {
            let separator = self.at;
            while is_thing && (self.is_comma() || self.is(Word::And)) {
                self.at += 1;
            }
            if let Some(noun) = self.sense(noun) {
                self.describe(pattern);
                pattern.category = noun;
                return true;
            }
            let is_adjective = self.sense(attribute).is_some() || self.is_action_before_noun();
            if !is_adjective {
                self.at = if is_thing { separator } else { start };
                return is_thing;
            }
            self.describe(pattern);
            is_thing = true;
        }
    }

    /// Adds what the token at hand says of a thing, and steps over it.
    fn describe(&mut self, pattern: &mut Pattern) {
        let senses = self.peek().map_or(&[][..], Token::senses);
        pattern.conditions.extend(senses.iter().filter_map(attribute));
        pattern.conditions.extend(senses.iter().filter_map(action).map(Condition::Action));
        self.at += 1;
    }

    /// "seated" in "the seated person".
    fn is_action_before_noun(&self) -> bool {
        let mut rest = self.tokens[self.at..].iter();
        let is_action = |t: &Token| t.senses().iter().any(|s| action(s).is_some());
        let is_attribute = |t: &Token| t.senses().iter().any(|s| attribute(s).is_some());
        rest.next().is_some_and(is_action)
            && rest
                .find(|t| !is_attribute(t))
                .is_some_and(|t| t.senses().iter().any(|s| noun(s).is_some()))
    }

    /// Reads what is said of a thing behind its noun, to the end of the question.
    fn clauses(&mut self, pattern: &mut Pattern, depth: usize) {
        while self.at < self.tokens.len() {
            let start = self.at;
            self.skip(&GLUE);
            self.at += usize::from(self.is_comma());
            let is_glue = self.at > start;
            if !is_glue && !self.clause(pattern, depth) {
                self.report_unknown();
            }
        }
    }

    fn clause(&mut self, pattern: &mut Pattern, depth: usize) -> bool {
        let is_read =
            self.doing(pattern) || self.placed(pattern, depth) || self.other(pattern, depth);
        // An article before nothing says nothing.
        let is_article = !is_read && self.is(Word::The);
        self.at += usize::from(is_article);
        is_read || is_article
    }

    /// "walking", "walking with a woman", "chatting with a man".
    fn doing(&mut self, pattern: &mut Pattern) -> bool {
        let with_someone =
            self.tokens.get(self.at + 1).is_some_and(|next| next.is_word(Word::With));
        let label = self.sense(interaction);
        let done = self.sense(action);
        if with_someone && (label.is_some() || done.is_some()) {
            self.at += 2;
            let together = || done.map(|action| format!("{action} together")).unwrap_or_default();
            let label = label.unwrap_or_else(together);
            let mut partner = Pattern::default();
            self.thing(&mut partner);
            let kind = RelationKind::Interaction { label };
            pattern.conditions.push(Condition::Relation(RelationPattern { kind, partner }));
            return true;
        }
        self.at += usize::from(done.is_some());
        pattern.conditions.extend(done.map(Condition::Action));
        done.is_some()
    }

    /// "close to me", "to the left of a child", "at a far distance".
    fn placed(&mut self, pattern: &mut Pattern, depth: usize) -> bool {
        let start = self.at;
        let place = self.place(depth);
        if place.is_empty() {
            self.at = start;
            return false;
        }
        self.put(place, pattern);
        true
    }

    fn put(&mut self, mut place: Place, pattern: &mut Pattern) {
        match std::mem::take(&mut place.anchor) {
            Anchor::Thing(partner) => {
                self.report_viewpoint(&place);
                pattern.conditions.push(place.relation(Viewpoint::Partner, partner));
            }
            Anchor::Unsaid | Anchor::Robot | Anchor::Him => {
                pattern.conditions.extend(place.distance.map(Condition::RobotDistance));
                pattern.conditions.extend(place.direction().map(Condition::RobotDirection));
            }
        }
    }

    /// "a woman located to his right at a close distance": another thing and where it is; a noun phrase
    /// without a place describes the thing spoken of.
    fn other(&mut self, pattern: &mut Pattern, depth: usize) -> bool {
        let start = self.at;
        let mut partner = Pattern::default();
        if !self.thing(&mut partner) {
            return false;
        }
        let end = self.at;
        self.skip(&[Word::Who, Word::Is, Word::Located]);
        let place = self.place(depth);
        if place.anchor == Anchor::Him {
            pattern.conditions.push(place.relation(Viewpoint::Subject, partner));
            return true;
        }
        if partner.category == Category::Person || partner.category == pattern.category {
            pattern.conditions.append(&mut partner.conditions);
        } else {
            // A person is no table: what joins the two was not understood.
            self.report_unused(start, end);
        }
        self.put(place, pattern);
        true
    }

    fn place(&mut self, depth: usize) -> Place {
        let mut place = Place::default();
        loop {
            let before = self.at;
            self.place_word(&mut place, depth);
            if self.at == before {
                break;
            }
        }
        place
    }

    /// One step through the words of a place; stays where it is at the end of them.
    fn place_word(&mut self, place: &mut Place, depth: usize) {
        let is_anchor = self.is(Word::Of);
        if self.is(Word::Robot) {
            self.at += 1;
            place.anchor = Anchor::Robot;
        } else if self.is(Word::His) {
            self.pronoun();
            place.anchor = Anchor::Him;
        } else if self.place_value(place) {
            if is_anchor {
                self.anchor(place, depth);
            }
        } else if [Word::Of, Word::Prep, Word::Relative].iter().any(|w| self.is(*w)) {
            self.at += 1;
            self.anchor(place, depth);
        } else if self.is(Word::Distance)
            || self.is(Word::The) && self.follows(&[Word::The], |p| p.is(Word::Robot).then_some(()))
            || (self.is(Word::The) || self.is(Word::And))
                && self.follows(&[Word::The, Word::And, Word::Prep], |p| p.sense(is_place_word))
        {
            self.at += 1;
        }
    }

    /// Takes a distance, sector or elevation.
    fn place_value(&mut self, place: &mut Place) -> bool {
        let elevation = self.sense(|s| if let Sense::Elevation(e) = s { Some(*e) } else { None });
        let distance = self.sense(|s| if let Sense::Distance(d) = s { Some(*d) } else { None });
        let sector = self.sense(|s| if let Sense::Sector(s) = s { Some(*s) } else { None });
        let found = elevation.is_some() || distance.is_some() || sector.is_some();
        place.elevation = elevation.or(place.elevation);
        place.distance = distance.or(place.distance);
        place.sector = sector.or(place.sector);
        place.span =
            self.peek().filter(|_| sector.is_some()).map(|token| token.span).or(place.span);
        self.at += usize::from(found);
        found
    }

    /// "his", "his\her", "his/her".
    fn pronoun(&mut self) {
        self.at += 1;
        while self.peek().is_some_and(|token| token.kind == Kind::Slash) {
            self.at += 1;
            self.skip(&[Word::His]);
        }
    }

    /// The thing behind "of", "to" or "from", with what is said of it.
    fn anchor(&mut self, place: &mut Place, depth: usize) {
        let is_robot = self.follows(&[Word::The], |p| p.is(Word::Robot).then_some(()));
        let is_value =
            self.follows(&[Word::The, Word::Relative, Word::Prep], |p| p.sense(is_place_word));
        if is_robot {
            self.skip(&[Word::The]);
        }
        if is_robot || is_value || place.anchor != Anchor::Unsaid || depth >= DEPTH_MAX {
            return;
        }
        let mut partner = Pattern::default();
        if !self.thing(&mut partner) && !self.unknown_thing() {
            return;
        }
        if self.sense(action).is_some() {
            self.doing(&mut partner);
        }
        if self.is(Word::Who) {
            self.clauses(&mut partner, depth + 1);
        }
        place.anchor = Anchor::Thing(partner);
    }

    /// Steps over "a zebra" with an issue: something that we do not know, but not the robot.
    fn unknown_thing(&mut self) -> bool {
        let start = self.at;
        self.skip(&[Word::The]);
        let is_unknown = self.peek().is_some_and(|token| matches!(token.kind, Kind::Unknown(_)));
        if is_unknown {
            self.report_unknown();
        } else {
            self.at = start;
        }
        is_unknown
    }

    fn report_viewpoint(&mut self, place: &Place) {
        let is_sided = place.sector.is_some_and(|sector| sector != sector.mirrored());
        if let (true, Some(span), Some(sector)) = (is_sided, place.span, place.sector) {
            let message = format!("read as that person's own {sector}, not as seen from the robot");
            self.issues.push(Issue::at(IssueKind::Ambiguous, span, message));
        }
    }
}

fn is_place_word(sense: &Sense) -> Option<()> {
    let is_value = matches!(sense, Sense::Distance(_) | Sense::Sector(_) | Sense::Elevation(_));
    (is_value || *sense == Sense::Word(Word::Distance)).then_some(())
}
