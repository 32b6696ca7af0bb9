//! The oracle on relations: who is related to whom, and how sure that is.

use jrdb_types::query::{Category, Place, Viewpoint};
use jrdb_types::vocab::PairWord;
use jrdb_types::*;

use super::{Partner, Truth, World, all, any, counted, is_distance, placed, seen};

impl World<'_> {
    pub(super) fn related(&self, thing: usize, related: &Related) -> Truth {
        let link = |partner| {
            all(related.kinds.iter().map(|kind| self.kind(thing, partner, kind, &related.kinds)))
        };
        let truths: Vec<Truth> = if related.partner.category == Category::Robot {
            vec![if related.partner.conditions.is_empty() { link(None) } else { Some(false) }]
        } else {
            let held = self.matches(&related.partner);
            let those = self.others(thing).filter(|other| held[*other] != Some(false));
            those.map(|other| all([held[other], link(Some(other))].into_iter())).collect()
        };
        let sure = truths.iter().filter(|truth| **truth == Some(true)).count();
        let perhaps = truths.iter().filter(|truth| truth.is_none()).count();
        counted(related.quantity, sure, sure + perhaps)
    }

    /// Whether the graph tells a thing's place in any way.
    fn has_place(&self, thing: usize) -> bool {
        let told = |node: &Node| node.center.is_some() || node.from_robot.is_some();
        self.node(thing).is_some_and(told)
            || self.others(thing).any(|other| {
                !self.spatial(thing, other).is_empty() || !self.spatial(other, thing).is_empty()
            })
    }

    /// What no edge says does not hold, of a thing with a place.
    fn unsaid(&self, thing: usize) -> Truth {
        self.has_place(thing).then_some(false)
    }

    fn kind(
        &self,
        thing: usize,
        partner: Partner,
        kind: &RelationKind,
        kinds: &[RelationKind],
    ) -> Truth {
        match (kind, partner) {
            (RelationKind::Placed { place, viewpoint }, Some(other)) => match viewpoint {
                Viewpoint::Robot if !is_distance(place) => self.beside(thing, other, place),
                Viewpoint::Partner => self.on_one_edge(other, thing, thing, kinds, true),
                _ => self.on_one_edge(thing, other, thing, kinds, false),
            },
            (RelationKind::Placed { place, viewpoint }, None) => {
                let looks = *viewpoint == Viewpoint::Subject && !is_distance(place);
                placed(place, &if looks { self.robot_from(thing)? } else { self.by_robot(thing)? })
            }
            (RelationKind::Pair(word), Some(other)) => self.word(thing, other, *word),
            (RelationKind::Pair(word), None) => self.robot_word(thing, *word),
            (RelationKind::Interaction(label), Some(other)) => Some(self.does(thing, other, label)),
            (RelationKind::Interaction(_), None) => Some(false),
            (RelationKind::With, Some(other)) => {
                let deed =
                    |a, b| self.edges(a, b).any(|r| matches!(r, EdgeRelation::Interaction { .. }));
                let together = deed(thing, other) || deed(other, thing);
                if together { Some(true) } else { self.word(thing, other, PairWord::Adjacent) }
            }
            (RelationKind::With, None) => self.robot_word(thing, PairWord::Adjacent),
            (RelationKind::Between(far), _) => self.between(thing, partner, far),
        }
    }

    /// All places of a phrase that are told by edges one way, of one edge. A distance may be on the edge the other way.
    fn on_one_edge(
        &self,
        from: usize,
        to: usize,
        subject: usize,
        kinds: &[RelationKind],
        by_partner: bool,
    ) -> Truth {
        let places: Vec<&Place> = kinds
            .iter()
            .filter_map(|kind| match kind {
                RelationKind::Placed { place, viewpoint } => match viewpoint {
                    Viewpoint::Robot if !is_distance(place) => None,
                    viewpoint => {
                        ((*viewpoint == Viewpoint::Partner) == by_partner).then_some(place)
                    }
                },
                _ => None,
            })
            .collect();
        let mut edges = self.spatial(from, to);
        if edges.is_empty() && places.iter().all(|place| is_distance(place)) {
            edges = self.spatial(to, from);
        }
        if edges.is_empty() {
            return self.unsaid(subject);
        }
        any(edges.iter().map(|edge| all(places.iter().map(|place| placed(place, edge)))))
    }

    fn beside(&self, thing: usize, other: usize, asked: &Place) -> Truth {
        let [x, y, z] = self.node(thing)?.center?;
        let Some([a, b, c]) = self.node(other).and_then(|node| node.center) else {
            return Some(false);
        };
        // Turned so that the robot looks at the partner along x; ahead for the partner is towards the robot.
        let angle = b.atan2(a);
        let (x, y) = (x - a, y - b);
        let (away, left) = (x * angle.cos() + y * angle.sin(), y * angle.cos() - x * angle.sin());
        placed(asked, &seen(-away, left, z - c))
    }

    fn word(&self, thing: usize, other: usize, asked: PairWord) -> Truth {
        let turned = match asked {
            PairWord::Hides => PairWord::HiddenBy,
            PairWord::HiddenBy => PairWord::Hides,
            same => same,
        };
        let says = |a, b, asked| {
            self.edges(a, b).any(|r| matches!(r, EdgeRelation::Pair { word, .. } if *word == asked))
        };
        if says(thing, other, asked) || (asked != PairWord::Facing && says(other, thing, turned)) {
            return Some(true);
        }
        if self.edges(thing, other).chain(self.edges(other, thing)).next().is_none() {
            return self.unsaid(thing);
        }
        let heads = |thing| self.node(thing).is_some_and(|node| node.heading_rad.is_some());
        let moves = |thing| self.node(thing).is_some_and(|node| node.velocity_mps.is_some());
        let is_known = match asked {
            PairWord::Facing => heads(thing),
            PairWord::FacingEachOther => heads(thing) && heads(other),
            PairWord::SameDirection => moves(thing) && moves(other),
            _ => true,
        };
        if is_known { self.unsaid(thing) } else { None }
    }

    fn robot_word(&self, thing: usize, word: PairWord) -> Truth {
        let half_width = self.config.facing_half_angle_deg;
        let ahead = Place::Degrees { center: 0.0, half_width };
        let looks = || placed(&ahead, &self.robot_from(thing)?);
        match word {
            PairWord::Facing => looks(),
            PairWord::FacingEachOther => {
                let back = self.by_robot(thing).and_then(|found| placed(&ahead, &found));
                all([looks(), back].into_iter())
            }
            PairWord::Adjacent => Some(self.by_robot(thing)?.distance_m? <= self.config.close_m),
            _ => None,
        }
    }

    fn does(&self, thing: usize, other: usize, asked: &str) -> bool {
        let mut relations = self.edges(thing, other);
        relations.any(|r| matches!(r, EdgeRelation::Interaction { label } if label == asked))
    }

    fn between(&self, thing: usize, partner: Partner, far: &Pattern) -> Truth {
        let far_is_robot = far.category == Category::Robot;
        match partner {
            None if far_is_robot => Some(false),
            None => {
                let held = self.matches(far);
                let those = self.others(thing).filter(|other| self.node(*other).is_some());
                any(those
                    .map(|other| all([held[other], self.before_robot(thing, other)].into_iter())))
            }
            Some(other) if far_is_robot => {
                if far.conditions.is_empty() {
                    self.before_robot(thing, other)
                } else {
                    Some(false)
                }
            }
            Some(other) => {
                let (middle, end) = (self.things[thing].0, self.things[other].0);
                let entries = self.graph.between.iter().filter(|entry| entry.middle == *middle);
                let ends = entries.filter_map(|entry| match &entry.ends {
                    [a, b] if a == end => Some(b),
                    [a, b] if b == end => Some(a),
                    _ => None,
                });
                let ends: Vec<&EntityId> = ends.collect();
                if ends.is_empty() {
                    return self.unsaid(thing);
                }
                let held = self.matches(far);
                let found = |id: &EntityId| self.things.iter().position(|(other, _)| *other == id);
                any(ends.into_iter().map(|id| found(id).map_or(Some(false), |place| held[place])))
            }
        }
    }

    /// Whether something is between the robot and another.
    fn before_robot(&self, thing: usize, other: usize) -> Truth {
        let [x, y, _] = self.node(thing)?.center?;
        let Some([a, b, _]) = self.node(other).and_then(|node| node.center) else {
            return Some(false);
        };
        let (range, angle) = ((a * a + b * b).sqrt(), b.atan2(a));
        let along = x * angle.cos() + y * angle.sin();
        let off = (y * angle.cos() - x * angle.sin()).abs();
        let inside = self.config.between_min_inside_m;
        let is_inside = along >= inside && range - along >= inside;
        Some(is_inside && off <= self.config.between_max_offset_m)
    }
}
