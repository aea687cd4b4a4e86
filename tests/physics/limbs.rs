//! Ropes and ragdolls: many light bodies on joints.

use super::joints::join;
use super::{grounded, packed};
use glam::{DVec3, Vec3};
use rapier_ist_examples::shapes;
use rapier3d::prelude::*;

/// Ropes with a ring at their end that lies on the ground. Joints, pressed against what they were expected to do, threw them about at
/// 390 m/s within two seconds.
#[test]
fn ropes_pull_what_lies_on_the_ground() {
    const LENGTH: f32 = 0.1;
    let ring = packed(&shapes::ring(0.15, 0.06, [48, 24]), 500);
    let bar = packed(&shapes::cuboid(DVec3::new(0.045, 0.01, 0.01)), 30);
    for (density, height) in [(20.0, 0.6), (50.0, 0.6), (50.0, 1.4), (200.0, 1.4)] {
        for link in [ColliderBuilder::capsule_x(0.04, 0.01), bar.clone().into_collider()] {
            let (mut world, mut plugin) = grounded();
            let mut last = world.bodies.insert(RigidBodyBuilder::fixed().translation(Vec3::Y * height));
            let mut bodies = Vec::new();
            for i in 0..21 {
                let is_ring = i == 20;
                let (half, collider) = if is_ring {
                    (0.21, ring.clone().into_collider().density(density))
                } else {
                    (0.5 * LENGTH, link.clone().density(500.0))
                };
                let place = Vec3::new(i as f32 * LENGTH + half, height, 0.0);
                let motion = Vec3::Z * 0.3 * (i as f32 * 0.7).sin();
                let body = RigidBodyBuilder::dynamic().translation(place).linvel(motion).can_sleep(false);
                let (body, _) = world.insert(body, collider);
                let joint = SphericalJointBuilder::new()
                    .local_anchor1(if i == 0 { Vec3::ZERO } else { Vec3::X * 0.5 * LENGTH })
                    .local_anchor2(Vec3::X * -half)
                    .contacts_enabled(false);
                join(&mut world, false, [last, body], joint);
                last = body;
                bodies.push(body);
            }
            let (mut fastest, mut at_last) = (0.0_f32, 0.0_f32);
            for step in 0..600 {
                plugin.step(&mut world);
                let speeds = bodies.iter().map(|body| world.bodies[*body].linvel().length());
                let speed = speeds.fold(0.0, f32::max);
                fastest = fastest.max(speed);
                if step >= 540 {
                    at_last = at_last.max(speed);
                }
            }
            println!(
                "density {density}, {height} m high: at most {fastest} m/s, {at_last} in the last second"
            );
            assert!(fastest < 10.0 && at_last < 1.5);
        }
    }
}

/// Half sizes and places of torso, head, hips, arms and legs (m), and what each hangs on.
const LIMBS: [([f64; 3], [f32; 3], usize); 10] = [
    ([0.10, 0.18, 0.16], [0.0, 0.0, 0.0], 0),
    ([0.09, 0.11, 0.09], [0.0, 0.32, 0.0], 0),
    ([0.09, 0.10, 0.15], [0.0, -0.3, 0.0], 0),
    ([0.05, 0.14, 0.05], [0.0, 0.03, 0.23], 0),
    ([0.04, 0.13, 0.04], [0.0, -0.25, 0.23], 3),
    ([0.05, 0.14, 0.05], [0.0, 0.03, -0.23], 0),
    ([0.04, 0.13, 0.04], [0.0, -0.25, -0.23], 5),
    ([0.07, 0.2, 0.07], [0.0, -0.62, 0.1], 2),
    ([0.07, 0.2, 0.07], [0.0, -0.62, -0.1], 2),
    ([0.06, 0.2, 0.06], [0.0, -1.04, 0.1], 7),
];

/// Ragdolls fall on stairs, limbs and stairs of trees and of Rapier's cuboids. As multibodies they were thrown out of f32: what locked axes
/// exert was held against in the directions of the beginning of a step, in which a forearm turns by radians.
#[test]
fn ragdolls_come_to_lie() {
    let packed_limbs = LIMBS.map(|(half, ..)| packed(&shapes::cuboid(DVec3::from(half)), 200));
    let stair = packed(&shapes::cuboid(DVec3::new(0.3, 0.1, 1.0)), 1500);
    for (limbs_are_trees, stairs_are_trees) in [(true, false), (true, true), (false, true)] {
        for is_link in [false, true] {
            let (mut world, mut plugin) = grounded();
            for step in 0..6 {
                let place = Vec3::new(0.5 * step as f32, 0.1 + 0.18 * step as f32, 0.0);
                let collider = if stairs_are_trees {
                    stair.clone().into_collider()
                } else {
                    ColliderBuilder::cuboid(0.3, 0.1, 1.0)
                };
                world.insert(RigidBodyBuilder::fixed().translation(place), collider.friction(0.6));
            }
            let mut all = Vec::new();
            for doll in 0..3 {
                let doll = doll as f32;
                let frame = Pose::new(
                    Vec3::new(2.2 - 0.1 * doll, 2.6 + 1.8 * doll, -0.3 + 0.15 * doll),
                    Vec3::X * 0.4 * doll,
                );
                let mut bodies = Vec::new();
                for (i, (half, place, parent)) in LIMBS.into_iter().enumerate() {
                    let place = Vec3::from(place);
                    let collider = if limbs_are_trees {
                        packed_limbs[i].clone().into_collider()
                    } else {
                        let [x, y, z] = half.map(|half| half as f32);
                        ColliderBuilder::cuboid(x, y, z)
                    };
                    let pose = frame * Pose::from_translation(place);
                    let body = RigidBodyBuilder::dynamic().pose(pose).linvel(Vec3::NEG_X);
                    let (body, _) = world.insert(body, collider.density(900.0).friction(0.6));
                    bodies.push(body);
                    if i > 0 {
                        let end = half[1] as f32 * if i == 1 { -1.0 } else { 1.0 };
                        let joint = SphericalJointBuilder::new()
                            .local_anchor1(place + Vec3::Y * end - Vec3::from(LIMBS[parent].1))
                            .local_anchor2(Vec3::Y * end)
                            .limits(JointAxis::AngX, [-0.8, 0.8])
                            .limits(JointAxis::AngY, [-0.4, 0.4])
                            .limits(JointAxis::AngZ, [-1.2, 0.6])
                            .contacts_enabled(false);
                        join(&mut world, is_link, [bodies[parent], body], joint);
                    }
                }
                all.extend(bodies);
            }
            let (mut fastest, mut at_last, mut lowest) = (0.0_f32, 0.0_f32, f32::INFINITY);
            for step in 0..480 {
                plugin.step(&mut world);
                for body in all.iter().map(|body| &world.bodies[*body]) {
                    assert!(body.position().is_finite() && body.linvel().is_finite());
                    fastest = fastest.max(body.linvel().length());
                    lowest = lowest.min(body.translation().y);
                    if step >= 420 {
                        at_last = at_last.max(body.linvel().length());
                    }
                }
            }
            println!(
                "limbs trees {limbs_are_trees}, stairs trees {stairs_are_trees}, links {is_link}: at most {fastest} m/s, \
                 {at_last} in the last second, lowest {lowest} m"
            );
            // They arrive at 10 m/s, and an arm may be whipped to twice that.
            assert!(fastest < 50.0 && at_last < 5.0 && lowest > 0.0);
        }
    }
}
