//! Bodies that are driven and held by Rapier's joints, which the solve must know of: a finger that a motor presses does not give
//! way like a free body.

use super::{grounded, packed};
use glam::{DVec3, Vec3};
use rapier_ist::IstShape;
use rapier_ist_examples::shapes;
use rapier3d::prelude::*;
use std::f32::consts::FRAC_PI_2;

/// A joint of either kind.
fn join(
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

/// A finger of 4 g on a slider, hung where it is not heaviest, that a motor presses against a block. With Rapier's joints working against
/// what held it, it was thrown off at some metres per second in every other step: they are solved one after the other, and a motor that
/// gives all it can has nothing left for what they leave.
#[test]
fn light_fingers_press_wherever_they_hang() {
    let block = packed(&shapes::cuboid(DVec3::splat(0.02)), 1000);
    for offset in [0.0, 0.01, 0.023] {
        for (mass, stiffness, most) in
            [(0.004, 2e3, 15.0), (0.004, 2e4, 15.0), (0.001, 2e3, 15.0), (0.1, 2e4, 100.0)]
        {
            let mut mesh = shapes::cuboid(DVec3::new(0.004, 0.03, 0.0015));
            mesh.vertices.iter_mut().for_each(|vertex| vertex.y += offset);
            let (mut world, mut plugin) = grounded();
            world.gravity = Vec3::ZERO;
            let place = Vec3::Y;
            world.insert(RigidBodyBuilder::fixed().translation(place), block.clone().into_collider());
            let palm = world.bodies.insert(RigidBodyBuilder::fixed().translation(place));
            let body = RigidBodyBuilder::dynamic().translation(place + Vec3::X * 0.05).can_sleep(false);
            let (finger, _) = world.insert(body, packed(&mesh, 500).into_collider().mass(mass));
            let joint = PrismaticJointBuilder::new(Vec3::X)
                .motor_model(MotorModel::ForceBased)
                .motor_position(0.02, stiffness, 20.0)
                .motor_max_force(most);
            let joint = join(&mut world, false, [palm, finger], joint);
            let mut fastest = 0.0_f32;
            for step in 0..60 {
                plugin.step(&mut world);
                if step >= 20 {
                    fastest = fastest.max(world.bodies[finger].linvel().length());
                }
            }
            let pressed = stiffness * (world.bodies[finger].translation().x - 0.02);
            let expected = pressed.min(most);
            let force = plugin.report().contacts[0].force.length();
            let motor = joint
                .and_then(|joint| world.impulse_joints.get(joint))
                .and_then(|joint| joint.data.motor(JointAxis::LinX));
            let told = motor.map_or(f32::NAN, |motor| motor.impulse * 240.0);
            println!(
                "{mass} kg, {offset} m off, {stiffness} N/m: {force} N of {expected}, motor {told}, at most {fastest} m/s"
            );
            assert!(fastest < 1e-3 && (force / expected - 1.0).abs() < 0.01);
            assert!((told / force - 1.0).abs() < 0.01, "Rapier's motor knows what it did: {told} {force}");
        }
    }
}

/// A motor sets a light finger in motion so fast that it would be behind a plate at the end of the step, which nothing that moves now is
/// near.
#[test]
fn motors_do_not_push_through_a_plate() {
    let plate = packed(&shapes::cuboid(DVec3::new(0.003, 0.05, 0.05)), 2000);
    let finger = packed(&shapes::cuboid(DVec3::new(0.01, 0.01, 0.01)), 200);
    for is_link in [false, true] {
        for force in [10.0, 50.0] {
            let (mut world, mut plugin) = grounded();
            let place = Vec3::Y;
            world.insert(RigidBodyBuilder::fixed().translation(place), plate.clone().into_collider());
            let palm = world.bodies.insert(RigidBodyBuilder::fixed().translation(place));
            let body = RigidBodyBuilder::dynamic().translation(place + Vec3::X * 0.06).can_sleep(false);
            let (finger, _) = world.insert(body, finger.clone().into_collider().mass(0.02));
            let joint = PrismaticJointBuilder::new(Vec3::X)
                .local_anchor1(Vec3::X * 0.06)
                .motor_model(MotorModel::ForceBased)
                .motor_position(-0.2, 1000.0, 1.0)
                .motor_max_force(force);
            join(&mut world, is_link, [palm, finger], joint);
            let mut least = f32::INFINITY;
            for _ in 0..60 {
                plugin.step(&mut world);
                least = least.min(world.bodies[finger].translation().x);
            }
            let last = world.bodies[finger].translation().x;
            let pressed = plugin.report().contacts[0].force.x;
            assert!((pressed / force - 1.0).abs() < 0.01, "{is_link} {force}: {pressed} N");
            println!(
                "link {is_link}, {force} N: finger at least {:.2}, at last {:.2} mm from the middle of the plate",
                least * 1e3,
                last * 1e3
            );
            // At 7 mm it would look out behind the plate, at 13 they touch.
            assert!(least > 0.007 && (last - 0.013).abs() < 0.001, "{is_link} {force}: {least} {last}");
        }
    }
}

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
