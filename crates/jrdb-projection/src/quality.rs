//! How far a position from points can be trusted.

use jrdb_types::vocab::PlacementQuality;

use crate::box_view::BoxView;
use crate::{BaseCloud, ProjectionConfig};

/// The points in a box, by where they lie to the thing in it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Depths {
    /// At most as far as the thing, ascending.
    pub(crate) up_to_it: Vec<u32>,
    /// At the range of the thing, ascending.
    pub(crate) own: Vec<u32>,
}

impl Depths {
    /// Sorts the points in a box by the range of the points that the rule used.
    pub(crate) fn new(cloud: &BaseCloud, inside: &[u32], [near_m, far_m]: [f64; 2]) -> Self {
        let range = |i: &u32| cloud.point(*i as usize).coords.xy().norm();
        let up_to_it: Vec<u32> = inside.iter().copied().filter(|i| range(i) <= far_m).collect();
        let own = up_to_it.iter().copied().filter(|i| range(i) >= near_m).collect();
        Self { up_to_it, own }
    }

    /// Share of the points up to the thing that are not in front of it; `None` without points.
    pub(crate) fn visible_fraction(&self) -> Option<f64> {
        let all = self.up_to_it.len();
        (all > 0).then(|| self.own.len() as f64 / all as f64)
    }
}

/// Poor: fewer than `few_points` points, or a whole person of a height that no person has. Doubtful: fewer than
/// `good_points` points, less visible than `good_visible_fraction`, or points over a longer range than
/// twice `bin_m`. Else good.
pub(crate) fn quality(
    points_used: usize,
    [near_m, far_m]: [f64; 2],
    visible_fraction: Option<f64>,
    person: Option<&BoxView>,
    config: &ProjectionConfig,
) -> PlacementQuality {
    let is_odd = person.is_some_and(|view| {
        let [top, bottom] = view.heights_m(near_m);
        let [low, high] = config.person_height_m;
        let cut_off = view.cut_off.contains(&true);
        top - bottom > high + config.bin_m || (!cut_off && top - bottom < low - config.bin_m)
    });
    if is_odd || points_used < config.few_points {
        return PlacementQuality::Poor;
    }
    let is_good = points_used >= config.good_points
        && visible_fraction.is_some_and(|share| share >= config.good_visible_fraction)
        && far_m - near_m <= 2.0 * config.bin_m;
    if is_good { PlacementQuality::Good } else { PlacementQuality::Doubtful }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_in_front_is_not_visible() {
        let x = vec![2.0, 4.0, 4.2, 9.0, 4.1];
        let cloud = BaseCloud { x, y: vec![0.0; 5], z: vec![0.0; 5], ..BaseCloud::default() };
        let depths = Depths::new(&cloud, &[0, 1, 2, 3, 4], [3.9, 4.3]);
        assert_eq!(depths.up_to_it, [0, 1, 2, 4]);
        assert_eq!(depths.visible_fraction(), Some(0.75));
        assert_eq!(Depths::new(&cloud, &[], [0.0, 1.0]).visible_fraction(), None);
    }

    #[test]
    fn few_points_are_poor_and_half_hidden_ones_doubtful() {
        let config = ProjectionConfig::default();
        let of = |points, visible| quality(points, [4.0, 4.4], Some(visible), None, &config);
        assert_eq!(of(config.few_points - 1, 1.0), PlacementQuality::Poor);
        assert_eq!(of(100, 0.1), PlacementQuality::Doubtful);
        assert_eq!(of(config.good_points - 1, 1.0), PlacementQuality::Doubtful);
        assert_eq!(of(100, 1.0), PlacementQuality::Good);
    }
}
