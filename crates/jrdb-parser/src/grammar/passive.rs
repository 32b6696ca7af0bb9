//! Passives: "the bag carried by the man", "the trolley that is being pushed by her".

use jrdb_types::Pattern;
use jrdb_types::query::{Category, Quantity, RelationKind};

use crate::lexicon::{Role, Roles};
use crate::parser::Parser;
use crate::pattern::{push_related, related};

impl Parser<'_> {
    /// A participle with "by" and whoever does it.
    pub(crate) fn passive(&mut self, pattern: &mut Pattern) -> bool {
        const BEFORE: Roles = Roles::of(&[Role::Is, Role::Filler]);
        let verb = self.next_not_in(self.state.at, BEFORE);
        let entry = self.entry_at(verb);
        let is_participle = self.is_at(verb, Role::Interaction)
            && !self.is_at(verb, Role::Action)
            && !self.word(verb).ends_with("ing");
        if !is_participle || !self.is_by(verb + 1) {
            return false;
        }
        let checkpoint = self.checkpoint();
        self.state.at = verb + 2;
        let is_person = pattern.category == Category::Person;
        let doers = self.partners_of(pattern);
        if doers.is_empty() {
            self.rewind(checkpoint);
            return false;
        }
        for doer in doers {
            match (&entry.people, &entry.object) {
                (Some(label), _) if is_person => {
                    let kinds = vec![RelationKind::Interaction(label.clone())];
                    push_related(pattern, kinds, doer.pattern, doer.quantity);
                }
                (_, Some(label)) => {
                    let mut other = doer.pattern;
                    let kinds = vec![RelationKind::Interaction(label.clone())];
                    let thing = Pattern::of(pattern.category.clone());
                    other.conditions.push(related(kinds, thing, Quantity::SOME));
                    push_related(pattern, vec![RelationKind::With], other, doer.quantity);
                }
                _ => push_related(pattern, vec![RelationKind::With], doer.pattern, doer.quantity),
            }
        }
        true
    }

    fn is_by(&self, at: usize) -> bool {
        self.word(at).eq_ignore_ascii_case("by")
    }
}
