//! Occlusion: who hides whom from the robot.

use jrdb_types::entity::Hides;
use jrdb_types::{ImageGeometry, PixelBox};

/// What a thing shows to the robot.
#[derive(Debug, Clone, Copy)]
pub struct Silhouette<'a> {
    /// Its image box: its bearings and elevations.
    pub bbox: &'a PixelBox,
    /// Nearest and farthest horizontal range of its own points, or of its centre where there are none, metres.
    pub range_m: [f64; 2],
    /// Indices into the cloud of its own points, ascending.
    pub own: &'a [u32],
    /// Indices of the points in its image box that are at most as far as it is, ascending.
    pub up_to_it: &'a [u32],
}

/// What `front` hides of `behind` from the robot; `None` when nothing.
///
/// `front` must be nearer: the middle of its range at least `clearance_m` before that of `behind`. The image
/// fraction is the share of `behind`'s image box that `front`'s covers (around the seam), an upper bound, as people do not
/// fill their boxes. The point fraction is what the LiDAR saw: of the points in `behind`'s box that are no farther than
/// it, the share that is on `front`. "In front of" holds from
/// [`super::RelationConfig::hides_min_fraction`] of the image fraction.
#[must_use]
pub fn hides(
    front: &Silhouette<'_>,
    behind: &Silhouette<'_>,
    image: ImageGeometry,
    clearance_m: f64,
) -> Option<Hides> {
    let middle = |thing: &Silhouette<'_>| f64::midpoint(thing.range_m[0], thing.range_m[1]);
    let is_nearer = middle(front) + clearance_m <= middle(behind);
    if !is_nearer {
        return None;
    }
    let shared = match image.period_px() {
        Some(period) => behind.bbox.circular_intersection_px2(front.bbox, period),
        None => behind.bbox.intersection_px2(front.bbox),
    };
    let image_fraction = shared / behind.bbox.area_px2();
    (image_fraction > 0.0).then(|| {
        let points = behind.up_to_it.len();
        let on_front = || count_common(front.own, behind.up_to_it) as f64 / points as f64;
        Hides { image_fraction, point_fraction: (points > 0).then(on_front) }
    })
}

/// How many numbers two ascending lists have in common.
fn count_common(a: &[u32], b: &[u32]) -> usize {
    let (short, long) = if a.len() < b.len() { (a, b) } else { (b, a) };
    short.iter().filter(|number| long.binary_search(number).is_ok()).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const IMAGE: ImageGeometry = ImageGeometry { width_px: 1000, height_px: 100, wraps: true };

    fn thing<'a>(
        bbox: &'a PixelBox,
        range_m: f64,
        own: &'a [u32],
        up_to_it: &'a [u32],
    ) -> Silhouette<'a> {
        Silhouette { bbox, range_m: [range_m; 2], own, up_to_it }
    }

    #[test]
    fn the_nearer_one_hides_what_it_covers() {
        let (front, behind) =
            (PixelBox::from([990.0, 0.0, 20.0, 50.0]), PixelBox::from([0.0, 0.0, 20.0, 100.0]));
        let [front, behind] =
            [thing(&front, 2.0, &[3, 4, 9], &[]), thing(&behind, 4.0, &[], &[1, 3, 4, 5])];
        let found = hides(&front, &behind, IMAGE, 0.3).unwrap();
        assert_eq!((found.image_fraction, found.point_fraction), (0.25, Some(0.5)));
        assert_eq!(hides(&behind, &front, IMAGE, 0.3), None);
    }

    #[test]
    fn neighbours_at_one_range_hide_nothing_of_each_other() {
        let bbox = PixelBox::from([10.0, 0.0, 20.0, 50.0]);
        let (a, b) = (thing(&bbox, 2.0, &[], &[]), thing(&bbox, 2.1, &[], &[]));
        assert_eq!((hides(&a, &b, IMAGE, 0.3), hides(&b, &a, IMAGE, 0.3)), (None, None));
    }

    proptest! {
        #[test]
        fn at_most_one_of_two_hides_the_other_and_turning_the_image_changes_nothing(
            a in (0.0..1000.0, 1.0..300.0), b in (0.0..1000.0, 1.0..300.0),
            ranges in prop::array::uniform2(0.5..9.0), turn in 0.0..1000.0,
        ) {
            let bbox = |(x, w): (f64, f64), turn: f64| PixelBox { x: x + turn, y: 0.0, w, h: 9.0 }.wrapped(1000.0);
            let found = |turn: f64| {
                let (a, b) = (bbox(a, turn), bbox(b, turn));
                let (a, b) = (thing(&a, ranges[0], &[], &[]), thing(&b, ranges[1], &[], &[]));
                [hides(&a, &b, IMAGE, 0.3), hides(&b, &a, IMAGE, 0.3)].map(|h| h.map_or(0.0, |h| h.image_fraction))
            };
            let (still, turned) = (found(0.0), found(turn));
            prop_assert!(still[0] == 0.0 || still[1] == 0.0);
            prop_assert!((0..2).all(|i| (0.0..=1.0 + 1e-9).contains(&still[i]) && (still[i] - turned[i]).abs() < 1e-9));
        }
    }
}
