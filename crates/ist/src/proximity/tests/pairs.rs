//! Distance and intersection.

use super::*;
use crate::{OverlapWorkspace, reference};

proptest! {
    #[test]
    fn distance_equals_brute_force(
        a in random_tree(300), b in random_tree(300), pose in random_pose(8.0), kind in random_kind(),
    ) {
        let options = DistanceOptions { balls: kind, ..Default::default() };
        let found = a.distance_with(&b, &pose, &options, &mut Default::default()).unwrap();
        let exact = reference::distance(&a, &b, &pose, kind);
        let rounding = 3e-6 * f64::from(extent(&a, &b, &pose));
        let error = f64::from(found.distance) - exact.gap.max(0.0);
        prop_assert!((-1e-6 * exact.gap.abs()..=rounding).contains(&error), "{error}");
        prop_assert!(f64::from(found.lower_bound) <= exact.gap.max(0.0));
        prop_assert!(f64::from(found.lower_bound) >= exact.gap - rounding);
        check_witnesses(&a, &b, &pose, kind, &found)?;
    }

    #[test]
    fn early_ends_hold_the_distance_between_their_bounds(
        a in random_tree(300), b in random_tree(300), pose in random_pose(10.0), kind in random_kind(),
        tolerance in 0.0_f32..1.0, max_visits in 0_usize..60,
    ) {
        let exact = reference::distance(&a, &b, &pose, kind).gap.max(0.0);
        let rounding = 3e-6 * f64::from(extent(&a, &b, &pose));
        let mut workspace = ProximityWorkspace::default();
        let tolerant = DistanceOptions { balls: kind, tolerance, ..Default::default() };
        let bounded = DistanceOptions { balls: kind, max_visits, ..Default::default() };
        for options in [tolerant, bounded] {
            let found = a.distance_with(&b, &pose, &options, &mut workspace).unwrap();
            prop_assert!(f64::from(found.lower_bound) <= exact);
            prop_assert!(f64::from(found.distance) >= exact * (1.0 - 1e-6));
            check_witnesses(&a, &b, &pose, kind, &found)?;
            if options.max_visits == usize::MAX {
                prop_assert!(f64::from(found.distance) <= exact + f64::from(tolerance) + rounding);
                let width = f64::from(found.distance - found.lower_bound);
                prop_assert!(width <= f64::from(tolerance) + rounding);
            }
        }
    }

    #[test]
    fn a_largest_distance_only_hides_what_is_farther(
        a in random_tree(100), b in random_tree(100), pose in random_pose(10.0), max_distance in 0.0_f32..10.0,
    ) {
        let mut workspace = ProximityWorkspace::default();
        let all = a.distance(&b, &pose, &mut workspace).unwrap();
        let options = DistanceOptions { max_distance, ..Default::default() };
        let near = a.distance_with(&b, &pose, &options, &mut workspace);
        let rounding = 3e-6 * extent(&a, &b, &pose);
        if (all.distance - max_distance).abs() > rounding {
            prop_assert_eq!(near.map(|near| near.distance), (all.distance < max_distance).then_some(all.distance));
        }
    }

    #[test]
    fn distance_is_symmetric(a in random_tree(100), b in random_tree(100), pose in random_pose(8.0)) {
        let mut workspace = ProximityWorkspace::default();
        let ab = a.distance(&b, &pose, &mut workspace).unwrap();
        let ba = b.distance(&a, &pose.inverse(), &mut workspace).unwrap();
        prop_assert!((ab.distance - ba.distance).abs() <= 1e-5 * extent(&a, &b, &pose));
    }

    #[test]
    fn intersects_as_the_overlap_says(a in random_tree(300), b in random_tree(300), pose in random_pose(5.0)) {
        let overlap = a.overlap(&b, &pose, &mut OverlapWorkspace::default());
        prop_assert_eq!(a.intersects(&b, &pose, &mut Default::default()), overlap.intersects);
        let gap = reference::distance(&a, &b, &pose, BallKind::Inner).gap;
        if gap.abs() > 3e-6 * f64::from(extent(&a, &b, &pose)) {
            prop_assert_eq!(a.intersects(&b, &pose, &mut Default::default()), gap < 0.0);
        }
    }

    /// Of two balls of 0.5 m, 173 m from the origins of their frames and up to 20 µm apart, every ninth pair was said to meet.
    #[test]
    fn issue_balls_that_are_apart_do_not_intersect(
        radii in prop::array::uniform2(0.1_f32..1.0), scales in prop::array::uniform2(0.2_f32..5.0),
        origins in prop::array::uniform2(prop::array::uniform3(-100.0_f32..100.0)), far in prop_oneof![Just(0.0_f32), Just(1.0)],
        pose in random_pose(1.0), gap in -1e-6_f32..1e-6,
    ) {
        let solid = |i: usize| {
            balls(&[(Vec3::from_array(origins[i]) * far, radii[i])]).scaled(scales[i]).unwrap()
        };
        let (a, b) = (solid(0), solid(1));
        let [center_a, center_b] = [&a, &b].map(|tree| tree.inner_balls().next().unwrap().0);
        let away = pose.translation.try_normalize().unwrap_or(Vec3::X);
        let distance = radii[0] * scales[0] + radii[1] * scales[1] + gap * (1.0 + 100.0 * far);
        let pose = Pose3::from_parts(center_a + away * distance - pose.rotation * center_b, pose.rotation);
        let meet = reference::distance(&a, &b, &pose, BallKind::Inner).gap < 0.0;
        let said = a.intersects(&b, &pose, &mut Default::default());
        prop_assert!(meet || !said);
        prop_assert_eq!(a.overlap(&b, &pose, &mut OverlapWorkspace::default()).intersects, said);
    }

    #[test]
    fn a_used_workspace_changes_nothing(
        a in random_tree(200), b in random_tree(200), poses in prop::collection::vec(random_pose(6.0), 2..5),
    ) {
        let mut workspace = ProximityWorkspace::default();
        for pose in &poses {
            let fresh = a.distance(&b, pose, &mut ProximityWorkspace::default());
            prop_assert_eq!(a.distance(&b, pose, &mut workspace), fresh);
            let bounded = DistanceOptions { max_visits: 9, ..Default::default() };
            let fresh = a.distance_with(&b, pose, &bounded, &mut ProximityWorkspace::default());
            prop_assert_eq!(a.distance_with(&b, pose, &bounded, &mut workspace), fresh);
            let fresh = a.penetration(&b, pose, &mut ProximityWorkspace::default());
            prop_assert_eq!(a.penetration(&b, pose, &mut workspace), fresh);
            let fresh = a.intersects(&b, pose, &mut ProximityWorkspace::default());
            prop_assert_eq!(a.intersects(&b, pose, &mut workspace), fresh);
            let towards = RigidMotion { linear_velocity: -pose.translation, ..RigidMotion::at_rest(*pose) };
            let motions = [RigidMotion::at_rest(Pose3::IDENTITY), towards];
            let fresh = a.time_of_impact(&b, &motions, &Default::default(), &mut ProximityWorkspace::default());
            prop_assert_eq!(a.time_of_impact(&b, &motions, &Default::default(), &mut workspace), fresh);
        }
    }
}

/// Witnesses lie on the balls that are named, as far apart as the distance says.
fn check_witnesses(
    a: &InnerSphereTree,
    b: &InnerSphereTree,
    pose: &Pose3,
    kind: BallKind,
    found: &Separation,
) -> Result<(), TestCaseError> {
    let rounding = 1e-5 * extent(a, b, pose);
    let (center_a, radius_a) = reference::balls(a, kind)[found.sphere_a];
    let (center_b, radius_b) = reference::balls(b, kind)[found.sphere_b];
    let center_b = *pose * center_b;
    prop_assert!((found.point_a.distance(found.point_b) - found.distance).abs() <= rounding);
    prop_assert!((found.normal.length() - 1.0).abs() < 1e-5);
    let outside = (found.point_a.distance(center_a) - radius_a, found.point_b.distance(center_b) - radius_b);
    if found.distance > 0.0 {
        prop_assert!(outside.0.abs() <= rounding && outside.1.abs() <= rounding);
        let along = found.point_a + found.distance * found.normal;
        prop_assert!(along.distance(found.point_b) <= rounding);
    } else {
        prop_assert!(outside.0 <= rounding && outside.1 <= rounding);
    }
    Ok(())
}

#[test]
fn two_balls() {
    let pose = Pose3::translation(0.0, 4.0, 0.0);
    let found = ball(1.0).distance(&ball(0.5), &pose, &mut Default::default()).unwrap();
    assert_eq!((found.distance, found.sphere_a, found.sphere_b), (2.5, 0, 0));
    assert_eq!((found.point_a, found.point_b, found.normal), (Vec3::Y, 3.5 * Vec3::Y, Vec3::Y));
    assert!(found.lower_bound <= 2.5 && found.lower_bound > 2.4999);
}

#[test]
fn more_visits_tighten_the_bounds() {
    let row: Vec<_> =
        (0..400).map(|i| (Vec3::new(0.1 * i as f32, (i % 7) as f32 * 0.1, 0.0), 0.04)).collect();
    let (a, b) = (balls(&row), balls(&row));
    let pose = Pose3::from_parts(Vec3::new(1.0, 3.0, 0.5), Quat::from_rotation_z(0.3));
    let mut last = f32::INFINITY;
    for max_visits in [0, 8, 64, 512, 4096] {
        let options = DistanceOptions { max_visits, ..Default::default() };
        let found = a.distance_with(&b, &pose, &options, &mut Default::default()).unwrap();
        let width = found.distance - found.lower_bound;
        assert!(width <= last, "{max_visits}");
        last = width;
    }
    assert!(last < 1e-3);
}
