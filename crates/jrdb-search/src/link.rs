//! What the graph says of a pair, against the relations that are asked.

use jrdb_graph::BitSet;
use jrdb_types::query::{Place, RelationKind, Viewpoint};
use jrdb_types::vocab::PairWord;
use jrdb_types::{EdgeRelation, Pattern, SpatialRelation};

use crate::evaluate::Evaluated;
use crate::geometry::{along, beside};
use crate::place;
use crate::probability::{certainty, of_offset};
use crate::searcher::{Searcher, is_distance};

/// Which things may be a partner.
pub(crate) enum Partner<'q> {
    /// The robot; not if anything is asked of it.
    Robot(bool),
    /// Things that match a pattern; with their probabilities where these are wanted.
    Things { passed: BitSet, evaluated: Option<Box<Evaluated<'q>>> },
}

impl Partner<'_> {
    pub(crate) fn passed(&self, number: usize) -> bool {
        matches!(self, Self::Things { passed, .. } if passed.contains(number))
    }

    /// Probabilities that it matches: as believed, and for the ranking.
    pub(crate) fn probabilities(&self, number: usize) -> [f64; 2] {
        match self {
            Self::Things { evaluated: Some(evaluated), .. } => evaluated.probabilities(number),
            _ => [certainty(self.passed(number)); 2],
        }
    }
}

/// The relations asked of one pair, sorted by where the graph has them.
pub(crate) struct Kinds<'q> {
    pub(crate) asked: &'q [RelationKind],
    /// Where the partner is from the subject, and how far they are apart: of one edge.
    outward: Vec<Place>,
    /// Where the subject is from the partner: of one edge.
    inward: Vec<Place>,
    beside: Vec<Place>,
    words: Vec<PairWord>,
    labels: Vec<&'q str>,
    with: bool,
    between: Vec<Partner<'q>>,
}

/// Whether something holds of a pair, and how probable that is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Link {
    pub(crate) holds: bool,
    pub(crate) probability: f64,
}

impl Link {
    pub(crate) const SURE: Self = Self { holds: true, probability: 1.0 };
    pub(crate) const NONE: Self = Self { holds: false, probability: 0.0 };

    pub(crate) fn of(holds: bool) -> Self {
        if holds { Self::SURE } else { Self::NONE }
    }

    pub(crate) fn and(self, other: Self) -> Self {
        Self { holds: self.holds && other.holds, probability: self.probability * other.probability }
    }

    /// Whether it is the better one of two.
    fn beats(self, other: Self) -> bool {
        (self.holds, self.probability) > (other.holds, other.probability)
    }
}

impl<'q> Kinds<'q> {
    /// Sorts the kinds; `resolve` finds the other end of "between".
    pub(crate) fn new(
        asked: &'q [RelationKind],
        resolve: impl Fn(&'q Pattern) -> Partner<'q>,
    ) -> Self {
        let (outward, inward, beside) = (Vec::new(), Vec::new(), Vec::new());
        let (words, labels, between) = (Vec::new(), Vec::new(), Vec::new());
        let with = false;
        let mut kinds = Self { asked, outward, inward, beside, words, labels, with, between };
        for kind in asked {
            match kind {
                RelationKind::Placed { place, viewpoint } => match viewpoint {
                    Viewpoint::Partner => kinds.inward.push(*place),
                    Viewpoint::Robot if !is_distance(place) => kinds.beside.push(*place),
                    Viewpoint::Subject | Viewpoint::Robot => kinds.outward.push(*place),
                },
                RelationKind::Pair(word) => kinds.words.push(*word),
                RelationKind::Interaction(label) => kinds.labels.push(label),
                RelationKind::With => kinds.with = true,
                RelationKind::Between(pattern) => kinds.between.push(resolve(pattern)),
            }
        }
        kinds
    }

    /// Whether the relations are all on edges of the subject, so that only its neighbours can be partners.
    fn is_local(&self) -> bool {
        self.beside.is_empty() && self.between.is_empty()
    }

    pub(crate) fn between(&self) -> &[Partner<'q>] {
        &self.between
    }

    pub(crate) fn words(&self) -> &[PairWord] {
        &self.words
    }

    pub(crate) fn has_labels(&self) -> bool {
        !self.labels.is_empty()
    }

    pub(crate) fn is_with(&self) -> bool {
        self.with
    }

    /// Places with whether the subject is the one who looks.
    pub(crate) fn places(&self) -> impl Iterator<Item = (&Place, bool)> {
        let outward = self.outward.iter().map(|place| (place, true));
        outward.chain(self.inward.iter().chain(&self.beside).map(|place| (place, false)))
    }
}

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

    /// All the relations between a subject and one partner.
    pub(crate) fn link(&self, subject: usize, partner: usize, kinds: &Kinds<'_>) -> Link {
        let mut link = Link::SURE;
        for (places, outward) in [(&kinds.outward, true), (&kinds.inward, false)] {
            if !places.is_empty() {
                let best = self.best_edge(subject, partner, places, outward);
                link = link.and(best.map_or(Link::NONE, |(_, link)| link));
            }
        }
        for place in &kinds.beside {
            link = link.and(self.beside(subject, partner, place).map_or(Link::NONE, |(_, l)| l));
        }
        for &word in &kinds.words {
            link = link.and(Link::of(self.has_word(subject, partner, word)));
        }
        for label in &kinds.labels {
            link = link.and(Link::of(self.does(subject, partner, label)));
        }
        if kinds.with {
            link = link.and(Link::of(self.is_with(subject, partner)));
        }
        for others in &kinds.between {
            link = link.and(self.between(subject, Some(partner), others));
        }
        link
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
        let view = self.person_view();
        let best = |row| {
            let edges = self.index.spatial(row).map(|relation| {
                let links = places.iter().map(|asked| Link {
                    holds: place::truth(asked, relation).holds(),
                    probability: place::probability(asked, relation, &view),
                });
                (*relation, links.fold(Link::SURE, Link::and))
            });
            edges.reduce(|best, next| if next.1.beats(best.1) { next } else { best })
        };
        let only_distances = places.iter().all(is_distance);
        best(own.with(partner as u32))
            .or_else(|| only_distances.then(|| best(other.with(partner as u32))).flatten())
    }

    /// The edge that a place of the pair is told by: the one that fits all places with the same viewpoint.
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
        let probability = place::probability(asked, &found, &self.robot_view());
        Some((found, Link { holds: place::truth(asked, &found).holds(), probability }))
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

    fn does(&self, subject: usize, partner: usize, asked: &str) -> bool {
        self.deeds(subject, partner).any(|label| label == asked)
    }

    /// What the subject does with the partner.
    pub(crate) fn deeds(&self, subject: usize, partner: usize) -> impl Iterator<Item = &str> {
        let edges = self.index.outgoing(subject).with(partner as u32).edges;
        edges.iter().filter_map(|&edge| match self.index.relation(edge) {
            EdgeRelation::Interaction { label } => Some(label.as_str()),
            _ => None,
        })
    }

    /// Doing anything together, whoever does it with whom, or next to each other.
    pub(crate) fn is_with(&self, subject: usize, partner: usize) -> bool {
        self.deeds(subject, partner).next().is_some()
            || self.deeds(partner, subject).next().is_some()
            || self.has_word(subject, partner, PairWord::Adjacent)
    }

    /// Whether the subject is between a partner, or the robot where there is none, and one of the others.
    pub(crate) fn between(
        &self,
        subject: usize,
        partner: Option<usize>,
        others: &Partner<'_>,
    ) -> Link {
        let best = self.between_links(subject, partner, others).map(|(_, link)| link);
        best.reduce(|best, next| if next.beats(best) { next } else { best }).unwrap_or(Link::NONE)
    }

    /// The others that the subject is between, with the partner at the other end.
    pub(crate) fn between_links<'s>(
        &'s self,
        subject: usize,
        partner: Option<usize>,
        others: &'s Partner<'_>,
    ) -> Box<dyn Iterator<Item = (Option<usize>, Link)> + 's> {
        match (partner, others) {
            (None, Partner::Robot(_)) => Box::new(std::iter::empty()),
            (Some(other), Partner::Robot(is_free)) => {
                let link = self.between_robot_and(subject, other).filter(|_| *is_free);
                Box::new(link.map(|link| (None, link)).into_iter())
            }
            (None, Partner::Things { .. }) => {
                let things = (0..self.index.node_count()).filter(move |&other| other != subject);
                Box::new(things.filter_map(move |other| {
                    let link = self.between_robot_and(subject, other)?;
                    Some((Some(other), link.and(end(others, other))))
                }))
            }
            (Some(partner), Partner::Things { .. }) => {
                let entries = self.index.between(subject).filter_map(move |(ends, entry)| {
                    let other = match ends {
                        [a, b] if a == partner => b,
                        [a, b] if b == partner => a,
                        _ => return None,
                    };
                    let link = Link { holds: true, ..self.offset_link(entry.offset_m) };
                    Some((Some(other), link.and(end(others, other))))
                });
                Box::new(entries)
            }
        }
    }

    fn between_robot_and(&self, subject: usize, other: usize) -> Option<Link> {
        let (subject, other) = (self.center(subject)?, self.center(other)?);
        let (offset_m, _) = along(subject, [[0.0; 3], other], self.config.between_min_inside_m)?;
        Some(self.offset_link(offset_m))
    }

    fn offset_link(&self, offset_m: f64) -> Link {
        let max_m = self.config.between_max_offset_m;
        let probability = of_offset(offset_m, max_m, self.config.position_sigma_m);
        Link { holds: offset_m <= max_m, probability }
    }
}

/// The far end of "between".
fn end(others: &Partner<'_>, other: usize) -> Link {
    Link { holds: others.passed(other), probability: others.probabilities(other)[0] }
}
