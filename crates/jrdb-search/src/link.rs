//! What the graph says of a pair, against the relations that are asked.

use jrdb_types::query::{Place, Viewpoint};
use jrdb_types::vocab::PairWord;
use jrdb_types::{EdgeRelation, Node, SpatialRelation};

use crate::evaluation::{Kinds, Link, Partner};
use crate::geometry::beside;
use crate::place::{self, is_distance};
use crate::searcher::Searcher;
use crate::value::{Truth, UNBOUNDED};

impl Searcher<'_, '_> {
    /// Numbers of things that may stand in the relations to a subject, ascending.
    pub(crate) fn possible_partners(
        &self,
        subject: usize,
        kinds: &Kinds<'_>,
        found: &mut Vec<u32>,
    ) {
        found.clear();
        if kinds.is_local() {
            found.extend_from_slice(self.index.outgoing(subject).others);
            found.extend_from_slice(self.index.incoming(subject).others);
            found.sort_unstable();
            found.dedup();
        } else {
            found.extend((0..self.index.size() as u32).filter(|&other| other as usize != subject));
        }
    }

    /// How many things that are not on an edge of the subject may be its partners all the same: where nothing tells its place,
    /// everything that it need not do something with.
    pub(crate) fn unseen_partners(
        &self,
        subject: usize,
        kinds: &Kinds<'_>,
        partner: &Partner<'_>,
        neighbors: &[u32],
    ) -> usize {
        if partner.may_be_unseen() || kinds.between.iter().any(Partner::may_be_unseen) {
            return UNBOUNDED;
        }
        if !kinds.is_local() || kinds.has_labels() || self.has_place(subject) {
            return 0;
        }
        let others = (0..self.index.size())
            .filter(|&other| other != subject && neighbors.binary_search(&(other as u32)).is_err());
        others.filter(|&other| partner.truth(other) != Truth::No).count()
    }

    /// All the relations between a subject and one partner.
    pub(crate) fn link(&self, subject: usize, partner: usize, kinds: &Kinds<'_>) -> Link {
        self.spatial_link(subject, partner, kinds).and(self.stated_link(subject, partner, kinds))
    }

    /// The relations that are about interactions.
    fn stated_link(&self, subject: usize, partner: usize, kinds: &Kinds<'_>) -> Link {
        kinds.labels.iter().fold(Link::SURE, |link, label| {
            let is_stated = self.does(subject, partner, label);
            link.and(Link::certain(self.of_interaction(label, is_stated)))
        })
    }

    /// The relations that are about places.
    fn spatial_link(&self, subject: usize, partner: usize, kinds: &Kinds<'_>) -> Link {
        let mut link = Link::SURE;
        for (places, outward) in [(&kinds.outward, true), (&kinds.inward, false)] {
            if !places.is_empty() {
                let best = self.best_edge(subject, partner, places, outward);
                link = link.and(best.map_or_else(|| self.unsaid(subject), |(_, link)| link));
            }
        }
        for place in &kinds.beside {
            let beside = self.beside(subject, partner, place);
            link = link.and(beside.map_or_else(|| self.unplaced(subject), |(_, link)| link));
        }
        for &word in &kinds.words {
            link = link.and(Link::certain(self.word(subject, partner, word)));
        }
        if kinds.with {
            link = link.and(Link::certain(self.with_truth(subject, partner)));
        }
        for others in &kinds.between {
            link = link.and(self.between(subject, Some(partner), others));
        }
        self.link_of_place(link)
    }

    /// Of what no edge says: it does not hold of a thing with a place, as graphs may leave out what is far.
    pub(crate) fn unsaid(&self, subject: usize) -> Link {
        if self.has_place(subject) { Link::NONE } else { Link::UNKNOWN }
    }

    /// Of what the centres do not tell: things without one are nowhere, but of a subject without one nothing is known.
    pub(crate) fn unplaced(&self, subject: usize) -> Link {
        if self.center(subject).is_some() { Link::NONE } else { Link::UNKNOWN }
    }

    /// The edge that fits best. A distance is the same both ways: it may be on either edge.
    pub(crate) fn best_edge(
        &self,
        subject: usize,
        partner: usize,
        places: &[Place],
        outward: bool,
    ) -> Option<(SpatialRelation, Link)> {
        let rows = [self.index.outgoing(subject), self.index.incoming(subject)];
        let [own, other] = if outward { rows } else { [rows[1], rows[0]] };
        let observer = self.person_observer();
        let best = |row| {
            let edges = self.index.spatial(row).map(|relation| {
                let links = places.iter().map(|asked| Link {
                    truth: place::truth(asked, relation),
                    probability: place::probability(asked, relation, &observer),
                });
                (*relation, links.fold(Link::SURE, Link::and))
            });
            edges.reduce(|best, next| if next.1.beats(best.1) { next } else { best })
        };
        let only_distances = places.iter().all(is_distance);
        best(own.with(partner as u32))
            .or_else(|| only_distances.then(|| best(other.with(partner as u32))).flatten())
    }

    /// The edge that states a place of the pair: the one that fits all places with the same viewpoint.
    pub(crate) fn edge_for(
        &self,
        subject: usize,
        partner: usize,
        kinds: &Kinds<'_>,
        viewpoint: Viewpoint,
    ) -> Option<SpatialRelation> {
        let outward = viewpoint != Viewpoint::Partner;
        let places = if outward { &kinds.outward } else { &kinds.inward };
        self.best_edge(subject, partner, places, outward).map(|(relation, _)| relation)
    }

    /// Where the subject is beside the partner as the robot sees both.
    pub(crate) fn beside(
        &self,
        subject: usize,
        partner: usize,
        asked: &Place,
    ) -> Option<(SpatialRelation, Link)> {
        let found = beside(self.center(subject)?, self.center(partner)?, self.lateral());
        let probability = place::probability(asked, &found, &self.robot_observer());
        Some((found, Link { truth: place::truth(asked, &found), probability }))
    }

    /// Whether a word is on the edge, or the word that says the same of the pair turned round.
    pub(crate) fn has_word(&self, subject: usize, partner: usize, asked: PairWord) -> bool {
        let says = |edges: &[u32], asked: PairWord| {
            let mut relations = edges.iter().map(|&edge| self.index.relation(edge));
            relations.any(|r| matches!(r, EdgeRelation::Pair { word, .. } if *word == asked))
        };
        let turned = match asked {
            PairWord::Hides => Some(PairWord::HiddenBy),
            PairWord::HiddenBy => Some(PairWord::Hides),
            PairWord::Facing => None,
            same => Some(same),
        };
        says(self.index.outgoing(subject).with(partner as u32).edges, asked)
            || turned.is_some_and(|turned| {
                says(self.index.incoming(subject).with(partner as u32).edges, turned)
            })
    }

    /// Whether a word holds. The words of headings and motions say nothing of a pair with an edge whose headings or motions are unknown.
    pub(crate) fn word(&self, subject: usize, partner: usize, asked: PairWord) -> Truth {
        if self.has_word(subject, partner, asked) {
            return Truth::Yes;
        }
        let both = |is_known: fn(&Node) -> bool| {
            [subject, partner].map(|number| self.index.node(number).is_some_and(is_known))
        };
        let [own, other] = match asked {
            PairWord::Facing => [both(|node| node.heading_rad.is_some())[0], true],
            PairWord::FacingEachOther => both(|node| node.heading_rad.is_some()),
            PairWord::SameDirection => both(|node| node.velocity_mps.is_some()),
            _ => [true; 2],
        };
        let rows = [self.index.outgoing(subject), self.index.incoming(subject)];
        let has_edge = rows.iter().any(|row| !row.with(partner as u32).edges.is_empty());
        if has_edge && !(own && other) { Truth::Unknown } else { self.unsaid(subject).truth }
    }

    fn does(&self, subject: usize, partner: usize, asked: &str) -> bool {
        self.interactions(subject, partner).any(|label| label == asked)
    }

    /// What the subject does with the partner.
    pub(crate) fn interactions(
        &self,
        subject: usize,
        partner: usize,
    ) -> impl Iterator<Item = &str> {
        let edges = self.index.outgoing(subject).with(partner as u32).edges;
        edges.iter().filter_map(|&edge| match self.index.relation(edge) {
            EdgeRelation::Interaction { label } => Some(label.as_str()),
            _ => None,
        })
    }

    /// Whether they do anything together, whoever does it with whom, or are next to each other.
    pub(crate) fn with_truth(&self, subject: usize, partner: usize) -> Truth {
        let both = [(subject, partner), (partner, subject)];
        if both.into_iter().any(|(a, b)| self.interactions(a, b).next().is_some()) {
            return Truth::Yes;
        }
        self.word(subject, partner, PairWord::Adjacent)
    }
}
