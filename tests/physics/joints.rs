//! Bodies that are driven and held by Rapier's joints, which the solve must know of: a finger that a motor presses does not give
//! way like a free body.

use super::{grounded, packed};
use glam::{DVec3, Vec3};
use rapier_ist::IstShape;
use rapier_ist_examples::shapes;
use rapier3d::prelude::*;
use std::f32::consts::FRAC_PI_2;

/// A joint of either kind.
pub(super) fn join(
    world: &mut PhysicsWorld,
    is_link: bool,
    bodies: [RigidBodyHandle; 2],
    joint: impl Into<GenericJoint>,
) -> Option<ImpulseJointHandle> {
    let [a, b] = bodies;
    if is_link {
        world.multibody_joints.insert(a, b, joint, true);
        return None;
    }
    Some(world.impulse_joints.insert(a, b, joint, true))
}

/// A cube of 5 cm, density 1000.
fn cube() -> IstShape {
    packed(&shapes::cuboid(DVec3::splat(0.025)), 1000)
}

/// Two fingers of 100 g, each pressed by a motor of limited force, take a cube of 125 g, lift it, hold it and shake it. Before the
/// solve knew of joints the fingers went right through it.
#[test]
fn a_gripper_holds_and_carries() {
    let fingers = [
        ("rigid", ColliderBuilder::cuboid(0.01, 0.02, 0.02)),
        ("packed", packed(&shapes::cuboid(DVec3::new(0.01, 0.02, 0.02)), 500).into_collider()),
    ];
    let cube = cube();
    for (name, finger) in fingers {
        for force in [5.0, 20.0, 100.0] {
            let (mut world, mut plugin) = grounded();
            let at = Vec3::Y * 0.026;
            let body = RigidBodyBuilder::dynamic().translation(at).can_sleep(false);
            let (object, _) = world.insert(body, cube.clone().into_collider().density(1000.0).friction(0.5));
            let hand = world.bodies.insert(RigidBodyBuilder::kinematic_velocity_based().translation(at));
            let fingers = [-1.0_f32, 1.0].map(|side| {
                let place = Vec3::X * side * 0.055;
                let body = RigidBodyBuilder::dynamic().translation(at + place).can_sleep(false);
                let (finger, _) = world.insert(body, finger.clone().mass(0.1).friction(0.5));
                let joint = PrismaticJointBuilder::new(Vec3::X * -side)
                    .local_anchor1(place)
                    .motor_position(0.06, 2000.0, 50.0)
                    .motor_max_force(force);
                join(&mut world, false, [hand, finger], joint);
                finger
            });
            let mut steps = |world: &mut PhysicsWorld, count: usize, velocity: &dyn Fn(f32) -> Vec3| {
                for step in 0..count {
                    world.bodies[hand].set_linvel(velocity(step as f32 / 60.0), true);
                    plugin.step(world);
                }
            };
            let middle = |world: &PhysicsWorld| {
                let [a, b] = fingers.map(|finger| world.bodies[finger].translation());
                world.bodies[object].translation() - (a + b) * 0.5
            };
            steps(&mut world, 60, &|_| Vec3::ZERO);
            let gap = fingers.map(|finger| world.bodies[finger].translation().x);
            steps(&mut world, 60, &|_| Vec3::Y * 0.3);
            steps(&mut world, 30, &|_| Vec3::ZERO);
            let lifted = middle(&world);
            steps(&mut world, 300, &|_| Vec3::ZERO);
            let held = middle(&world);
            steps(&mut world, 120, &|t| Vec3::Z * 0.5 * (12.0 * t).cos());
            let shaken = middle(&world);
            let (crept, shifted) = (held.distance(lifted), shaken.distance(held));
            println!(
                "{name} fingers, {force} N: {:.2} mm apart, lifted by {:.4} m, crept {:.2} mm in 5 s, shaken {:.2} mm",
                (gap[1] - gap[0]) * 1e3,
                world.bodies[object].translation().y - 0.026,
                crept * 1e3,
                shifted * 1e3
            );
            // The packed cube is 50 mm thick, give or take a bump, and a finger 20.
            assert!((gap[1] - gap[0] - 0.07).abs() < 0.003, "{name} {force}: {gap:?}");
            assert!(lifted.length() < 0.005 && crept < 0.003 && shifted < 0.003, "{name} {force}");
        }
    }
}

/// Motors press on a stack: what arrives at the ground is their force and the weights.
#[test]
fn a_press_presses_with_the_force_of_its_motor() {
    let cube = packed(&shapes::cuboid(DVec3::splat(0.1)), 1000);
    for is_link in [false, true] {
        for force in [100.0, 1000.0] {
            let (mut world, mut plugin) = grounded();
            for height in [0.101, 0.304] {
                let body = RigidBodyBuilder::dynamic().translation(Vec3::Y * height).can_sleep(false);
                world.insert(body, cube.clone().into_collider().density(1000.0));
            }
            let frame = world.bodies.insert(RigidBodyBuilder::fixed().translation(Vec3::Y));
            let body = RigidBodyBuilder::dynamic().translation(Vec3::Y * 0.48).can_sleep(false);
            let (piston, _) = world.insert(body, ColliderBuilder::cuboid(0.15, 0.05, 0.15).density(300.0));
            let joint =
                PrismaticJointBuilder::new(Vec3::Y).motor_position(-10.0, 1e4, 100.0).motor_max_force(force);
            join(&mut world, is_link, [frame, piston], joint);
            for _ in 0..240 {
                plugin.step(&mut world);
            }
            let mut forces = plugin.report().contacts.iter().map(|c| c.force.y.abs()).collect::<Vec<_>>();
            forces.sort_unstable_by(f32::total_cmp);
            let weights = [2.7, 10.7, 18.7].map(|mass| mass * 9.81);
            let depth = plugin.report().contacts.iter().map(|c| c.depth).fold(0.0, f32::max);
            println!("link {is_link}, {force} N: {forces:.1?} N, {:.2} mm deep", depth * 1e3);
            assert_eq!(forces.len(), 3);
            for (found, weight) in forces.iter().zip(weights) {
                assert!((found / (force + weight) - 1.0).abs() < 0.01, "{is_link} {force}: {forces:?}");
            }
            assert!(depth < 0.003, "{depth}");
        }
    }
}

/// Wheels on motors take a car as far as they roll, and carry it. Before the solve knew of joints it lay in the ground by a
/// tenth of the wheels' radius and more.
#[test]
fn a_car_drives_as_far_as_its_wheels_roll() {
    const RADIUS: f32 = 0.25;
    let wheel = packed(&shapes::ring(0.17, 0.08, [64, 32]), 1000);
    for is_link in [false, true] {
        for most in [f32::MAX, 40.0] {
            let (mut world, mut plugin) = grounded();
            let body = RigidBodyBuilder::dynamic().translation(Vec3::Y * 0.27).can_sleep(false);
            let (chassis, _) = world.insert(body, ColliderBuilder::cuboid(0.4, 0.1, 0.8).density(400.0));
            let places = [(-0.55, -0.6), (0.55, -0.6), (-0.55, 0.6), (0.55, 0.6)];
            let wheels = places.map(|(x, z)| {
                let place = Vec3::new(x, 0.0, z);
                let body = RigidBodyBuilder::dynamic()
                    .translation(place + Vec3::Y * 0.27)
                    .rotation(Vec3::Z * FRAC_PI_2)
                    .can_sleep(false);
                let collider = wheel.clone().into_collider().density(300.0).friction(0.8);
                let (wheel, _) = world.insert(body, collider);
                let joint = GenericJointBuilder::new(JointAxesMask::LOCKED_REVOLUTE_AXES)
                    .local_axis1(Vec3::X)
                    .local_axis2(Vec3::NEG_Y)
                    .local_anchor1(place)
                    .motor_velocity(JointAxis::AngX, 8.0, 100.0)
                    .motor_max_force(JointAxis::AngX, most);
                join(&mut world, is_link, [chassis, wheel], joint.build());
                wheel
            });
            let (mut rolled, mut apart, mut height) = (0.0, 0.0_f32, [f32::MAX, 0.0]);
            for step in 0..240 {
                plugin.step(&mut world);
                rolled += world.bodies[wheels[0]].angvel().x * RADIUS / 60.0;
                for (wheel, (x, z)) in wheels.iter().zip(places) {
                    let hub = *world.bodies[chassis].position() * Vec3::new(x, 0.0, z);
                    apart = apart.max(hub.distance(world.bodies[*wheel].translation()));
                }
                if step >= 60 {
                    let y = world.bodies[chassis].translation().y;
                    height = [height[0].min(y), height[1].max(y)];
                }
            }
            let moved = world.bodies[chassis].translation();
            println!(
                "links {is_link}, {most} N·m: {moved} m, {rolled} rolled, hubs off by {apart} m, {height:?} high"
            );
            assert!((moved.z / rolled - 1.0).abs() < 0.05 && moved.z > 5.0 && moved.x.abs() < 0.1);
            assert!(apart < 2e-3 && height[0] > RADIUS - 0.01 && height[1] < RADIUS + 0.02);
        }
    }
}

/// What arrives on a guide is stopped like what arrives free: in the step in which it touches, not over it.
#[test]
fn a_link_is_stopped_where_it_touches() {
    let deepest = |guide: Option<bool>| {
        let (mut world, mut plugin) = grounded();
        let body = RigidBodyBuilder::dynamic().translation(Vec3::Y * 1.5).can_sleep(false);
        let (ball, _) = world.insert(body, super::ball().into_collider().density(1000.0));
        if let Some(is_link) = guide {
            let frame = world.bodies.insert(RigidBodyBuilder::fixed().translation(Vec3::Y * 1.5));
            join(&mut world, is_link, [frame, ball], PrismaticJointBuilder::new(Vec3::Y));
        }
        let mut lowest = f32::INFINITY;
        for _ in 0..120 {
            plugin.step(&mut world);
            lowest = lowest.min(world.bodies[ball].translation().y);
        }
        let speed = world.bodies[ball].linvel().length();
        assert!(speed < 1e-2, "{guide:?}: it lies still, {speed}");
        0.1 - lowest
    };
    let [free, joint, link] = [None, Some(false), Some(true)].map(deepest);
    println!("deepest at 5 m/s: free {free} m, on an impulse joint {joint} m, as a link {link} m");
    assert!((joint - free).abs() < 1e-3 && (link - free).abs() < 1e-3);
}

/// Motors of a multibody hold it in the same place whether it touches something or not.
#[test]
fn an_arm_is_held_by_its_motors_while_it_pushes_a_body() {
    let bar = packed(&shapes::cuboid(DVec3::new(0.15, 0.03, 0.03)), 500);
    for stiffness in [100.0_f32, 1000.0, 1e4] {
        let tips = [ColliderBuilder::cuboid(0.15, 0.03, 0.03), bar.clone().into_collider()].map(|collider| {
            let (mut world, mut plugin) = grounded();
            let mut last = world.bodies.insert(RigidBodyBuilder::fixed().translation(Vec3::Y * 0.5));
            for link in 0..4 {
                let place = Vec3::new(0.15 + 0.3 * link as f32, 0.5, 0.0);
                let body = RigidBodyBuilder::dynamic().translation(place).can_sleep(false);
                let (body, _) = world.insert(body, collider.clone().density(800.0).friction(0.5));
                let joint = RevoluteJointBuilder::new(Vec3::Z)
                    .local_anchor1(if link == 0 { Vec3::ZERO } else { Vec3::X * 0.15 })
                    .local_anchor2(Vec3::X * -0.15)
                    .motor_position(-0.4, stiffness, 2.0 * stiffness.sqrt())
                    .contacts_enabled(false);
                join(&mut world, true, [last, body], joint);
                last = body;
            }
            for _ in 0..300 {
                plugin.step(&mut world);
            }
            let body = &world.bodies[last];
            (body.translation(), body.linvel().length())
        });
        println!("stiffness {stiffness}: {tips:?}");
        let [(rigid, _), (packed, speed)] = tips;
        assert!(rigid.distance(packed) < 0.02 && speed < 0.15, "{stiffness}: {tips:?}");
    }
}
