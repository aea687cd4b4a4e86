//! Rebound heights, against e² h.

use super::{DENSITY, ball, packed};
use glam::Vec3;
use rapier_ist::{IstPlugin, IstShape};
use rapier_ist_examples::shapes;
use rapier3d::prelude::*;

/// A ball of radius 0.1 m, packed as any other mesh.
fn packed_ball() -> IstShape {
    packed(&shapes::sphere(0.1, 3), 500)
}

/// Greatest height of the ball's centre over its place at rest after the first impact, when dropped from `height`.
fn rebound(shape: &IstShape, restitution: f32, height: f32, dt: f32) -> f32 {
    let mut world = PhysicsWorld::new();
    world.integration_parameters.dt = dt;
    let mut plugin = IstPlugin::install(&mut world);
    let ground = ColliderBuilder::new(SharedShape::halfspace(Vec3::Y)).restitution(restitution);
    world.insert(RigidBodyBuilder::fixed(), ground);
    let body = RigidBodyBuilder::dynamic().translation(Vec3::Y * (0.1 + height)).can_sleep(false);
    let collider = shape.clone().into_collider().density(DENSITY).restitution(restitution);
    let (handle, _) = world.insert(body, collider);
    let (mut touched, mut highest) = (false, 0.0_f32);
    // Twice the time that a ball needs down and up again.
    for _ in 0..(4.0 * (2.0 * height / 9.81).sqrt() / dt) as usize {
        touched |= !plugin.step(&mut world).contacts.is_empty();
        if touched && world.bodies[handle].linvel().y > 0.0 {
            highest = highest.max(world.bodies[handle].translation().y - 0.1);
        }
    }
    highest
}

#[test]
fn balls_rebound_to_the_height_that_theory_gives() {
    for shape in [ball(), packed_ball()] {
        for restitution in [0.0, 0.5, 1.0] {
            for height in [0.3, 1.0, 2.7] {
                let highest = rebound(&shape, restitution, height, 1.0 / 60.0);
                let theory = restitution * restitution * height;
                println!("e = {restitution}, from {height} m: {highest} m, theory {theory} m");
                assert!((highest - theory).abs() < 0.1 * height.max(theory), "{highest} {theory}");
            }
        }
    }
}

/// Impacts that took two to twenty steps lost energy: at 1 kHz a ball with e = 1 rebounded to 0.4 of the height, and at 2 kHz, with
/// e = 0.7, to 0.72.
#[test]
fn issue_rebounds_do_not_depend_on_the_time_step() {
    let shape = ball();
    for restitution in [0.3, 0.7, 1.0] {
        for rate in [30.0, 60.0, 120.0, 240.0, 500.0, 700.0, 1000.0, 1400.0, 2000.0, 5000.0, 10000.0, 30000.0]
        {
            let share = rebound(&shape, restitution, 1.0, 1.0 / rate) / (restitution * restitution);
            println!("e = {restitution} at {rate} Hz: {share} of the height");
            assert!((share - 1.0).abs() < 0.1, "{rate} Hz: {share}");
        }
    }
}
