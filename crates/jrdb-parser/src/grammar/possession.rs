//! What an entity has or is with, and where that is: "has a woman to his right", "with a bag".

use jrdb_types::query::{Category, Quantity, RelationKind, Viewpoint};
use jrdb_types::vocab::PairWord;
use jrdb_types::{Condition, Pattern};

use crate::lexicon::{Role, Roles};
use crate::parser::Parser;
use crate::pattern::{join_alternative, levels, push_related, related};
use crate::phrase::{LocationPhrase, NounGroup, Reference};

impl Parser<'_> {
    /// "has a woman to his right", "with a bag": entities and where they are from the subject's
    /// viewpoint.
    pub(crate) fn possession(&mut self, pattern: &mut Pattern) -> bool {
        let checkpoint = self.checkpoint();
        let mut is_without = self.is(Role::Without);
        if !self.roles().has_any(Roles::of(&[Role::Has, Role::With, Role::Without])) {
            return false;
        }
        self.bump();
        self.skip_while(Roles::of(&[Role::With, Role::Filler, Role::Either]));
        is_without |= self.eat(Role::Neither);
        let length = pattern.conditions.len();
        let mut is_or = false;
        while let Some(one) = self.one_possession(pattern) {
            let is_placed = is_placed(&one);
            // "No bag or phone" is neither.
            is_without |= is_or && pattern.conditions.last().is_some_and(is_not);
            let is_negated = is_without && !is_not(&one);
            let condition = if is_negated { Condition::Not(Box::new(one)) } else { one };
            pattern.conditions.push(condition);
            if is_or && !is_without {
                let last = pattern.conditions.len() - 1;
                join_alternative(&mut pattern.conditions, last);
            }
            let is_first = pattern.conditions.len() - length == 1;
            let is_person = is_first && self.is_person_next();
            let is_other = is_person && !(is_placed && self.is_located_person_next());
            if is_other || !self.is_possession_next() {
                break;
            }
            is_or = self.is(Role::Or);
            self.bump();
        }
        let found = pattern.conditions.len() > length;
        if !found {
            self.rewind(checkpoint);
        }
        found
    }

    /// Whether a joint and another possession follow, which describes nothing else.
    fn is_possession_next(&self) -> bool {
        let is_joint = self.roles().has_any(Roles::of(&[Role::And, Role::Or, Role::Neither]));
        let is_claimed = self.is_next_located_by_his() || self.is_head_resumed(self.state.at);
        is_joint && self.is_noun_group_next() && !is_claimed
    }

    /// "'s bag" behind "the woman": the bag that is with the woman.
    pub(crate) fn owned(&mut self, group: &mut NounGroup) {
        while self.has_possessives
            && self.is(Role::Possessive)
            && self.is_at(self.state.at + 1, Role::Noun)
        {
            if !self.has_room(levels(&group.pattern)) {
                return;
            }
            self.bump();
            let owner = std::mem::take(&mut group.pattern);
            self.noun(group);
            let with = related(vec![RelationKind::With], owner, Quantity::SOME);
            group.pattern.conditions.push(with);
        }
    }

    /// "a phone" behind "has the man".
    pub(crate) fn possessed(&mut self, pattern: &mut Pattern) {
        let one = self.one_possession(pattern);
        pattern.conditions.extend(one);
    }

    /// "and a man on the right" behind "has a woman on the left".
    fn is_located_person_next(&self) -> bool {
        const PERSON: Roles = Roles::of(&[Role::The, Role::A, Role::Implies, Role::Noun]);
        let next = self.next_not_in(self.state.at + 1, PERSON);
        self.roles_at(next).has_any(Roles::of(&[Role::At, Role::To, Role::Sector, Role::Near]))
    }

    fn is_person_next(&self) -> bool {
        let next =
            self.next_not_in(self.state.at + 1, Roles::of(&[Role::The, Role::A, Role::Implies]));
        self.entry_at(next).category == Some(Category::Person)
    }

    pub(crate) fn one_possession(&mut self, pattern: &mut Pattern) -> Option<Condition> {
        if let Some(robot) = self.robot() {
            let kinds = vec![RelationKind::With];
            return Some(related(kinds, robot, Quantity::SOME));
        }
        if self.is(Role::Him) && !self.is_noun_ahead(self.state.at + 1) && self.discourse.is_some()
        {
            let him = self.pronoun()?;
            return Some(related(vec![RelationKind::With], him, Quantity::SOME));
        }
        let start = self.state.at;
        let mut group = NounGroup::default();
        if !self.read_noun_group(&mut group) {
            return None;
        }
        let quantity = group.how_many();
        if self.is_facing_him() {
            self.set_antecedent(pattern);
        }
        let is_person = matches!(group.pattern.category, Category::Person | Category::Anything);
        if is_person && self.is_at_hand_clothes() {
            self.clothes(&mut group.pattern);
        }
        while is_person && self.is_activity_next() && self.activity(&mut group.pattern) {}
        if self.is_facing_him() {
            self.relation(&mut group.pattern);
        }
        if self.is(Role::With) && self.is_at(self.state.at + 1, Role::Him) {
            // "With him" adds nothing to "has a dog".
            self.bump();
            self.eat_pronoun();
        }
        let is_none = quantity == Quantity::NONE;
        let quantity = if is_none { Quantity::SOME } else { quantity };
        let kinds = self.where_it_is(&mut group.pattern, pattern, start);
        if self.is(Role::Who) {
            group.pattern = self.with_modifiers(group.pattern, group.count);
        }
        let one = related(kinds, group.pattern, quantity);
        Some(if is_none { Condition::Not(Box::new(one)) } else { one })
    }

    /// "facing him" behind "has a man".
    fn is_facing_him(&self) -> bool {
        let facing = Some(RelationKind::Pair(PairWord::Facing));
        self.is(Role::Relation)
            && self.entry().relation == facing
            && self.is_at(self.state.at + 1, Role::Him)
    }

    /// "in yellow" behind "with a girl".
    fn is_at_hand_clothes(&self) -> bool {
        let is_in = self.is(Role::At) && self.word(self.state.at).eq_ignore_ascii_case("in");
        is_in || self.entry().object.as_deref() == Some("wearing")
    }

    fn is_activity_next(&self) -> bool {
        self.roles().has_any(Roles::of(&[Role::Action, Role::Interaction]))
    }

    /// The relation of the subject to what it has.
    fn where_it_is(
        &mut self,
        partner: &mut Pattern,
        subject: &Pattern,
        start: usize,
    ) -> Vec<RelationKind> {
        if let Some(kind) = self.beside_him() {
            return vec![kind];
        }
        let mut location = LocationPhrase::default();
        let checkpoint = self.checkpoint();
        if self.location_phrase(subject, &mut location) {
            let is_asked = self.state.asks_several
                && matches!(location.reference, Reference::Robot)
                && (self.is_end() || self.is(Role::Or));
            if is_asked {
                // "is the man with the cart behind me": asked of the man.
                self.rewind(checkpoint);
                return vec![RelationKind::With];
            }
            if matches!(location.reference, Reference::Unsaid | Reference::His | Reference::Him) {
                location.apply_near_default();
                return location.kinds(Viewpoint::Subject);
            }
            self.push_location(&mut location, partner, start);
        }
        vec![RelationKind::With]
    }

    /// "next to him" behind "with a woman".
    fn beside_him(&mut self) -> Option<RelationKind> {
        let kind = self.entry().relation.as_ref().filter(|_| self.is(Role::Relation))?;
        let next = self.state.at + 1;
        let is_pair =
            matches!(kind, RelationKind::Pair(PairWord::Adjacent | PairWord::Overlapping));
        if !is_pair || !self.is_at(next, Role::Him) || self.is_noun_ahead(next + 1) {
            return None;
        }
        self.state.at = next;
        self.eat_pronoun();
        Some(kind.clone())
    }

    /// "a woman located to his right": possession without "has". If the interaction before it is
    /// with the same described person, both become one relation.
    pub(crate) fn noun_located_by_his(&mut self, pattern: &mut Pattern) -> bool {
        let checkpoint = self.checkpoint();
        let found = self.noun_group().filter(|_| self.is_located_by_his_at(self.state.at));
        let mut location = LocationPhrase::default();
        let is_at_his = self.location_phrase(pattern, &mut location)
            && matches!(location.reference, Reference::His);
        let Some(group) = found.filter(|_| is_at_his) else {
            self.rewind(checkpoint);
            return false;
        };
        let kinds = location.kinds(Viewpoint::Subject);
        if let Some(Condition::Related(last)) = pattern.conditions.last_mut() {
            let is_activity = matches!(last.kinds[..], [RelationKind::Interaction(_)]);
            if is_activity && last.partner == group.pattern && !group.pattern.conditions.is_empty()
            {
                last.kinds.extend(kinds);
                return true;
            }
        }
        push_related(pattern, kinds, group.pattern, Quantity::SOME);
        true
    }
}

fn is_not(condition: &Condition) -> bool {
    matches!(condition, Condition::Not(_))
}

/// Whether a relation gives the place of the partner.
fn is_placed(condition: &Condition) -> bool {
    let Condition::Related(related) = condition else { return false };
    matches!(related.kinds[..], [RelationKind::Placed { .. }, ..])
}
