//! Friction on a slope, against Coulomb's law.

use super::{DENSITY, slab, stiff};
use glam::{Quat, Vec3};
use rapier_ist::{IstPlugin, IstShape};
use rapier3d::prelude::*;

/// Lets a slab lie on a slope of the given angle (rad) and gives its velocity down the slope after `seconds`.
fn slide(shape: &IstShape, friction: f32, angle: f32, stiffness: Option<f32>, seconds: f32) -> f32 {
    // The ground stays level and gravity tilts: the same motion, seen from the slope.
    let gravity = Quat::from_rotation_z(angle) * Vec3::NEG_Y * 9.81;
    let mut world = PhysicsWorld { gravity: Vec3::NEG_Y * 9.81, ..PhysicsWorld::new() };
    let mut plugin = IstPlugin::install(&mut world);
    if let Some(stiffness) = stiffness {
        stiff(&mut plugin, stiffness);
    }
    let ground = ColliderBuilder::new(SharedShape::halfspace(Vec3::Y)).friction(friction);
    world.insert(RigidBodyBuilder::fixed(), ground);
    let body = RigidBodyBuilder::dynamic().translation(Vec3::Y * 0.05).can_sleep(false);
    let (handle, _) = world.insert(body, shape.clone().into_collider().density(DENSITY).friction(friction));
    for _ in 0..60 {
        plugin.step(&mut world);
    }
    world.gravity = gravity;
    for _ in 0..(60.0 * seconds) as usize {
        plugin.step(&mut world);
    }
    world.bodies[handle].linvel().x
}

#[test]
fn bodies_slide_from_the_angle_of_friction_on() {
    let shape = slab();
    for friction in [0.2_f32, 0.5, 0.8] {
        for stiffness in [None, Some(1e7)] {
            let critical = friction.atan();
            let below = slide(&shape, friction, critical * 0.97, stiffness, 2.0);
            let above = slide(&shape, friction, critical * 1.03, stiffness, 2.0);
            println!(
                "μ = {friction}, {stiffness:?} N/m³: {below} m/s at 0.97, {above} m/s at 1.03 of the angle"
            );
            assert!(below < 2e-3, "μ = {friction}: creeps at {below} m/s");
            let angle = critical * 1.03;
            let theory = 2.0 * 9.81 * (angle.sin() - friction * angle.cos());
            assert!(above > 0.75 * theory, "μ = {friction}: {above} m/s of {theory}");
        }
    }
}

#[test]
fn sliding_bodies_accelerate_as_coulomb_says() {
    let shape = slab();
    for (friction, angle) in [(0.0_f32, 0.3_f32), (0.2, 0.4), (0.5, 0.7), (0.8, 0.9)] {
        let (first, second) = (0.5, 1.5);
        let rate = slide(&shape, friction, angle, None, second) - slide(&shape, friction, angle, None, first);
        let acceleration = rate / (second - first);
        let theory = 9.81 * (angle.sin() - friction * angle.cos());
        println!("μ = {friction}, {angle} rad: {acceleration} m/s², theory {theory}");
        assert!((acceleration / theory - 1.0).abs() < 0.01, "{acceleration} {theory}");
    }
}
