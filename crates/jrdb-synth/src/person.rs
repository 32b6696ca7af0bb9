//! The people: who they are, where they go, and what a LiDAR ray meets of them.

use std::collections::BTreeSet;

use jrdb_projection::nalgebra::{Point3, Rotation2, Vector2, Vector3};
use jrdb_projection::relation::wrap_rad;
use jrdb_types::{Action, Age, Box3d, Gender, Race};

use super::feature::Feature;
use super::random::Random;
use super::room::{Color, FLOOR_M};
use super::solid::{Shape, Solid};

/// Someone in the scene.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Person {
    pub(super) number: u32,
    pub(super) age: Age,
    pub(super) gender: Gender,
    pub(super) race: Race,
    pub(super) action: Action,
    pub(super) height_m: f64,
    pub(super) look: Look,
    /// What is true of their looks beyond that.
    pub(super) features: BTreeSet<Feature>,
    /// Where the trunk stands in the first frame, metres in the base frame.
    pub(super) start_m: Vector2<f64>,
    /// Where they look in the first frame, radians counter-clockwise from +x.
    pub(super) heading_rad: f64,
    /// How fast they walk, metres per second; 0 for everyone else.
    pub(super) speed_m_s: f64,
    /// How far they walk before they turn round, metres.
    pub(super) path_m: f64,
    /// With whom they do what.
    pub(super) company: Option<(u32, &'static str)>,
}

/// Colours and clothes, the same in every frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Look {
    pub(super) skin: Color,
    pub(super) hair: Color,
    pub(super) top: Color,
    pub(super) bottom: Color,
    pub(super) shoes: Color,
    pub(super) skirt: bool,
    pub(super) bag: Option<Color>,
    pub(super) cane: bool,
}

/// Where someone is at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pose {
    pub(super) place_m: Vector2<f64>,
    pub(super) heading_rad: f64,
    /// Which foot is in front: 1 or -1.
    pub(super) stride: f64,
}

/// Sizes of a body as fractions of its standing height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Build {
    pub(super) head: f64,
    pub(super) hip: f64,
    pub(super) neck: f64,
    /// Half the width of the trunk, and half its depth.
    pub(super) half: [f64; 2],
    /// How far the head is in front of the hip.
    pub(super) stoop: f64,
}

/// Half the width and half the depth of a trunk, as fractions of the height.
const TRUNK: [f64; 2] = [0.105, 0.068];
/// Space between neck and chin, and hair over the head, as fractions of height and head.
pub(super) const CHIN: f64 = 0.015;
pub(super) const HAIR: f64 = 1.04;
/// How far the knees of a sitting person are in front of the hip, as a fraction of the height.
pub(super) const KNEE: f64 = 0.2;
/// Metres walked per step, after which the other foot is in front.
const STEP_M: f64 = 0.7;

/// Three flat drawing tones. They stand for the annotation labels of the target data set, nothing
/// else.
const fn tone(race: Race) -> Color {
    match race {
        Race::White => [238, 200, 180],
        Race::Black => [98, 62, 44],
        Race::Asian => [222, 172, 110],
    }
}

const HAIRS: [Color; 4] = [[35, 25, 20], [74, 44, 24], [128, 84, 42], [24, 24, 30]];
const GREYS: [Color; 2] = [[188, 188, 192], [222, 222, 220]];
pub(super) const TOPS: [Color; 9] = [
    [178, 44, 48],
    [44, 78, 164],
    [42, 122, 72],
    [216, 172, 56],
    [150, 76, 150],
    [66, 148, 168],
    [234, 234, 230],
    [200, 108, 56],
    [232, 140, 160],
];
const BOTTOMS: [Color; 6] =
    [[40, 50, 84], [44, 44, 50], [96, 84, 70], [92, 96, 104], [122, 56, 62], [58, 84, 74]];
const SHOES: [Color; 3] = [[30, 26, 24], [96, 64, 44], [214, 214, 214]];
const BAGS: [Color; 3] = [[60, 64, 72], [140, 60, 50], [70, 90, 60]];

impl Look {
    pub(super) fn new(
        age: Age,
        gender: Gender,
        race: Race,
        top: Color,
        random: &mut Random,
    ) -> Self {
        let elderly = age == Age::Elderly;
        Self {
            skin: tone(race),
            hair: if elderly { random.pick(&GREYS) } else { random.pick(&HAIRS) },
            top,
            bottom: random.pick(&BOTTOMS),
            shoes: random.pick(&SHOES),
            skirt: gender == Gender::Female && random.chance(0.6),
            bag: random.chance(0.25).then(|| random.pick(&BAGS)),
            cane: elderly && random.chance(0.7),
        }
    }
}

/// A height that fits age and gender, metres.
pub(super) fn height_m(age: Age, gender: Gender, random: &mut Random) -> f64 {
    let range_m = match (age, gender) {
        (Age::Child, _) => [1.1, 1.3],
        (Age::Adolescent, _) => [1.5, 1.6],
        (Age::Elderly, Gender::Female) => [1.56, 1.64],
        (_, Gender::Female) => [1.62, 1.72],
        (Age::Elderly, Gender::Male) => [1.64, 1.74],
        (_, Gender::Male) => [1.72, 1.85],
    };
    random.within(range_m)
}

impl Person {
    /// Where they are after so many seconds: along their heading, and back again.
    pub(super) fn pose(&self, seconds: f64) -> Pose {
        let walked_m = self.speed_m_s * seconds;
        let lap_m = if self.path_m > 0.0 { walked_m.rem_euclid(2.0 * self.path_m) } else { 0.0 };
        let back = lap_m > self.path_m;
        let ahead_m = if back { 2.0 * self.path_m - lap_m } else { lap_m };
        let turn_rad = if back { std::f64::consts::PI } else { 0.0 };
        let ahead = Rotation2::new(self.heading_rad) * Vector2::new(ahead_m, 0.0);
        let even = (walked_m / STEP_M) as i64 % 2 == 0;
        Pose {
            place_m: self.start_m + ahead,
            heading_rad: wrap_rad(self.heading_rad + turn_rad),
            stride: if even { 1.0 } else { -1.0 },
        }
    }

    pub(super) fn build(&self) -> Build {
        let child = self.age == Age::Child;
        let wide = match self.age {
            Age::Adolescent => 0.92,
            Age::Young | Age::Elderly => 1.0,
            Age::Child | Age::MiddleAged => 1.16,
        };
        let wide = wide * if self.gender == Gender::Female { 0.93 } else { 1.05 };
        // Children sit on the chairs of adults.
        let hip = match (self.action, child) {
            (Action::Sitting, true) => 0.36,
            (Action::Sitting, false) => 0.27,
            (_, true) => 0.43,
            _ => 0.48,
        };
        let elderly = self.age == Age::Elderly;
        let lean = if self.action == Action::Sitting { 0.03 } else { 0.0 };
        Build {
            head: if child { 0.21 } else { 0.142 },
            hip,
            neck: hip + if child { 0.34 } else { 0.36 } - if elderly { 0.025 } else { 0.0 },
            half: TRUNK.map(|fraction| fraction * wide),
            stoop: lean + if elderly { 0.06 } else { 0.0 },
        }
    }

    /// Height of the crown over the floor in this pose, metres.
    pub(super) fn crown_m(&self) -> f64 {
        let build = self.build();
        (build.neck + CHIN + build.head * HAIR) * self.height_m
    }

    /// The label in space: length along the heading with arms, legs and, of a sitting person, the
    /// thighs.
    pub(super) fn box3d(&self, pose: &Pose) -> Box3d {
        let tall_m = self.crown_m();
        let ([back_m, front_m], wide_m) = match self.action {
            Action::Walking => ([-0.45, 0.45], 0.55),
            Action::Sitting => ([-0.12 * self.height_m, 0.26 * self.height_m], 0.55),
            _ => ([-0.28, 0.28], 0.55),
        };
        let ahead = Rotation2::new(pose.heading_rad) * Vector2::new((back_m + front_m) / 2.0, 0.0);
        let middle = pose.place_m + ahead;
        Box3d {
            center: [middle.x, middle.y, FLOOR_M + tall_m / 2.0],
            size: [front_m - back_m, wide_m, tall_m],
            heading_rad: pose.heading_rad,
        }
    }

    /// The body as a LiDAR meets it, in the base frame.
    pub(super) fn solids(&self, pose: &Pose) -> Vec<Solid> {
        let build = self.build();
        let swing = if self.action == Action::Walking { 0.06 * pose.stride } else { 0.0 };
        let mut parts = trunk(&build, swing);
        match self.action {
            Action::Sitting => parts.extend(sitting_limbs(&build)),
            Action::Walking => parts.extend(upright_legs(&build, 0.09 * pose.stride)),
            _ => parts.extend(upright_legs(&build, 0.0)),
        }
        if self.look.skirt && self.action != Action::Sitting {
            let [wide, deep] = build.half;
            let (low, high) = (build.hip - 0.2, build.hip);
            parts.push(part(Shape::Cylinder, [0.0, 0.0], [1.3 * deep, 1.2 * wide], [low, high]));
        }
        let metres = |part: Solid| Solid {
            center: part.center * self.height_m,
            half: part.half * self.height_m,
            ..part
        };
        parts
            .into_iter()
            .map(|p| metres(p).placed(pose.place_m, FLOOR_M, pose.heading_rad))
            .collect()
    }
}

/// A part of the body, in fractions of the height: middle and half sizes ahead and aside, from
/// which height to which.
fn part(shape: Shape, [x, y]: [f64; 2], [along, aside]: [f64; 2], [low, high]: [f64; 2]) -> Solid {
    let center = Point3::new(x, y, f64::midpoint(low, high));
    Solid { shape, center, half: Vector3::new(along, aside, (high - low) / 2.0), yaw_rad: 0.0 }
}

/// Trunk, head, neck and arms; one arm swings ahead and the other back.
fn trunk(build: &Build, swing: f64) -> Vec<Solid> {
    use Shape::{Cylinder, Ellipsoid};
    let [wide, deep] = build.half;
    let (hip, neck, stoop) = (build.hip, build.neck, build.stoop);
    let chin = neck + CHIN;
    let mut parts = vec![
        part(Cylinder, [0.35 * stoop, 0.0], [deep, wide], [hip - 0.03, neck]),
        part(Cylinder, [stoop, 0.0], [0.03, 0.03], [neck, chin + 0.02]),
        part(
            Ellipsoid,
            [stoop, 0.0],
            [0.46 * build.head, 0.41 * build.head],
            [chin, chin + build.head * HAIR],
        ),
    ];
    for side in [-1.0, 1.0] {
        let at = [0.5 * stoop - side * swing, side * (wide + 0.02)];
        parts.push(part(Cylinder, at, [0.028, 0.028], [neck - 0.36, neck - 0.02]));
    }
    parts
}

fn upright_legs(build: &Build, swing: f64) -> Vec<Solid> {
    let leg = |side: f64| {
        part(
            Shape::Cylinder,
            [side * swing, side * 0.5 * build.half[0]],
            [0.042; 2],
            [0.0, build.hip],
        )
    };
    vec![leg(-1.0), leg(1.0)]
}

/// Thighs, shins, and forearms held forward.
fn sitting_limbs(build: &Build) -> Vec<Solid> {
    let mut parts = Vec::new();
    for side in [-0.6, 0.6] {
        let aside = side * build.half[0];
        let thigh = [build.hip - 0.05, build.hip + 0.05];
        parts.push(part(Shape::Block, [KNEE / 2.0, aside], [KNEE / 2.0 + 0.02, 0.04], thigh));
        parts.push(part(Shape::Cylinder, [KNEE - 0.02, aside], [0.036; 2], [0.0, build.hip]));
        let forearm = [build.neck - 0.29, build.neck - 0.22];
        parts.push(part(Shape::Block, [0.1, 1.7 * aside], [0.08, 0.025], forearm));
    }
    parts
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Someone 4 m ahead who walks to the left.
    pub(crate) fn walker() -> Person {
        let mut random = Random::stream(5, 5);
        Person {
            number: 1,
            age: Age::Young,
            gender: Gender::Male,
            race: Race::Asian,
            action: Action::Walking,
            height_m: 1.8,
            look: Look::new(Age::Young, Gender::Male, Race::Asian, TOPS[0], &mut random),
            features: BTreeSet::new(),
            start_m: Vector2::new(4.0, 0.0),
            heading_rad: std::f64::consts::FRAC_PI_2,
            speed_m_s: 1.2,
            path_m: 2.0,
            company: None,
        }
    }

    #[test]
    fn walkers_go_along_their_heading_and_back() {
        let walker = walker();
        let there = walker.pose(1.0);
        assert!((there.place_m - Vector2::new(4.0, 1.2)).norm() < 1e-9);
        let back = walker.pose(2.0);
        assert!((back.place_m - Vector2::new(4.0, 1.6)).norm() < 1e-9);
        assert!((back.heading_rad + std::f64::consts::FRAC_PI_2).abs() < 1e-9);
    }

    #[test]
    fn the_body_fills_its_label_and_stays_inside() {
        for action in [Action::Standing, Action::Walking, Action::Sitting] {
            let person = Person { action, ..walker() };
            let pose = person.pose(0.0);
            let (solids, label) = (person.solids(&pose), person.box3d(&pose));
            for solid in &solids {
                let top = solid.center.z + solid.half.z;
                assert!(top <= label.center[2] + label.size[2] / 2.0 + 0.001, "{action}");
                let aside = (solid.center.x - label.center[0]).abs() + solid.half.y;
                assert!(aside <= label.size[1] / 2.0 + 0.05, "{action} {aside}");
            }
            let trunk = Point3::new(4.0, 0.0, FLOOR_M + 0.55 * person.height_m);
            assert!(solids.iter().any(|solid| solid.contains(&trunk)), "{action}");
        }
    }

    #[test]
    fn age_shows_in_height_and_head() {
        let mut random = Random::stream(1, 2);
        let child = height_m(Age::Child, Gender::Male, &mut random);
        let adult = height_m(Age::Young, Gender::Male, &mut random);
        assert!(child < 1.31 && adult > 1.71);
        let child = Person { age: Age::Child, ..walker() };
        assert!(child.build().head > walker().build().head);
    }
}
