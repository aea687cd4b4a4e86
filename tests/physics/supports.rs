//! Trees on Rapier's own shapes, which stand on others of their kind: the solve has to know what carries them.

use super::{grounded, packed};
use glam::{DVec3, Vec3};
use rapier_ist_examples::shapes;
use rapier3d::prelude::*;

/// What a stack is made of, from below.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Layer {
    /// One of Rapier's cuboids, 15 kg.
    Crate,
    /// A tree.
    Ring,
}
use Layer::{Crate, Ring};

/// Before the solve knew of Rapier's contacts, it took crate and ring to fall together, and the ring slid off.
#[test]
fn stacks_of_crates_and_rings_stand() {
    let ring = packed(&shapes::ring(0.15, 0.06, [48, 24]), 1000);
    let stacks: [&[Layer]; 4] =
        [&[Crate, Ring], &[Crate, Crate, Ring], &[Ring, Crate, Ring], &[Crate, Ring, Crate, Ring, Crate]];
    for layers in stacks {
        for (tilt, density) in [(0.0_f32, 1000.0), (10.0, 1000.0), (0.0, 10_000.0)] {
            let (mut world, mut plugin) = grounded();
            let (sin, cos) = tilt.to_radians().sin_cos();
            world.gravity = 9.81 * Vec3::new(sin, -cos, 0.0);
            let mut height = 0.0;
            let mut bodies = Vec::new();
            for layer in layers {
                let (half, collider) = match layer {
                    Crate => (0.1, ColliderBuilder::cuboid(0.25, 0.1, 0.25).density(300.0)),
                    Ring => (0.06, ring.clone().into_collider().density(density)),
                };
                let body =
                    RigidBodyBuilder::dynamic().translation(Vec3::Y * (height + half)).can_sleep(false);
                let (body, _) = world.insert(body, collider.friction(0.5));
                height += 2.0 * half;
                bodies.push((body, half));
            }
            let start: Vec<Vec3> = bodies.iter().map(|(body, _)| world.bodies[*body].translation()).collect();
            for _ in 0..300 {
                plugin.step(&mut world);
            }
            // Between two of Rapier's own shapes gaps are Rapier's.
            let is_ours = |i: usize| layers[i] == Ring || (i > 0 && layers[i - 1] == Ring);
            let (mut below, mut gap, mut way, mut fastest) = (0.0, 0.0_f32, 0.0_f32, 0.0_f32);
            for (i, ((body, half), start)) in bodies.iter().zip(start).enumerate() {
                let body = &world.bodies[*body];
                let place = body.translation();
                if is_ours(i) {
                    gap = gap.max((place.y - half - below).abs());
                }
                way = way.max((place.x - start.x).abs());
                fastest = fastest.max(body.linvel().length());
                below = place.y + half;
            }
            println!(
                "{layers:?}, {tilt}°, {density}: gaps of {:.2} mm, moved {:.2} mm, {fastest} m/s",
                gap * 1e3,
                way * 1e3
            );
            // On a slope what friction holds creeps.
            assert!(gap < 0.003 && fastest < 0.003 && way < if tilt > 0.0 { 0.02 } else { 0.002 });
            let mut forces = plugin.report().contacts.iter().map(|c| c.force.length()).collect::<Vec<_>>();
            forces.sort_unstable_by(f32::total_cmp);
            let mut carried = 0.0;
            let mut expected = Vec::new();
            for (i, (body, _)) in bodies.iter().enumerate().rev() {
                carried += world.bodies[*body].mass() * 9.81;
                expected.extend(is_ours(i).then_some(carried));
            }
            assert_eq!(forces.len(), expected.len(), "{forces:?} {expected:?}");
            for (force, expected) in forces.iter().zip(&expected) {
                assert!((force / expected - 1.0).abs() < 0.01, "{forces:?} {expected:?}");
            }
        }
    }
}

/// Bodies that move in a plane only, as in games seen from the side.
#[test]
fn a_crate_with_locked_axes_carries_a_ring() {
    let ring = packed(&shapes::ring(0.15, 0.06, [48, 24]), 1000);
    let (mut world, mut plugin) = grounded();
    let mut insert = |height: f32, collider: ColliderBuilder| {
        let body = RigidBodyBuilder::dynamic()
            .translation(Vec3::Y * height)
            .enabled_translations(true, true, false)
            .enabled_rotations(false, false, true)
            .can_sleep(false);
        world.insert(body, collider.friction(0.5)).0
    };
    let bodies = [
        insert(0.1, ColliderBuilder::cuboid(0.25, 0.1, 0.25).density(300.0)),
        insert(0.26, ring.into_collider().density(1000.0)),
    ];
    for _ in 0..300 {
        plugin.step(&mut world);
    }
    let [under, over] = bodies.map(|body| &world.bodies[body]);
    let way = under.translation().x.abs().max(over.translation().x.abs());
    let gap = (over.translation().y - under.translation().y - 0.16).abs();
    println!("moved {:.2} mm, gap of {:.2} mm, {} m/s", way * 1e3, gap * 1e3, over.linvel().length());
    assert!(way < 0.002 && gap < 0.003 && over.linvel().length() < 1e-3);
}

/// What Rapier tells of the contact of a crate with the floor: the weight of the crate and of the ring on it.
#[test]
fn rapiers_contacts_feel_what_lies_on_them() {
    let ring = packed(&shapes::ring(0.15, 0.06, [48, 24]), 1000);
    for density in [0.0, 100.0, 1000.0, 3000.0] {
        let (mut world, mut plugin) = grounded();
        let body = RigidBodyBuilder::dynamic().translation(Vec3::Y * 0.1).can_sleep(false);
        let (body, collider) = world.insert(body, ColliderBuilder::cuboid(0.25, 0.1, 0.25).density(300.0));
        let mut mass = 15.0;
        if density > 0.0 {
            let place = RigidBodyBuilder::dynamic().translation(Vec3::Y * 0.26).can_sleep(false);
            let (ring, _) = world.insert(place, ring.clone().into_collider().density(density));
            plugin.step(&mut world);
            mass += world.bodies[ring].mass();
        }
        for _ in 0..300 {
            plugin.step(&mut world);
        }
        let points = world
            .narrow_phase
            .contact_pairs_with(collider)
            .flat_map(|pair| pair.manifolds())
            .flat_map(|m| &m.points);
        let force = points.map(|point| point.data.impulse).sum::<f32>() / world.integration_parameters.dt;
        println!("density {density}: Rapier's contact has {force} N of {}", mass * 9.81);
        assert!((force / (mass * 9.81) - 1.0).abs() < 0.02, "{density}: {force}");
        assert!(world.bodies[body].linvel().length() < 1e-3);
    }
}

/// A robot of Rapier's shapes on Rapier's floor takes a cube and lifts it. Before the solve knew of the floor robot and cube fell
/// together, and the cube fell on when the floor held the robot.
#[test]
fn a_robot_that_stands_on_a_floor_lifts_a_cube() {
    const REACH: f32 = 0.45;
    let cube = packed(&shapes::cuboid(DVec3::splat(0.025)), 1000);
    let (mut world, mut plugin) = grounded();
    let base = RigidBodyBuilder::dynamic().translation(Vec3::Y * 0.1).can_sleep(false);
    let (base, _) = world.insert(base, ColliderBuilder::cuboid(0.3, 0.1, 0.2).density(400.0).friction(0.8));
    let alone = InteractionGroups::none();
    let arm = RigidBodyBuilder::dynamic().translation(Vec3::new(REACH, 0.3, 0.0)).can_sleep(false);
    let (arm, _) =
        world.insert(arm, ColliderBuilder::cuboid(0.03, 0.03, 0.06).density(800.0).collision_groups(alone));
    let lift = |place: f32| {
        PrismaticJointBuilder::new(Vec3::Y)
            .motor_model(MotorModel::ForceBased)
            .local_anchor1(Vec3::X * REACH)
            .motor_position(place, 2e4, 1e3)
            .motor_max_force(500.0)
    };
    let slide = world.impulse_joints.insert(base, arm, lift(0.2), true);
    let grip = InteractionGroups::new(Group::GROUP_2, Group::GROUP_2, InteractionTestMode::And);
    for side in [-1.0, 1.0] {
        let place = Vec3::new(REACH, 0.2, side * 0.05);
        let finger = RigidBodyBuilder::dynamic().translation(place).can_sleep(false);
        let collider = ColliderBuilder::cuboid(0.02, 0.06, 0.005).density(1000.0).friction(0.6);
        let (finger, _) = world.insert(finger, collider.collision_groups(grip));
        let joint = PrismaticJointBuilder::new(Vec3::Z * -side)
            .motor_model(MotorModel::ForceBased)
            .local_anchor1(Vec3::new(0.0, -0.1, side * 0.05))
            .motor_position(0.03, 2000.0, 50.0)
            .motor_max_force(30.0);
        world.impulse_joints.insert(arm, finger, joint, true);
    }
    let object = RigidBodyBuilder::dynamic()
        .translation(Vec3::new(REACH, 0.17, 0.0))
        .can_sleep(false)
        .gravity_scale(0.0);
    let (object, _) = world.insert(object, cube.into_collider().density(1000.0).friction(0.6));
    let start = world.bodies[base].translation();
    let mut held = Vec3::ZERO;
    for step in 0..480 {
        if step == 60 {
            world.bodies[object].set_gravity_scale(1.0, true);
            held = world.bodies[object].translation() - world.bodies[arm].translation();
        }
        if step == 120
            && let Some(joint) = world.impulse_joints.get_mut(slide, true)
        {
            joint.data = lift(0.3).into();
        }
        plugin.step(&mut world);
    }
    let slip = held.distance(world.bodies[object].translation() - world.bodies[arm].translation());
    let moved = world.bodies[base].translation().distance(start);
    let height = world.bodies[object].translation().y;
    println!("cube {height} m high, slipped {:.2} mm, base moved {:.2} mm", slip * 1e3, moved * 1e3);
    assert!(slip < 0.002 && moved < 0.001 && (height - 0.27).abs() < 0.002);
}

/// Velocity and angular velocity at a time (s).
type Motion = fn(f32) -> [Vec3; 2];

/// A crate with a ring on it goes where the platform under it goes: along, up and down, round.
#[test]
fn what_stands_on_a_platform_moves_with_it() {
    let ring = packed(&shapes::ring(0.15, 0.06, [48, 24]), 1000);
    let motions: [(&str, Motion); 3] = [
        ("along", |t| [Vec3::X * (2.0 * t).min(1.0), Vec3::ZERO]),
        ("up and down", |t| [Vec3::Y * 0.5 * (3.0 * t).sin(), Vec3::ZERO]),
        ("round", |t| [Vec3::ZERO, Vec3::Y * t.min(1.0)]),
    ];
    for (name, motion) in motions {
        for is_positional in [false, true] {
            let (mut world, mut plugin) = grounded();
            let start = Vec3::Y;
            let body = if is_positional {
                RigidBodyBuilder::kinematic_position_based()
            } else {
                RigidBodyBuilder::kinematic_velocity_based()
            };
            let (platform, _) =
                world.insert(body.translation(start), ColliderBuilder::cuboid(1.0, 0.1, 1.0).friction(0.8));
            let mut insert = |height: f32, collider: ColliderBuilder| {
                let body = RigidBodyBuilder::dynamic().translation(start + Vec3::Y * height).can_sleep(false);
                world.insert(body, collider.friction(0.8)).0
            };
            let case = insert(0.2, ColliderBuilder::cuboid(0.25, 0.1, 0.25).density(300.0));
            let ring = insert(0.36, ring.clone().into_collider().density(1000.0));
            let places = |world: &PhysicsWorld| {
                let frame = world.bodies[platform].position().inverse();
                [case, ring].map(|body| frame * world.bodies[body].translation())
            };
            let mut settled = places(&world);
            for step in 0..240 {
                let [linear, angular] = motion(step as f32 / 60.0);
                let body = &mut world.bodies[platform];
                if is_positional {
                    let turn = Rotation::from_scaled_axis(angular / 60.0) * *body.rotation();
                    let place = body.translation() + linear / 60.0;
                    body.set_next_kinematic_position(Pose::from_parts(place, turn));
                } else {
                    body.set_linvel(linear, true);
                    body.set_angvel(angular, true);
                }
                plugin.step(&mut world);
                if step == 60 {
                    settled = places(&world);
                }
            }
            let shifts = [0, 1].map(|i| settled[i].distance(places(&world)[i]));
            println!("{name}, by positions {is_positional}: crate and ring shift by {shifts:?} m");
            assert!(shifts[0] < 0.005 && shifts[1] < 0.01, "{name} {is_positional}");
        }
    }
}

/// Crate and ring are moved off a platform by the user, and set in motion: nothing carries and stops them there.
#[test]
fn what_is_moved_away_from_its_support_falls() {
    let ring = packed(&shapes::ring(0.15, 0.06, [48, 24]), 1000);
    let (mut world, mut plugin) = grounded();
    let start = Vec3::Y * 5.0;
    world.insert(RigidBodyBuilder::fixed().translation(start), ColliderBuilder::cuboid(1.0, 0.1, 1.0));
    let mut insert = |height: f32, collider: ColliderBuilder| {
        let body = RigidBodyBuilder::dynamic().translation(start + Vec3::Y * height).can_sleep(false);
        world.insert(body, collider).0
    };
    let bodies = [
        insert(0.2, ColliderBuilder::cuboid(0.25, 0.1, 0.25).density(300.0)),
        insert(0.36, ring.into_collider().density(1000.0)),
    ];
    for _ in 0..60 {
        plugin.step(&mut world);
    }
    for body in bodies {
        let place = world.bodies[body].translation();
        world.bodies[body].set_translation(place + Vec3::X * 3.0, true);
        world.bodies[body].set_linvel(Vec3::NEG_Y, true);
    }
    for step in 1..=10 {
        plugin.step(&mut world);
        let bodies = bodies.map(|body| &world.bodies[body]);
        let mass: f32 = bodies.iter().map(|body| body.mass()).sum();
        let speed = bodies.iter().map(|body| body.mass() * body.linvel().y).sum::<f32>() / mass;
        assert!((speed + 1.0 + 9.81 * step as f32 / 60.0).abs() < 1e-3, "step {step}: {speed} m/s");
    }
}
