//! Non-convex bodies of Bevy entities fall and come to rest, without a window.

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_rapier3d::prelude::{ActiveEvents, Collider, CollidingEntities, RigidBody, Velocity};
use packer::{PackOptions, Solid, TriangleMesh, pack};
use rapier_ist::IstShape;
use rapier_ist_bevy::{IstPhysicsPlugin, VolumeContacts, collider};
use std::time::Duration;

/// A bone, which is not convex, and its length.
fn bone() -> (IstShape, f32) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/femur.obj");
    let solid = Solid::new(&TriangleMesh::load(path).unwrap()).unwrap();
    let packed = pack(&solid, &PackOptions::fast()).unwrap();
    let (low, high) = packed.packing.bounds();
    (IstShape::from_packing(&packed.packing), (high - low).max_element())
}

#[test]
fn bones_fall_on_each_other_and_rest() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin));
    app.insert_resource(Time::<Fixed>::from_hz(60.0));
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(1.0 / 60.0)));
    app.add_plugins(IstPhysicsPlugin);

    let world = app.world_mut();
    world.spawn((Collider::cuboid(5.0, 0.5, 5.0), Transform::from_xyz(0.0, -0.5, 0.0)));
    let (bone, length) = bone();
    let fallen: Vec<Entity> = [0.3, 0.6]
        .into_iter()
        .map(|height| {
            // The bones are made 0.3 m long by the entities' scale, and lie across each other.
            let pose = Transform::from_xyz(0.0, height, 0.0)
                .with_rotation(Quat::from_rotation_y(10.0 * height))
                .with_scale(Vec3::splat(0.3 / length));
            let body = (RigidBody::Dynamic, Velocity::default(), pose);
            world.spawn((body, collider(&bone), ActiveEvents::COLLISION_EVENTS, CollidingEntities::default())).id()
        })
        .collect();
    app.finish();
    app.cleanup();

    let mut met = false;
    for _ in 0..600 {
        app.update();
        met |= app.world().get::<CollidingEntities>(fallen[0]).unwrap().contains(fallen[1]);
    }
    assert!(met, "the bones have touched each other, and Bevy was told");
    assert!(!app.world().resource::<VolumeContacts>().0.report().dispatcher_replaced);
    for body in fallen {
        let height = app.world().get::<Transform>(body).unwrap().translation.y;
        let velocity = app.world().get::<Velocity>(body).unwrap();
        assert!((0.0..0.3).contains(&height), "it lies on the ground: {height} m");
        assert!(velocity.linear.length() < 0.01, "it rests: {} m/s", velocity.linear);
    }
}
