//! Head, face and hair of a drawn person.

use jrdb_types::{Age, Gender};

use super::person::{Facing, Figure};
use super::shade::shade;
use crate::feature::Feature;
use crate::room::Color;

pub(super) const DARK: Color = [22, 20, 20];
pub(super) const WHITE: Color = [248, 246, 242];
const GREY_TEMPLES: Color = [172, 172, 174];
const LIPS: Color = [176, 52, 60];

impl Figure<'_> {
    /// Half the width of the head as seen.
    pub(super) fn head_half(&self) -> f64 {
        self.build.head * if self.side == 0.0 { 0.41 } else { 0.44 }
    }

    /// Hair down to the shoulders, between two places across the head.
    pub(super) fn long_hair(&mut self, [left, right]: [f64; 2], factor: f64) {
        let is_long = self.has(Feature::LongHair);
        if self.person.gender == Gender::Male && !is_long {
            return;
        }
        let ([x, y], half) = (self.head, self.head_half());
        let low = self.build.neck - if is_long { 0.075 } else { -0.01 };
        let outline = [
            [x + left * half, y + 0.01],
            [x + right * half, y + 0.01],
            [x + 1.06 * right * half, low],
            [x + 1.06 * left * half, low],
        ];
        self.pen.polygon(&outline, shade(self.look.hair, factor));
    }

    pub(super) fn face(&mut self) {
        let ([x, y], half, tall) = (self.head, self.head_half(), self.build.head / 2.0);
        let (neck, skin, hair) = (self.build.neck, self.look.skin, self.look.hair);
        self.pen.limb(&[[0.9 * x, neck - 0.01], [x, neck + 0.03]], 0.05, shade(skin, 0.86));
        self.pen.oval([x, y], [half, tall], skin);
        let cap = [1.1 * half, tall * 1.08];
        match self.facing {
            Facing::Away => {
                self.pen.oval([x, y + 0.004], cap, hair);
                self.long_hair([-1.1, 1.1], 0.94);
            }
            Facing::Towards => {
                self.pen.pie([x, y + 0.12 * tall], [cap[0], 0.96 * tall], [0.0, 180.0], hair);
                self.features(&[-0.42, 0.42]);
            }
            Facing::Left | Facing::Right => {
                self.profile(cap);
                self.features(&[0.55 * self.side]);
            }
        }
        self.baseball_cap(cap);
        if self.person.age == Age::MiddleAged && self.facing != Facing::Away {
            let temples: &[f64] =
                if self.side == 0.0 { &[-1.0, 1.0] } else { &[-0.35 * self.side] };
            for place in temples {
                let at = [x + 0.9 * place * half, y + 0.05 * tall];
                self.pen.oval(at, [0.014, 0.026], GREY_TEMPLES);
            }
        }
    }

    /// What tells adolescents from young adults, in pictures that do not say how tall anybody is.
    fn baseball_cap(&mut self, [across, up]: [f64; 2]) {
        if self.person.age != Age::Adolescent {
            return;
        }
        let ([x, y], color) = (self.head, shade(self.look.top, 0.72));
        let rim = y + 0.3 * up;
        self.pen.pie([x, rim], [1.04 * across, 0.74 * up], [0.0, 180.0], color);
        let brim = match self.facing {
            Facing::Away => return,
            Facing::Towards => [[x - 0.7 * across, rim], [x + 0.7 * across, rim]],
            Facing::Left | Facing::Right => [[x, rim], [x + 1.55 * self.side * across, rim]],
        };
        self.pen.limb(&brim, 0.022, shade(color, 0.7));
    }

    fn profile(&mut self, cap: [f64; 2]) {
        let ([x, y], half, side) = (self.head, self.head_half(), self.side);
        let angles = if side > 0.0 { [62.0, 258.0] } else { [118.0, -78.0] };
        self.pen.pie([x, y], cap, angles, self.look.hair);
        let nose = [x + side * half, y - 0.02 * self.build.head];
        self.pen.oval(nose, [0.1 * self.build.head, 0.09 * self.build.head], self.look.skin);
        let (back, ear) = (-side * 1.25, -side * 0.1);
        self.long_hair([back.min(ear), back.max(ear)], 0.94);
    }

    /// Eyes at these places across the head, and a mouth between or below them.
    fn features(&mut self, eyes: &[f64]) {
        let ([x, y], half, head) = (self.head, self.head_half(), self.build.head);
        for place in eyes {
            let at = [x + place * half, y - 0.04 * head];
            self.pen.oval(at, [0.095 * head, 0.085 * head], WHITE);
            self.pen.oval(
                [at[0] + 0.03 * head * self.side, at[1]],
                [0.055 * head, 0.065 * head],
                DARK,
            );
        }
        let middle = x + 0.6 * half * self.side;
        let width = if self.side == 0.0 { 0.3 } else { 0.18 };
        let mouth =
            [[middle - width * half, y - 0.3 * head], [middle + width * half, y - 0.3 * head]];
        let is_male = self.person.gender == Gender::Male;
        let lips = if is_male { shade(self.look.skin, 0.55) } else { LIPS };
        self.pen.limb(&mouth, 0.045 * head, lips);
        if is_male && matches!(self.person.age, Age::MiddleAged | Age::Elderly) && self.side == 0.0
        {
            let lip =
                [[middle - 0.3 * half, y - 0.22 * head], [middle + 0.3 * half, y - 0.22 * head]];
            self.pen.limb(&lip, 0.06 * head, self.look.hair);
        }
    }
}
