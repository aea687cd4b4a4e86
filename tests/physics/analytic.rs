//! Bodies at rest and impacts, against closed forms.

use super::{DENSITY, packed, stiff};
use glam::{DVec3, Vec3};
use rapier_ist::{IstPlugin, IstShape, PairContact};
use rapier_ist_examples::shapes;
use rapier3d::prelude::*;
use std::f32::consts::PI;

const RADIUS: f32 = 0.1;

/// Volume of a cap of height `h` of a ball of radius `r`.
fn cap(r: f32, h: f32) -> f32 {
    PI * h * h * (3.0 * r - h) / 3.0
}

/// Lets a body come to rest on `ground` and gives its height, its weight and its contact.
fn rest(
    shape: &IstShape,
    ground: impl Into<Collider>,
    height: f32,
    stiffness: f32,
) -> (f32, f32, PairContact) {
    let mut world = PhysicsWorld::new();
    let mut plugin = IstPlugin::install(&mut world);
    stiff(&mut plugin, stiffness);
    world.insert(RigidBodyBuilder::fixed(), ground);
    let body = RigidBodyBuilder::dynamic()
        .translation(Vec3::Y * height)
        .locked_axes(
            LockedAxes::ROTATION_LOCKED | LockedAxes::TRANSLATION_LOCKED_X | LockedAxes::TRANSLATION_LOCKED_Z,
        )
        .can_sleep(false);
    let (handle, _) = world.insert(body, shape.clone().into_collider().density(DENSITY));
    for _ in 0..400 {
        plugin.step(&mut world);
    }
    let body = &world.bodies[handle];
    assert!(body.linvel().length() < 1e-3, "{}", body.linvel());
    (body.translation().y, 9.81 * body.mass(), plugin.report().contacts[0])
}

fn check(name: &str, contact: &PairContact, weight: f32, stiffness: f32, volume: f32) {
    let errors = [contact.volume / volume - 1.0, contact.force.y.abs() / weight - 1.0];
    let law = stiffness * volume / weight - 1.0;
    println!(
        "{name}: volume {:+.2} %, force {:+.2} %, stiffness times exact volume {:+.2} %",
        100.0 * errors[0],
        100.0 * errors[1],
        100.0 * law
    );
    assert!(errors.iter().all(|error| error.abs() < 0.02) && law.abs() < 0.02, "{name}");
}

#[test]
fn bodies_at_rest_overlap_by_the_volume_that_carries_them() {
    let ball = packed(&shapes::sphere(f64::from(RADIUS), 4), 3000);
    let cube = packed(&shapes::cuboid(DVec3::splat(0.1)), 3000);
    let plane = || ColliderBuilder::new(SharedShape::halfspace(Vec3::Y));
    // Soft enough to sink in by a tenth of their size: the depth is then known to a part in a thousand.
    let stiffness = 1.5e5;
    let (y, weight, contact) = rest(&ball, plane(), RADIUS, stiffness);
    check("ball on plane", &contact, weight, stiffness, cap(RADIUS, RADIUS - y));
    let (y, weight, contact) = rest(&ball, ball.clone().into_collider(), 2.0 * RADIUS, stiffness);
    check("ball on ball", &contact, weight, stiffness, 2.0 * cap(RADIUS, RADIUS - 0.5 * y));
    let (y, weight, contact) = rest(&cube, plane(), 0.1, stiffness);
    check("cube on plane", &contact, weight, stiffness, 0.04 * (0.1 - y));
}

/// Two equal balls that meet head on at 2 m/s each: when they are midway between impact and rebound (s), and the speed
/// after it (m/s).
fn impact(rate: f32, restitution: f32) -> [f32; 2] {
    let mut world = PhysicsWorld { gravity: Vec3::ZERO, ..PhysicsWorld::new() };
    world.integration_parameters.dt = 1.0 / rate;
    let mut plugin = IstPlugin::install(&mut world);
    let shape = super::ball();
    let mut throw = |side: f32| {
        let body =
            RigidBodyBuilder::dynamic().translation(Vec3::X * side * 0.5).linvel(Vec3::X * side * -2.0);
        let collider = shape.clone().into_collider().density(DENSITY).restitution(restitution);
        world.insert(body, collider).0
    };
    let (_, right) = (throw(-1.0), throw(1.0));
    let steps = (0.6 * rate) as usize;
    for _ in 0..steps {
        plugin.step(&mut world);
    }
    let body = &world.bodies[right];
    let (x, speed) = (body.translation().x, body.linvel().x);
    // Back along both straight lines to where they cross.
    let end = steps as f32 / rate;
    [(0.5 - x + speed * end) / (2.0 + speed), speed]
}

#[test]
fn impacts_at_60_hz_are_those_at_10_khz() {
    for restitution in [0.3, 0.6, 0.9] {
        let [reference, coarse] = [10_000.0, 60.0].map(|rate| impact(rate, restitution));
        println!("e = {restitution}: at 10 kHz {reference:.4?}, at 60 Hz {coarse:.4?} (s, m/s)");
        assert!((reference[1] / (2.0 * restitution) - 1.0).abs() < 0.1, "{reference:?}");
        assert!((coarse[1] / reference[1] - 1.0).abs() < 0.1, "{coarse:?} {reference:?}");
        assert!((coarse[0] - reference[0]).abs() < 1.0 / 60.0, "{coarse:?} {reference:?}");
    }
}
