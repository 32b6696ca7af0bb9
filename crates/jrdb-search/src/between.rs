//! Who is between two things, or between the robot and one.

use crate::evaluation::{Link, Partner};
use crate::geometry::along;
use crate::probability::of_offset;
use crate::searcher::Searcher;
use crate::value::Truth;

impl Searcher<'_, '_> {
    /// Whether the subject is between a partner, or the robot where there is none, and one of the others.
    pub(crate) fn between(
        &self,
        subject: usize,
        partner: Option<usize>,
        others: &Partner<'_>,
    ) -> Link {
        let best = self.between_links(subject, partner, others).map(|(_, link)| link);
        let best = best.reduce(|best, next| if next.beats(best) { next } else { best });
        let link = best.unwrap_or_else(|| match (partner, others) {
            (Some(_), Partner::Things { .. }) => self.unsaid(subject),
            _ => Link::NONE,
        });
        // Between the partner and something that was not seen.
        if link.truth == Truth::No && others.may_be_unseen() { Link::UNKNOWN } else { link }
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
                let link = self.between_robot_and(subject, other);
                Box::new(is_free.then_some((None, link)).into_iter())
            }
            (None, Partner::Things { .. }) => {
                let things = (0..self.index.node_count()).filter(move |&other| other != subject);
                Box::new(things.map(move |other| {
                    let link = self.between_robot_and(subject, other);
                    (Some(other), link.and(end(others, other)))
                }))
            }
            (Some(partner), Partner::Things { .. }) => {
                let entries = self.index.between(subject).filter_map(move |(ends, entry)| {
                    let other = match ends {
                        [a, b] if a == partner => b,
                        [a, b] if b == partner => a,
                        _ => return None,
                    };
                    let link = Link { truth: Truth::Yes, ..self.offset_link(entry.offset_m) };
                    Some((Some(other), link.and(end(others, other))))
                });
                Box::new(entries)
            }
        }
    }

    fn between_robot_and(&self, subject: usize, other: usize) -> Link {
        let offset_m = self.offset_m(subject, other);
        offset_m.map_or_else(|| self.unplaced(subject), |offset_m| self.offset_link(offset_m))
    }

    /// How far something is from the line between the robot and another, metres; `None` unless it is between them.
    fn offset_m(&self, subject: usize, other: usize) -> Option<f64> {
        let ends = [[0.0; 3], self.center(other)?];
        Some(along(self.center(subject)?, ends, self.config.between_min_inside_m)?.0)
    }

    /// How far something is from the line between a partner and the far end, metres; the robot where there is none.
    pub(crate) fn aside_m(
        &self,
        subject: usize,
        partner: Option<usize>,
        far: Option<usize>,
    ) -> Option<f64> {
        let (Some(a), Some(b)) = (partner, far) else {
            return self.offset_m(subject, partner.or(far)?);
        };
        let mut entries = self.index.between(subject);
        let entry = entries.find(|(ends, _)| *ends == [a, b] || *ends == [b, a]);
        entry.map(|(_, entry)| entry.offset_m)
    }

    fn offset_link(&self, offset_m: f64) -> Link {
        let max_m = self.config.between_max_offset_m;
        let probability = of_offset(offset_m, max_m, self.config.position_sigma_m);
        Link { truth: Truth::of(offset_m <= max_m), probability }
    }
}

/// The far end of "between".
fn end(others: &Partner<'_>, other: usize) -> Link {
    Link { truth: others.truth(other), probability: others.probabilities(other)[0] }
}
