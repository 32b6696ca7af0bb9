//! Why a candidate was chosen or refused: every condition with what was found.

use std::sync::Arc;

use jrdb_graph::BitSet;
use jrdb_types::answer::{
    self, CandidateTrace, Check, Criterion, DirectionFound, DistanceFound, Finding, Measured, Unit,
};
use jrdb_types::query::{Interval, Order, Pick, Place, RelationKind, Viewpoint};
use jrdb_types::vocab::PairWord;
use jrdb_types::{Condition, EntityId, Quantity, Related, SpatialRelation};

use crate::evaluation::{Column, Comparison, Evaluated, Inner, Kinds, Link, Partner};
use crate::measure::{in_order, unit};
use crate::place::is_distance;
use crate::searcher::Searcher;
use crate::value::{NOBODY, Truth, Value};
use crate::{attribute, measure, place};

/// A pick, made: who is in which place of the order.
pub(crate) struct Picked<'q> {
    pub(crate) pick: &'q Pick,
    /// The pick for the traces, which share it.
    shared: Arc<Pick>,
    measures: Vec<Option<f64>>,
    order: Vec<usize>,
}

impl<'q> Picked<'q> {
    /// The order of those that the pick was made from.
    pub(crate) fn new(searcher: &Searcher<'_, '_>, pick: &'q Pick, from: &BitSet) -> Self {
        let measures = searcher.measures(&pick.measure);
        let order = in_order(from, &measures, pick.order);
        Self { pick, shared: Arc::new(pick.clone()), measures, order }
    }

    fn check(&self, number: usize, holds: bool) -> Check {
        let place = self.order.iter().position(|&other| other == number).map(|place| place + 1);
        let first = f64::from(self.pick.rank.max(1));
        let last = first + f64::from(self.pick.count) - 1.0;
        let value = self.measures.get(number).copied().flatten();
        let (count, unit) = (self.order.len(), unit(&self.pick.measure));
        let is_known = place.is_some() || value.is_some();
        Check {
            criterion: Criterion::Pick(Arc::clone(&self.shared)),
            finding: is_known.then_some(Finding::Order { place, count, value, unit }),
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
        let base = Check { criterion: column.criterion(), ..of_value(&value) };
        match (column.condition, &column.inner) {
            (Condition::FromRobot(asked), _) => {
                let relation = self.index.node(number).and_then(|node| self.seen_by_robot(node));
                Check {
                    finding: relation.and_then(|relation| place_found(asked, &relation)),
                    measured: relation.and_then(|r| place::measure(asked, &r, self.lateral())),
                    ..base
                }
            }
            (Condition::GroupSize(asked), _) => {
                let size = self.group_size(number);
                Check {
                    finding: size.map(Finding::Group),
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
                Check { finding: holds(value.truth), parts: self.checks(number, those), ..base }
            }
            (_, Inner::Parts(parts)) => {
                let parts = parts.iter().map(|part| self.check(number, part)).collect();
                Check { parts, ..base }
            }
            (Condition::Attribute(asked), _) => {
                let known = self.index.node(number).map(|node| &node.attributes);
                let finding = known.and_then(|known| attribute::finding(known, asked.attribute()));
                let measured = known.and_then(|known| attribute::balance(known, *asked));
                Check { finding, measured, ..base }
            }
            (Condition::Looks(phrase), _) => {
                Check { finding: self.said(number, &phrase.words), ..base }
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
            return Check { measured: only_measure(&parts), witnesses, parts, ..base };
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
        let measured = only_measure(&parts);
        if let Partner::Things { evaluated: Some(evaluated), .. } = partner {
            parts.extend(self.checks(witness, evaluated));
        }
        let plain = related.quantity == Quantity::SOME;
        let measured = if plain { measured } else { None };
        Check { measured, witnesses, parts, ..base }
    }

    /// One relation between a subject and its witness.
    fn kind_check(
        &self,
        subject: usize,
        partner: usize,
        kind: &RelationKind,
        kinds: &Kinds<'_>,
    ) -> Check {
        let base = self.relation_base(kind, Some(partner));
        match kind {
            RelationKind::Placed { place: asked, viewpoint } => {
                let from_robot = *viewpoint == Viewpoint::Robot && !is_distance(asked);
                let (relation, observer) = if from_robot {
                    (self.beside(subject, partner, asked).map(|(r, _)| r), self.robot_observer())
                } else {
                    (self.edge_for(subject, partner, kinds, *viewpoint), self.person_observer())
                };
                let Some(relation) = relation else { return Check { unknown: true, ..base } };
                let truth = self.of_place(place::truth(asked, &relation));
                let probability = place::probability(asked, &relation, &observer);
                Check {
                    finding: place_found(asked, &relation),
                    measured: place::measure(asked, &relation, self.lateral()),
                    ..of_link(Link { truth, probability }, base)
                }
            }
            RelationKind::Pair(word) => {
                let link = Link::certain(self.word(subject, partner, *word));
                Check { finding: holds(link.truth), ..of_link(link, base) }
            }
            RelationKind::Interaction(label) => {
                let labels: Vec<String> =
                    self.interactions(subject, partner).map(Into::into).collect();
                let is_stated = labels.contains(label);
                let link = Link::certain(self.of_interaction(label, is_stated));
                Check {
                    finding: (!labels.is_empty()).then_some(Finding::Interactions(labels)),
                    ..of_link(link, base)
                }
            }
            RelationKind::With => of_link(Link::certain(self.with_truth(subject, partner)), base),
            RelationKind::Between(_) => base,
        }
    }

    /// A check of one relation with a partner, or with the robot where there is none, before anything is found.
    fn relation_base(&self, kind: &RelationKind, partner: Option<usize>) -> Check {
        let criterion = Criterion::Relation { kind: kind.clone(), partner: self.named(partner) };
        Check { criterion, ..Check::default() }
    }

    /// A thing by its id, or the robot where there is none.
    fn named(&self, number: Option<usize>) -> answer::Partner {
        let id = number.and_then(|number| self.index.id(number));
        id.map_or(answer::Partner::Robot, |id| answer::Partner::Thing(id.clone()))
    }

    fn between_check(
        &self,
        subject: usize,
        partner: Option<usize>,
        kind: &RelationKind,
        others: &Partner<'_>,
    ) -> Check {
        let base = self.relation_base(kind, partner);
        let links = self.between_links(subject, partner, others);
        let links = links.filter(|(_, link)| link.probability > 0.0 || link.truth.holds());
        let best = links.reduce(|best, next| if next.1.beats(best.1) { next } else { best });
        let Some((other, link)) = best else { return base };
        let aside_m = self.aside_m(subject, partner, other);
        let bounds = Interval { min: None, max: Some(self.config.between_max_offset_m) };
        let ends = [partner, other].map(|end| self.named(end));
        let other = other.and_then(|other| self.index.id(other)).cloned();
        Check {
            finding: Some(Finding::Between(ends)),
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
        let base = self.relation_base(kind, None);
        let Some(node) = self.index.node(subject) else { return base };
        match kind {
            RelationKind::Placed { place: asked, viewpoint } => {
                let looks = *viewpoint == Viewpoint::Subject;
                let Some((relation, link)) = self.robot_place(node, asked, looks) else {
                    return base;
                };
                Check {
                    finding: place_found(asked, &relation),
                    measured: place::measure(asked, &relation, self.lateral()),
                    ..of_link(link, base)
                }
            }
            RelationKind::Pair(word) => {
                let link = self.robot_word(node, *word);
                let ahead = self.ahead();
                let robot = self.robot_place(node, &ahead, true).map(|(relation, _)| relation);
                let robot = robot.filter(|_| *word == PairWord::Facing);
                let direction = robot.and_then(|relation| DirectionFound::of(&relation));
                Check {
                    finding: direction.map(Finding::RobotIn).or_else(|| holds(link.truth)),
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
        let other = hardest.map(|(_, theirs)| theirs);
        Check {
            finding: Some(Finding::Comparison { own: mine, other, unit }),
            measured: bounds.map(|bounds| place::measured(mine, unit, bounds)),
            witnesses: hardest.and_then(|(n, _)| self.index.id(n)).into_iter().cloned().collect(),
            ..base
        }
    }
}

/// Whether something holds; nothing where that is unknown.
fn holds(truth: Truth) -> Option<Finding> {
    match truth {
        Truth::Yes => Some(Finding::Holds(true)),
        Truth::No => Some(Finding::Holds(false)),
        Truth::Unknown => None,
    }
}

/// What a place is, as far as it answers what was asked: distances for distances, directions for directions.
fn place_found(asked: &Place, relation: &SpatialRelation) -> Option<Finding> {
    match asked {
        Place::Distance(_) | Place::Metres(_) => DistanceFound::of(relation).map(Finding::Distance),
        Place::Direction(_) | Place::Degrees { .. } => {
            DirectionFound::of(relation).map(Finding::Direction)
        }
    }
}

fn of_value(value: &Value) -> Check {
    let (holds, unknown) = (value.truth.holds(), value.truth == Truth::Unknown);
    Check { holds, unknown, probability: value.probability, ..Check::default() }
}

fn of_link(link: Link, base: Check) -> Check {
    let (holds, unknown) = (link.truth.holds(), link.truth == Truth::Unknown);
    Check { holds, unknown, probability: link.probability, ..base }
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
