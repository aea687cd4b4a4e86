//! Friction of bodies that slide and of balls that bounce, against Coulomb's law.

use super::{DENSITY, ball, slab};
use glam::Vec3;
use rapier_ist::IstPlugin;
use rapier3d::prelude::*;

const GRAVITY: f32 = 9.81;

/// A belt that starts at 1 m/s under a slab at rest: that follows at μ g and then at the belt's speed.
#[test]
fn issue_a_slab_on_a_belt_follows_as_coulomb_says() {
    let shape = slab();
    for friction in [0.1, 0.3] {
        let mut world = PhysicsWorld::new();
        let mut plugin = IstPlugin::install(&mut world);
        let belt = ColliderBuilder::cuboid(9.0, 0.1, 1.0).friction(friction);
        let (belt, _) = world.insert(RigidBodyBuilder::kinematic_velocity_based(), belt);
        let body = RigidBodyBuilder::dynamic().translation(Vec3::Y * 0.15).can_sleep(false);
        let collider = shape.clone().into_collider().density(DENSITY).friction(friction);
        let (handle, _) = world.insert(body, collider);
        for _ in 0..30 {
            plugin.step(&mut world);
        }
        world.bodies[belt].set_linvel(Vec3::X, true);
        let mut worst = 0.0_f32;
        for step in 1..=90 {
            plugin.step(&mut world);
            let expected = (friction * GRAVITY * step as f32 / 60.0).min(1.0);
            worst = worst.max((world.bodies[handle].linvel().x - expected).abs());
        }
        println!("μ = {friction}: off by at most {worst} m/s");
        assert!(worst < 0.01, "μ = {friction}: {worst} m/s");
    }
}

/// Drops a spinning ball from 0.5 m and gives its velocity and spin about z once it has bounced.
fn bounce(restitution: f32, friction: f32, spin: f32, substeps: u32) -> (Vec3, f32) {
    let mut world = PhysicsWorld::new();
    let mut plugin = IstPlugin::install(&mut world);
    plugin.substeps = substeps;
    let ground = ColliderBuilder::new(SharedShape::halfspace(Vec3::Y));
    world.insert(RigidBodyBuilder::fixed(), ground.friction(friction).restitution(restitution));
    let body = RigidBodyBuilder::dynamic().translation(Vec3::Y * 0.6).angvel(Vec3::Z * spin);
    let collider = ball().into_collider().density(DENSITY).friction(friction).restitution(restitution);
    let (handle, _) = world.insert(body, collider);
    for step in 0..60 {
        plugin.step(&mut world);
        let body = &world.bodies[handle];
        if step > 12 && body.linvel().y > 0.0 {
            return (body.linvel(), body.angvel().z);
        }
    }
    unreachable!("it falls for 19 steps")
}

/// The impulse across a rebound is μ times the normal one, or as much as ends the slip: 2/7 of it for a ball.
#[test]
fn issue_balls_that_bounce_have_friction() {
    let speed = (2.0 * GRAVITY * 0.5_f32).sqrt();
    let spin = -40.0;
    for substeps in [1, 4] {
        for (restitution, friction) in [(0.5, 0.05), (0.5, 0.2), (0.5, 2.0), (0.9, 0.05), (0.9, 2.0)] {
            let (velocity, turn) = bounce(restitution, friction, spin, substeps);
            let across = (friction * (1.0 + restitution) * speed).min(-spin * 0.1 * 2.0 / 7.0);
            let left = spin + 2.5 * across / 0.1;
            println!(
                "e = {restitution}, μ = {friction}: {velocity}, {turn} rad/s, expected {across} m/s, {left} rad/s"
            );
            assert!((velocity.x / across - 1.0).abs() < 0.06, "{velocity}, expected {across}");
            assert!((turn - left).abs() < 0.06 * spin.abs(), "{turn}, expected {left}");
        }
    }
}
