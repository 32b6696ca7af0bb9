//! Slots of time: "walking and then sitting during 0.13 to 0.4 seconds".

use jrdb_types::query::Slot;
use jrdb_types::{Condition, Pattern};

use crate::lexicon::{Role, Roles};
use crate::parser::Parser;

impl Parser<'_> {
    /// Reads "during 0 to 3 seconds" into the slot at hand.
    pub(crate) fn during(&mut self) -> bool {
        let start = self.state.at;
        let span = self.eat(Role::During).then(|| self.seconds()).flatten();
        match span {
            Some(span) => {
                (self.state.during, self.state.is_timed) = (Some(span), true);
                true
            }
            None => {
                self.state.at = start;
                false
            }
        }
    }

    fn seconds(&mut self) -> Option<[f64; 2]> {
        self.skip_while(Roles::of(&[Role::The, Role::Between, Role::Seconds]));
        let from = self.number()?;
        self.eat(Role::Seconds);
        if !(self.eat(Role::To) || self.eat(Role::Dash) || self.eat(Role::And)) {
            return None;
        }
        let to = self.number()?;
        self.eat(Role::Seconds);
        Some([from, to])
    }

    /// Whether "and then" or ", then" is at hand.
    pub(crate) fn is_then(&self) -> bool {
        let joints = Roles::of(&[Role::Comma, Role::And]);
        self.is_at(self.next_not_in(self.state.at, joints), Role::Then)
    }

    /// Consumes "and then", and closes the slot of the conditions from `head` on.
    pub(crate) fn then(&mut self, pattern: &mut Pattern, head: usize) {
        self.skip_while(Roles::of(&[Role::Comma, Role::And, Role::Then]));
        self.state.is_timed = true;
        self.close_slot(pattern, head);
    }

    /// Moves the conditions from `head` on into a slot.
    pub(crate) fn close_slot(&mut self, pattern: &mut Pattern, head: usize) {
        let head = head.min(pattern.conditions.len());
        let conditions: Vec<Condition> = pattern.conditions.drain(head..).collect();
        let during_s = self.state.during.take();
        self.push_slot(Slot { during_s, conditions });
    }
}
