//! Bodies that turn while they touch, against closed forms: nothing but friction may change how fast.

use super::{DENSITY, ball};
use glam::{DMat3, DVec3, Vec3};
use ist::{InnerSphere, SolidProperties, SpherePacking};
use rapier_ist::{IstPlugin, IstShape};
use rapier_ist_examples::shapes;
use rapier3d::prelude::*;
use std::f32::consts::{FRAC_PI_2, TAU};

const RADIUS: f32 = 0.1;
/// Speed (m/s) at which a ball begins.
const SPEED: f32 = 2.0;

/// A ball on a plane, on a triangle mesh, and on a heavy plate that is free to move.
fn grounds() -> [(&'static str, RigidBodyBuilder, ColliderBuilder); 3] {
    let corners = [(-1.0, -1.0), (9.0, -1.0), (9.0, 1.0), (-1.0, 1.0)].map(|(x, z)| Vec3::new(x, 0.0, z));
    let mesh = ColliderBuilder::trimesh(corners.to_vec(), vec![[0, 2, 1], [0, 3, 2]]).unwrap();
    let plate = ColliderBuilder::cuboid(9.0, 0.5, 9.0).translation(Vec3::Y * -0.5).density(1e6);
    [
        ("plane", RigidBodyBuilder::fixed(), ColliderBuilder::new(SharedShape::halfspace(Vec3::Y))),
        ("mesh", RigidBodyBuilder::fixed(), mesh),
        ("plate", RigidBodyBuilder::dynamic().gravity_scale(0.0), plate),
    ]
}

/// Velocity and spin of a ball after two seconds on a ground; `spin` about z (rad/s) and the friction are given.
fn roll(
    (body, collider): (RigidBodyBuilder, ColliderBuilder),
    spin: f32,
    friction: f32,
    gravity: Vec3,
) -> [Vec3; 2] {
    let mut world = PhysicsWorld { gravity, ..PhysicsWorld::new() };
    let mut plugin = IstPlugin::install(&mut world);
    world.insert(body, collider.friction(friction));
    let body = RigidBodyBuilder::dynamic()
        .translation(Vec3::Y * RADIUS)
        .linvel(if gravity.x == 0.0 { Vec3::X * SPEED } else { Vec3::ZERO })
        .angvel(Vec3::Z * spin)
        .can_sleep(false);
    let (handle, _) = world.insert(body, ball().into_collider().density(DENSITY).friction(friction));
    for _ in 0..120 {
        plugin.step(&mut world);
    }
    let body = &world.bodies[handle];
    [body.linvel(), body.angvel()]
}

const DOWN: Vec3 = Vec3::new(0.0, -9.81, 0.0);

/// Asserts that a ball moves along x with the speed `v` and turns about z with `w`.
fn assert_rolls(what: &str, [velocity, spin]: [Vec3; 2], v: f32, w: f32, tolerance: f32) {
    println!("{what}: {} m/s of {v}, {} rad/s of {w}", velocity.x, spin.z);
    assert!((velocity.x - v).abs() <= tolerance * v.abs(), "{what}: {velocity}");
    assert!((spin.z - w).abs() <= tolerance * w.abs(), "{what}: {spin}");
    let aside = velocity.z.abs().max(RADIUS * spin.x.hypot(spin.y));
    assert!(aside <= tolerance * SPEED, "{what}: {velocity} {spin}");
}

#[test]
fn issue_a_rolling_ball_goes_on_rolling() {
    for (name, body, collider) in grounds() {
        let rolled = roll((body, collider), -SPEED / RADIUS, 0.5, DOWN);
        assert_rolls(name, rolled, SPEED, -SPEED / RADIUS, 5e-3);
    }
}

#[test]
fn issue_a_ball_turns_on_without_friction() {
    for (name, body, collider) in grounds() {
        let rolled = roll((body, collider), 20.0, 0.0, DOWN);
        assert_rolls(name, rolled, SPEED, 20.0, 1e-3);
    }
}

#[test]
fn a_sliding_ball_ends_up_rolling_at_five_sevenths_of_its_speed() {
    for (name, body, collider) in grounds() {
        let rolled = roll((body, collider), 0.0, 0.3, DOWN);
        let end = SPEED * 5.0 / 7.0;
        assert_rolls(name, rolled, end, -end / RADIUS, 1e-2);
    }
}

#[test]
fn a_ball_rolls_down_a_slope_at_five_sevenths_of_the_acceleration() {
    let (sin, cos) = 0.2_f32.sin_cos();
    let gravity = Vec3::new(sin, -cos, 0.0) * 9.81;
    for (name, body, collider) in grounds() {
        let end = 5.0 / 7.0 * gravity.x * 2.0;
        assert_rolls(name, roll((body, collider), 0.0, 0.5, gravity), end, -end / RADIUS, 1e-2);
    }
}

/// A ring of 24 balls about the y axis, `major` and `minor` its radii (m).
fn ring(major: f32, minor: f32) -> IstShape {
    let spheres: Vec<_> = (0..24)
        .map(|i| {
            let (z, x) = (TAU * i as f32 / 24.0).sin_cos();
            let out = Vec3::new(x, 0.0, z);
            InnerSphere::solid_ball(out * major, minor, -out)
        })
        .collect();
    let one = SolidProperties::ball(minor.into());
    let thin = DMat3::from_diagonal(DVec3::new(0.5, 1.0, 0.5)) * f64::from(major).powi(2);
    let unit_inertia = (one.unit_inertia + thin * one.volume) * 24.0;
    let solid = SolidProperties { volume: 24.0 * one.volume, centroid: DVec3::ZERO, unit_inertia };
    IstShape::from_packing(&SpherePacking::new(spheres, solid).unwrap())
}

/// Normal forces all around a shaft have no torque about it, whatever they are.
#[test]
fn issue_a_ring_squeezed_onto_a_shaft_turns_on_as_it_was() {
    for (name, shaft, spin) in [
        ("fixed", RigidBodyBuilder::fixed(), 0.0),
        ("free", RigidBodyBuilder::dynamic().angvel(Vec3::Y * -10.0), -10.0),
    ] {
        for substeps in [1, 4] {
            let mut world = PhysicsWorld { gravity: Vec3::ZERO, ..PhysicsWorld::new() };
            let mut plugin = IstPlugin::install(&mut world);
            plugin.substeps = substeps;
            let cylinder = ColliderBuilder::cylinder(0.2, RADIUS).friction(0.0).density(DENSITY);
            let (shaft, _) = world.insert(shaft.clone().can_sleep(false), cylinder);
            let body = RigidBodyBuilder::dynamic().angvel(Vec3::Y * 20.0).can_sleep(false);
            let ring = ring(RADIUS + 0.019, 0.02).into_collider().friction(0.0).density(DENSITY);
            let (handle, _) = world.insert(body, ring);
            for _ in 0..120 {
                plugin.step(&mut world);
            }
            let [turned, still] = [handle, shaft].map(|body| world.bodies[body].angvel());
            println!("{name} shaft, {substeps} substeps: ring {turned}, shaft {still}");
            assert!(turned.distance(Vec3::Y * 20.0) < 0.02 && still.distance(Vec3::Y * spin) < 0.02);
        }
    }
}

/// Rapier looks for what fast bodies would pass through, and shortens their way to where they meet it. What they roll or slide on
/// they meet all the time.
#[test]
fn issue_fast_bodies_in_contact_move_at_their_velocity() {
    let upright = Vec3::X * FRAC_PI_2;
    let fine = super::packed(&shapes::cuboid(DVec3::new(0.2, 0.05, 0.2)), 10_000);
    for (name, shape, height, turned, rolls) in [
        ("ring", super::ring(1000), 0.15, upright, true),
        ("slab", super::slab(), 0.05, Vec3::ZERO, false),
        // More spheres lie closer to the ground: they were held back to four fifths of 3 m/s.
        ("slab of 10,000 spheres", fine, 0.05, Vec3::ZERO, false),
    ] {
        for speed in [1.0, 3.0, 10.0, 30.0] {
            for (ground, body, collider) in grounds().into_iter().take(2) {
                let mut world = PhysicsWorld::new();
                let mut plugin = IstPlugin::install(&mut world);
                let friction = if rolls { 0.5 } else { 0.0 };
                world.insert(body, collider.friction(friction));
                let body = RigidBodyBuilder::dynamic()
                    .translation(Vec3::Y * height)
                    .rotation(turned)
                    .linvel(Vec3::X * speed)
                    .angvel(if rolls { Vec3::Z * -speed / height } else { Vec3::ZERO });
                let collider = shape.clone().into_collider().density(DENSITY).friction(friction);
                let (handle, _) = world.insert(body, collider);
                let mut way = 0.0;
                for _ in 0..((360.0 / speed) as usize).min(60) {
                    plugin.step(&mut world);
                    way += world.bodies[handle].linvel().x / 60.0;
                }
                let moved = world.bodies[handle].translation().x;
                println!("{name} on {ground} at {speed} m/s: {moved} m of {way}");
                assert!(
                    (moved - way).abs() < 0.02 * way,
                    "{name} on {ground} at {speed} m/s: {moved} m of {way}"
                );
            }
        }
    }
}
