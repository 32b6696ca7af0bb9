//! Between: who stands in the straight way from one to another.

use nalgebra::Point3;

/// Where a point lies along and beside the line between two others, horizontally.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Along {
    /// Where along the line, from 0 at the first to 1 at the second.
    pub fraction: f64,
    /// Distance from the line, metres.
    pub offset_m: f64,
}

/// Where `middle` lies between `ends`; `None` unless its foot on the line is strictly between them.
///
/// "Between" holds up to [`super::RelationConfig::between_max_offset_m`] from the line and from
/// [`super::RelationConfig::between_min_inside_m`] away from either end, for ends at most
/// [`super::RelationConfig::between_max_apart_m`] apart.
///
/// ```
/// use jrdb_projection::{nalgebra::Point3, relation::between};
/// let at = |x, y| Point3::new(x, y, 0.0);
/// let found = between::along(&at(1.0, 0.2), [&at(0.0, 0.0), &at(4.0, 0.0)]).unwrap();
/// assert_eq!((found.fraction, found.offset_m), (0.25, 0.2));
/// ```
#[must_use]
pub fn along(middle: &Point3<f64>, ends: [&Point3<f64>; 2]) -> Option<Along> {
    let line = (ends[1] - ends[0]).xy();
    let to_middle = (middle - ends[0]).xy();
    let length_m = line.norm();
    let fraction = to_middle.dot(&line) / (length_m * length_m);
    let offset_m = to_middle.perp(&line).abs() / length_m;
    (fraction > 0.0 && fraction < 1.0).then_some(Along { fraction, offset_m })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn nobody_is_between_two_at_one_place_or_beyond_the_ends() {
        let at = |x: f64| Point3::new(x, 0.0, 0.0);
        assert_eq!(along(&at(1.0), [&at(0.0), &at(0.0)]), None);
        assert_eq!(along(&at(0.0), [&at(0.0), &at(2.0)]), None);
        assert_eq!(along(&at(3.0), [&at(0.0), &at(2.0)]), None);
    }

    proptest! {
        #[test]
        fn the_ends_may_be_exchanged_and_at_most_one_of_three_is_near_the_middle(
            p in prop::array::uniform3(prop::array::uniform2(-5.0..5.0)),
        ) {
            let [a, b, c] = p.map(|[x, y]| Point3::new(x, y, 0.0));
            if let (Some(there), Some(back)) = (along(&b, [&a, &c]), along(&b, [&c, &a])) {
                prop_assert!((there.offset_m - back.offset_m).abs() < 1e-9);
                prop_assert!((there.fraction + back.fraction - 1.0).abs() < 1e-9);
            }
        }
    }
}
