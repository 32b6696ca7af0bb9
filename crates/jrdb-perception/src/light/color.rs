//! Colours of clothes, by counting pixels.

use std::collections::BTreeMap;

use jrdb_types::vocab::Color;
use jrdb_types::{Belief, Image};

/// Pixels of a colour are counted when they are at least this part of all.
const MIN_SHARE: f64 = 0.15;
/// Below this share of the most frequent colour, the colour is unknown.
const MIN_BEST_SHARE: f64 = 0.4;

/// Up to this value (0 to 1) a pixel is black: in a lit room of a JRDB frame dark clothes lie
/// below.
const BLACK_MAX_VALUE: f64 = 0.2;
/// Up to this saturation a pixel has no hue.
const GRAY_MAX_SATURATION: f64 = 0.2;
/// From this value on a pixel without a hue is white.
const WHITE_MIN_VALUE: f64 = 0.7;
/// Up to this value orange is brown.
const BROWN_MAX_VALUE: f64 = 0.55;
/// Up to this saturation, from the value on, red is pink.
const PINK_MAX_SATURATION: f64 = 0.55;
const PINK_MIN_VALUE: f64 = 0.6;

/// Where one hue ends and the next begins, degrees; beyond the last it is red again.
const HUES: [(f64, Color); 6] = [
    (15.0, Color::Red),
    (40.0, Color::Orange),
    (70.0, Color::Yellow),
    (165.0, Color::Green),
    (255.0, Color::Blue),
    (300.0, Color::Purple),
];
const PINK_MAX_DEGREES: f64 = 345.0;

/// The colours of a picture by their share of its pixels; nothing where no colour has much of it.
pub(crate) fn colors(picture: &Image) -> Belief<Color> {
    let (pixels, _) = picture.rgb.as_chunks::<3>();
    let mut counts: BTreeMap<Color, usize> = BTreeMap::new();
    pixels.iter().for_each(|pixel| *counts.entry(color(*pixel)).or_default() += 1);
    let mut shares: BTreeMap<Color, f64> =
        counts.into_iter().map(|(color, n)| (color, n as f64 / pixels.len() as f64)).collect();
    if shares.values().all(|share| *share < MIN_BEST_SHARE) {
        return Belief::default();
    }
    shares.retain(|_, share| *share >= MIN_SHARE);
    Belief(shares)
}

/// The colour of one pixel, by hue, saturation and value (Smith 1978).
fn color(rgb: [u8; 3]) -> Color {
    let [r, g, b] = rgb.map(|byte| f64::from(byte) / 255.0);
    let value = r.max(g).max(b);
    let spread = value - r.min(g).min(b);
    let saturation = if value > 0.0 { spread / value } else { 0.0 };
    match () {
        () if value <= BLACK_MAX_VALUE => Color::Black,
        () if saturation <= GRAY_MAX_SATURATION && value >= WHITE_MIN_VALUE => Color::White,
        () if saturation <= GRAY_MAX_SATURATION => Color::Gray,
        () => of_hue(hue_deg([r, g, b], value, spread), saturation, value),
    }
}

/// Hue in `[0, 360)`, degrees, red 0, green 120; `value` is the largest part, `spread` its distance
/// to the smallest, above 0.
fn hue_deg([r, g, b]: [f64; 3], value: f64, spread: f64) -> f64 {
    let sixths = if value == r {
        (g - b) / spread
    } else if value == g {
        2.0 + (b - r) / spread
    } else {
        4.0 + (r - g) / spread
    };
    (60.0 * sixths).rem_euclid(360.0)
}

fn of_hue(hue_deg: f64, saturation: f64, value: f64) -> Color {
    let named = HUES.iter().find(|(end, _)| hue_deg < *end).map(|(_, color)| *color);
    let is_light = saturation <= PINK_MAX_SATURATION && value >= PINK_MIN_VALUE;
    match named {
        Some(Color::Orange) if value <= BROWN_MAX_VALUE => Color::Brown,
        Some(Color::Red) if is_light => Color::Pink,
        Some(color) => color,
        None if hue_deg < PINK_MAX_DEGREES || is_light => Color::Pink,
        None => Color::Red,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_that_everybody_would_name_are_named_so() {
        let cases = [
            ([10, 12, 20], Color::Black),
            ([240, 240, 235], Color::White),
            ([120, 125, 118], Color::Gray),
            ([200, 20, 25], Color::Red),
            ([250, 140, 20], Color::Orange),
            ([240, 220, 40], Color::Yellow),
            ([30, 140, 50], Color::Green),
            ([30, 60, 200], Color::Blue),
            ([120, 40, 180], Color::Purple),
            ([250, 150, 190], Color::Pink),
            ([110, 70, 35], Color::Brown),
        ];
        for (rgb, expected) in cases {
            assert_eq!(color(rgb), expected, "{rgb:?}");
        }
    }

    #[test]
    fn shares_are_told_and_a_motley_has_no_colour() {
        let mut rgb = [[200, 20, 25]; 3].concat();
        rgb.extend([10, 10, 10]);
        let belief = colors(&Image { width: 4, height: 1, rgb });
        assert_eq!(belief.probability(Color::Red), 0.75);
        assert_eq!(belief.probability(Color::Black), 0.25);
        let motley = [[200, 20, 25], [30, 60, 200], [30, 140, 50], [10, 10, 10]].concat();
        assert!(colors(&Image { width: 4, height: 1, rgb: motley }).is_unknown());
        assert!(colors(&Image { width: 0, height: 0, rgb: Vec::new() }).is_unknown());
    }
}
