//! Useless poses, extreme sizes and coincidence.

use super::*;
use crate::reference;
use core::ops::ControlFlow;

fn useless() -> [Pose3; 5] {
    [
        Pose3::translation(f32::NAN, 0.0, 0.0),
        Pose3::translation(f32::INFINITY, 0.0, 0.0),
        Pose3::translation(1e30, 0.0, 0.0),
        Pose3::from_rotation(Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)),
        Pose3::from_rotation(Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0)),
    ]
}

fn grid(count: usize, step: f32, radius: f32) -> InnerSphereTree {
    let at = |i: usize| Vec3::new((i % 10) as f32, (i / 10 % 10) as f32, (i / 100) as f32) * step;
    let list: Vec<_> = (0..count).map(|i| (at(i), radius)).collect();
    balls(&list)
}

#[test]
fn useless_poses_have_stated_results() {
    let (a, b) = (grid(300, 0.3, 0.1), ball(1.0));
    let mut workspace = ProximityWorkspace::default();
    for pose in useless() {
        assert_eq!(a.distance(&b, &pose, &mut workspace), None);
        assert!(!a.intersects(&b, &pose, &mut Default::default()));
        assert_eq!(a.penetration(&b, &pose, &mut workspace), None);
        if pose.translation.x == 1e30 {
            continue;
        }
        let motions = [RigidMotion::at_rest(pose), RigidMotion::at_rest(Pose3::IDENTITY)];
        let result = a.time_of_impact(&b, &motions, &ImpactOptions::default(), &mut workspace);
        assert_eq!(result, TimeOfImpact::Undecided { safe_time: 0.0 });
    }
}

#[test]
fn rotations_near_unit_length_are_normalised() {
    let (a, b) = (grid(300, 0.3, 0.1), grid(100, 0.5, 0.2));
    let mut workspace = ProximityWorkspace::default();
    for shift in [Vec3::splat(-3.5), Vec3::splat(0.4)] {
        let unit = Pose3::from_parts(shift, Quat::from_rotation_x(0.6));
        let long = Pose3::from_parts(shift, unit.rotation * 1.5);
        let distance = |pose, workspace: &mut _| a.distance(&b, pose, workspace).unwrap().distance;
        assert!((distance(&unit, &mut workspace) - distance(&long, &mut workspace)).abs() < 1e-5);
        let depth = |pose, workspace: &mut _| a.penetration(&b, pose, workspace).unwrap().depth;
        assert!((depth(&unit, &mut workspace) - depth(&long, &mut workspace)).abs() < 1e-3);
        let motions = |pose| {
            let towards = RigidMotion { linear_velocity: 9.0 * Vec3::ONE, ..RigidMotion::at_rest(pose) };
            [RigidMotion::at_rest(Pose3::IDENTITY), towards]
        };
        let time = |pose, workspace: &mut _| {
            let result = a.time_of_impact(&b, &motions(pose), &ImpactOptions::default(), workspace);
            let TimeOfImpact::Hit(impact) = result else { panic!("{result:?}") };
            impact.time
        };
        assert!((time(unit, &mut workspace) - time(long, &mut workspace)).abs() < 1e-5);
    }
}

#[test]
fn useless_points_and_rays_hit_nothing() {
    let tree = grid(300, 0.3, 0.1);
    for kind in KINDS {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30] {
            let point = Vec3::new(0.0, bad, 0.0);
            assert_eq!(tree.nearest_sphere(point, kind), None);
            assert!(!tree.contains_point(point, kind) && !tree.meets_ball(point, 1.0, kind));
            let ray = Ray { origin: point, direction: Vec3::X, max_time: 1.0 };
            assert_eq!(tree.cast_ray(&ray, true, kind), None);
        }
        let ray = Ray { origin: Vec3::ZERO, direction: Vec3::X, max_time: 1.0 };
        for bad in [
            Ray { direction: Vec3::splat(f32::NAN), ..ray },
            Ray { direction: Vec3::splat(f32::INFINITY), ..ray },
            Ray { max_time: f32::NAN, ..ray },
            Ray { max_time: -1.0, ..ray },
            Ray { origin: -Vec3::ONE, direction: Vec3::ZERO, ..ray },
        ] {
            assert_eq!(tree.cast_ray(&bad, true, kind), None, "{bad:?}");
        }
        let still = Ray { direction: Vec3::ZERO, ..ray };
        assert_eq!(tree.cast_ray(&still, false, kind).unwrap().time, 0.0);
        assert!(!tree.meets_ball(Vec3::ZERO, -1.0, kind) && !tree.meets_ball(Vec3::ZERO, f32::NAN, kind));
        let mut all = 0;
        let _ = tree.visit_spheres_in_ball(Vec3::ZERO, f32::INFINITY, kind, |_| {
            all += 1;
            ControlFlow::<()>::Continue(())
        });
        assert_eq!(all, tree.len());
    }
}

#[test]
fn coincident_trees_meet() {
    let mut workspace = ProximityWorkspace::default();
    for tree in [grid(1, 1.0, 0.3), grid(8, 0.3, 0.1), grid(700, 0.3, 0.1), balls(&[(Vec3::ONE, 0.5); 100])] {
        assert!(tree.intersects(&tree, &Pose3::IDENTITY, &mut workspace));
        let found = tree.distance(&tree, &Pose3::IDENTITY, &mut workspace).unwrap();
        assert_eq!((found.distance, found.lower_bound), (0.0, 0.0));
        assert!(found.normal.is_normalized() && found.point_a.is_finite());
        let depth = tree.penetration(&tree, &Pose3::IDENTITY, &mut workspace).unwrap();
        assert!(depth.depth.is_finite() && depth.depth > 0.0);
        let motions = [RigidMotion::at_rest(Pose3::IDENTITY); 2];
        let result = tree.time_of_impact(&tree, &motions, &ImpactOptions::default(), &mut workspace);
        assert!(matches!(result, TimeOfImpact::Hit(impact) if impact.time == 0.0));
    }
}

#[test]
fn scales_change_lengths_only() {
    let (a, b) = (grid(300, 0.3, 0.1), grid(200, 0.5, 0.2));
    let mut workspace = ProximityWorkspace::default();
    for pose in [Pose3::translation(-6.0, 1.0, 2.0), Pose3::translation(1.0, 1.0, 0.4)] {
        let unscaled = a.distance(&b, &pose, &mut workspace).unwrap();
        let depth = a.penetration(&b, &pose, &mut workspace).unwrap().depth;
        for scale in [1e-4, 1e4] {
            let (a, b) = (a.scaled(scale).unwrap(), b.scaled(scale).unwrap());
            let pose = Pose3::from_parts(pose.translation * scale, pose.rotation);
            let scaled = a.distance(&b, &pose, &mut workspace).unwrap();
            assert!((scaled.distance / scale - unscaled.distance).abs() < 1e-5);
            assert_eq!(a.intersects(&b, &pose, &mut Default::default()), unscaled.distance == 0.0);
            let scaled = a.penetration(&b, &pose, &mut workspace).unwrap().depth;
            assert!((scaled / scale - depth).abs() <= 0.02 * depth, "{} {depth}", scaled / scale);
        }
    }
}

#[test]
fn bodies_of_very_different_sizes() {
    let (large, small) = (grid(1000, 0.3, 0.1), grid(300, 0.3, 0.1).scaled(1e-7).unwrap());
    let mut workspace = ProximityWorkspace::default();
    // Above the ball at the origin's corner, by much more than the small one's size.
    let pose = Pose3::translation(0.0, 0.0, -0.5);
    for (a, b, pose) in [(&large, &small, pose), (&small, &large, pose.inverse())] {
        let found = a.distance(b, &pose, &mut workspace).unwrap();
        let exact = reference::distance(a, b, &pose, BallKind::Inner).gap;
        assert!((f64::from(found.distance) - exact).abs() < 1e-5, "{} {exact}", found.distance);
        assert!(!a.intersects(b, &pose, &mut workspace));
    }
    let inside = Pose3::translation(0.3, 0.3, 0.31);
    assert!(large.intersects(&small, &inside, &mut workspace));
    assert!(small.intersects(&large, &inside.inverse(), &mut workspace));
    let depth = large.penetration(&small, &inside, &mut workspace).unwrap();
    assert!(depth.depth > 0.089 && depth.depth < 2.0);
    let motions = [
        RigidMotion::at_rest(Pose3::IDENTITY),
        RigidMotion { linear_velocity: Vec3::Z, ..RigidMotion::at_rest(pose) },
    ];
    let result = large.time_of_impact(&small, &motions, &ImpactOptions::default(), &mut workspace);
    assert!(matches!(result, TimeOfImpact::Hit(impact) if (impact.time - 0.4).abs() < 1e-5), "{result:?}");
}

#[test]
fn equal_spheres_and_single_ones() {
    let mut workspace = ProximityWorkspace::default();
    for count in [1, 2, 7, 8, 9, 64, 65] {
        let tree = balls(&alloc::vec![(Vec3::ONE, 0.5); count]);
        let pose = Pose3::translation(2.0, 0.0, 0.0);
        let found = tree.distance(&tree, &pose, &mut workspace).unwrap();
        assert!((found.distance - 1.0).abs() < 1e-5, "{count}");
        assert!(
            (tree.nearest_sphere(Vec3::ZERO, BallKind::Inner).unwrap().distance - (3.0_f32.sqrt() - 0.5))
                .abs()
                < 1e-5
        );
        let ray = Ray { origin: Vec3::new(1.0, 1.0, -3.0), direction: Vec3::Z, max_time: 10.0 };
        assert!((tree.cast_ray(&ray, true, BallKind::Inner).unwrap().time - 3.5).abs() < 1e-5);
    }
}
