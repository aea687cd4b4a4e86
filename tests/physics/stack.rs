//! Six rings on each other, and five cubes.

use super::{packed, stiff};
use glam::{DVec3, Vec3};
use rapier_ist::IstPlugin;
use rapier_ist_examples::scenes::{RING_MINOR, Stack, ring_shape};
use rapier_ist_examples::shapes;
use rapier3d::prelude::*;

/// Density (kg/m³) at which the softest stack is 20 % and the stiffest 1e-4 % deep: that of foam.
const DENSITY: f32 = 20.0;

struct Outcome {
    /// When all slept (s).
    asleep: Option<f32>,
    /// How much closer than touching each ring is to the one below, in units of its thickness.
    sink: Vec<f32>,
    /// Farthest that a ring went from the axis (m).
    drift: f32,
}

fn run(stack: &mut Stack, seconds: u32) -> Outcome {
    let mut asleep = None;
    for step in 1..=60 * seconds {
        stack.plugin.step(&mut stack.world);
        if asleep.is_none() && stack.rings.iter().all(|&ring| stack.world.bodies[ring].is_sleeping()) {
            asleep = Some(step as f32 / 60.0);
        }
    }
    let places: Vec<_> = stack.rings.iter().map(|&ring| stack.world.bodies[ring].translation()).collect();
    let drift = places.iter().map(|p| p.x.hypot(p.z)).fold(0.0, f32::max);
    let mut below = -RING_MINOR;
    let sink = places.iter().map(|place| {
        let gap = place.y - below;
        below = place.y;
        1.0 - gap / (2.0 * RING_MINOR)
    });
    Outcome { asleep, sink: sink.collect(), drift }
}

#[test]
fn rings_stand_on_each_other_at_any_stiffness() {
    let shape = ring_shape(3000).unwrap();
    for stiffness in [1e4, 1e5, 1e6, 1e7, 1e8] {
        let mut stack = Stack::new(6, &shape, DENSITY, 0.01);
        stiff(&mut stack.plugin, stiffness);
        let Outcome { asleep, sink, drift } = run(&mut stack, 5);
        println!("{stiffness:.0e} N/m³: asleep {asleep:?} s, drift {drift} m, sink {sink:.4?}");
        assert!(asleep.is_some(), "{stiffness}");
        assert!(drift < RING_MINOR, "{stiffness}: {drift}");
        assert!(sink.iter().all(|sink| (-0.05..0.25).contains(sink)), "{stiffness}: {sink:?}");
    }
}

#[test]
fn rings_of_any_density_sink_at_most_a_hundredth_by_default() {
    for (spheres, density) in [(1000, 1.0), (3000, 1000.0), (6724, 7800.0)] {
        let mut stack = Stack::new(6, &ring_shape(spheres).unwrap(), density, 0.01);
        let Outcome { asleep, sink, drift } = run(&mut stack, 5);
        println!("{spheres} spheres, {density} kg/m³: asleep {asleep:?} s, drift {drift} m, sink {sink:.4?}");
        assert!(asleep.is_some() && drift < RING_MINOR);
        assert!(sink.iter().all(|sink| *sink <= 0.01), "{spheres}: {sink:?}");
    }
}

/// Where the fifth of five cubes of 0.2 m is after 10 s, from where it belongs (m), and how fast it is (m/s). Each is so many times as heavy
/// as the one below it, and they begin a `gap` (m) above each other.
fn tower(cube: &ColliderBuilder, ratio: f32, gap: f32) -> (Vec3, f32) {
    let mut world = PhysicsWorld::new();
    let mut plugin = IstPlugin::install(&mut world);
    world.insert(RigidBodyBuilder::fixed(), ColliderBuilder::new(SharedShape::halfspace(Vec3::Y)));
    let mut put = |i: i32| {
        let at = Vec3::Y * (0.1 + (0.2 + gap) * i as f32);
        let body = RigidBodyBuilder::dynamic().translation(at).can_sleep(false);
        world.insert(body, cube.clone().density(100.0 * ratio.powi(i))).0
    };
    let top = (0..5).map(&mut put).last().unwrap();
    for _ in 0..600 {
        plugin.step(&mut world);
    }
    let body = &world.bodies[top];
    (body.translation() - 0.9 * Vec3::Y, body.linvel().length())
}

#[test]
fn heavy_cubes_stand_on_light_ones() {
    let cube = packed(&shapes::cuboid(DVec3::splat(0.1)), 1000).into_collider();
    for ratio in [0.25, 1.0, 2.0, 4.0, 8.0] {
        for gap in [0.0, 0.005] {
            let (off, speed) = tower(&cube, ratio, gap);
            let (of_rapier, _) = tower(&ColliderBuilder::cuboid(0.1, 0.1, 0.1), ratio, gap);
            println!(
                "each {ratio} times as heavy, {gap} m apart: {off} m off, {speed} m/s; Rapier's cuboids {of_rapier} m"
            );
            // They stand on the unevenness of their faces, five times 4 to 5 mm.
            assert!(
                off.y.abs() < 0.03 && off.x.hypot(off.z) < 0.03 && speed < 0.01,
                "{ratio}, {gap}: {off}, {speed}"
            );
        }
    }
}
