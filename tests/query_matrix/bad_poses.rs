//! Poses and velocities that are not finite: nothing meets.

use crate::{BALLS, shapes, solid};
use rapier_ist::IstDispatcher;
use rapier3d::math::{Pose, Real, Rotation, Vector};
use rapier3d::parry::query::details::ShapeCastOptions;
use rapier3d::parry::query::{
    ClosestPoints, ContactManifold, NonlinearRigidMotion, PersistentQueryDispatcher, QueryDispatcher,
};
use rapier3d::parry::shape::{Shape, SharedShape};

#[test]
fn nothing_meets_at_poses_that_are_not_finite() {
    let (tree, _) = solid(&BALLS);
    let nan = Rotation::from_xyzw(Real::NAN, 0.0, 0.0, 1.0);
    let bad = [
        Pose::translation(Real::NAN, 0.0, 0.0),
        Pose::translation(0.0, Real::INFINITY, 0.0),
        Pose::from_parts(Vector::ZERO, nan),
    ];
    let mut all = shapes();
    all.push(("tree", SharedShape::new(tree.clone())));
    for (name, shape) in all {
        for pose in bad {
            let orders: [[&dyn Shape; 2]; 2] = [[&tree, shape.as_ref()], [shape.as_ref(), &tree]];
            for [g1, g2] in orders {
                let it = IstDispatcher;
                assert!(!it.intersection_test(&pose, g1, g2).unwrap().intersecting, "{name} {pose:?}");
                assert_eq!(it.distance(&pose, g1, g2).unwrap().distance, Real::MAX, "{name} {pose:?}");
                assert!(it.contact(&pose, g1, g2, 1.0).unwrap().is_none(), "{name} {pose:?}");
                let points = it.closest_points(&pose, g1, g2, 1.0).unwrap();
                assert_eq!(points, ClosestPoints::Disjoint, "{name} {pose:?}");
                let options = ShapeCastOptions::default();
                assert!(it.cast_shapes(&pose, Vector::X, g1, g2, options).unwrap().is_none(), "{name}");
                let motion = NonlinearRigidMotion::constant_position(pose);
                let still = NonlinearRigidMotion::identity();
                let hit = it.cast_shapes_nonlinear(&still, g1, &motion, g2, 0.0, 1.0, true).unwrap();
                assert!(hit.is_none(), "{name} {pose:?}");
                let mut manifolds: Vec<ContactManifold<(), ()>> = Vec::new();
                it.contact_manifolds(&pose, g1, g2, 0.1, &mut manifolds, &mut None).unwrap();
                assert!(manifolds.iter().all(|m| m.points.is_empty()), "{name} {pose:?}");
            }
        }
    }
}

#[test]
fn velocities_that_are_not_finite_hit_nothing() {
    let (tree, _) = solid(&BALLS);
    for (name, shape) in shapes() {
        for velocity in [Vector::NAN, Vector::new(Real::INFINITY, 0.0, 0.0)] {
            let options = ShapeCastOptions::default();
            let pose = Pose::translation(3.0, 0.0, 0.0);
            let hit = IstDispatcher.cast_shapes(&pose, velocity, &tree, shape.as_ref(), options).unwrap();
            assert!(hit.is_none(), "{name} {velocity}");
        }
    }
}

#[test]
fn shapes_that_are_not_ours_are_refused() {
    let [ball, cuboid] = [SharedShape::ball(1.0), SharedShape::cuboid(1.0, 1.0, 1.0)];
    let [g1, g2] = [ball.as_ref(), cuboid.as_ref()];
    assert!(IstDispatcher.intersection_test(&Pose::IDENTITY, g1, g2).is_err());
    assert!(IstDispatcher.distance(&Pose::IDENTITY, g1, g2).is_err());
    assert!(IstDispatcher.contact(&Pose::IDENTITY, g1, g2, 0.0).is_err());
    assert!(
        IstDispatcher.cast_shapes(&Pose::IDENTITY, Vector::X, g1, g2, ShapeCastOptions::default()).is_err()
    );
}
