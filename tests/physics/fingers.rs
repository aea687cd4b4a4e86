//! Light bodies that strong motors press and set in motion.

use super::joints::join;
use super::{grounded, packed};
use glam::{DVec3, Vec3};
use rapier_ist_examples::shapes;
use rapier3d::prelude::*;

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
