//! Patterns of shirts, and what is worn or carried over them.

use jrdb_types::Action;

use super::person::{ARM, Facing, Figure};
use super::shade::shade;
use crate::feature::Feature;
use crate::room::Color;

const LIGHT: Color = [250, 250, 246];
const NIGHT: Color = [18, 22, 58];
const COLLAR: Color = [250, 250, 250];
const TIES: [Color; 3] = [[20, 20, 24], [190, 16, 30], [18, 34, 120]];
const SCARVES: [Color; 4] = [[252, 214, 20], [226, 22, 120], [26, 200, 130], [250, 250, 250]];
const APRONS: [Color; 2] = [[244, 238, 220], [30, 34, 38]];
const UMBRELLAS: [Color; 3] = [[16, 18, 24], [200, 24, 40], [26, 60, 190]];

/// Stripes and dots around the trunk lie this far apart.
const STRIPE: f64 = 0.052;
const DOT: f64 = 0.058;

impl Figure<'_> {
    pub(super) fn has(&self, feature: Feature) -> bool {
        self.person.features.contains(&feature)
    }

    /// One of some colours, another for each person; the next one where it would hardly show on the
    /// shirt.
    pub(super) fn accent(&self, colors: &[Color]) -> Color {
        let first = self.person.number as usize;
        let apart = |color: &Color| {
            let sides = color.iter().zip(self.look.top);
            sides.map(|(a, b)| u32::from(a.abs_diff(b))).sum::<u32>() > 150
        };
        let mut turns = (first..first + colors.len()).map(|at| colors[at % colors.len()]);
        turns.find(apart).unwrap_or(colors[0])
    }

    /// The colour of a pattern: dark on light shirts, light on dark ones.
    fn pattern(&self) -> Color {
        let sum: u32 = self.look.top.iter().map(|part| u32::from(*part)).sum();
        if sum > 420 { NIGHT } else { LIGHT }
    }

    /// Middle and half of the trunk at a height.
    fn trunk_at(&self, y: f64) -> [f64; 2] {
        let (shoulder, waist) = (self.build.neck - 0.035, self.build.hip + 0.1);
        let part = ((y - waist) / (shoulder - waist)).clamp(0.0, 1.0);
        [self.lean * (0.4 + 0.6 * part), self.half * (0.9 + 0.08 * part)]
    }

    pub(super) fn shirt(&mut self) {
        let (low, high) = (self.build.hip + 0.03, self.build.neck - 0.03);
        if self.has(Feature::StripedShirt) {
            let color = self.pattern();
            for row in 0..((high - low) / STRIPE) as usize + 1 {
                let y = low + row as f64 * STRIPE;
                let [x, half] = self.trunk_at(y);
                self.rectangle([[x - half, y], [x + half, (y + 0.5 * STRIPE).min(high)]], color);
            }
        } else if self.has(Feature::DottedShirt) {
            for row in 0..((high - low) / DOT) as usize + 1 {
                self.dots(low + row as f64 * DOT + 0.015, row % 2);
            }
        }
    }

    /// A row of dots; odd rows lie half a step aside.
    fn dots(&mut self, y: f64, odd: usize) {
        let ([x, half], color) = (self.trunk_at(y), self.pattern());
        let first = if odd == 1 { -1.0 } else { -1.5 };
        for at in (0..4).map(|step| (first + f64::from(step)) * DOT) {
            if at.abs() + 0.012 < half {
                self.pen.oval([x + at, y], [0.016, 0.016], color);
            }
        }
    }

    /// The pattern on an arm from shoulder to wrist.
    pub(super) fn sleeve(&mut self, arm: &[[f64; 2]; 3], factor: f64) {
        let (striped, dotted) = (self.has(Feature::StripedShirt), self.has(Feature::DottedShirt));
        let color = shade(self.pattern(), factor);
        for part in arm.windows(2) {
            for share in [0.15, 0.5, 0.85] {
                let between = |axis: usize| part[0][axis] + share * (part[1][axis] - part[0][axis]);
                let [x, y] = [between(0), between(1)];
                if striped {
                    let half = [0.5 * ARM, 0.011];
                    self.rectangle([[x - half[0], y - half[1]], [x + half[0], y + half[1]]], color);
                } else if dotted && share != 0.5 {
                    self.pen.oval([x, y], [0.014, 0.014], color);
                }
            }
        }
    }

    /// What covers the shirt.
    pub(super) fn clothes(&mut self) {
        if self.has(Feature::Apron) {
            self.apron();
        }
        if self.has(Feature::Tie) && self.facing == Facing::Towards {
            self.tie();
        }
    }

    fn apron(&mut self) {
        let color = self.accent(&APRONS);
        let (neck, hip, half) = (self.build.neck, self.build.hip, self.half);
        let hem = hip - if self.person.action == Action::Sitting { 0.06 } else { 0.19 };
        if self.facing == Facing::Towards {
            let bib = [[-0.6 * half, hip + 0.1], [0.6 * half, neck - 0.07]];
            for side in [-1.0, 1.0] {
                let strap = [[0.5 * side * half, neck - 0.08], [0.35 * side * half, neck]];
                self.pen.limb(&strap, 0.016, color);
            }
            self.rectangle(bib, color);
            self.rectangle([[-1.08 * half, hem], [1.08 * half, hip + 0.11]], color);
        } else if self.side != 0.0 {
            let (front, lean) = (self.side * half, self.lean);
            let across = |a: f64, b: f64| [a.min(b), a.max(b)];
            let [left, right] = across(lean + 0.35 * front, lean + 1.15 * front);
            self.rectangle([[left, hip + 0.1], [right, neck - 0.07]], color);
            let reach = if self.person.action == Action::Sitting { 2.6 } else { 1.25 };
            let [left, right] = across(-0.2 * front, reach * front);
            self.rectangle([[left, hem], [right, hip + 0.11]], color);
        }
    }

    fn tie(&mut self) {
        let (neck, low, color) = (self.build.neck, self.build.hip + 0.06, self.accent(&TIES));
        for side in [-1.0, 1.0] {
            let collar = [[0.0, neck - 0.055], [0.05 * side, neck + 0.012], [0.0, neck + 0.012]];
            self.pen.polygon(&collar, COLLAR);
        }
        self.pen.polygon(
            &[[-0.022, neck], [0.022, neck], [0.013, neck - 0.035], [-0.013, neck - 0.035]],
            color,
        );
        let blade = [
            [-0.012, neck - 0.03],
            [0.012, neck - 0.03],
            [0.03, low + 0.035],
            [0.0, low],
            [-0.03, low + 0.035],
        ];
        self.pen.polygon(&blade, color);
    }

    /// Around the neck; an end hangs down in front, or behind of who is seen from there.
    pub(super) fn scarf(&mut self) {
        if !self.has(Feature::Scarf) {
            return;
        }
        let (color, neck, lean) = (self.accent(&SCARVES), self.build.neck, self.lean);
        let half = 0.052;
        let end = lean + if self.side == 0.0 { 0.035 } else { 0.03 * self.side };
        self.rectangle([[end - 0.022, neck - 0.19], [end + 0.022, neck]], shade(color, 0.85));
        self.pen.limb(&[[lean - half, neck], [lean + half, neck]], 0.058, color);
    }

    /// A closed umbrella in the left hand as the picture shows it, point down.
    pub(super) fn umbrella(&mut self, arm: &[[f64; 2]; 3]) {
        if !self.has(Feature::Umbrella) {
            return;
        }
        let ([x, y], color) = (arm[2], UMBRELLAS[self.person.number as usize % UMBRELLAS.len()]);
        let long = (y - 0.02).min(0.34);
        let cloth = [
            [x - 0.012, y - 0.03],
            [x + 0.012, y - 0.03],
            [x + 0.036, y - 0.09],
            [x + 0.005, y - long],
            [x - 0.005, y - long],
            [x - 0.036, y - 0.09],
        ];
        self.pen.polygon(&cloth, color);
        self.pen.limb(&[[x, y - 0.04], [x, y + 0.03], [x + 0.025, y + 0.045]], 0.016, HANDLE);
    }
}

const HANDLE: Color = [196, 148, 84];
