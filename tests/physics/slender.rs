//! Bodies much longer than thick, with the automatic stiffness.

use super::{DENSITY, packed};
use glam::{DVec3, Vec3};
use rapier_ist::{IstPlugin, IstShape};
use rapier_ist_examples::shapes;
use rapier3d::prelude::*;
use std::f32::consts::FRAC_PI_2;

/// A box with these sides (m) and its eight corners.
fn bar(sides: Vec3, spheres: usize) -> (IstShape, [Vec3; 8]) {
    let half = 0.5 * sides;
    let corner =
        |i: usize| half * Vec3::from([0, 1, 2].map(|axis| if i >> axis & 1 == 1 { 1.0 } else { -1.0 }));
    (packed(&shapes::cuboid(DVec3::from(half)), spheres), std::array::from_fn(corner))
}

/// The least coordinate along `axis` of a body's corners.
fn lowest(body: &RigidBody, corners: &[Vec3; 8], axis: Vec3) -> f32 {
    corners.iter().map(|corner| (*body.position() * *corner).dot(axis)).fold(f32::INFINITY, f32::min)
}

/// A frictionless ladder: at an angle θ with the ground, let go at θ₀, it has θ'² = 3 g (sin θ₀ − sin θ) / L as long as it leans on
/// the wall, and leaves it at sin θ = 2/3 sin θ₀ with √(g L sin³θ₀) / 3 along the ground.
#[test]
fn a_ladder_leaves_the_wall_as_on_rigid_ground() {
    let angle = 60_f32.to_radians();
    for sides in [Vec3::new(0.1, 2.0, 0.1), Vec3::new(0.06, 2.0, 0.06)] {
        let (shape, corners) = bar(sides, 500);
        let mut world = PhysicsWorld::new();
        let mut plugin = IstPlugin::install(&mut world);
        for axis in [Vec3::X, Vec3::Y] {
            let wall = ColliderBuilder::new(SharedShape::halfspace(axis)).friction(0.0);
            world.insert(RigidBodyBuilder::fixed(), wall);
        }
        let body = RigidBodyBuilder::dynamic().rotation(Vec3::Z * (FRAC_PI_2 - angle));
        let (ladder, _) = world.insert(body, shape.into_collider().density(DENSITY).friction(0.0));
        let start = Vec3::new(
            lowest(&world.bodies[ladder], &corners, Vec3::X),
            lowest(&world.bodies[ladder], &corners, Vec3::Y),
            0.0,
        );
        world.bodies[ladder].set_translation(-start, true);
        let (mut deepest, mut speed) = (0.0_f32, 0.0_f32);
        // It leaves the wall after 0.9 s and lies on the ground after 1.2 s.
        for _ in 0..60 {
            plugin.step(&mut world);
            let body = &world.bodies[ladder];
            deepest = deepest.min(lowest(body, &corners, Vec3::X)).min(lowest(body, &corners, Vec3::Y));
            speed = speed.max(body.linvel().x);
        }
        let theory = (9.81 * sides.y * angle.sin().powi(3)).sqrt() / 3.0;
        println!("{sides}: leaves at {speed} m/s, theory {theory}; {} mm deep", -1e3 * deepest);
        assert!((speed / theory - 1.0).abs() < 0.05, "{speed} m/s, theory {theory}");
        assert!(deepest > -0.1 * sides.x, "{deepest} m deep");
    }
}

#[test]
fn heaps_of_slender_bodies_rest_on_each_other_and_not_in_each_other() {
    // Corners of planks hold little volume: they go deeper.
    for (sides, spheres, most) in
        [(Vec3::new(1.0, 0.05, 0.05), 300, 0.01), (Vec3::new(1.0, 0.2, 0.02), 500, 0.015)]
    {
        let (shape, corners) = bar(sides, spheres);
        let mut world = PhysicsWorld::new();
        let mut plugin = IstPlugin::install(&mut world);
        // A pit of 1.2 m × 1.2 m.
        for inward in [Vec3::Y, Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z] {
            let away = if inward == Vec3::Y { 0.0 } else { -0.6 };
            let wall = ColliderBuilder::new(SharedShape::halfspace(inward)).translation(away * inward);
            world.insert(RigidBodyBuilder::fixed(), wall.friction(0.5));
        }
        let bars: Vec<_> = (0..12)
            .map(|i| {
                let (at, turn) = (0.7 + 0.3 * i as f32, Vec3::new(0.3 * i as f32, 1.9 * i as f32, 0.2));
                let body =
                    RigidBodyBuilder::dynamic().translation(at * Vec3::Y).rotation(turn).can_sleep(false);
                world.insert(body, shape.clone().into_collider().density(500.0).friction(0.5)).0
            })
            .collect();
        for _ in 0..480 {
            plugin.step(&mut world);
        }
        let lowest =
            bars.iter().map(|bar| lowest(&world.bodies[*bar], &corners, Vec3::Y)).fold(0.0, f32::min);
        let deepest = plugin.report().patches.iter().map(|patch| patch.depth).fold(0.0, f32::max);
        let speed = bars.iter().map(|bar| world.bodies[*bar].linvel().length()).fold(0.0, f32::max);
        println!(
            "{sides}: {} mm below the ground, patches up to {} mm deep, {speed} m/s",
            -1e3 * lowest,
            1e3 * deepest
        );
        assert!(lowest > -most && deepest < most && speed < 0.01, "{lowest} {deepest} {speed}");
    }
}
