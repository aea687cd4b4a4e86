//! Time of impact with solids of known distance.

use super::impact::hit;
use super::*;
use crate::{SurfaceDistance, reference};

/// The solid around a hollow ball: nowhere convex.
fn hollow(radius: f32) -> impl Fn(Vec3) -> SurfaceDistance {
    move |point| SurfaceDistance {
        distance: radius - point.length(),
        outward: -point.try_normalize().unwrap_or(Vec3::Y),
    }
}

fn solid_ball(radius: f32) -> impl Fn(Vec3) -> SurfaceDistance {
    move |point| SurfaceDistance {
        distance: point.length() - radius,
        outward: point.try_normalize().unwrap_or(Vec3::Y),
    }
}

fn motion(reach: f32) -> impl Strategy<Value = RigidMotion> {
    let vector = |size: f32| prop::array::uniform3(-size..size).prop_map(Vec3::from_array);
    (random_pose(reach), vector(0.5), vector(6.0), vector(3.0)).prop_map(|(pose, center, linear, angular)| {
        RigidMotion { pose, local_center: center, linear_velocity: linear, angular_velocity: angular }
    })
}

/// Least distance of a ball of the tree from the surface at `time`.
fn gap_at(
    tree: &InnerSphereTree,
    surface: &impl Fn(Vec3) -> SurfaceDistance,
    motions: &[RigidMotion; 2],
    time: f32,
) -> f32 {
    let [a, b] = [0, 1].map(|i| motions[i].pose_at(time));
    let pose = b.inverse() * a;
    let balls = reference::balls(tree, BallKind::Volume);
    balls.iter().map(|(c, r)| surface(pose * *c).distance - r).fold(f32::INFINITY, f32::min)
}

/// Not late, and at contact.
fn check(
    tree: &InnerSphereTree,
    surface: &impl Fn(Vec3) -> SurfaceDistance,
    (motions, tolerance): (&[RigidMotion; 2], f32),
    result: TimeOfImpact,
) -> Result<(), TestCaseError> {
    let (until, found) = match result {
        TimeOfImpact::Hit(impact) => (impact.time, true),
        TimeOfImpact::NoHit => (1.0, false),
        TimeOfImpact::Undecided { .. } => return Err(TestCaseError::fail("undecided")),
    };
    const ROUNDING: f32 = 2e-4;
    for sample in 0..100 {
        let time = until * sample as f32 / 100.0;
        prop_assert!(
            until == 0.0 || gap_at(tree, surface, motions, time) > -ROUNDING,
            "{} of {}",
            time,
            until
        );
    }
    prop_assert!(!found || gap_at(tree, surface, motions, until) < tolerance + ROUNDING);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]
    #[test]
    fn is_never_late_and_at_contact(
        tree in random_tree(40), hollow_motions in prop::array::uniform2(motion(0.5)),
        motions in prop::array::uniform2(motion(5.0)), tolerance in prop_oneof![Just(1e-3_f32), 0.0_f32..0.5],
    ) {
        let mut workspace = ProximityWorkspace::default();
        let options = ImpactOptions { balls: BallKind::Volume, tolerance, ..ImpactOptions::default() };
        let size = tree.bounding_ball().1 + 3.0;
        let result = tree.time_of_surface_impact(hollow(size), &hollow_motions, &options, &mut workspace);
        check(&tree, &hollow(size), (&hollow_motions, tolerance), result)?;
        let result = tree.time_of_surface_impact(solid_ball(1.0), &motions, &options, &mut workspace);
        check(&tree, &solid_ball(1.0), (&motions, tolerance), result)?;
        let result = tree.time_of_convex_impact(solid_ball(1.0), &motions, &options, &mut workspace);
        check(&tree, &solid_ball(1.0), (&motions, tolerance), result)?;
    }
}

/// Where only its balls that pass along the wall are near it, a convex solid is left behind in few visits, and another with a
/// tolerance.
#[test]
fn a_ball_that_passes_by_takes_few_visits() {
    let wall = |point: Vec3| SurfaceDistance { distance: point.y, outward: Vec3::Y };
    let past = RigidMotion {
        linear_velocity: Vec3::X * 100.0,
        ..RigidMotion::at_rest(Pose3::from_translation(Vec3::Y * 1.01))
    };
    let motions = [past, RigidMotion::at_rest(Pose3::IDENTITY)];
    let mut workspace = ProximityWorkspace::default();
    let few = ImpactOptions { max_visits: 10, ..ImpactOptions::default() };
    let convex = ball(1.0).time_of_convex_impact(wall, &motions, &few, &mut workspace);
    assert_eq!(convex, TimeOfImpact::NoHit);
    let any = ball(1.0).time_of_surface_impact(wall, &motions, &few, &mut workspace);
    assert!(matches!(any, TimeOfImpact::Undecided { .. }), "{any:?}");
    let near = ImpactOptions { tolerance: 0.02, ..few };
    let any = ball(1.0).time_of_surface_impact(wall, &motions, &near, &mut workspace);
    assert!(matches!(any, TimeOfImpact::Hit(_)), "{any:?}");
}

/// A corner of a room: inside it all three coordinates are positive.
fn corner(point: Vec3) -> SurfaceDistance {
    let wall = if point.x < point.y { 0 } else { 1 };
    let wall = if point.z < point[wall] { 2 } else { wall };
    SurfaceDistance { distance: point[wall], outward: Vec3::AXES[wall] }
}

#[test]
fn what_passes_by_close_hits_what_stands_in_its_way() {
    let options = ImpactOptions { ignored_depth: 0.5, max_visits: 1, ..ImpactOptions::default() };
    let mut workspace = ProximityWorkspace::default();
    for gap in [0.001_f32, 0.01, 0.1, 0.4] {
        for speed in [6.0_f32, 100.0] {
            let past = RigidMotion {
                linear_velocity: Vec3::NEG_X * speed,
                ..RigidMotion::at_rest(Pose3::from_translation(Vec3::new(5.0, 1.0 + gap, 9.0)))
            };
            let motions = [past, RigidMotion::at_rest(Pose3::IDENTITY)];
            let found = hit(ball(1.0).time_of_surface_impact(corner, &motions, &options, &mut workspace));
            let late = found.time * speed - 4.0;
            assert!(
                (-1e-3..=1e-5).contains(&late) && found.normal == Vec3::NEG_X,
                "{gap} m, {speed} m/s: {found:?}"
            );
        }
    }
}

/// Surfaces are asked about no point that is not finite.
#[test]
fn what_moves_away_for_ever_is_followed_to_no_infinity() {
    let floor = |point: Vec3| {
        assert!(point.is_finite(), "{point}");
        SurfaceDistance { distance: point.y, outward: Vec3::Y }
    };
    let away = RigidMotion {
        linear_velocity: Vec3::new(1.0, 0.1, 0.0),
        ..RigidMotion::at_rest(Pose3::from_translation(Vec3::Y * 1.01))
    };
    let motions = [away, RigidMotion::at_rest(Pose3::IDENTITY)];
    let options = ImpactOptions { ignored_depth: 0.5, max_time: f32::INFINITY, ..ImpactOptions::default() };
    let found = ball(1.0).time_of_surface_impact(floor, &motions, &options, &mut Default::default());
    assert_eq!(found, TimeOfImpact::NoHit);
}

proptest! {
    /// Of the walls that a ball comes near it may go deep into any: into the first one, or into the second while it passes along the
    /// first.
    #[test]
    fn what_goes_deep_is_stopped_before_and_nothing_else(
        tree in random_tree(40), gaps in prop::array::uniform3(0.001_f32..3.0), velocity in prop::array::uniform3(-8.0_f32..2.0),
        share in 0.05_f32..0.4,
    ) {
        let balls = reference::balls(&tree, BallKind::Inner);
        let smallest = balls.iter().map(|(_, r)| *r).fold(f32::INFINITY, f32::min);
        let ignored_depth = share * smallest;
        let lower = balls.iter().map(|(c, r)| c - r).fold(Vec3::INFINITY, Vec3::min);
        let start = Vec3::from_array(gaps) - lower;
        let velocity = Vec3::from_array(velocity);
        let moving = RigidMotion {
            linear_velocity: velocity,
            ..RigidMotion::at_rest(Pose3::from_translation(start))
        };
        let options = ImpactOptions { ignored_depth, ..ImpactOptions::default() };
        let motions = [moving, RigidMotion::at_rest(Pose3::IDENTITY)];
        let found = tree.time_of_surface_impact(corner, &motions, &options, &mut Default::default());
        let (time, is_hit) = match found {
            TimeOfImpact::Hit(impact) => (impact.time, true),
            TimeOfImpact::NoHit => (1.0, false),
            TimeOfImpact::Undecided { .. } => return Err(TestCaseError::fail("undecided")),
        };
        let rounding = 1e-4 * (1.0 + start.abs().max_element());
        let mut nearest = f32::INFINITY;
        for (center, radius) in balls {
            for wall in 0..3 {
                let (gap, speed) = ((center + start)[wall] - radius, -velocity[wall]);
                // The least depths that certainly count, and that may.
                if speed - gap > ignored_depth + rounding {
                    prop_assert!(time * speed - gap < ignored_depth + rounding, "{} of {:?}, {}", wall, velocity, time);
                }
                if speed - gap > ignored_depth - rounding {
                    nearest = nearest.min(gap - time * speed);
                }
            }
        }
        prop_assert!(!is_hit || nearest < rounding, "nothing is nearer than {} at {}", nearest, time);
    }
}

/// It was advanced in steps of its gap, until no visit was left.
#[test]
fn issue_what_passes_by_is_passed_over_if_asked_for() {
    let wall = |point: Vec3| SurfaceDistance { distance: point.y, outward: Vec3::Y };
    let mut workspace = ProximityWorkspace::default();
    for (down, visits, meets) in [(0.0, 1, false), (0.4, 1, false), (0.6, 1 << 16, true)] {
        let past = RigidMotion {
            linear_velocity: Vec3::new(100.0, -down, 0.0),
            ..RigidMotion::at_rest(Pose3::from_translation(Vec3::Y * 1.01))
        };
        let motions = [past, RigidMotion::at_rest(Pose3::IDENTITY)];
        let options = ImpactOptions { ignored_depth: 0.5, max_visits: visits, ..ImpactOptions::default() };
        let found = ball(1.0).time_of_surface_impact(wall, &motions, &options, &mut workspace);
        let expected =
            if meets { matches!(found, TimeOfImpact::Hit(_)) } else { found == TimeOfImpact::NoHit };
        assert!(expected, "{down} m/s: {found:?}");
    }
}
