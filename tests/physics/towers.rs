//! Bodies with flat faces stand on them: contact begins at the surface, and not where spheres reach out of it.

use super::{grounded, packed};
use glam::{Quat, Vec3};
use rapier_ist::{IstPlugin, IstShape};
use rapier_ist_examples::shapes;
use rapier3d::prelude::*;

/// A cuboid of the given sides (m).
fn block(sides: Vec3, spheres: usize) -> IstShape {
    packed(&shapes::cuboid(sides.as_dvec3() / 2.0), spheres)
}

/// Where bodies that may not sleep are after so many seconds, from where they were put, and their greatest speed (m/s) then.
fn after(
    seconds: usize,
    (mut world, mut plugin): (PhysicsWorld, IstPlugin),
    shape: &IstShape,
    places: &[(Vec3, f32)],
) -> (Vec<Vec3>, f32) {
    let mut insert = |&(at, yaw): &(Vec3, f32)| {
        let body = RigidBodyBuilder::dynamic().translation(at).rotation(Vec3::Y * yaw).can_sleep(false);
        world.insert(body, shape.clone().into_collider().density(300.0)).0
    };
    let bodies: Vec<_> = places.iter().map(&mut insert).collect();
    for _ in 0..60 * seconds {
        plugin.step(&mut world);
    }
    let bodies = || bodies.iter().map(|body| &world.bodies[*body]);
    let ways = bodies().zip(places).map(|(body, (at, _))| body.translation() - *at).collect();
    (ways, bodies().map(|body| body.linvel().length()).fold(0.0, f32::max))
}

/// Rests 2.8 mm too high where contact begins at the volume balls, of 1,000 spheres; and by as much as the spheres are larger with fewer.
#[test]
fn a_cube_lies_flush_on_any_ground() {
    const SIDE: f32 = 0.2;
    for (spheres, most) in [(300, 0.0025), (1000, 0.0015), (3000, 0.001)] {
        let cube = block(Vec3::splat(SIDE), spheres);
        let slab = SharedShape::cuboid(0.5, 0.1, 0.5);
        let tree = cube.clone().into_collider();
        let grounds = [
            ("half-space", ColliderBuilder::new(SharedShape::halfspace(Vec3::Y)), 0.0),
            ("cuboid", ColliderBuilder::new(slab), -0.1),
            ("tree", tree, -0.1),
        ];
        for (name, ground, height) in grounds {
            let mut world = PhysicsWorld::new();
            let plugin = IstPlugin::install(&mut world);
            world.insert(RigidBodyBuilder::fixed().translation(Vec3::Y * height), ground);
            let (ways, speed) = after(3, (world, plugin), &cube, &[(Vec3::Y * 0.102, 0.0)]);
            let gap = ways[0].y + 0.002;
            println!("{spheres} spheres on a {name}: gap of {:.2} mm, {speed} m/s", gap * 1e3);
            assert!(gap > -0.001 && gap < most && speed < 1e-3, "{spheres} on a {name}: {gap} m");
        }
    }
}

#[test]
fn towers_of_cubes_and_bricks_stand() {
    let towers = [
        ("cubes", Vec3::splat(0.2), 10, 0.0),
        ("cubes, each turned", Vec3::splat(0.2), 10, 0.2),
        ("bricks", Vec3::new(0.25, 0.075, 0.15), 10, 0.0),
        ("long bricks, each turned", Vec3::new(0.75, 0.15, 0.25), 10, 0.3),
    ];
    for (name, sides, count, turn) in towers {
        let shape = block(sides, 1000);
        let places: Vec<_> =
            (0..count).map(|i| (Vec3::Y * sides.y * (0.5 + i as f32), turn * i as f32)).collect();
        let (ways, speed) = after(10, grounded(), &shape, &places);
        let aside = ways.iter().map(|way| way.x.hypot(way.z)).fold(0.0, f32::max);
        let top = ways[count - 1].y;
        println!("{count} {name}: {:.2} mm aside, {:+.2} mm high, {speed} m/s", aside * 1e3, top * 1e3);
        assert!(aside < 0.1 * sides.z && top.abs() < 0.02 * sides.y * count as f32, "{name}: {aside} {top}");
        assert!(speed < 0.02, "{name}: {speed} m/s");
    }
}

/// Planks lie on the unevenness of all below them: 17 mm too high where contact begins at the volume balls.
#[test]
fn planks_lie_crosswise_on_each_other() {
    let sides = Vec3::new(0.6, 0.1, 0.2);
    let shape = block(sides, 1000);
    let places: Vec<_> = (0..16)
        .map(|i| {
            let (layer, side) = (i / 2, if i % 2 == 0 { -0.2 } else { 0.2 });
            let yaw = if layer % 2 == 0 { 0.0 } else { std::f32::consts::FRAC_PI_2 };
            let aside = Quat::from_rotation_y(yaw) * (Vec3::Z * side);
            (aside + Vec3::Y * sides.y * (layer as f32 + 0.5), yaw)
        })
        .collect();
    let (ways, speed) = after(10, grounded(), &shape, &places);
    let highest = ways.iter().map(|way| way.y.abs()).fold(0.0, f32::max);
    println!("{:.2} mm off their height, {speed} m/s", highest * 1e3);
    assert!(highest < 0.003 && speed < 2e-3, "{highest} m, {speed} m/s");
}
