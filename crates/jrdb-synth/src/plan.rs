//! Who does what with whom, and roughly where: small groups that are then placed as a whole.

use std::f64::consts::{FRAC_PI_2, PI};

use jrdb_types::Action;

use super::furniture::Kind;
use super::random::Random;
use super::room::Setting;

/// Where a group may stand, seen from the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Zone {
    pub(super) range_m: [f64; 2],
    pub(super) bearing_rad: [f64; 2],
}

/// Anywhere around the robot where people can be seen well.
const ANYWHERE: Zone = Zone { range_m: [1.9, 5.4], bearing_rad: [-PI, PI] };
/// Where people go who find no place elsewhere.
pub(super) const EVERYWHERE: Zone = Zone { range_m: [1.6, 12.0], bearing_rad: [-PI, PI] };
/// Across the seam of the panorama.
const SEAM: Zone = Zone { range_m: [2.2, 4.0], bearing_rad: [PI - 0.02, PI + 0.02] };
/// "Close" to the robot, whatever the error of the position.
const NEAR: Zone = Zone { range_m: [1.16, 1.24], bearing_rad: [-2.4, 2.4] };
/// "Far", whatever the error of the position.
const FAR: Zone = Zone { range_m: [8.2, 9.2], bearing_rad: [-PI, PI] };
const AHEAD: Zone = Zone { range_m: [2.4, 4.4], bearing_rad: [-0.35, 0.35] };

/// One person of a group, in a frame with x along the line of sight, away from the robot, and y
/// left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Member {
    pub(super) offset_m: [f64; 2],
    /// Heading in that frame: 0 looks away from the robot, π at it, π/2 to its left.
    pub(super) heading_rad: f64,
    pub(super) action: Action,
}

/// People who belong together.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Group {
    pub(super) zone: Zone,
    pub(super) members: Vec<Member>,
    /// Stands in the group's middle.
    pub(super) table: Option<Kind>,
    /// JRDB-Social's label of what two members do together.
    pub(super) company: Option<&'static str>,
}

const AWAY: f64 = 0.0;
const TOWARDS: f64 = PI;
const LEFT: f64 = FRAC_PI_2;
const RIGHT: f64 = -FRAC_PI_2;
const HEADINGS: [f64; 4] = [AWAY, TOWARDS, LEFT, RIGHT];

/// Half the space between two who talk, walk or sit together, metres: apart enough that the
/// direction from one to the other survives an error of the positions, and "close".
const TALK_M: f64 = 0.52;
const WALK_M: f64 = 0.45;
const SIDE_M: f64 = 0.46;
const FACE_M: f64 = 0.56;
/// From a table's middle to the hip of who sits at it, metres.
const SEAT_M: f64 = 0.56;
const SMALL_TABLE: Kind = Kind::Table([0.6, 0.6]);
const WIDE_TABLE: Kind = Kind::Table([0.6, 1.4]);

fn member(offset_m: [f64; 2], heading_rad: f64, action: Action) -> Member {
    Member { offset_m, heading_rad, action }
}

fn alone(zone: Zone, heading_rad: f64, action: Action) -> Group {
    let members = vec![member([0.0; 2], heading_rad, action)];
    Group { zone, members, table: None, company: None }
}

fn talk(zone: Zone) -> Group {
    let stand = |y, heading| member([0.0, y], heading, Action::Standing);
    let members = vec![stand(TALK_M, RIGHT), stand(-TALK_M, LEFT)];
    Group { zone, members, table: None, company: Some("conversation") }
}

fn walk_together(zone: Zone, heading_rad: f64) -> Group {
    let walk = |y| member([0.0, y], heading_rad, Action::Walking);
    let members = vec![walk(WALK_M), walk(-WALK_M)];
    Group { zone, members, table: None, company: Some("walking together") }
}

fn at_table(zone: Zone, heading_rad: f64) -> Group {
    let (sin, cos) = heading_rad.sin_cos();
    let members = vec![member([-SEAT_M * cos, -SEAT_M * sin], heading_rad, Action::Sitting)];
    Group { zone, members, table: Some(SMALL_TABLE), company: None }
}

fn face_to_face(zone: Zone) -> Group {
    let sit = |y, heading| member([0.0, y], heading, Action::Sitting);
    let members = vec![sit(FACE_M, RIGHT), sit(-FACE_M, LEFT)];
    Group { zone, members, table: Some(SMALL_TABLE), company: Some("conversation") }
}

fn side_by_side(zone: Zone) -> Group {
    let sit = |y| member([SEAT_M, y], TOWARDS, Action::Sitting);
    let members = vec![sit(SIDE_M), sit(-SIDE_M)];
    Group { zone, members, table: Some(WIDE_TABLE), company: Some("sitting together") }
}

/// Groups of together this many people: first those that every scene of the setting should have.
pub(super) fn groups(setting: Setting, people: usize, random: &mut Random) -> Vec<Group> {
    let mut wanted = first_groups(setting, random);
    let mut groups: Vec<Group> = Vec::new();
    let mut left = people;
    while left > 0 {
        let next = if wanted.is_empty() { any_group(setting, random) } else { wanted.remove(0) };
        if next.members.len() <= left {
            left -= next.members.len();
            groups.push(next);
        }
    }
    groups
}

fn first_groups(setting: Setting, random: &mut Random) -> Vec<Group> {
    use Action::{Sitting, Standing, Walking};
    let any = |random: &mut Random| random.pick(&HEADINGS);
    match setting {
        Setting::Plaza => vec![
            alone(SEAM, any(random), Standing),
            alone(ANYWHERE, random.pick(&[LEFT, RIGHT]), Walking),
            talk(AHEAD),
            at_table(ANYWHERE, random.pick(&[LEFT, RIGHT, TOWARDS])),
            alone(NEAR, TOWARDS, Standing),
            alone(FAR, TOWARDS, Walking),
            face_to_face(ANYWHERE),
            walk_together(ANYWHERE, random.pick(&[AWAY, TOWARDS])),
        ],
        Setting::Cafe => vec![
            at_table(SEAM, random.pick(&[LEFT, RIGHT, TOWARDS])),
            face_to_face(AHEAD),
            alone(ANYWHERE, random.pick(&[LEFT, RIGHT]), Walking),
            side_by_side(ANYWHERE),
            alone(NEAR, any(random), Standing),
            at_table(FAR, TOWARDS),
            face_to_face(ANYWHERE),
            at_table(ANYWHERE, AWAY),
        ],
        Setting::Corridor => vec![
            alone(SEAM, random.pick(&[AWAY, TOWARDS]), Walking),
            walk_together(AHEAD, TOWARDS),
            alone(ANYWHERE, any(random), Sitting),
            talk(ANYWHERE),
            alone(FAR, AWAY, Walking),
            alone(NEAR, random.pick(&[LEFT, RIGHT, TOWARDS]), Standing),
            walk_together(ANYWHERE, AWAY),
        ],
    }
}

fn any_group(setting: Setting, random: &mut Random) -> Group {
    let heading = random.pick(&HEADINGS);
    let along = random.pick(&[AWAY, TOWARDS]);
    let choices = match setting {
        Setting::Plaza => [
            alone(ANYWHERE, heading, Action::Standing),
            alone(ANYWHERE, heading, Action::Walking),
            at_table(ANYWHERE, heading),
            talk(ANYWHERE),
        ],
        Setting::Cafe => [
            at_table(ANYWHERE, heading),
            face_to_face(ANYWHERE),
            alone(ANYWHERE, heading, Action::Sitting),
            alone(ANYWHERE, heading, Action::Standing),
        ],
        Setting::Corridor => [
            alone(ANYWHERE, along, Action::Walking),
            alone(ANYWHERE, heading, Action::Standing),
            walk_together(ANYWHERE, along),
            talk(ANYWHERE),
        ],
    };
    choices[(random.unit() * choices.len() as f64) as usize].clone()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_hold_exactly_the_people_asked_for() {
        for setting in [Setting::Plaza, Setting::Cafe, Setting::Corridor] {
            for people in 0..30 {
                let groups = groups(setting, people, &mut Random::stream(people as u64, 0));
                let found: usize = groups.iter().map(|group| group.members.len()).sum();
                assert_eq!(found, people, "{setting:?}");
            }
        }
    }

    #[test]
    fn two_who_do_something_together_are_close_and_clear_of_the_bound() {
        let groups =
            [talk(AHEAD), walk_together(AHEAD, AWAY), face_to_face(AHEAD), side_by_side(AHEAD)];
        for group in groups {
            let [a, b] = [group.members[0].offset_m, group.members[1].offset_m];
            let apart = (a[0] - b[0]).hypot(a[1] - b[1]);
            assert!((0.85..1.2).contains(&apart), "{apart}");
        }
    }
}
