//! The robot as a partner: at the origin of the base frame, facing along x.

use jrdb_types::query::Place;
use jrdb_types::vocab::PairWord;
use jrdb_types::{Node, SpatialRelation};

use crate::evaluation::{Kinds, Link};
use crate::geometry::robot_seen_by;
use crate::place::{self, is_distance};
use crate::searcher::Searcher;

impl Searcher<'_, '_> {
    /// All the relations between a subject and the robot.
    pub(crate) fn robot_link(&self, subject: usize, kinds: &Kinds<'_>) -> Link {
        if kinds.has_labels() {
            return Link::NONE;
        }
        let Some(node) = self.index.node(subject) else { return Link::UNKNOWN };
        let mut link = Link::SURE;
        for (asked, subject_looks) in kinds.places() {
            let found = self.robot_place(node, asked, subject_looks);
            link = link.and(found.map_or(Link::UNKNOWN, |(_, link)| link));
        }
        for &word in kinds.words() {
            link = link.and(self.robot_word(node, word));
        }
        if kinds.is_with() {
            link = link.and(self.robot_word(node, PairWord::Adjacent));
        }
        for others in kinds.between() {
            link = link.and(self.between(subject, None, others));
        }
        self.link_of_place(link)
    }

    /// Where the robot is for the subject, or the subject for the robot.
    pub(crate) fn robot_place(
        &self,
        node: &Node,
        asked: &Place,
        subject_looks: bool,
    ) -> Option<(SpatialRelation, Link)> {
        let (found, observer) = if subject_looks && !is_distance(asked) {
            let found = robot_seen_by(node.center?, node.heading_rad?, self.lateral());
            (found, self.person_observer())
        } else {
            (self.seen_by_robot(node)?, self.robot_observer())
        };
        let probability = place::probability(asked, &found, &observer);
        Some((found, Link { truth: place::truth(asked, &found), probability }))
    }

    /// Where the robot is for somebody who faces it.
    pub(crate) fn ahead(&self) -> Place {
        Place::Degrees { center: 0.0, half_width: self.config.facing_half_angle_deg }
    }

    /// Facing the robot has no limit of range; next to it is close to it. Of the other words nothing is known.
    pub(crate) fn robot_word(&self, node: &Node, word: PairWord) -> Link {
        let ahead = self.ahead();
        let place = |asked: &Place, subject_looks| {
            self.robot_place(node, asked, subject_looks).map_or(Link::UNKNOWN, |(_, link)| link)
        };
        match word {
            PairWord::Facing => place(&ahead, true),
            PairWord::FacingEachOther => place(&ahead, true).and(place(&ahead, false)),
            PairWord::Adjacent => {
                let near = place::interval(f64::NEG_INFINITY, self.config.close_m);
                place(&Place::Metres(near), false)
            }
            PairWord::Overlapping
            | PairWord::Hides
            | PairWord::HiddenBy
            | PairWord::SameDirection => Link::UNKNOWN,
        }
    }
}
