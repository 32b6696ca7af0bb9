//! What people wear on the head and around the neck, and beards.

use super::head::{DARK, WHITE};
use super::person::{Facing, Figure};
use crate::feature::Feature;
use crate::room::Color;

const LENS: Color = [196, 226, 240];
const RIM: Color = [12, 12, 16];
const LIPS: Color = [176, 60, 64];
const CUPS: [Color; 3] = [[236, 30, 40], [30, 120, 240], [250, 250, 250]];
const BAND: Color = [16, 16, 18];

impl Figure<'_> {
    /// From the neck upwards, over the face.
    pub(super) fn worn_on_the_head(&mut self) {
        self.scarf();
        if self.facing != Facing::Away {
            self.beard();
            self.glasses();
        }
        self.headphones();
    }

    fn beard(&mut self) {
        if !self.has(Feature::Beard) {
            return;
        }
        let ([x, y], half, tall) = (self.head, self.head_half(), self.build.head / 2.0);
        let angles = match self.facing {
            Facing::Left => [165.0, 285.0],
            Facing::Right => [255.0, 375.0],
            Facing::Towards | Facing::Away => [198.0, 342.0],
        };
        self.pen.pie([x, y - 0.04 * tall], [1.06 * half, 1.12 * tall], angles, self.look.hair);
        let middle = x + 0.6 * half * self.side;
        let width = if self.side == 0.0 { 0.26 } else { 0.14 };
        let mouth = [-1.0, 1.0].map(|end| [middle + end * width * half, y - 0.58 * tall]);
        self.pen.limb(&mouth, 0.1 * tall, LIPS);
    }

    fn glasses(&mut self) {
        if !self.has(Feature::Glasses) {
            return;
        }
        let ([x, y], half, head) = (self.head, self.head_half(), self.build.head);
        let y = y - 0.03 * head;
        let eyes: &[f64] = if self.side == 0.0 { &[-0.45, 0.45] } else { &[0.55 * self.side] };
        let ear = [x - 0.2 * half * self.side, y + 0.02 * head];
        let bridge = match self.facing {
            Facing::Towards | Facing::Away => [[x - 0.9 * half, y], [x + 0.9 * half, y]],
            Facing::Left | Facing::Right => [ear, [x + 0.8 * half * self.side, y]],
        };
        self.pen.limb(&bridge, 0.05 * head, RIM);
        for place in eyes {
            let at = [x + place * half, y];
            self.pen.oval(at, [0.175 * head, 0.16 * head], RIM);
            self.pen.oval(at, [0.115 * head, 0.105 * head], LENS);
            self.pen.oval([at[0] + 0.02 * head * self.side, y], [0.04 * head, 0.05 * head], DARK);
        }
    }

    /// A band over the crown and a cup on each ear that is seen.
    fn headphones(&mut self) {
        if !self.has(Feature::Headphones) {
            return;
        }
        let ([x, y], half, tall) = (self.head, self.head_half(), self.build.head / 2.0);
        let color = CUPS[self.person.number as usize % CUPS.len()];
        let ears: &[f64] = if self.side == 0.0 { &[-1.08, 1.08] } else { &[-0.1 * self.side] };
        let arc = |step: i32| {
            let (sin, cos) = (f64::from(step) * std::f64::consts::PI / 12.0).sin_cos();
            let across = if self.side == 0.0 { 1.1 } else { 0.1 };
            [x - 0.1 * half * self.side + across * half * cos, y + 1.1 * tall * sin]
        };
        let band: Vec<[f64; 2]> = (0..=12).map(arc).collect();
        self.pen.limb(&band, 0.026, BAND);
        for ear in ears {
            let at = [x + ear * half, y - 0.02];
            self.pen.oval(at, [0.034, 0.046], WHITE);
            self.pen.oval(at, [0.027, 0.039], color);
        }
    }
}
