//! What a question asks for and the graph cannot give.

use std::collections::BTreeSet;

use jrdb_types::issue::IssueKind;
use jrdb_types::query::{Category, Measure, Place, RelationKind, Viewpoint};
use jrdb_types::vocab::PairWord;
use jrdb_types::{
    Attribute, Condition, EdgeRelation, Issue, Node, Pattern, Query, SpatialRelation, Task,
};

use crate::candidates::candidates;
use crate::searcher::{Searcher, measured_pattern};

/// What is missing, each thing once, in alphabetical order.
pub(crate) fn of(searcher: &Searcher<'_, '_>, query: &Query) -> Vec<Issue> {
    let mut missing = Missing { searcher, found: BTreeSet::new() };
    missing.kind(&query.target.category);
    missing.pattern(&query.target);
    if let Task::CompareCounts { than, .. } = &query.task {
        missing.pattern(than);
    }
    query.slots.iter().flat_map(|slot| &slot.conditions).for_each(|c| missing.condition(c));
    let issue =
        |what| Issue::new(IssueKind::NotInGraph, format!("the scene graph holds no {what}"));
    missing.found.into_iter().map(issue).collect()
}

struct Missing<'s, 'i, 'a> {
    searcher: &'s Searcher<'i, 'a>,
    found: BTreeSet<String>,
}

impl Missing<'_, '_, '_> {
    fn kind(&mut self, category: &Category) {
        if candidates(self.searcher, &Pattern::of(category.clone())).is_empty() {
            let things = match category {
                Category::Person => "people",
                Category::Object => "objects",
                Category::Anything => "things",
                Category::Class(name) => name,
                Category::Robot => "robot",
            };
            self.found.insert(things.into());
        }
    }

    /// Of an empty graph nothing more need be said.
    fn need(&mut self, what: &str, has: impl Fn(&Node) -> bool) {
        let mut nodes = self.searcher.index.nodes();
        if nodes.next().is_some() && !self.searcher.index.nodes().any(|(_, node)| has(node)) {
            self.found.insert(what.into());
        }
    }

    fn need_edge(&mut self, what: &str, has: impl Fn(&EdgeRelation) -> bool) {
        let scene = self.searcher.index.scene();
        if !scene.nodes.is_empty() && !scene.edges.iter().any(|edge| has(&edge.relation)) {
            self.found.insert(what.into());
        }
    }

    /// Things of a partner's kind are missing only where perception cannot see them: else there are none.
    fn partner(&mut self, pattern: &Pattern) {
        if !self.searcher.sees.sees_category(&pattern.category) {
            self.kind(&pattern.category);
        }
        self.pattern(pattern);
    }

    fn pattern(&mut self, pattern: &Pattern) {
        pattern.conditions.iter().for_each(|condition| self.condition(condition));
        if let Some(pick) = &pattern.pick {
            self.measure(&pick.measure);
        }
    }

    fn condition(&mut self, condition: &Condition) {
        match condition {
            Condition::Attribute(value) => self.attribute(value.attribute()),
            Condition::FromRobot(place) => self.place(place),
            Condition::GroupSize(_) => {
                let index = self.searcher.index;
                if (0..index.node_count()).all(|n| self.searcher.group_size(n).is_none()) {
                    self.need("groups", |_| false);
                }
            }
            Condition::Related(related) => {
                related.kinds.iter().for_each(|kind| self.relation(kind, &related.partner));
                self.partner(&related.partner);
            }
            Condition::Compared(compared) => {
                self.measure(&compared.measure);
                self.partner(&compared.than);
            }
            Condition::Measures(measured) => self.measure(&measured.measure),
            Condition::Nearer(nearer) => {
                self.partner(&nearer.to);
                self.partner(&nearer.than);
            }
            Condition::Looks(_) | Condition::Id(_) | Condition::Phrase(_) => {}
            Condition::Is(pattern) => self.pattern(pattern),
            Condition::Not(inner) => self.condition(inner),
            Condition::Any(parts) | Condition::All(parts) => {
                parts.iter().for_each(|part| self.condition(part));
            }
        }
    }

    fn attribute(&mut self, attribute: Attribute) {
        let is_known = |node: &Node| !node.attributes.belief(attribute).is_unknown();
        self.need(attribute.row().plural, is_known);
    }

    fn place(&mut self, place: &Place) {
        let searcher = self.searcher;
        let knows = |node: &Node, has: fn(&SpatialRelation) -> bool| {
            searcher.seen_by_robot(node).is_some_and(|relation| has(&relation))
        };
        match place {
            Place::Distance(_) => {
                self.need("distances from the robot", |n| knows(n, |r| r.distance.is_some()));
            }
            Place::Direction(_) => {
                self.need("directions from the robot", |n| knows(n, |r| r.direction.is_some()));
            }
            Place::Metres(_) => {
                self.need("distances from the robot in metres", |n| {
                    knows(n, |r| r.distance_m.is_some())
                });
            }
            Place::Degrees { .. } => {
                self.need("directions from the robot in degrees", |n| {
                    knows(n, |r| r.bearing_rad.is_some())
                });
            }
        }
    }

    fn relation(&mut self, kind: &RelationKind, partner: &Pattern) {
        let with_robot = partner.category == Category::Robot;
        match kind {
            RelationKind::Placed { place, viewpoint } if with_robot => match place {
                Place::Direction(_) | Place::Degrees { .. } if *viewpoint == Viewpoint::Subject => {
                    self.need("headings", |node| node.heading_rad.is_some());
                }
                place => self.place(place),
            },
            RelationKind::Pair(PairWord::Facing | PairWord::FacingEachOther) if with_robot => {
                self.need("headings", |node| node.heading_rad.is_some());
            }
            RelationKind::Pair(PairWord::Adjacent) | RelationKind::With if with_robot => {
                self.place(&Place::Metres(jrdb_types::query::Interval::default()));
            }
            RelationKind::Pair(word) if with_robot => {
                self.found.insert(format!("word {:?} of anything and the robot", word.word()));
            }
            RelationKind::Placed { place, viewpoint } => self.placed(place, *viewpoint),
            RelationKind::Pair(word) => {
                let is_word =
                    |r: &EdgeRelation| matches!(r, EdgeRelation::Pair { word: w, .. } if w == word);
                let has_any =
                    |r: &EdgeRelation| matches!(r, EdgeRelation::Pair { .. }) || is_word(r);
                match word {
                    PairWord::SameDirection => {
                        self.need("velocities", |n| n.velocity_mps.is_some());
                    }
                    PairWord::Facing | PairWord::FacingEachOther => {
                        self.need_edge("headings", |r| {
                            is_word(r)
                                || matches!(r, EdgeRelation::Spatial(s) if s.direction.is_some())
                        });
                    }
                    _ => self.need_edge("words of pairs such as \"next to\"", has_any),
                }
            }
            RelationKind::Interaction(_) => {
                self.need_edge("interactions", |r| matches!(r, EdgeRelation::Interaction { .. }));
            }
            RelationKind::With => self
                .need_edge("interactions, and nothing next to anything", |r| {
                    !matches!(r, EdgeRelation::Spatial(_))
                }),
            RelationKind::Between(other) => {
                self.need("positions", |_| true);
                self.pattern(other);
            }
        }
    }

    fn placed(&mut self, place: &Place, viewpoint: Viewpoint) {
        let has = |of: fn(&SpatialRelation) -> bool| move |r: &EdgeRelation| matches!(r, EdgeRelation::Spatial(s) if of(s));
        match place {
            Place::Direction(_) | Place::Degrees { .. } if viewpoint == Viewpoint::Robot => {
                self.need("positions", |node| node.center.is_some());
            }
            Place::Direction(_) => self.need_edge("headings", has(|s| s.direction.is_some())),
            Place::Degrees { .. } => {
                self.need_edge("directions in degrees", has(|s| s.bearing_rad.is_some()));
            }
            Place::Distance(_) => self.need_edge("distances", has(|s| s.distance.is_some())),
            Place::Metres(_) => {
                self.need_edge("distances in metres", has(|s| s.distance_m.is_some()));
            }
        }
    }

    fn measure(&mut self, measure: &Measure) {
        match measure {
            Measure::Height => self.need("heights", |node| node.height_m.is_some()),
            Measure::Age => self.attribute(Attribute::Age),
            Measure::Speed => self.need("velocities", |node| node.velocity_mps.is_some()),
            Measure::FromLeft => self.place(&Place::Degrees { center: 0.0, half_width: 0.0 }),
            Measure::DistanceTo(_) => {
                if self.searcher.measures(measure).iter().all(Option::is_none) {
                    self.need("distances in metres", |_| false);
                }
            }
        }
        if let Some(pattern) = measured_pattern(measure) {
            self.pattern(pattern);
        }
    }
}
