//! A place as a condition: seen from the robot, or relative to another entity.

use jrdb_types::issue::IssueKind;
use jrdb_types::query::{Category, Quantity, Viewpoint};
use jrdb_types::{Condition, Pattern};

use crate::config::OfPerson;
use crate::lexicon::{Role, Roles};
use crate::parser::Parser;
use crate::pattern::push_related;
use crate::phrase::{After, LocationPhrase, Partner, Reference, is_distance, is_robot};

impl Parser<'_> {
    /// "close to me", "to the left of a child", "at a far distance".
    pub(crate) fn location(&mut self, pattern: &mut Pattern, after: After) -> bool {
        let start = self.state.at;
        let checkpoint = (after == After::Partner).then(|| self.checkpoint());
        let mut location = LocationPhrase::default();
        if !self.location_phrase(pattern, &mut location) {
            return false;
        }
        let is_unsaid = matches!(location.reference, Reference::Unsaid);
        if let Some(checkpoint) = checkpoint
            && is_unsaid
            && location.places.iter().all(is_distance)
        {
            // In "left of the woman at a far distance" the distance is between the two, not from
            // the robot.
            self.rewind(checkpoint);
            return false;
        }
        if matches!(location.reference, Reference::His) && self.is_at_his(pattern, start) {
            let Some(Condition::Related(last)) = pattern.conditions.last_mut() else { return true };
            last.kinds.extend(location.kinds(Viewpoint::Subject));
            return true;
        }
        self.push_location(&mut location, pattern, start);
        true
    }

    /// Whether the place that begins at `start` is the place of the partner before it: "standing
    /// with a woman on his left".
    fn is_at_his(&self, pattern: &Pattern, start: usize) -> bool {
        const JOINTS: Roles = Roles::of(&[Role::And, Role::Or, Role::Comma, Role::Who, Role::Is]);
        let is_direct = start > 0 && !self.roles_at(start - 1).has_any(JOINTS);
        is_direct && matches!(pattern.conditions.last(), Some(Condition::Related(_)))
    }

    pub(crate) fn push_location(
        &mut self,
        location: &mut LocationPhrase,
        pattern: &mut Pattern,
        start: usize,
    ) {
        match std::mem::take(&mut location.reference) {
            Reference::Unsaid | Reference::Robot => push_from_robot(location, pattern),
            Reference::Own(owner) if owner.category == Category::Robot => {
                push_from_robot(location, pattern);
            }
            Reference::Own(owner) => self.push_own_side(location, owner, pattern),
            Reference::His => {
                let owner = self.owner_of_his(start);
                self.push_own_side(location, owner, pattern);
            }
            Reference::Him => {
                let partner = self.owner_of_his(start);
                let partner = Partner { pattern: partner, ..Partner::default() };
                self.push_beside(location, vec![partner], pattern);
            }
            Reference::Partners(partners) => self.push_beside(location, partners, pattern),
        }
    }

    fn owner_of_his(&mut self, start: usize) -> Pattern {
        const PRONOUN: Roles = Roles::of(&[Role::His, Role::Him]);
        let at = (start..self.state.at).find(|at| self.roles_at(*at).has_any(PRONOUN));
        let found = self.antecedent_at(at.unwrap_or(start));
        if found.is_none() {
            let message = "nobody was spoken of before who can be meant; read as anybody".into();
            self.report(IssueKind::Ambiguous, start, self.state.at, message);
        }
        found.unwrap_or_default()
    }

    /// "on the man's left": his own left, whatever the configuration says about "left of the man".
    fn push_own_side(
        &mut self,
        location: &mut LocationPhrase,
        owner: Pattern,
        pattern: &mut Pattern,
    ) {
        let is_person = owner.category == Category::Person;
        let viewpoint = if is_person { Viewpoint::Partner } else { Viewpoint::Robot };
        location.apply_near_default();
        push_related(pattern, location.kinds(viewpoint), owner, Quantity::SOME);
    }

    fn push_beside(
        &mut self,
        location: &mut LocationPhrase,
        partners: Vec<Partner>,
        pattern: &mut Pattern,
    ) {
        let mut is_reported = false;
        for partner in partners {
            if is_robot(&partner) {
                push_from_robot(location, pattern);
                continue;
            }
            let is_person = partner.pattern.category == Category::Person;
            let viewpoint = match self.config.viewpoint {
                OfPerson::Own if is_person => Viewpoint::Partner,
                _ => Viewpoint::Robot,
            };
            if viewpoint == Viewpoint::Partner && !is_reported {
                self.report_side(location);
                is_reported = true;
            }
            location.apply_near_default();
            let kinds = location.kinds(viewpoint);
            push_related(pattern, kinds, partner.pattern, partner.quantity);
        }
    }

    fn report_side(&mut self, location: &LocationPhrase) {
        let Some(at) = location.sided else { return };
        let word = self.word(at);
        let message = format!("read as that person's own {word}, not as seen from the robot");
        self.report(IssueKind::Ambiguous, at, at + 1, message);
    }
}

fn push_from_robot(location: &LocationPhrase, pattern: &mut Pattern) {
    pattern.conditions.extend(location.places.iter().copied().map(Condition::FromRobot));
}
