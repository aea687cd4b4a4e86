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
