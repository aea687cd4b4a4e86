//! Linear and nonlinear shape casts.

use crate::{BALLS, poses, shapes, solid};
use rapier_ist::IstDispatcher;
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::query::details::ShapeCastOptions;
use rapier3d::parry::query::{DefaultQueryDispatcher, NonlinearRigidMotion, QueryDispatcher};
use rapier3d::parry::shape::Shape;

fn signed_gap(pos12: &Pose, g1: &dyn Shape, g2: &dyn Shape) -> Real {
    IstDispatcher.contact(pos12, g1, g2, Real::MAX).unwrap().unwrap().dist
}

#[test]
fn two_solids_meet_when_compounds_of_their_balls_do() {
    let (tree, compound) = solid(&BALLS);
    let mut hits = 0;
    for pose in poses() {
        for stop_at_penetration in [true, false] {
            let aside = Vector::new(0.1, -0.2, 0.15);
            let velocity = aside - 0.7 * pose.translation;
            let options =
                ShapeCastOptions { max_time_of_impact: 3.0, stop_at_penetration, ..Default::default() };
            let parry = DefaultQueryDispatcher
                .cast_shapes(&pose, velocity, compound.as_ref(), compound.as_ref(), options)
                .unwrap();
            let ours = IstDispatcher.cast_shapes(&pose, velocity, &tree, &tree, options).unwrap();
            let case = format!("{} {stop_at_penetration}: {ours:?} {parry:?}", pose.translation);
            assert_eq!(ours.is_some(), parry.is_some(), "{case}");
            let (Some(ours), Some(parry)) = (ours, parry) else { continue };
            hits += 1;
            assert!((ours.time_of_impact - parry.time_of_impact).abs() < 1e-4, "{case}");
        }
    }
    assert!(hits > 20, "{hits}");
}

#[test]
fn linear_casts_stop_at_the_target_distance_and_never_past_it() {
    let (tree, _) = solid(&BALLS);
    let mut hits = 0;
    for (name, shape) in shapes() {
        let shape = shape.as_ref();
        for pose in poses() {
            for target_distance in [0.0, 0.05] {
                let velocity = Vector::new(0.1, -0.2, 0.15) - 0.7 * pose.translation;
                let options =
                    ShapeCastOptions { max_time_of_impact: 3.0, target_distance, ..Default::default() };
                let hit = IstDispatcher.cast_shapes(&pose, velocity, &tree, shape, options).unwrap();
                let case = format!("{name} at {:?}, {hit:?}", pose.translation);
                // Seen from the other shape the tree moves the other way.
                let turn = pose.rotation.inverse();
                let swapped = IstDispatcher
                    .cast_shapes(&pose.inverse(), turn * -velocity, shape, &tree, options)
                    .unwrap();
                assert_eq!(hit.is_some(), swapped.is_some(), "{case} {swapped:?}");
                let at = |time: Real| Pose::from_parts(pose.translation + velocity * time, pose.rotation);
                let end = hit.map_or(3.0, |hit| hit.time_of_impact);
                for i in 0..60 {
                    let time = end * i as Real / 60.0;
                    let gap = signed_gap(&at(time), &tree, shape);
                    assert!(gap > target_distance - 1e-4 || end == 0.0, "{case}: {gap} at {time}");
                }
                let (Some(hit), Some(swapped)) = (hit, swapped) else { continue };
                assert!((hit.time_of_impact - swapped.time_of_impact).abs() < 1e-3, "{case} {swapped:?}");
                if end > 0.0 {
                    hits += 1;
                    let gap = signed_gap(&at(end), &tree, shape);
                    assert!((gap - target_distance).abs() < 1e-3, "{case}: {gap}");
                }
            }
        }
    }
    assert!(hits > 100, "{hits}");
}

#[test]
fn turning_bodies_stop_in_front_of_every_shape() {
    let (tree, _) = solid(&BALLS);
    let mut hits = 0;
    for (name, shape) in shapes() {
        let shape = shape.as_ref();
        for pose in poses() {
            for spin in [Vector::ZERO, Vector::new(1.0, 2.0, -1.5)] {
                let velocity = Vector::new(0.1, -0.2, 0.15) - 0.7 * pose.translation;
                let still = NonlinearRigidMotion::new(Pose::IDENTITY, Vector::ZERO, Vector::ZERO, spin);
                let moving = NonlinearRigidMotion::new(
                    pose,
                    Vector::new(0.1, 0.0, 0.05),
                    velocity,
                    Vector::new(-2.0, 1.0, 0.5),
                );
                let hit = IstDispatcher
                    .cast_shapes_nonlinear(&moving, &tree, &still, shape, 0.0, 3.0, true)
                    .unwrap();
                let case = format!("{name} at {:?}, {hit:?}", pose.translation);
                let end = hit.map_or(3.0, |hit| hit.time_of_impact);
                let gap = |time: Real| {
                    let pos12 = moving.position_at_time(time).inv_mul(&still.position_at_time(time));
                    signed_gap(&pos12, &tree, shape)
                };
                for i in 0..60 {
                    let time = end * i as Real / 60.0;
                    assert!(gap(time) > -1e-4 || end == 0.0, "{case}: {} at {time}", gap(time));
                }
                if hit.is_some() && end > 0.0 {
                    hits += 1;
                    assert!(gap(end).abs() < 2e-3, "{case}: {}", gap(end));
                }
                let swapped = IstDispatcher
                    .cast_shapes_nonlinear(&still, shape, &moving, &tree, 0.0, 3.0, true)
                    .unwrap();
                assert_eq!(
                    swapped.map(|hit| hit.time_of_impact),
                    hit.map(|hit| hit.time_of_impact),
                    "{case}"
                );
            }
        }
    }
    assert!(hits > 100, "{hits}");
}
