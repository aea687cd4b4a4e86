//! Time of impact.

use super::*;
use crate::reference;

fn motion() -> impl Strategy<Value = RigidMotion> {
    let vector = |size: f32| prop::array::uniform3(-size..size).prop_map(Vec3::from_array);
    (random_pose(5.0), vector(0.5), vector(6.0), vector(5.0)).prop_map(|(pose, center, linear, angular)| {
        RigidMotion { pose, local_center: center, linear_velocity: linear, angular_velocity: angular }
    })
}

/// Distance of the balls at `time`, in f64 but for the poses.
fn gap_at(trees: [&InnerSphereTree; 2], motions: &[RigidMotion; 2], time: f32, kind: BallKind) -> f64 {
    let [a, b] = [0, 1].map(|i| motions[i].pose_at(time));
    reference::distance(trees[0], trees[1], &(a.inverse() * b), kind).gap
}

pub(super) fn hit(result: TimeOfImpact) -> Impact {
    match result {
        TimeOfImpact::Hit(impact) => impact,
        other => panic!("{other:?}"),
    }
}

fn moving(from: Vec3, linear_velocity: Vec3) -> RigidMotion {
    RigidMotion { linear_velocity, ..RigidMotion::at_rest(Pose3::from_translation(from)) }
}

#[test]
fn issue_an_approach_of_nan_counts_as_zero() {
    let ball = ball(0.5);
    let workspace = &mut ProximityWorkspace::default();
    for (speed, meets) in [(1.0, true), (-1.0, false)] {
        let motions = [moving(Vec3::ZERO, Vec3::X * speed), moving(Vec3::X * 0.9, Vec3::ZERO)];
        for ignored_approach in [0.0, f32::NAN] {
            let options = ImpactOptions { ignored_approach, ..Default::default() };
            let found = ball.time_of_impact(&ball, &motions, &options, workspace);
            assert_eq!(matches!(found, TimeOfImpact::Hit(_)), meets, "{speed} {ignored_approach}");
            let plane = |p: Vec3| crate::SurfaceDistance { distance: -0.5 - p.x, outward: Vec3::NEG_X };
            let found = ball.time_of_surface_impact(plane, &motions, &options, workspace);
            assert_eq!(matches!(found, TimeOfImpact::Hit(_)), meets, "{speed} {ignored_approach}");
        }
    }
}

/// Two balls 0.2 m apart that approach by 1 m in a second meet after 0.2 s and would be 0.8 m deep in the end.
#[test]
fn what_does_not_go_deep_is_passed_over_if_asked_for() {
    let ball = ball(0.5);
    let workspace = &mut ProximityWorkspace::default();
    let motions = [moving(Vec3::ZERO, Vec3::X), moving(Vec3::X * 1.2, Vec3::ZERO)];
    for (ignored_depth, meets) in [(f32::NEG_INFINITY, true), (0.7, true), (0.9, false)] {
        let options = ImpactOptions { ignored_depth, ignored_approach: f32::INFINITY, ..Default::default() };
        let found = ball.time_of_impact(&ball, &motions, &options, workspace);
        assert_eq!(matches!(found, TimeOfImpact::Hit(_)), meets, "{ignored_depth}");
        let plane = |p: Vec3| crate::SurfaceDistance { distance: -0.5 - p.x, outward: Vec3::NEG_X };
        let found = ball.time_of_surface_impact(plane, &motions, &options, workspace);
        assert_eq!(matches!(found, TimeOfImpact::Hit(_)), meets, "{ignored_depth}");
        // What meets at the start is the other option's business.
        let together = [motions[0], moving(Vec3::X * 0.9, Vec3::ZERO)];
        let options = ImpactOptions { ignored_depth, ..Default::default() };
        assert_eq!(hit(ball.time_of_impact(&ball, &together, &options, workspace)).time, 0.0);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]
    #[test]
    fn is_never_late_and_at_contact(
        a in random_tree(40), b in random_tree(40), motions in prop::array::uniform2(motion()), kind in random_kind(),
        target_distance in prop_oneof![Just(0.0_f32), 0.0_f32..0.5],
    ) {
        let options = ImpactOptions { balls: kind, target_distance, ..Default::default() };
        let result = a.time_of_impact(&b, &motions, &options, &mut Default::default());
        let rounding = 2e-5 * f64::from(extent(&a, &b, &motions[0].pose) + motions[1].pose.translation.length() + 20.0);
        let (until, found) = match result {
            TimeOfImpact::Hit(impact) => (impact.time, true),
            TimeOfImpact::NoHit => (1.0, false),
            TimeOfImpact::Undecided { safe_time } => return Err(TestCaseError::fail(alloc::format!("{safe_time}"))),
        };
        let target = f64::from(target_distance);
        for sample in 0..100 {
            let time = until * sample as f32 / 100.0;
            let gap = gap_at([&a, &b], &motions, time, kind);
            prop_assert!(gap >= target - rounding || until == 0.0, "{gap} at {time} of {until}");
        }
        if found {
            let gap = gap_at([&a, &b], &motions, until, kind);
            let tolerance = 1e-6 * f64::from(a.bounding_ball().1.min(b.bounding_ball().1));
            prop_assert!(gap <= target + tolerance + rounding, "{gap}");
            prop_assert!(gap >= target - rounding || until == 0.0);
        }
    }

    #[test]
    fn the_witnesses_lie_on_the_balls(
        a in random_tree(60), b in random_tree(60), motions in prop::array::uniform2(motion()),
    ) {
        let TimeOfImpact::Hit(impact) =
            a.time_of_impact(&b, &motions, &ImpactOptions::default(), &mut Default::default())
        else { return Ok(()) };
        for (tree, motion, sphere, point) in [
            (&a, &motions[0], impact.sphere_a, impact.point_a), (&b, &motions[1], impact.sphere_b, impact.point_b),
        ] {
            let (center, radius) = reference::balls(tree, BallKind::Inner)[sphere];
            let outside = point.distance(motion.pose_at(impact.time) * center) - radius;
            let rounding = 2e-4;
            prop_assert!(outside.abs() < rounding || (impact.time == 0.0 && outside < rounding), "{outside}");
        }
    }

    #[test]
    fn few_visits_give_a_safe_time(
        a in random_tree(60), b in random_tree(60), motions in prop::array::uniform2(motion()), max_visits in 0_usize..40,
    ) {
        let mut workspace = ProximityWorkspace::default();
        let whole = a.time_of_impact(&b, &motions, &ImpactOptions::default(), &mut workspace);
        let options = ImpactOptions { max_visits, ..Default::default() };
        match a.time_of_impact(&b, &motions, &options, &mut workspace) {
            TimeOfImpact::Undecided { safe_time } => {
                if let TimeOfImpact::Hit(impact) = whole {
                    prop_assert!(safe_time <= impact.time);
                }
            }
            early => prop_assert_eq!(early, whole),
        }
    }
}

#[test]
fn two_balls_meet_when_the_quadratic_says() {
    let motions = [moving(Vec3::ZERO, Vec3::Y), moving(Vec3::new(10.0, 1.0, 0.0), Vec3::new(-4.0, 1.0, 0.0))];
    let options = ImpactOptions { max_time: 10.0, ..Default::default() };
    let impact = hit(ball(1.0).time_of_impact(&ball(0.5), &motions, &options, &mut Default::default()));
    let exact = (10.0 - (1.5_f32 * 1.5 - 1.0).sqrt()) / 4.0;
    assert!(impact.time <= exact && impact.time > exact - 1e-5, "{} {exact}", impact.time);
    // With a distance of 0.5 they graze the one of radius 2.
    let options = ImpactOptions { target_distance: 0.5, ..options };
    let earlier = hit(ball(1.0).time_of_impact(&ball(0.5), &motions, &options, &mut Default::default()));
    assert!((earlier.time - (10.0 - 3.0_f32.sqrt()) / 4.0).abs() < 1e-5);
}

#[test]
fn a_spinning_dumb_bell_hits_with_its_end() {
    // Balls of radius 0.1 at ±1 on the x axis turn about z at 1 rad/s; a ball of radius 0.1 waits at 90° less the
    // angle under which two such balls, both at distance 1 from the axis, touch.
    let bell = balls(&[(Vec3::X, 0.1), (Vec3::NEG_X, 0.1)]);
    let spin = RigidMotion { angular_velocity: Vec3::Z, ..RigidMotion::at_rest(Pose3::IDENTITY) };
    let waits = RigidMotion::at_rest(Pose3::translation(0.0, 1.0, 0.0));
    let options = ImpactOptions { max_time: 10.0, ..Default::default() };
    let mut workspace = ProximityWorkspace::default();
    let impact = hit(bell.time_of_impact(&ball(0.1), &[spin, waits], &options, &mut workspace));
    let exact = core::f32::consts::FRAC_PI_2 - 2.0 * 0.1_f32.asin();
    assert!(impact.time <= exact && impact.time > exact - 1e-5, "{} {exact}", impact.time);
    assert_eq!((impact.sphere_a, impact.sphere_b), (0, 0));
    // Out of its reach nothing happens in two turns.
    let far = RigidMotion::at_rest(Pose3::translation(0.0, 1.2002, 0.0));
    let result = bell.time_of_impact(&ball(0.1), &[spin, far], &options, &mut workspace);
    assert_eq!(result, TimeOfImpact::NoHit);
    // A body that passes through the middle of the bell while it turns broadside is not hit.
    let through = moving(Vec3::new(0.0, 0.0, -3.0), 3.0 * Vec3::Z);
    assert_eq!(
        bell.time_of_impact(&ball(0.1), &[spin, through], &options, &mut workspace),
        TimeOfImpact::NoHit
    );
}

#[test]
fn bodies_that_begin_in_contact_hit_at_once() {
    let motions = [moving(Vec3::ZERO, Vec3::ZERO), moving(Vec3::X, Vec3::X)];
    let impact =
        hit(ball(1.0).time_of_impact(&ball(1.0), &motions, &Default::default(), &mut Default::default()));
    assert_eq!(impact.time, 0.0);
    assert_eq!(impact.point_a, impact.point_b);
}

#[test]
fn fast_bodies_do_not_tunnel_and_parting_ones_do_not_meet() {
    let wall: Vec<_> = (0..400)
        .map(|i| (Vec3::new(0.0, (i % 20) as f32 * 0.1 - 1.0, (i / 20) as f32 * 0.1 - 1.0), 0.05))
        .collect();
    let wall = balls(&wall);
    let rest = RigidMotion::at_rest(Pose3::IDENTITY);
    let mut workspace = ProximityWorkspace::default();
    let shot = moving(Vec3::new(-50.0, 0.02, 0.03), 10_000.0 * Vec3::X);
    let impact = hit(wall.time_of_impact(&ball(0.05), &[rest, shot], &Default::default(), &mut workspace));
    assert!(impact.time > 0.00498 && impact.time < 0.005);
    let away = RigidMotion { linear_velocity: -10_000.0 * Vec3::X, ..shot };
    let options = ImpactOptions { max_time: f32::INFINITY, ..Default::default() };
    assert_eq!(
        wall.time_of_impact(&ball(0.05), &[rest, away], &options, &mut workspace),
        TimeOfImpact::NoHit
    );
    assert_eq!(
        wall.time_of_impact(
            &ball(0.05),
            &[rest, moving(3.0 * Vec3::X, Vec3::ZERO)],
            &options,
            &mut workspace
        ),
        TimeOfImpact::NoHit
    );
}

#[test]
fn endless_spinning_ends() {
    let spin = RigidMotion { angular_velocity: 50.0 * Vec3::Z, ..RigidMotion::at_rest(Pose3::IDENTITY) };
    let bell = balls(&[(Vec3::X, 0.1), (Vec3::NEG_X, 0.1)]);
    // In the plane of the spin and within reach of no ball, but not of the balls' hull.
    let near = RigidMotion::at_rest(Pose3::translation(0.5, 0.0, 0.0));
    let options = ImpactOptions { max_time: f32::INFINITY, ..Default::default() };
    let result = bell.time_of_impact(&ball(0.2), &[spin, near], &options, &mut Default::default());
    assert!(matches!(result, TimeOfImpact::Undecided { safe_time } if safe_time > 1.0), "{result:?}");
}
