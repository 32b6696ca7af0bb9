//! Why a candidate was chosen or refused: every condition with what was found.

use jrdb_graph::BitSet;
use jrdb_types::answer::{CandidateTrace, Check, Measured, Unit};
use jrdb_types::query::{Interval, Order, Pick, RelationKind, Viewpoint};
use jrdb_types::vocab::PairWord;
use jrdb_types::{Condition, EntityId, Quantity, Related};

use crate::evaluate::{Column, Evaluated, Inner};
use crate::link::{Kinds, Link, Partner};
use crate::measure::{Comparison, in_order, unit};
use crate::searcher::{Searcher, is_distance};
use crate::value::{NOBODY, Truth, Value};
use crate::{attribute, found, measure, place, wording};

/// A pick, made: who is in which place of the order.
pub(crate) struct Picked<'q> {
    pub(crate) pick: &'q Pick,
    measures: Vec<Option<f64>>,
    order: Vec<usize>,
}

impl<'q> Picked<'q> {
    /// The order of those that the pick was made from.
    pub(crate) fn new(searcher: &Searcher<'_, '_>, pick: &'q Pick, from: &BitSet) -> Self {
        let measures = searcher.measures(&pick.measure);
        let order = in_order(from, &measures, pick.order);
        Self { pick, measures, order }
    }

    fn check(&self, number: usize, holds: bool) -> Check {
        let place = self.order.iter().position(|&other| other == number).map(|place| place + 1);
        let first = f64::from(self.pick.rank.max(1));
        let last = first + f64::from(self.pick.count) - 1.0;
        let value = self.measures.get(number).copied().flatten();
        let value = value.map(|value| found::number(value, unit(&self.pick.measure)));
        let place_found = place.map(|place| format!("number {place} of {}", self.order.len()));
        let words: Vec<String> = place_found.into_iter().chain(value).collect();
        Check {
            asked: wording::pick(self.pick),
            found: (!words.is_empty()).then(|| words.join(", ")),
            holds,
            probability: if holds { 1.0 } else { 0.0 },
            measured: place.map(|place| {
                place::measured(place as f64, Unit::Count, place::interval(first, last))
            }),
            ..Check::default()
        }
    }
}

impl Searcher<'_, '_> {
    /// The trace of one candidate.
    pub(crate) fn trace(
        &self,
        id: &EntityId,
        number: usize,
        evaluated: &Evaluated<'_>,
        picked: Option<&Picked<'_>>,
        selected: bool,
    ) -> CandidateTrace {
        let verdict = &evaluated.verdicts[number];
        let mut checks = self.checks(number, evaluated);
        checks.extend(picked.map(|picked| picked.check(number, selected)));
        CandidateTrace {
            id: id.clone(),
            selected,
            passed_attributes: verdict.passed_attributes,
            passed_relations: verdict.passed_relations,
            checks,
        }
    }

    /// Every condition of a pattern on one thing.
    pub(crate) fn checks(&self, number: usize, evaluated: &Evaluated<'_>) -> Vec<Check> {
        evaluated.columns.iter().map(|column| self.check(number, column)).collect()
    }

    fn check(&self, number: usize, column: &Column<'_>) -> Check {
        let value = column.values[number];
        let base = Check { asked: wording::asked(column.condition), ..of_value(&value) };
        match (column.condition, &column.inner) {
            (Condition::FromRobot(asked), _) => {
                let relation = self.index.node(number).and_then(|node| self.seen_by_robot(node));
                Check {
                    found: relation.and_then(|relation| found::place(asked, &relation)),
                    measured: relation.and_then(|r| place::measure(asked, &r, self.lateral())),
                    ..base
                }
            }
            (Condition::GroupSize(asked), _) => {
                let size = self.group_size(number);
                Check {
                    found: size.map(|size| format!("{size} together")),
                    measured: size.map(|size| counted(size as usize, *asked)),
                    ..base
                }
            }
            (Condition::Related(related), Inner::Relation { kinds, partner }) => {
                self.relation_check(number, related, kinds, partner, &value, base)
            }
            (Condition::Compared(compared), Inner::Comparison(comparison)) => {
                let unit = measure::unit(&compared.measure);
                self.comparison_check(number, comparison, unit, compared.order, base)
            }
            (_, Inner::Pattern(those)) => {
                let (found, parts) = (said(value.truth, "it is"), self.checks(number, those));
                Check { found, parts, ..base }
            }
            (_, Inner::Parts(parts)) => {
                let parts: Vec<Check> = parts.iter().map(|part| self.check(number, part)).collect();
                let mut found: Vec<String> =
                    parts.iter().filter_map(|part| part.found.clone()).collect();
                found.dedup();
                Check { found: (!found.is_empty()).then(|| found.join("; ")), parts, ..base }
            }
            (Condition::Attribute(asked), _) => {
                let known = self.index.node(number).map(|node| &node.attributes);
                let found = known.and_then(|k| wording::belief(k.belief(asked.attribute())));
                let measured = known.and_then(|known| attribute::balance(known, *asked));
                Check { found, measured, ..base }
            }
            _ => base,
        }
    }

    fn relation_check(
        &self,
        subject: usize,
        related: &Related,
        kinds: &Kinds<'_>,
        partner: &Partner<'_>,
        value: &Value,
        base: Check,
    ) -> Check {
        if let Partner::Robot(_) = partner {
            let mut parts = self.robot_checks(subject, kinds);
            let witnesses = parts.iter_mut().flat_map(|part| std::mem::take(&mut part.witnesses));
            let witnesses = witnesses.collect();
            let (found, measured) = (joined(&parts), only_measure(&parts));
            return Check { found, measured, witnesses, parts, ..base };
        }
        if value.witness == NOBODY {
            return base;
        }
        let witness = value.witness as usize;
        let mut between = kinds.between().iter();
        let mut witnesses: Vec<EntityId> = self.index.id(witness).into_iter().cloned().collect();
        let mut parts = Vec::new();
        for kind in kinds.asked {
            let part = match kind {
                RelationKind::Between(_) => {
                    let others = between.next();
                    others.map(|others| self.between_check(subject, Some(witness), kind, others))
                }
                _ => Some(self.kind_check(subject, witness, kind, kinds)),
            };
            parts.extend(part);
        }
        witnesses.extend(parts.iter_mut().flat_map(|part| std::mem::take(&mut part.witnesses)));
        let (found, measured) = (joined(&parts), only_measure(&parts));
        if let Partner::Things { evaluated: Some(evaluated), .. } = partner {
            parts.extend(self.checks(witness, evaluated));
        }
        let plain = related.quantity == Quantity::SOME;
        let measured = if plain { measured } else { None };
        Check { found, measured, witnesses, parts, ..base }
    }

    /// One relation between a subject and its witness.
    fn kind_check(
        &self,
        subject: usize,
        partner: usize,
        kind: &RelationKind,
        kinds: &Kinds<'_>,
    ) -> Check {
        let name = self.index.id(partner).map(EntityId::short).unwrap_or_default();
        let base = Check { asked: wording::kind(kind, &name), ..Check::default() };
        match kind {
            RelationKind::Placed { place: asked, viewpoint } => {
                let from_robot = *viewpoint == Viewpoint::Robot && !is_distance(asked);
                let (relation, view) = if from_robot {
                    (self.beside(subject, partner, asked).map(|(r, _)| r), self.robot_view())
                } else {
                    (self.edge_for(subject, partner, kinds, *viewpoint), self.person_view())
                };
                let Some(relation) = relation else { return base };
                Check {
                    found: found::place(asked, &relation),
                    holds: place::truth(asked, &relation).holds(),
                    probability: place::probability(asked, &relation, &view),
                    measured: place::measure(asked, &relation, self.lateral()),
                    ..base
                }
            }
            RelationKind::Pair(word) => {
                let link = Link::certain(self.word(subject, partner, *word));
                Check { found: said(link.truth, word.word()), ..of_link(link, base) }
            }
            RelationKind::Interaction(label) => {
                let deeds: Vec<&str> = self.deeds(subject, partner).collect();
                let link = Link::of(deeds.contains(&label.as_str()));
                Check {
                    found: (!deeds.is_empty()).then(|| deeds.join(", ")),
                    ..of_link(link, base)
                }
            }
            RelationKind::With => of_link(Link::certain(self.with_truth(subject, partner)), base),
            RelationKind::Between(_) => base,
        }
    }

    fn between_check(
        &self,
        subject: usize,
        partner: Option<usize>,
        kind: &RelationKind,
        others: &Partner<'_>,
    ) -> Check {
        let name = partner.and_then(|partner| self.index.id(partner));
        let name = name.map_or_else(|| "the robot".into(), EntityId::short);
        let base = Check { asked: wording::kind(kind, &name), ..Check::default() };
        let links = self.between_links(subject, partner, others);
        let links = links.filter(|(_, link)| link.probability > 0.0 || link.truth.holds());
        let best = links.reduce(|best, next| if next.1.beats(best.1) { next } else { best });
        let Some((other, link)) = best else { return base };
        let aside_m = self.aside_m(subject, partner, other);
        let bounds = Interval { min: None, max: Some(self.config.between_max_offset_m) };
        let other = other.and_then(|other| self.index.id(other)).cloned();
        let end = other.as_ref().map_or_else(|| "the robot".into(), EntityId::short);
        Check {
            found: Some(format!("between {name} and {end}")),
            measured: aside_m.map(|metres| place::measured(metres, Unit::Metres, bounds)),
            witnesses: other.into_iter().collect(),
            ..of_link(link, base)
        }
    }

    /// Every relation between a subject and the robot.
    fn robot_checks(&self, subject: usize, kinds: &Kinds<'_>) -> Vec<Check> {
        let mut between = kinds.between().iter();
        let mut check = |kind: &RelationKind| match kind {
            RelationKind::Between(_) => between.next().map_or_else(Check::default, |others| {
                self.between_check(subject, None, kind, others)
            }),
            _ => self.robot_check(subject, kind),
        };
        kinds.asked.iter().map(&mut check).collect()
    }

    /// One relation between a subject and the robot.
    fn robot_check(&self, subject: usize, kind: &RelationKind) -> Check {
        let base = Check { asked: wording::kind(kind, "the robot"), ..Check::default() };
        let Some(node) = self.index.node(subject) else { return base };
        match kind {
            RelationKind::Placed { place: asked, viewpoint } => {
                let looks = *viewpoint == Viewpoint::Subject;
                let Some((relation, link)) = self.robot_place(node, asked, looks) else {
                    return base;
                };
                Check {
                    found: found::place(asked, &relation),
                    measured: place::measure(asked, &relation, self.lateral()),
                    ..of_link(link, base)
                }
            }
            RelationKind::Pair(word) => {
                let link = self.robot_word(node, *word);
                let ahead = self.ahead();
                let robot = self.robot_place(node, &ahead, true).map(|(relation, _)| relation);
                let robot = robot.filter(|_| *word == PairWord::Facing);
                let angle = robot.and_then(|relation| found::direction(&relation));
                let found = angle.map(|angle| format!("the robot at {angle}"));
                Check {
                    found: found.or_else(|| said(link.truth, word.word())),
                    measured: robot.and_then(|r| place::measure(&ahead, &r, self.lateral())),
                    ..of_link(link, base)
                }
            }
            RelationKind::With => of_link(self.robot_word(node, PairWord::Adjacent), base),
            RelationKind::Interaction(_) | RelationKind::Between(_) => base,
        }
    }

    fn comparison_check(
        &self,
        number: usize,
        comparison: &Comparison,
        unit: Unit,
        order: Order,
        base: Check,
    ) -> Check {
        let Some(mine) = comparison.measures[number] else { return base };
        let hardest = comparison.hardest(number);
        let bounds = hardest.map(|(_, theirs)| match order {
            Order::Least => Interval { min: None, max: Some(theirs) },
            Order::Most => Interval { min: Some(theirs), max: None },
        });
        let theirs = hardest.map(|(_, theirs)| format!(" against {}", found::number(theirs, unit)));
        Check {
            found: Some(format!("{}{}", found::number(mine, unit), theirs.unwrap_or_default())),
            measured: bounds.map(|bounds| place::measured(mine, unit, bounds)),
            witnesses: hardest.and_then(|(n, _)| self.index.id(n)).into_iter().cloned().collect(),
            ..base
        }
    }
}

/// What holds in words, or that it does not; nothing where that is unknown.
fn said(truth: Truth, words: &str) -> Option<String> {
    match truth {
        Truth::Yes => Some(words.into()),
        Truth::No => Some("no".into()),
        Truth::Unknown => None,
    }
}

fn of_value(value: &Value) -> Check {
    let (holds, probability) = (value.truth.holds(), value.probability);
    Check { holds, probability, ..Check::default() }
}

fn of_link(link: Link, base: Check) -> Check {
    Check { holds: link.truth.holds(), probability: link.probability, ..base }
}

fn joined(parts: &[Check]) -> Option<String> {
    let found: Vec<&str> = parts.iter().filter_map(|part| part.found.as_deref()).collect();
    (!found.is_empty()).then(|| found.join("; "))
}

/// The number of a relation that consists of one measured part.
fn only_measure(parts: &[Check]) -> Option<Measured> {
    let mut measured = parts.iter().filter_map(|part| part.measured);
    let first = measured.next();
    first.filter(|_| measured.next().is_none())
}

fn counted(number: usize, asked: Quantity) -> Measured {
    let most = asked.at_most.map_or(f64::INFINITY, f64::from);
    place::measured(number as f64, Unit::Count, place::interval(f64::from(asked.at_least), most))
}
