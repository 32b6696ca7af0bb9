//! What could have been seen: the absence of anything else is no evidence.

use jrdb_types::query::{Category, Property, RelationKind};
use jrdb_types::{Condition, Coverage, Pattern};

use crate::evaluation::Link;
use crate::searcher::Searcher;
use crate::value::Truth;

impl Searcher<'_, '_> {
    /// Whether things that a pattern means may exist although the graph does not hold them: perception
    /// does not see their kind, or the kind is named by words that were not understood.
    pub(crate) fn may_be_unseen(&self, pattern: &Pattern) -> bool {
        let is_wide = matches!(pattern.category, Category::Anything | Category::Object);
        let is_unnamed = || {
            pattern
                .conditions
                .iter()
                .any(|c| matches!(c, Condition::Phrase(_) | Condition::Looks(_)))
        };
        !self.sees.sees_category(&pattern.category) || (is_wide && is_unnamed())
    }

    /// Whether perception sees who belongs together: it states groups, or what people do together.
    pub(crate) fn sees_groups(&self) -> bool {
        let index = self.index;
        let is_labelled = |n: usize| index.node(n).is_some_and(|node| node.group.is_some());
        self.sees.interactions.any(|_| true) || (0..index.node_count()).any(is_labelled)
    }

    /// Whether a LiDAR's sweep is missing, so that places without points need not be empty.
    pub(crate) fn has_blind_places(&self) -> bool {
        self.sees.places == Coverage::Partial
    }

    /// The truth of a statement about a place: it is refuted only if every LiDAR gave its sweep.
    pub(crate) fn of_place(&self, truth: Truth) -> Truth {
        if truth == Truth::No && self.has_blind_places() { Truth::Unknown } else { truth }
    }

    /// The same of a link.
    pub(crate) fn link_of_place(&self, link: Link) -> Link {
        Link { truth: self.of_place(link.truth), ..link }
    }

    /// Whether a person does something, where the graph does or does not say so.
    pub(crate) fn of_interaction(&self, label: &str, is_stated: bool) -> Truth {
        match is_stated {
            true => Truth::Yes,
            false if self.sees.sees_interaction(label) => Truth::No,
            false => Truth::Unknown,
        }
    }

    /// The alternatives that perception can decide. What is worn on the head is an attribute to one source and an object
    /// that somebody is wearing to another: whichever is seen decides.
    pub(crate) fn alternatives<'q>(&self, parts: &'q [Condition]) -> &'q [Condition] {
        let [Condition::Attribute(value), Condition::Related(related)] = parts else {
            return parts;
        };
        let [RelationKind::Interaction(label)] = &related.kinds[..] else { return parts };
        if related.partner.category != Category::Class(value.to_string()) {
            return parts;
        }
        let sees_object = self.sees.sees_interaction(label);
        match (self.sees.sees_attribute(value.attribute()), sees_object) {
            (true, false) => &parts[..1],
            (false, true) => &parts[1..],
            _ => parts,
        }
    }

    /// Whether the absence of a property is evidence: nobody is around, nothing is done.
    pub(crate) fn could_be_told(&self, property: Property) -> bool {
        let sees_around =
            |category: Category| !self.has_blind_places() && self.sees.sees_category(&category);
        match property {
            Property::SocialInteraction | Property::ObjectInteraction => {
                self.sees.interactions.any(|_| true)
            }
            Property::PeopleAround => sees_around(Category::Person),
            Property::ObjectsAround => sees_around(Category::Object),
            Property::Attribute(_)
            | Property::Distance
            | Property::Direction
            | Property::Height
            | Property::Speed
            | Property::Facing
            | Property::Category => false,
        }
    }
}
