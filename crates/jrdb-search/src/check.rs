//! One candidate against one pattern: every condition checked, with its witness.

use jrdb_graph::{GraphIndex, Neighbor};
use jrdb_types::answer::Check;
use jrdb_types::detection::PERSON;
use jrdb_types::query::{Category, RelationKind, RelationPattern, Viewpoint};
use jrdb_types::vocab::MatchPolicy;
use jrdb_types::{
    Belief, Condition, EdgeRelation, EntityId, LateralConvention, Node, Pattern, SpatialRelation,
};

use crate::{SearchConfig, probability, wording};

/// What checking every condition of a pattern came to.
#[derive(Debug, Clone)]
pub(crate) struct Verdict {
    /// One check per condition, in their order.
    pub(crate) checks: Vec<Check>,
    /// Enough attributes hold (the paper's phase 1).
    pub(crate) passed_attributes: bool,
    /// Every relation has a witness (the paper's phase 2).
    pub(crate) passed_relations: bool,
    /// Conditions that hold, those of the witnesses included.
    pub(crate) satisfied: usize,
    /// Product of the probabilities of the conditions.
    pub(crate) probability: f64,
}

impl Verdict {
    pub(crate) fn passed(&self) -> bool {
        self.passed_attributes && self.passed_relations
    }
}

/// Where candidates are looked for, and how strictly.
pub(crate) struct Judge<'a> {
    pub(crate) index: GraphIndex<'a>,
    pub(crate) lateral: LateralConvention,
    pub(crate) config: &'a SearchConfig,
}

/// A candidate partner of a relation.
struct Witness<'a> {
    id: &'a EntityId,
    relation_holds: bool,
    relation_probability: f64,
    found: Option<String>,
    verdict: Verdict,
}

impl Witness<'_> {
    fn holds(&self) -> bool {
        self.relation_holds && self.verdict.passed()
    }

    fn satisfied(&self) -> usize {
        usize::from(self.relation_holds) + self.verdict.satisfied
    }

    fn probability(&self) -> f64 {
        self.relation_probability * self.verdict.probability
    }
}

/// Whether a thing is of the kind a pattern asks for.
pub(crate) fn is_of(category: &Category, node: &Node) -> bool {
    match category {
        Category::Person => node.category == PERSON,
        Category::Object => node.category != PERSON,
        Category::Class(name) => node.category == *name,
    }
}

impl Judge<'_> {
    /// Checks every condition of a pattern; of a thing without a node nothing is known.
    pub(crate) fn judge(&self, id: &EntityId, node: Option<&Node>, pattern: &Pattern) -> Verdict {
        let mut verdict = Verdict {
            checks: Vec::new(),
            passed_attributes: true,
            passed_relations: true,
            satisfied: 0,
            probability: 1.0,
        };
        let (mut attributes, mut attributes_held) = (0, 0);
        for condition in &pattern.conditions {
            let (check, satisfied) = self.check(id, node, condition);
            if matches!(condition, Condition::Relation(_)) {
                verdict.passed_relations &= check.holds;
            } else {
                attributes += 1;
                attributes_held += usize::from(check.holds);
            }
            verdict.satisfied += satisfied;
            verdict.probability *= check.probability;
            verdict.checks.push(check);
        }
        verdict.passed_attributes = match self.config.policy {
            MatchPolicy::Strict => attributes_held == attributes,
            MatchPolicy::Majority | MatchPolicy::Ranked => {
                attributes == 0 || 2 * attributes_held > attributes
            }
        };
        verdict
    }

    /// One condition, and how many conditions hold in it (a relation counts its partner's too).
    fn check(&self, id: &EntityId, node: Option<&Node>, condition: &Condition) -> (Check, usize) {
        let known = node.map(|n| &n.attributes);
        let check = match condition {
            Condition::Age(value) => {
                attribute(known.map(|a| &a.age), *value, jrdb_types::Age::ALL.len())
            }
            Condition::Gender(value) => {
                attribute(known.map(|a| &a.gender), *value, jrdb_types::Gender::ALL.len())
            }
            Condition::Race(value) => {
                attribute(known.map(|a| &a.race), *value, jrdb_types::Race::ALL.len())
            }
            Condition::Action(value) => {
                attribute(known.map(|a| &a.action), *value, jrdb_types::Action::ALL.len())
            }
            Condition::RobotDistance(value) => from_robot(
                node,
                wording::distance,
                |r| r.distance == Some(*value),
                |r| probability::of_distance(r, *value, self.config),
            ),
            Condition::RobotDirection(value) => from_robot(
                node,
                wording::direction,
                |r| r.direction == Some(*value),
                |r| probability::of_direction(r, *value, self.lateral, 0.0, self.config),
            ),
            Condition::Relation(relation) => {
                let (check, satisfied) = self.relation(id, relation);
                return (Check { asked: wording::asked(condition), ..check }, satisfied);
            }
        };
        let satisfied = usize::from(check.holds);
        (Check { asked: wording::asked(condition), ..check }, satisfied)
    }

    /// The best partner: one that holds before one that does not, then by conditions satisfied, then by
    /// probability, then by id.
    fn relation(&self, id: &EntityId, relation: &RelationPattern) -> (Check, usize) {
        let viewpoint = match &relation.kind {
            RelationKind::Spatial { viewpoint, .. } => *viewpoint,
            RelationKind::Interaction { .. } => Viewpoint::Subject,
        };
        let neighbors = match viewpoint {
            Viewpoint::Subject => self.index.outgoing(id),
            Viewpoint::Partner => self.index.incoming(id),
        };
        let witnesses = neighbors.iter().filter_map(|neighbor| self.witness(neighbor, relation));
        let rank = |w: &Witness<'_>| (w.holds(), w.satisfied());
        let best = witnesses.reduce(|best, next| {
            let order = rank(&next).cmp(&rank(&best));
            let order = order.then(next.probability().total_cmp(&best.probability()));
            if order.then_with(|| best.id.cmp(next.id)).is_gt() { next } else { best }
        });
        match best {
            None => (unknown(0.0), 0),
            Some(witness) => {
                let check = Check {
                    asked: String::new(),
                    found: witness.found.clone(),
                    holds: witness.holds(),
                    probability: witness.probability(),
                    witness: Some(witness.id.clone()),
                    witness_checks: witness.verdict.checks.clone(),
                };
                (check, witness.satisfied())
            }
        }
    }

    fn witness<'a>(
        &self,
        neighbor: &Neighbor<'a>,
        relation: &RelationPattern,
    ) -> Option<Witness<'a>> {
        let is_partner = match neighbor.node {
            Some(node) => is_of(&relation.partner.category, node),
            // The benchmark's graphs have edges to people it does not describe.
            None => relation.partner.category == Category::Person,
        };
        if !is_partner {
            return None;
        }
        let (relation_holds, relation_probability, found) =
            match (&relation.kind, neighbor.relation) {
                (
                    RelationKind::Interaction { label },
                    EdgeRelation::Interaction { label: found },
                ) => (label == found, if label == found { 1.0 } else { 0.0 }, Some(found.clone())),
                (RelationKind::Spatial { .. }, EdgeRelation::Spatial(found)) => {
                    let (holds, probability) = self.spatial(&relation.kind, found);
                    (holds, probability, wording::place(found))
                }
                _ => return None,
            };
        let verdict = self.judge(neighbor.id, neighbor.node, &relation.partner);
        Some(Witness { id: neighbor.id, relation_holds, relation_probability, found, verdict })
    }

    fn spatial(&self, asked: &RelationKind, found: &SpatialRelation) -> (bool, f64) {
        let RelationKind::Spatial { distance, direction, .. } = asked else { return (false, 0.0) };
        let far = distance.map(|word| {
            (found.distance == Some(word), probability::of_distance(found, word, self.config))
        });
        let aside = direction.map(|word| {
            let heading = self.config.heading_sigma_rad;
            let p = probability::of_direction(found, word, self.lateral, heading, self.config);
            (found.direction == Some(word), p)
        });
        let (far, aside) = (far.unwrap_or((true, 1.0)), aside.unwrap_or((true, 1.0)));
        (far.0 && aside.0, far.1 * aside.1)
    }
}

/// An attribute holds when the asked value is the most probable one; of an unknown attribute every value
/// is equally probable and none holds.
fn attribute<T: Ord + Copy + std::fmt::Display>(
    belief: Option<&Belief<T>>,
    asked: T,
    values: usize,
) -> Check {
    let ignorance = 1.0 / values as f64;
    match belief.filter(|b| !b.is_unknown()) {
        None => unknown(ignorance),
        Some(belief) => Check {
            found: wording::belief(belief),
            holds: belief.best() == Some(asked),
            probability: belief.probability(asked),
            ..unknown(0.0)
        },
    }
}

fn from_robot(
    node: Option<&Node>,
    found: impl Fn(&SpatialRelation) -> Option<String>,
    holds: impl Fn(&SpatialRelation) -> bool,
    probability: impl Fn(&SpatialRelation) -> f64,
) -> Check {
    match node.and_then(|n| n.from_robot.as_ref()) {
        None => unknown(0.0),
        Some(relation) => Check {
            found: found(relation),
            holds: holds(relation),
            probability: probability(relation),
            ..unknown(0.0)
        },
    }
}

fn unknown(probability: f64) -> Check {
    Check {
        asked: String::new(),
        found: None,
        holds: false,
        probability,
        witness: None,
        witness_checks: Vec::new(),
    }
}
