//! Trees that slide on trees without friction: spheres are bumps, and bumps must not brake.

use super::{DENSITY, packed, slab};
use glam::{DVec3, Vec3};
use rapier_ist::{IstPlugin, IstShape};
use rapier_ist_examples::shapes;
use rapier3d::prelude::*;

/// 3 × 0.1 × 0.8 m, its upper side at height 0.
fn plate() -> IstShape {
    packed(&shapes::cuboid(DVec3::new(1.5, 0.05, 0.4)), 15000)
}

/// Puts a slab `gap` (m) above one end of a plate and gives its velocity after `seconds`; all without friction, in steps of 1/240 s.
fn slide(shapes: &[IstShape; 2], gap: f32, velocity: Vec3, seconds: f32) -> Vec3 {
    let mut world = PhysicsWorld::new();
    let mut plugin = IstPlugin::install(&mut world);
    plugin.substeps = 4;
    let [slab, plate] = shapes.clone().map(|shape| shape.into_collider().friction(0.0));
    world.insert(RigidBodyBuilder::fixed().translation(Vec3::Y * -0.05), plate);
    let body = RigidBodyBuilder::dynamic().translation(Vec3::new(-1.2, 0.05 + gap, 0.0)).can_sleep(false);
    let (handle, _) = world.insert(body, slab.density(DENSITY));
    if gap == 0.0 {
        for _ in 0..60 {
            plugin.step(&mut world);
        }
    }
    world.bodies[handle].set_linvel(velocity, true);
    for _ in 0..(60.0 * seconds) as usize {
        plugin.step(&mut world);
    }
    world.bodies[handle].linvel()
}

/// It lost half of its speed in a second. What is left is that it goes up and down, which is damped.
#[test]
fn issue_bumps_do_not_brake_a_slab() {
    let shapes = [slab(), plate()];
    for (speed, seconds, most) in [(1.0, 1.0, 0.2), (2.0, 1.0, 0.2), (3.0, 0.6, 0.2)] {
        let end = slide(&shapes, 0.0, Vec3::X * speed, seconds);
        println!("{speed} m/s: {end} after {seconds} s");
        assert!(end.x > speed - most && end.x < 1.02 * speed, "{speed} m/s: {end}");
    }
}

/// An impact took up to a fifth of the speed across it.
#[test]
fn issue_frictionless_impacts_leave_the_velocity_across_them() {
    let shapes = [slab(), plate()];
    for (across, down) in [(1.0, 0.3), (1.0, 1.0), (3.0, 1.0), (3.0, 3.0)] {
        let end = slide(&shapes, 0.02, Vec3::new(across, -down, 0.0), 0.1);
        println!("{across} m/s across, {down} m/s down: {end}");
        assert!((end.x / across - 1.0).abs() < 0.05, "{across}, {down} m/s: {end}");
    }
}
