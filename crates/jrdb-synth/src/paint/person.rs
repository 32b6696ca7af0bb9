//! Draws a person: age by size, head, stoop and hair, gender by hair and skirt, facing by profile.

use jrdb_projection::nalgebra::Vector2;
use jrdb_projection::relation::wrap_rad;
use jrdb_types::{Action, Age};

use super::canvas::{Canvas, Extent};
use super::pen::Pen;
use super::shade::shade;
use crate::person::{Build, CHIN, KNEE, Look, Person, Pose};
use crate::robot::Panorama;
use crate::room::Color;

/// Which side of a person the robot sees.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Facing {
    Towards,
    Away,
    /// Looks to the left of the picture.
    Left,
    Right,
}

impl Facing {
    /// From the heading and the place of who has it.
    pub(super) fn of(place_m: Vector2<f64>, heading_rad: f64) -> Self {
        let bearing_rad = place_m.y.atan2(place_m.x);
        match wrap_rad(heading_rad - bearing_rad).to_degrees() {
            turn if turn.abs() <= 45.0 => Self::Away,
            turn if turn.abs() >= 135.0 => Self::Towards,
            turn if turn > 0.0 => Self::Left,
            _ => Self::Right,
        }
    }

    /// -1 for left, 1 for right, 0 for neither.
    fn side(self) -> f64 {
        match self {
            Self::Left => -1.0,
            Self::Right => 1.0,
            Self::Towards | Self::Away => 0.0,
        }
    }
}

const CANE: Color = [74, 46, 26];

/// Draws a person and says where; nothing when they stand in the robot.
pub(super) fn draw(
    canvas: &mut Canvas,
    camera: &Panorama,
    person: &Person,
    pose: &Pose,
    instance: u8,
) -> Option<Extent> {
    let pen = Pen::new(canvas, camera, pose.place_m, person.height_m, instance)?;
    let facing = Facing::of(pose.place_m, pose.heading_rad);
    let build = person.build();
    let side = facing.side();
    // A stoop shows in profile; from the front the head only sinks.
    let lean = build.stoop * side;
    let half = if side == 0.0 { build.half[0] } else { build.half[1] };
    let head = [lean, build.neck + CHIN + build.head / 2.0];
    let mut figure =
        Figure { pen, person, look: &person.look, build, facing, side, half, lean, head, pose };
    figure.draw();
    figure.pen.extent()
}

/// A person half drawn.
pub(super) struct Figure<'a> {
    pub(super) pen: Pen<'a>,
    pub(super) person: &'a Person,
    pub(super) look: &'a Look,
    pub(super) build: Build,
    pub(super) facing: Facing,
    pub(super) side: f64,
    /// Half the width of the trunk as seen.
    pub(super) half: f64,
    /// How far the neck is beside the hip.
    pub(super) lean: f64,
    /// Middle of the head.
    pub(super) head: [f64; 2],
    pose: &'a Pose,
}

const LEG: f64 = 0.072;
pub(super) const ARM: f64 = 0.05;
const SHOE: f64 = 0.036;

impl Figure<'_> {
    /// From the far side of the body to the near one.
    fn draw(&mut self) {
        let arms = self.arms();
        let is_walking = self.person.action == Action::Walking;
        let arms_behind = self.facing == Facing::Away && self.person.action == Action::Sitting;
        if self.facing == Facing::Towards {
            self.long_hair([-1.3, 1.3], 0.86);
        }
        if self.side != 0.0 {
            self.bag();
            self.arm(&arms[0], 0.62);
        }
        self.legs();
        if arms_behind || (self.side == 0.0 && is_walking) {
            arms.iter().for_each(|arm| self.arm(arm, 0.84));
        }
        self.trunk();
        self.shirt();
        self.skirt();
        self.clothes();
        self.face();
        self.worn_on_the_head();
        if self.side != 0.0 {
            self.arm(&arms[1], 0.84);
        } else if !arms_behind && !is_walking {
            arms.iter().for_each(|arm| self.arm(arm, 0.86));
        }
        if self.facing == Facing::Away {
            self.bag();
        }
        self.cane();
        self.umbrella(&arms[0]);
    }

    fn bottom(&self) -> Color {
        if self.look.skirt { self.look.skin } else { self.look.bottom }
    }

    fn legs(&mut self) {
        match self.person.action {
            Action::Sitting => self.sitting_legs(),
            Action::Walking => self.walking_legs(),
            _ => self.standing_legs(),
        }
    }

    fn shoe(&mut self, [x, y]: [f64; 2], outwards: f64) {
        let toe = if self.side == 0.0 { 0.012 * outwards } else { 0.055 * self.side };
        self.pen.limb(&[[x, y], [x + toe, y]], SHOE, self.look.shoes);
    }

    fn sitting_legs(&mut self) {
        let (hip, side, cloth, leg) = (self.build.hip, self.side, self.look.bottom, self.bottom());
        for (near, factor) in [(-1.0, 0.75), (1.0, 1.0)] {
            let (cloth, leg) = (shade(cloth, factor), shade(leg, factor));
            if side != 0.0 {
                let knee = [side * KNEE, hip - 0.005 * near];
                self.pen.limb(&[[0.0, hip], knee], LEG * 1.2, cloth);
                let foot = knee[0] + (0.015 * near - 0.04) * side;
                self.pen.limb(&[knee, [foot, 0.02]], LEG * 0.9, leg);
                self.shoe([foot, 0.018], near);
            } else if self.facing == Facing::Towards {
                let x = near * self.half * 0.8;
                self.pen.limb(
                    &[[near * self.half * 0.5, hip], [x, hip - 0.03]],
                    LEG * 1.35,
                    self.look.bottom,
                );
                self.pen.limb(&[[x, hip - 0.05], [x, 0.03]], LEG * 0.95, leg);
                self.shoe([x, 0.018], near);
            } else {
                let x = near * self.half * 0.8;
                self.pen.limb(&[[x, hip - 0.05], [x, 0.03]], LEG * 0.9, shade(self.bottom(), 0.7));
                self.shoe([x, 0.018], near);
            }
        }
    }

    fn walking_legs(&mut self) {
        let (hip, side) = (self.build.hip, self.side);
        let spread = if side == 0.0 { 0.045 } else { 0.12 };
        for (near, factor) in [(-self.pose.stride, 0.72), (self.pose.stride, 1.0)] {
            let color = shade(self.bottom(), factor);
            let forward = near * if side == 0.0 { 1.0 } else { side };
            let foot = [forward * spread, if near * self.pose.stride < 0.0 { 0.055 } else { 0.02 }];
            let knee = [forward * spread * 0.45 + 0.025 * side, hip * 0.52];
            self.pen.limb(&[[0.3 * forward * self.half, hip], knee, foot], LEG, color);
            self.shoe(foot, forward);
        }
    }

    fn standing_legs(&mut self) {
        for (near, factor) in [(-1.0, 0.82), (1.0, 1.0)] {
            let x = near * self.half * if self.side == 0.0 { 0.5 } else { 0.22 };
            let color = shade(self.bottom(), factor);
            self.pen.limb(&[[x, self.build.hip], [x, 0.03]], LEG, color);
            self.shoe([x, 0.018], near);
        }
    }

    /// Shoulder, elbow and hand of the far and the near arm.
    fn arms(&self) -> [[[f64; 2]; 3]; 2] {
        let (side, shoulder) = (self.side, self.build.neck - 0.035);
        [-1.0, 1.0].map(|near| {
            let outwards = if side == 0.0 { near } else { 0.0 };
            let x = self.lean + near * self.half * if side == 0.0 { 0.98 } else { 0.15 };
            let swing = -near * self.pose.stride * if side == 0.0 { 0.0 } else { 0.11 * side };
            let (elbow, hand) = match self.person.action {
                Action::Walking => (
                    [0.5 * swing + 0.035 * outwards, -0.16],
                    [
                        swing + 0.03 * outwards,
                        if side == 0.0 && near * self.pose.stride > 0.0 { -0.25 } else { -0.31 },
                    ],
                ),
                Action::Sitting => (
                    [0.04 * side + 0.04 * outwards, -0.16],
                    [0.16 * side - 0.015 * outwards, -0.25],
                ),
                _ => (
                    [0.03 * outwards + 0.005 * side, -0.17],
                    [0.03 * outwards + 0.03 * side, -0.33],
                ),
            };
            [[0.0, 0.0], elbow, hand].map(|[dx, dy]| [x + dx, shoulder + dy])
        })
    }

    fn arm(&mut self, points: &[[f64; 2]; 3], factor: f64) {
        self.pen.oval(points[2], [0.026, 0.028], shade(self.look.skin, factor.max(0.8)));
        let [shoulder, elbow, hand] = *points;
        let wrist = [0, 1].map(|axis| hand[axis] + 0.15 * (elbow[axis] - hand[axis]));
        self.pen.limb(&[shoulder, elbow, wrist], ARM, shade(self.look.top, factor));
        self.sleeve(&[shoulder, elbow, wrist], factor);
    }

    fn trunk(&mut self) {
        let (half, lean, neck, hip) = (self.half, self.lean, self.build.neck, self.build.hip);
        let stout = self.person.age == Age::MiddleAged;
        let waist = half * if stout { 1.12 } else { 0.88 };
        let belly = if stout { 0.02 * self.side } else { 0.0 };
        let outline = [
            [lean - 0.55 * half, neck],
            [lean + 0.55 * half, neck],
            [lean + half, neck - 0.035],
            [0.4 * lean + waist + belly.max(0.0), hip + 0.1],
            [0.92 * half, hip - 0.02],
            [-0.92 * half, hip - 0.02],
            [0.4 * lean - waist + belly.min(0.0), hip + 0.1],
            [lean - half, neck - 0.035],
        ];
        self.pen.polygon(&outline, self.look.top);
        let belt = [[-0.92 * half, hip - 0.025], [0.92 * half, hip + 0.015]];
        self.rectangle(belt, shade(self.look.bottom, 0.8));
    }

    pub(super) fn rectangle(&mut self, [[left, low], [right, high]]: [[f64; 2]; 2], color: Color) {
        self.pen.polygon(&[[left, low], [right, low], [right, high], [left, high]], color);
    }

    fn skirt(&mut self) {
        if !self.look.skirt {
            return;
        }
        let (half, hip, side, color) = (self.half, self.build.hip, self.side, self.look.bottom);
        let waist = 0.95 * half;
        if self.person.action != Action::Sitting {
            let hem = if side == 0.0 { 1.35 * half } else { 1.9 * half };
            let outline =
                [[-waist, hip + 0.03], [waist, hip + 0.03], [hem, hip - 0.21], [-hem, hip - 0.21]];
            self.pen.polygon(&outline, color);
        } else if side != 0.0 {
            let knee = side * (KNEE + 0.03);
            let outline = [
                [-side * waist, hip + 0.06],
                [knee, hip + 0.05],
                [knee, hip - 0.11],
                [-side * waist, hip - 0.05],
            ];
            self.pen.polygon(&outline, color);
        } else if self.facing == Facing::Towards {
            let hem = 1.2 * half;
            let outline =
                [[-waist, hip + 0.04], [waist, hip + 0.04], [hem, hip - 0.1], [-hem, hip - 0.1]];
            self.pen.polygon(&outline, color);
        }
    }

    /// A rucksack, on the back.
    fn bag(&mut self) {
        let Some(color) = self.look.bag.filter(|_| self.person.action != Action::Sitting) else {
            return;
        };
        let (neck, half) = (self.build.neck, self.half);
        if self.side == 0.0 {
            self.rectangle([[-0.7 * half, neck - 0.26], [0.7 * half, neck - 0.03]], color);
            self.rectangle(
                [[-0.45 * half, neck - 0.23], [0.45 * half, neck - 0.14]],
                shade(color, 0.75),
            );
        } else {
            let back = self.lean - self.side * half;
            let [low, high] = [back - self.side * 0.09, back + self.side * 0.03];
            self.rectangle([[low.min(high), neck - 0.27], [low.max(high), neck - 0.03]], color);
        }
    }

    fn cane(&mut self) {
        if !self.look.cane || self.person.action == Action::Sitting {
            return;
        }
        let ahead = if self.side == 0.0 { self.half + 0.045 } else { self.side * 0.15 };
        let top = self.build.neck - 0.36;
        self.pen.limb(&[[ahead, top], [ahead + 0.02 * ahead.signum(), 0.01]], 0.018, CANE);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn facing_comes_from_heading_and_place() {
        let ahead = Vector2::new(4.0, 0.0);
        assert_eq!(Facing::of(ahead, 3.0), Facing::Towards);
        assert_eq!(Facing::of(ahead, 0.3), Facing::Away);
        assert_eq!(Facing::of(ahead, 1.5), Facing::Left);
        assert_eq!(Facing::of(ahead, -1.5), Facing::Right);
        assert_eq!(Facing::of(Vector2::new(0.0, 4.0), -1.5), Facing::Towards);
        assert_eq!(Facing::of(Vector2::new(-4.0, 0.0), 1.5), Facing::Right);
    }
}
