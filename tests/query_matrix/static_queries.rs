//! Intersection, distance, contact, closest points and manifolds.

use crate::{BALLS, apart, poses, shapes, solid};
use rapier_ist::IstDispatcher;
use rapier3d::math::{Pose, Real};
use rapier3d::parry::query::{
    ClosestPoints, ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher, QueryDispatcher,
};
use rapier3d::parry::shape::{Ball, Shape};

/// parry's support-mapped queries iterate to about this (m).
pub(crate) const TOLERANCE: f64 = 2e-3;

/// Signed distance of the balls from `shape` at `pose`, by brute force; parry's own point queries.
pub(crate) fn reference(shape: &dyn Shape, pose: &Pose) -> Real {
    let part = |shape: &dyn Shape, pose: &Pose| {
        let gap = |(center, radius): &(rapier3d::math::Vector, Real)| {
            let local = pose.inverse_transform_point(*center);
            // parry has no distance from planes at infinity.
            let plane = shape.as_halfspace().map(|plane| plane.normal.dot(local));
            plane.unwrap_or_else(|| shape.distance_to_local_point(local, false)) - radius
        };
        BALLS.iter().map(gap).fold(Real::INFINITY, Real::min)
    };
    match shape.as_compound() {
        Some(compound) => {
            let gaps = compound.shapes().iter().map(|(at, child)| part(child.as_ref(), &(*pose * *at)));
            gaps.fold(Real::INFINITY, Real::min)
        }
        None => part(shape, pose),
    }
}

#[test]
fn both_orders_agree_with_brute_force_for_every_shape() {
    let (tree, _) = solid(&BALLS);
    let mut met = 0;
    for (name, shape) in shapes() {
        let shape = shape.as_ref();
        for pose in poses() {
            let gap = f64::from(reference(shape, &pose));
            let orders: [(Pose, &dyn Shape, &dyn Shape); 2] =
                [(pose, &tree, shape), (pose.inverse(), shape, &tree)];
            met += usize::from(gap < 0.0);
            for (pos12, g1, g2) in orders {
                let case = format!("{name} at {:?}, gap {gap}", pose.translation);
                let meets = IstDispatcher.intersection_test(&pos12, g1, g2).unwrap().intersecting;
                assert!(meets == (gap <= 0.0) || gap.abs() < 1e-5, "{case}");
                let distance = f64::from(IstDispatcher.distance(&pos12, g1, g2).unwrap().distance);
                assert!((distance - gap.max(0.0)).abs() < 1e-5, "{case}: {distance}");
                let contact = IstDispatcher.contact(&pos12, g1, g2, Real::MAX).unwrap().unwrap();
                assert!((f64::from(contact.dist) - gap).abs() < 1e-5, "{case}: {contact:?}");
                let between = pos12 * contact.point2 - contact.point1;
                assert!((f64::from(between.dot(contact.normal1)) - gap).abs() < 1e-4, "{case}: {contact:?}");
                assert!((between.length() - contact.dist.abs()).abs() < 1e-4, "{case}: {contact:?}");
                assert!(apart(pos12.rotation * contact.normal2, -contact.normal1) < 1e-5, "{case}");
                assert!(
                    IstDispatcher.contact(&pos12, g1, g2, gap as Real - 1e-3).unwrap().is_none(),
                    "{case}"
                );
                match IstDispatcher.closest_points(&pos12, g1, g2, 1.0).unwrap() {
                    ClosestPoints::Intersecting => assert!(gap < 1e-5, "{case}"),
                    ClosestPoints::Disjoint => assert!(gap > 1.0 - 1e-5, "{case}"),
                    ClosestPoints::WithinMargin(p1, p2) => {
                        assert!((apart(p1, pos12 * p2) - gap).abs() < 1e-4, "{case}");
                        assert!(gap < 1.0 + 1e-5, "{case}");
                    }
                }
            }
        }
    }
    assert!(met > 100, "{met}");
}

#[test]
fn two_solids_agree_with_compounds_of_their_balls() {
    let ((tree, compound), parry) = (solid(&BALLS), DefaultQueryDispatcher);
    for pose in poses() {
        let at = pose.translation;
        let meets = parry.intersection_test(&pose, compound.as_ref(), compound.as_ref()).unwrap();
        assert_eq!(
            IstDispatcher.intersection_test(&pose, &tree, &tree).unwrap().intersecting,
            meets.intersecting
        );
        let distance = parry.distance(&pose, compound.as_ref(), compound.as_ref()).unwrap().distance;
        let ours = IstDispatcher.distance(&pose, &tree, &tree).unwrap().distance;
        assert!((ours - distance).abs() < 1e-5, "{at}: {ours} {distance}");
        let contact = parry.contact(&pose, compound.as_ref(), compound.as_ref(), 100.0).unwrap().unwrap();
        let ours = IstDispatcher.contact(&pose, &tree, &tree, 100.0).unwrap().unwrap();
        assert!((ours.dist - contact.dist).abs() < 1e-5, "{at}: {ours:?} {contact:?}");
        let swapped = IstDispatcher.contact(&pose.inverse(), &tree, &tree, 100.0).unwrap().unwrap();
        assert!((swapped.dist - ours.dist).abs() < 1e-5, "{at}");
        let points = IstDispatcher.closest_points(&pose, &tree, &tree, 100.0).unwrap();
        match (points, parry.closest_points(&pose, compound.as_ref(), compound.as_ref(), 100.0).unwrap()) {
            (ClosestPoints::WithinMargin(p1, p2), ClosestPoints::WithinMargin(q1, q2)) => {
                assert!((apart(p1, pose * p2) - apart(q1, pose * q2)).abs() < 1e-5, "{at}");
            }
            (ours, parry) => assert_eq!(ours, parry, "{at}"),
        }
    }
}

#[test]
fn one_ball_agrees_with_parry_for_convex_shapes() {
    let (tree, _) = solid(&[(rapier3d::math::Vector::ZERO, 0.3)]);
    let (ball, parry) = (Ball::new(0.3), DefaultQueryDispatcher);
    for (name, shape) in shapes().iter().filter(|(_, shape)| shape.is_convex()) {
        for pose in poses().iter().filter(|pose| pose.translation.length() > 0.1) {
            let Ok(distance) = parry.distance(pose, &ball, shape.as_ref()) else { continue };
            let ours = IstDispatcher.distance(pose, &tree, shape.as_ref()).unwrap().distance;
            let error = f64::from((ours - distance.distance).abs());
            assert!(error < TOLERANCE, "{name} {}: {ours} {}", pose.translation, distance.distance);
        }
    }
}

#[test]
fn manifolds_have_a_point_within_the_prediction_and_none_beyond() {
    let (tree, _) = solid(&BALLS);
    for (name, shape) in shapes() {
        let shape = shape.as_ref();
        for pose in poses() {
            let gap = reference(shape, &pose);
            let orders: [(Pose, &dyn Shape, &dyn Shape); 2] =
                [(pose, &tree, shape), (pose.inverse(), shape, &tree)];
            for (pos12, g1, g2) in orders {
                let mut manifolds: Vec<ContactManifold<(), ()>> = Vec::new();
                let mut workspace = None;
                IstDispatcher.contact_manifolds(&pos12, g1, g2, 0.1, &mut manifolds, &mut workspace).unwrap();
                let points: Vec<_> = manifolds.iter().flat_map(|m| m.points.iter()).collect();
                let case = format!("{name} at {:?}, gap {gap}: {points:?}", pose.translation);
                if (gap - 0.1).abs() > 1e-4 {
                    assert_eq!(points.is_empty(), gap > 0.1, "{case}");
                }
                // The nearest point is as far away as the shapes are; others of the contact may be farther.
                let least = points.iter().map(|point| point.dist).fold(Real::MAX, Real::min);
                assert!(gap < 1e-4 || points.is_empty() || (least - gap).abs() < 1e-4, "{case}");
                for point in points {
                    assert!(point.dist < 0.1, "{case}");
                    let length = apart(point.local_p1, pos12 * point.local_p2);
                    assert!((length - f64::from(point.dist.abs())).abs() < 1e-4, "{case}");
                }
            }
        }
    }
}
