//! Laws of the relations: symmetry, antisymmetry, and that moving and turning the whole scene changes nothing.

use super::*;
use jrdb_types::Box3d;
use nalgebra::Rotation3;
use proptest::prelude::*;
use std::f64::consts::PI;

const PHYSICAL: LateralConvention = LateralConvention::Physical;

fn points() -> impl Strategy<Value = Point3<f64>> {
    (-9.0..9.0, -9.0..9.0, -1.0..1.0).prop_map(|(x, y, z)| Point3::new(x, y, z))
}

fn boxes() -> impl Strategy<Value = Box3d> {
    let size = (0.1..2.0, 0.1..2.0, 0.1..2.0);
    (prop::array::uniform3(-1.5..1.5), size, -7.0..7.0)
        .prop_map(|(center, (l, w, h), heading_rad)| Box3d { center, size: [l, w, h], heading_rad })
}

fn moved(b: &Box3d, turn: f64, shift: &Point3<f64>) -> Box3d {
    let rotation = Rotation3::from_axis_angle(&Vector3::z_axis(), turn);
    let center = rotation * Point3::from(b.center) + shift.coords;
    Box3d { center: center.into(), heading_rad: b.heading_rad + turn, ..*b }
}

/// From where things stand: single precision tells those near each other apart from the first only.
const FAR_M: &[f64] = &[0.0, 0.1, 1e3, 1e6, 1e9];

/// The words of all pairs at once are those of each alone.
fn check_words(centers: &[Point3<f64>], headings: &[f64]) -> Result<(), TestCaseError> {
    let all = pairwise::pairwise(centers, headings, PHYSICAL);
    for (i, from) in centers.iter().enumerate() {
        for (j, to) in centers.iter().enumerate() {
            let alone = from_person(from, Some(headings[i]), to, PHYSICAL);
            prop_assert_eq!(all.distance(i, j), alone.distance);
            prop_assert_eq!(Some(all.direction(i, j)), alone.direction);
        }
    }
    Ok(())
}

/// Upright boxes in awkward poses: on a grid, of one another's size, turned by eighths.
fn awkward() -> impl Strategy<Value = Box3d> {
    let half_metres =
        |range| prop::sample::select(range).prop_map(f64::from).prop_map(|n: f64| n / 2.0);
    let center = prop::array::uniform3(half_metres(vec![-2_i32, -1, 0, 1, 2]));
    let size = prop::array::uniform3(half_metres(vec![0_i32, 1, 2]));
    (center, size, prop::sample::select(vec![-8_i32, -2, -1, 0, 1, 2, 3, 4])).prop_map(
        |(center, size, eighth)| Box3d { center, size, heading_rad: f64::from(eighth) * PI / 4.0 },
    )
}

proptest! {
    #[test]
    fn distance_is_symmetric(a in points(), b in points()) {
        let there = from_person(&a, None, &b, PHYSICAL);
        let back = from_person(&b, None, &a, PHYSICAL);
        prop_assert_eq!(there.distance_m, back.distance_m);
        prop_assert_eq!(there.rise_m.map(|rise| -rise), back.rise_m);
        prop_assert_eq!(there.direction, None);
    }

    #[test]
    fn turning_and_moving_the_whole_scene_changes_no_bearing(
        a in points(), b in points(), heading in -3.0..3.0, turn in -3.0..3.0, shift in points(),
    ) {
        prop_assume!((a - b).xy().norm() > 0.1);
        let rotation = Rotation3::from_axis_angle(&Vector3::z_axis(), turn);
        let moved = |p: &Point3<f64>| rotation * p + shift.coords;
        let before = from_person(&a, Some(heading), &b, PHYSICAL);
        let after = from_person(&moved(&a), Some(heading + turn), &moved(&b), PHYSICAL);
        let change = wrap_rad(before.bearing_rad.unwrap() - after.bearing_rad.unwrap());
        prop_assert!(change.abs() < 1e-9);
    }

    #[test]
    fn facing_the_other_way_exchanges_front_and_back(a in points(), b in points(), heading in -3.0..3.0) {
        let seen = |heading| from_person(&a, Some(heading), &b, PHYSICAL);
        let there = seen(heading).bearing_rad.unwrap();
        let turned = seen(heading + PI).bearing_rad.unwrap();
        prop_assert!((wrap_rad(there - turned).abs() - PI).abs() < 1e-9);
    }

    #[test]
    fn of_two_who_face_the_same_way_one_is_left_and_the_other_right(
        a in points(), b in points(), heading in -3.0..3.0,
    ) {
        let seen = |from: &Point3<f64>, to: &Point3<f64>| {
            from_person(from, Some(heading), to, PHYSICAL).bearing_rad.unwrap()
        };
        prop_assume!((a - b).xy().norm() > 0.1);
        prop_assert!((wrap_rad(seen(&a, &b) - seen(&b, &a)).abs() - PI).abs() < 1e-9);
    }

    #[test]
    fn wrapped_angles_lie_in_one_turn(angle in -100.0..100.0) {
        let wrapped = wrap_rad(angle);
        prop_assert!(wrapped > -PI && wrapped <= PI);
        prop_assert!((wrapped.sin() - f64::sin(angle)).abs() < 1e-9);
    }

    #[test]
    fn all_pairs_at_once_have_the_words_of_each_alone(
        things in prop::collection::vec((points(), -7.0..7.0), 1..12), mirrored in any::<bool>(),
    ) {
        let lateral = if mirrored { LateralConvention::BenchmarkMirrored } else { PHYSICAL };
        let (centers, headings): (Vec<_>, Vec<_>) = things.into_iter().unzip();
        let all = pairwise::pairwise(&centers, &headings, lateral);
        for (i, from) in centers.iter().enumerate() {
            for (j, to) in centers.iter().enumerate() {
                let alone = from_person(from, Some(headings[i]), to, lateral);
                prop_assert_eq!(all.distance(i, j), alone.distance);
                prop_assert_eq!(Some(all.direction(i, j)), alone.direction);
                prop_assert!((all.distance_m(i, j) - alone.distance_m.unwrap()).abs() < 1e-12);
                prop_assert_eq!(Some(all.rise_m(i, j)), alone.rise_m);
            }
        }
    }

    #[test]
    fn bounds_are_decided_as_for_each_alone(
        things in prop::collection::vec(
            (prop::array::uniform3(-8..8_i32), -12..12_i32, prop::sample::select(FAR_M)), 2..40,
        ),
    ) {
        let place = |([x, y, z], _, far_m): ([i32; 3], i32, f64)| {
            Point3::new(x, y, z / 4).cast::<f64>() * 0.5 + Vector3::repeat(far_m)
        };
        let centers: Vec<_> = things.iter().copied().map(place).collect();
        let headings: Vec<_> = things.iter().map(|thing| f64::from(thing.1) * PI / 12.0).collect();
        check_words(&centers, &headings)?;
    }

    #[test]
    fn numbers_at_the_end_of_their_range_are_related_too(
        things in prop::collection::vec((prop::array::uniform3(any::<f64>()), any::<f64>()), 1..5),
    ) {
        let (centers, headings): (Vec<_>, Vec<_>) =
            things.into_iter().map(|(center, heading)| (Point3::from(center), heading)).unzip();
        check_words(&centers, &headings)?;
    }

    #[test]
    fn overlap_and_gap_are_symmetric_and_exclude_each_other(a in boxes(), b in boxes()) {
        let (iou, gap_m) = (overlap::iou(&a, &b), adjacency::gap_m(&a, &b));
        prop_assert_eq!(iou, overlap::iou(&b, &a));
        prop_assert!((gap_m - adjacency::gap_m(&b, &a)).abs() < 1e-12);
        prop_assert!((0.0..=1.0).contains(&iou) && (iou == 0.0 || gap_m == 0.0));
    }

    #[test]
    fn moving_and_turning_two_boxes_together_changes_neither_overlap_nor_gap(
        a in boxes(), b in boxes(), turn in -3.0..3.0, shift in points(),
    ) {
        let (a2, b2) = (moved(&a, turn, &shift), moved(&b, turn, &shift));
        prop_assert!((overlap::iou(&a, &b) - overlap::iou(&a2, &b2)).abs() < 1e-9);
        prop_assert!((adjacency::gap_m(&a, &b) - adjacency::gap_m(&a2, &b2)).abs() < 1e-9);
    }

    #[test]
    fn a_box_is_its_own_equal_wherever_it_is(a in boxes(), turns in -3..3_i32) {
        prop_assert_eq!(overlap::iou(&a, &a), 1.0);
        let turned = Box3d { heading_rad: a.heading_rad + f64::from(turns) * PI, ..a };
        prop_assert_eq!(overlap::iou(&a, &turned), 1.0);
        prop_assert_eq!(adjacency::gap_m(&a, &a), 0.0);
    }

    #[test]
    fn boxes_that_touch_share_nothing_and_have_no_gap(a in boxes(), shift in points(), side in 0..3_usize) {
        let offset = [0, 1, 2].map(|axis| if axis == side { a.size[axis] } else { 0.0 });
        let (sin, cos) = a.heading_rad.sin_cos();
        let [l, w, h] = offset;
        let center = [a.center[0] + cos * l - sin * w, a.center[1] + sin * l + cos * w, a.center[2] + h];
        let (a, b) = (moved(&a, 0.0, &shift), moved(&Box3d { center, ..a }, 0.0, &shift));
        prop_assert_eq!(overlap::iou(&a, &b), 0.0);
        prop_assert!(adjacency::gap_m(&a, &b) < 1e-12);
    }

    #[test]
    fn awkward_boxes_are_bounded_and_symmetric(a in awkward(), b in awkward()) {
        let iou = overlap::iou(&a, &b);
        prop_assert!((0.0..=1.0).contains(&iou), "{iou}");
        prop_assert_eq!(iou, overlap::iou(&b, &a));
        let empty = |b: &Box3d| b.size.contains(&0.0);
        prop_assert!(iou == 0.0 || !(empty(&a) || empty(&b)));
        prop_assert!(adjacency::gap_m(&a, &b).is_finite());
        prop_assert_eq!(overlap::iou(&a, &a), if empty(&a) { 0.0 } else { 1.0 });
    }

    #[test]
    fn nothing_panics_and_nothing_is_nan(
        numbers in prop::array::uniform7(any::<f64>()), b in boxes(),
    ) {
        let [x, y, z, l, w, h, heading_rad] = numbers;
        let a = Box3d { center: [x, y, z], size: [l, w, h], heading_rad };
        prop_assert!((0.0..=1.0).contains(&overlap::iou(&a, &b)));
        prop_assert!(adjacency::gap_m(&a, &b).is_nan() || adjacency::gap_m(&a, &b) >= 0.0);
    }
}

#[test]
fn crossing_boxes_have_no_gap_though_no_corner_is_inside_the_other() {
    let a = Box3d { center: [0.0; 3], size: [4.0, 0.5, 1.0], heading_rad: 0.3 };
    let b = Box3d { heading_rad: a.heading_rad + PI / 2.0, ..a };
    assert_eq!(adjacency::gap_m(&a, &b), 0.0);
    assert!((overlap::iou(&a, &b) - 0.25 / 3.75).abs() < 1e-12);
}

#[test]
fn a_gap_runs_from_corner_to_side() {
    let a = Box3d { center: [0.0; 3], size: [2.0; 3], heading_rad: 0.0 };
    let b = Box3d { center: [4.0, 0.0, 5.0], heading_rad: PI / 4.0, ..a };
    let apart = 4.0 - 1.0 - 2.0_f64.sqrt();
    assert!((adjacency::gap_m(&a, &b) - apart.hypot(3.0)).abs() < 1e-12);
}
