//! Rapier's continuous collision detection.

use crate::solid;
use rapier_ist::{ContactModel, IstPlugin, IstShape};
use rapier3d::parry::shape::SharedShape;
use rapier3d::prelude::*;

/// How far from its start a body of 300 m/s gets in a second, towards a target 4.3 m away.
fn way(target: SharedShape, model: ContactModel, bullet: bool) -> f32 {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let mut plugin = IstPlugin::install(&mut world);
    plugin.model = model;
    world.insert(
        RigidBodyBuilder::fixed().translation(Vector::new(4.3, 0.0, 0.0)),
        ColliderBuilder::new(target),
    );
    let (body, _) = solid(&[(Vector::ZERO, 0.1), (Vector::new(-0.2, 0.0, 0.0), 0.09)]);
    let fast = RigidBodyBuilder::dynamic().linvel(Vector::new(300.0, 0.0, 0.0)).ccd_enabled(bullet);
    let (body, _) = world.insert(fast, body.into_collider());
    let mut farthest = 0.0_f32;
    for _ in 0..60 {
        plugin.step(&mut world);
        farthest = farthest.max(world.bodies[body].translation().x);
    }
    farthest
}

/// A plate of 1 m across and 5 mm thick, of disjoint balls.
fn plate() -> IstShape {
    let place = |i: i32| (i - 100) as f32 * 0.005;
    let row = |i: i32| (80..=120).map(move |j| (Vector::new(0.0, place(i), place(j)), 0.0025));
    let balls: Vec<_> = (80..=120).flat_map(row).collect();
    solid(&balls).0
}

/// Every target, as a bullet and as a body that is merely fast.
fn stops(model: ContactModel) {
    let cuboid = SharedShape::cuboid(0.0025, 0.5, 0.5);
    let (vertices, triangles) = cuboid.as_cuboid().unwrap().to_trimesh();
    let targets = [
        ("cuboid", cuboid),
        ("trimesh", SharedShape::trimesh(vertices, triangles).unwrap()),
        ("plate of spheres", plate().into_shared()),
    ];
    for (name, target) in targets {
        for bullet in [true, false] {
            let way = way(target.clone(), model, bullet);
            assert!(way < 4.3 && way > 4.0, "{name}, {model:?}, bullet {bullet}: {way} m");
        }
    }
}

#[test]
fn a_fast_body_goes_through_no_thin_plate() {
    stops(ContactModel::VolumeManifold);
}

/// Rapier stops the body in front of the plate and leaves its velocity to the contact, which a step longer than the plate is
/// thick would pass over: the penalty measures it on the way.
#[test]
fn a_fast_body_goes_through_no_thin_plate_under_the_penalty() {
    stops(ContactModel::default());
}

/// Corners of a ground at y = 0, and its triangles.
fn ground() -> ([Vector; 4], [[u32; 3]; 2]) {
    let corners = [(-1.0, -2.0), (9.0, -2.0), (9.0, 2.0), (-1.0, 2.0)];
    (corners.map(|(x, z)| Vector::new(x, 0.0, z)), [[0, 2, 1], [0, 3, 2]])
}

/// What is passed over close along the ground may not let the body through what stands on it.
#[test]
fn a_fast_body_close_to_the_ground_goes_through_no_plate_on_it() {
    let (corners, halves) = ground();
    let (plate, sides) = SharedShape::cuboid(0.0025, 0.5, 0.5).as_cuboid().unwrap().to_trimesh();
    let vertices =
        corners.into_iter().chain(plate.into_iter().map(|v| v + Vector::new(4.3, 0.5, 0.0))).collect();
    let triangles = halves.into_iter().chain(sides.into_iter().map(|t| t.map(|i| i + 4))).collect();
    let scene = SharedShape::trimesh(vertices, triangles).unwrap();
    let (block, _) = solid(&[-0.1, 0.1].map(|y| (Vector::new(0.0, y, 0.0), 0.1)));
    let (ball, _) = solid(&[(Vector::ZERO, 0.1)]);
    for (name, body, height) in [("block", block, 0.2), ("ball", ball, 0.1)] {
        for model in [ContactModel::VolumeManifold, ContactModel::default()] {
            for (gap, speed) in [0.0005, 0.003, 0.03].into_iter().flat_map(|gap| [(gap, 30.0), (gap, 60.0)]) {
                let mut world = PhysicsWorld { gravity: Vector::ZERO, ..PhysicsWorld::new() };
                let mut plugin = IstPlugin::install(&mut world);
                plugin.model = model;
                world.insert(RigidBodyBuilder::fixed(), ColliderBuilder::new(scene.clone()).friction(0.0));
                let start = RigidBodyBuilder::dynamic()
                    .translation(Vector::new(0.0, height + gap, 0.0))
                    .linvel(Vector::new(speed, 0.0, 0.0));
                let (handle, _) = world.insert(start, body.clone().into_collider().friction(0.0));
                let mut farthest = 0.0_f32;
                for _ in 0..20 {
                    plugin.step(&mut world);
                    farthest = farthest.max(world.bodies[handle].translation().x);
                }
                assert!(
                    farthest < 4.3 && farthest > 4.0,
                    "{name}, {model:?}, {gap} m above, {speed} m/s: {farthest} m"
                );
            }
        }
    }
}

/// Rapier held it back to a twelfth of its velocity, 0.1 mm above: next to a triangle mesh the time of impact of so many balls was not found
/// out, and what is not known not to meet has to stop.
#[test]
fn issue_a_fast_body_slides_close_along_a_mesh() {
    let (corners, halves) = ground();
    let mesh = SharedShape::trimesh(corners.to_vec(), halves.to_vec()).unwrap();
    let place = |i: i32| i as f32 * 0.02;
    let row = |i: i32| (-10..=10).map(move |j| (Vector::new(place(i), 0.0, place(j)), 0.01));
    let (sheet, _) = solid(&(-10..=10).flat_map(row).collect::<Vec<_>>());
    for gap in [1e-5, 1e-4, 1e-3, 3e-3] {
        let mut world = PhysicsWorld { gravity: Vector::ZERO, ..PhysicsWorld::new() };
        let mut plugin = IstPlugin::install(&mut world);
        world.insert(RigidBodyBuilder::fixed(), ColliderBuilder::new(mesh.clone()));
        let body = RigidBodyBuilder::dynamic()
            .translation(Vector::new(0.0, 0.01 + gap, 0.0))
            .linvel(Vector::new(10.0, 0.0, 0.0));
        let (body, _) = world.insert(body, sheet.clone().into_collider());
        for _ in 0..30 {
            plugin.step(&mut world);
        }
        let way = world.bodies[body].translation().x;
        assert!((way - 5.0).abs() < 1e-3, "{gap} m above it: {way} m");
    }
}
