//! Why a question is open: words, perception, sensors and labels.

use std::collections::BTreeSet;

use jrdb_graph::BitSet;
use jrdb_types::answer::{Cause, CauseKind, Reply};
use jrdb_types::query::{Category, Measure, Pick, Property, RelationKind};
use jrdb_types::{
    Attribute, Condition, IssueKind, Node, Pattern, Place, Query, Related, Span, Task,
};

use crate::searcher::{Searcher, measured_pattern};

/// So many things are named in one cause.
const NAMED_MAX: usize = 5;

/// The causes, sorted. `perhaps` are the candidates of which it is not known whether they are meant.
pub(crate) fn of(
    searcher: &Searcher<'_, '_>,
    query: &Query,
    perhaps: &BitSet,
    reply: &Reply,
) -> Vec<Cause> {
    let mut causes = Causes { searcher, found: BTreeSet::new() };
    causes.pattern(&query.target, Some(perhaps));
    match &query.task {
        Task::CompareCounts { than: other, .. } | Task::From { partner: other, .. } => {
            causes.pattern(other, None);
        }
        Task::Each { asked: conditions, .. } | Task::Choice { options: conditions } => {
            conditions.iter().for_each(|condition| causes.condition(condition, None));
        }
        _ => {}
    }
    let slots = query.slots.iter().flat_map(|slot| &slot.conditions);
    slots.for_each(|condition| causes.condition(condition, Some(perhaps)));
    causes.told(query, reply);
    causes.words(query);
    causes.inputs();
    if causes.found.is_empty() {
        causes.add(CauseKind::Perception, "what is known of the scene does not decide it".into());
    }
    causes.found.into_iter().collect()
}

struct Causes<'s, 'i, 'a> {
    searcher: &'s Searcher<'i, 'a>,
    found: BTreeSet<Cause>,
}

impl Causes<'_, '_, '_> {
    fn add(&mut self, kind: CauseKind, message: String) {
        self.found.insert(Cause { kind, message, span: None });
    }

    fn word(&mut self, words: &str, span: Option<Span>) {
        let message = format!("{words:?} was not understood");
        self.found.insert(Cause { kind: CauseKind::Word, message, span });
    }

    fn looks(&mut self, words: &str, span: Option<Span>) {
        let message = format!("perception cannot tell whether somebody looks {words:?}");
        self.found.insert(Cause { kind: CauseKind::Perception, message, span });
    }

    /// What is wrong with the files of the frame.
    fn inputs(&mut self) {
        for issue in &self.searcher.index.scene().issues {
            match issue.kind {
                IssueKind::MissingInput => self.add(CauseKind::Sensor, issue.message.clone()),
                kind if kind.loses_input() => self.add(CauseKind::Label, issue.message.clone()),
                _ => {}
            }
        }
    }

    /// Words that are no condition: of a text of which nothing was understood.
    fn words(&mut self, query: &Query) {
        for issue in query.issues.iter().filter(|one| one.kind == IssueKind::NotUnderstood) {
            let message = issue.message.clone();
            self.found.insert(Cause { kind: CauseKind::Word, message, span: issue.span });
        }
    }

    fn told(&mut self, query: &Query, reply: &Reply) {
        let (Task::Which { properties, .. }, Reply::Properties(told)) = (&query.task, reply) else {
            return;
        };
        for &property in properties {
            let mut values = told.iter().filter(|one| one.property == Some(property));
            let is_told = values.any(|one| !one.values.is_empty());
            if !is_told && !self.searcher.could_be_told(property) {
                let what = match property {
                    Property::Attribute(attribute) => attribute.row().plural.into(),
                    other => other.name().replace('_', " "),
                };
                self.add(
                    CauseKind::Perception,
                    format!("{what}: nothing is known of those asked about"),
                );
            }
        }
    }

    fn pattern(&mut self, pattern: &Pattern, perhaps: Option<&BitSet>) {
        let sees_anything = self.searcher.sees.categories.any(|_| true);
        if sees_anything && !self.searcher.sees.sees_category(&pattern.category) {
            let what = match &pattern.category {
                Category::Person => "people".into(),
                Category::Object => "objects".into(),
                Category::Class(name) => format!("{name:?}"),
                Category::Anything | Category::Robot => "anything".into(),
            };
            let message = format!("perception does not detect {what}: finding none is no evidence");
            self.add(CauseKind::Perception, message);
        }
        pattern.conditions.iter().for_each(|condition| self.condition(condition, perhaps));
        if let Some(pick) = &pattern.pick {
            self.pick(pick, perhaps);
        }
    }

    fn pick(&mut self, pick: &Pick, perhaps: Option<&BitSet>) {
        self.measure(&pick.measure, perhaps);
    }

    fn measure(&mut self, measure: &Measure, perhaps: Option<&BitSet>) {
        match measure {
            Measure::Height => self.unknown_of(perhaps, "height", |n| n.height_m.is_some()),
            Measure::Speed => self.unknown_of(perhaps, "speed", |n| n.velocity_mps.is_some()),
            Measure::Age => self.attribute(Attribute::Age, perhaps),
            Measure::FromLeft | Measure::DistanceTo(_) => self.places(perhaps),
        }
        if let Some(pattern) = measured_pattern(measure) {
            self.pattern(pattern, None);
        }
    }

    fn condition(&mut self, condition: &Condition, perhaps: Option<&BitSet>) {
        match condition {
            Condition::Measures(measured) => self.measure(&measured.measure, perhaps),
            Condition::Nearer(nearer) => {
                self.places(perhaps);
                self.pattern(&nearer.to, None);
                self.pattern(&nearer.than, None);
            }
            Condition::Looks(phrase) => self.looks(&phrase.words, phrase.span),
            Condition::Id(_) => {}
            Condition::Phrase(phrase) => self.word(&phrase.words, phrase.span),
            Condition::Attribute(value) => self.attribute(value.attribute(), perhaps),
            Condition::FromRobot(_) => self.places(perhaps),
            Condition::GroupSize(_) => self.groups(perhaps),
            Condition::Related(related) => self.related(related, perhaps),
            Condition::Compared(compared) => {
                self.measure(&compared.measure, perhaps);
                self.pattern(&compared.than, None);
            }
            Condition::Is(pattern) => self.pattern(pattern, perhaps),
            Condition::Not(inner) => self.condition(inner, perhaps),
            Condition::Any(parts) => {
                let parts = self.searcher.alternatives(parts);
                parts.iter().for_each(|part| self.condition(part, perhaps));
            }
            Condition::All(parts) => {
                parts.iter().for_each(|part| self.condition(part, perhaps));
            }
        }
    }

    fn related(&mut self, related: &Related, perhaps: Option<&BitSet>) {
        for kind in &related.kinds {
            match kind {
                RelationKind::Interaction(label) if !self.searcher.sees.sees_interaction(label) => {
                    let message = format!("perception reports nothing about {label:?}");
                    self.add(CauseKind::Perception, message);
                }
                RelationKind::Between(other) => self.pattern(other, None),
                RelationKind::Placed {
                    place: Place::Direction(_) | Place::Degrees { .. }, ..
                }
                | RelationKind::Pair(_) => {
                    self.unknown_of(perhaps, "heading", |node| node.heading_rad.is_some());
                    self.places(perhaps);
                }
                _ => self.places(perhaps),
            }
        }
        self.pattern(&related.partner, None);
    }

    fn attribute(&mut self, attribute: Attribute, perhaps: Option<&BitSet>) {
        let plural = attribute.row().plural;
        if self.searcher.sees.sees_attribute(attribute) {
            let is_known = |node: &Node| !node.attributes.belief(attribute).is_unknown();
            self.unknown_of(perhaps, attribute.name(), is_known);
        } else {
            self.add(CauseKind::Perception, format!("perception reports no {plural}"));
        }
    }

    fn places(&mut self, perhaps: Option<&BitSet>) {
        self.unknown_of(perhaps, "place", |node| {
            node.from_robot.is_some() || node.center.is_some()
        });
    }

    fn groups(&mut self, perhaps: Option<&BitSet>) {
        let numbers = perhaps.map(|set| set.iter().collect::<Vec<_>>()).unwrap_or_default();
        if numbers.iter().any(|&n| self.searcher.group_size(n).is_none()) {
            self.add(CauseKind::Perception, "it is not known who belongs together".into());
        }
    }

    /// Names the candidates of which something is unknown.
    fn unknown_of(
        &mut self,
        perhaps: Option<&BitSet>,
        what: &str,
        is_known: impl Fn(&Node) -> bool,
    ) {
        let numbers = perhaps.map(|set| set.iter().collect::<Vec<_>>()).unwrap_or_default();
        let nodes = numbers.iter().filter_map(|&number| self.searcher.index.node(number));
        let unknown: Vec<&Node> = nodes.filter(|node| !is_known(node)).collect();
        if unknown.is_empty() {
            return;
        }
        let mut names: Vec<String> =
            unknown.iter().take(NAMED_MAX).map(|node| node.id.short()).collect();
        if unknown.len() > NAMED_MAX {
            names.push(format!("{} others", unknown.len() - NAMED_MAX));
        }
        let message = format!("the {} of {} is unknown", what.replace('_', " "), names.join(", "));
        self.add(CauseKind::Perception, message);
    }
}
