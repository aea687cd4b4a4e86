//! Saving and restoring.

use super::*;
use rapier_ist::snapshot;

fn bytes(world: &PhysicsWorld) -> Vec<u8> {
    let mut bytes = Vec::new();
    ciborium::into_writer(world, &mut bytes).unwrap();
    bytes
}

/// Balls that fall on each other; their user data is one more than their index.
fn scene() -> (PhysicsWorld, IstPlugin, Vec<RigidBodyHandle>) {
    let (mut world, plugin) = grounded();
    let place = |i: u32| Vector::new(0.05 * (i % 3) as f32, 0.1 + 0.19 * i as f32, 0.03 * (i % 2) as f32);
    let bodies =
        (0..6).map(|i| world.insert(dynamic(place(i)), ball_collider().user_data(1 + u128::from(i))).0);
    let bodies = bodies.collect();
    (world, plugin, bodies)
}

#[test]
fn rapier_alone_cannot_save_such_a_world() {
    let (world, ..) = scene();
    assert!(ciborium::into_writer(&world, Vec::new()).is_err());
}

#[test]
fn a_restored_world_moves_on_bit_for_bit() {
    for steps in [0, 1, 20, 60] {
        let (mut world, mut plugin, bodies) = scene();
        run(&mut plugin, &mut world, steps);
        let saved = snapshot::save(&mut world, bytes);
        let mut restored: PhysicsWorld = ciborium::from_reader(saved.as_slice()).unwrap();
        snapshot::restore(&mut restored.colliders, |_, collider| (collider.user_data > 0).then(ball));
        let mut second = plugin.clone();
        IstPlugin::install(&mut restored);
        for step in 0..120 {
            plugin.step(&mut world);
            assert!(!second.step(&mut restored).dispatcher_replaced);
            for &body in &bodies {
                assert_eq!(bits(&world, body), bits(&restored, body), "saved after {steps}, {step} later");
                let sleeping = [&world, &restored].map(|world| world.bodies[body].is_sleeping());
                assert_eq!(sleeping[0], sleeping[1], "saved after {steps}, {step} later");
            }
        }
    }
}

#[test]
fn sleepers_wake_and_stay_where_they_are() {
    let (mut world, mut plugin) = grounded();
    let body = world.insert(dynamic(Vector::Y * 0.1), ball_collider().user_data(1)).0;
    run(&mut plugin, &mut world, 300);
    assert!(world.bodies[body].is_sleeping());
    let saved = snapshot::save(&mut world, bytes);
    let mut restored: PhysicsWorld = ciborium::from_reader(saved.as_slice()).unwrap();
    snapshot::restore(&mut restored.colliders, |_, collider| (collider.user_data > 0).then(ball));
    let mut plugin = IstPlugin::install(&mut restored);
    let before = world.bodies[body].translation();
    run(&mut plugin, &mut restored, 1);
    assert!(!restored.bodies[body].is_sleeping());
    run(&mut plugin, &mut restored, 300);
    assert!(restored.bodies[body].is_sleeping());
    assert!((restored.bodies[body].translation() - before).length() < 1e-3);
}

#[test]
fn saving_changes_nothing() {
    let runs = [false, true].map(|save| {
        let (mut world, mut plugin, bodies) = scene();
        for _ in 0..60 {
            plugin.step(&mut world);
            if save {
                snapshot::save(&mut world, bytes);
            }
        }
        bodies.iter().map(|&body| bits(&world, body)).collect::<Vec<_>>()
    });
    assert_eq!(runs[0], runs[1]);
}

#[test]
fn a_hook_of_the_users_is_not_taken_for_the_plugins() {
    let (mut world, mut plugin, _) = scene();
    let asked = world.colliders.iter().map(|(handle, _)| handle).last().unwrap();
    world.colliders[asked].set_active_hooks(ActiveHooks::FILTER_CONTACT_PAIRS);
    run(&mut plugin, &mut world, 1);
    let saved = snapshot::save(&mut world, bytes);
    let mut restored: PhysicsWorld = ciborium::from_reader(saved.as_slice()).unwrap();
    snapshot::restore(&mut restored.colliders, |_, collider| (collider.user_data > 0).then(ball));
    let mut plugin = IstPlugin::install(&mut restored);
    plugin.model = ContactModel::VolumeManifold;
    plugin.step(&mut restored);
    for (handle, collider) in restored.colliders.iter() {
        let expected = if handle == asked { ActiveHooks::FILTER_CONTACT_PAIRS } else { ActiveHooks::empty() };
        assert_eq!(collider.active_hooks(), expected);
    }
}

/// They were left as they were, and the world could not be written.
#[test]
fn issue_compounds_that_hold_solids_are_saved_with_stand_ins() {
    let (mut world, ..) = weightless();
    let compound = |parts: Vec<SharedShape>| {
        SharedShape::compound(
            parts.into_iter().map(|part| (Pose::translation(0.3, 0.0, 0.0), part)).collect(),
        )
    };
    let dumbbell = || compound(vec![ball().into_shared(), SharedShape::cuboid(0.1, 0.2, 0.3)]);
    let cuboids = ColliderBuilder::new(compound(vec![SharedShape::cuboid(0.1, 0.2, 0.3)]));
    world.insert(dynamic(Vector::ZERO), ColliderBuilder::new(dumbbell()).user_data(1));
    let (_, cuboids) = world.insert(dynamic(Vector::Y), cuboids);
    let saved = snapshot::save(&mut world, bytes);
    let mut restored: PhysicsWorld = ciborium::from_reader(saved.as_slice()).unwrap();
    assert!(restored.colliders[cuboids].shape().as_compound().is_some(), "what can be written is");
    snapshot::restore(&mut restored.colliders, |_, collider| (collider.user_data > 0).then(dumbbell));
    for (handle, collider) in world.colliders.iter() {
        let restored = restored.colliders[handle].shape();
        assert_eq!(restored.compute_local_aabb(), collider.shape().compute_local_aabb());
    }
}
