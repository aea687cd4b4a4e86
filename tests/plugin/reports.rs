//! Contacts, patches and their states.

use super::*;
use rapier_ist::ContactState;

/// A fixed V-shaped groove of two half-spaces and a ball in it.
fn groove() -> (PhysicsWorld, IstPlugin, RigidBodyHandle) {
    let mut world = PhysicsWorld::new();
    let plugin = IstPlugin::install(&mut world);
    let wall = |x: f32| ColliderBuilder::new(SharedShape::halfspace(Vector::new(x, 1.0, 0.0).normalize()));
    world.insert(
        RigidBodyBuilder::fixed(),
        ball_of(0.5).into_collider().translation(Vector::new(-0.5, -0.3, 0.0)),
    );
    world.insert(RigidBodyBuilder::fixed(), wall(-1.0));
    let body = world.insert(dynamic(Vector::Y * 0.2).can_sleep(false), ball_collider()).0;
    (world, plugin, body)
}

#[test]
fn patches_add_up_to_pairs_and_pairs_to_the_motion() {
    let (mut world, mut plugin, body) = groove();
    world.bodies[body].set_angvel(Vector::new(3.0, 1.0, -2.0), true);
    let dt = world.integration_parameters.dt;
    let mut seen = 0;
    for _ in 0..120 {
        let before = world.bodies[body].linvel();
        let weight = world.gravity * world.bodies[body].mass();
        let report = plugin.step(&mut world);
        let mut force = Vector::ZERO;
        for (index, contact) in report.contacts.iter().enumerate() {
            let patches = report.patches_of(index);
            assert!(!patches.is_empty() && patches.iter().all(|patch| patch.pair == index));
            let volume: f32 = patches.iter().map(|patch| patch.volume).sum();
            let patch_force: Vector = patches.iter().map(|patch| patch.force).sum();
            let moment = |patch: &rapier_ist::PatchContact| {
                patch.torque + (patch.centroid - contact.centroid).cross(patch.force)
            };
            let torque: Vector = patches.iter().map(moment).sum();
            let scale = contact.force.length().max(1.0);
            assert!((volume / contact.volume - 1.0).abs() < 1e-4);
            assert!((patch_force - contact.force).length() < 1e-4 * scale);
            assert!((torque - contact.torque).length() < 1e-5 * scale, "{torque} {}", contact.torque);
            let deepest = patches.iter().map(|patch| patch.depth).fold(0.0, f32::max);
            assert_eq!(deepest, contact.depth);
            // The ball has the greater handle: it is B.
            force += contact.force;
            seen += patches.len();
        }
        assert_eq!(
            report.patches.len(),
            report.contacts.iter().enumerate().map(|(i, _)| report.patches_of(i).len()).sum::<usize>()
        );
        let change = (world.bodies[body].linvel() - before) * world.bodies[body].mass() / dt;
        assert!(
            (change - force - weight).length() < 0.01 * force.length().max(1.0),
            "{change} {force} {weight}"
        );
    }
    assert!(seen > 100);
    assert!(plugin.report().patches_of(99).is_empty());
}

#[test]
fn two_walls_of_one_solid_are_two_patches() {
    use packer::{PackOptions, Solid, pack};
    use rapier_ist_examples::shapes;
    // A ball in the hole of a ring leans on all sides of it.
    let ring = Solid::new(&shapes::ring(0.13, 0.05, [48, 24])).unwrap();
    let ring = IstShape::from_packing(&pack(&ring, &PackOptions::balanced().spheres(400)).unwrap().packing);
    let (mut world, mut plugin) = weightless();
    world.insert(RigidBodyBuilder::fixed(), ring.into_collider());
    world.insert(dynamic(Vector::ZERO), ball_collider());
    let report = plugin.step(&mut world);
    assert!(report.contacts.len() == 1 && report.patches.len() >= 3, "{}", report.patches.len());
    let outward = |patch: &rapier_ist::PatchContact| patch.force.dot(patch.centroid) < 0.0;
    assert!(report.patches.iter().all(outward), "every patch pushes the ball away from itself");
}

#[test]
fn issue_no_contact_is_deeper_than_the_smaller_body() {
    // Wholly inside and nearly so: there a ball has next to no cross-section.
    for distance in [0.0, 0.1, 0.25, 0.395, 0.4, 0.42, 0.5, 0.55] {
        let (mut world, mut plugin) = weightless();
        world.insert(RigidBodyBuilder::fixed(), ball_of(0.5).into_collider());
        world.insert(dynamic(Vector::new(0.3, 0.5, 0.8).normalize() * distance), ball_collider());
        for contact in &plugin.step(&mut world).contacts {
            assert!(contact.depth > 0.0 && contact.depth < 0.2 * 1.01, "{} m at {distance} m", contact.depth);
        }
    }
}

#[test]
fn issue_a_tree_keeps_its_own_skin() {
    let skinned = || IstShape::new(ball().tree().with_skin(0.02).unwrap());
    // Either ball may have the skin, as a tree or as the collider's contact skin.
    let pairs = [
        [ball().into_collider(), skinned().into_collider()],
        [skinned().into_collider(), ball().into_collider()],
        [ball().into_collider().contact_skin(0.02), ball().into_collider()],
    ];
    let volumes = pairs.map(|[a, b]| {
        let (mut world, mut plugin) = weightless();
        world.insert(dynamic(Vector::ZERO), a);
        world.insert(dynamic(Vector::X * 0.215), b);
        plugin.step(&mut world).contacts[0].volume
    });
    assert!(volumes.iter().all(|volume| (volume / volumes[2] - 1.0).abs() < 1e-3), "{volumes:?}");
    let (mut world, mut plugin) = grounded();
    world.insert(dynamic(Vector::Y * 0.115), skinned().into_collider());
    assert_eq!(plugin.step(&mut world).contacts.len(), 1);
}

#[test]
fn contacts_start_persist_and_stop() {
    let (mut world, mut plugin) = grounded();
    let (body, collider) = world.insert(dynamic(Vector::Y * 0.3).can_sleep(false), ball_collider());
    let (mut touched, mut counts) = (false, [0, 0, 0]);
    for step in 0..130 {
        if step == 100 {
            world.bodies[body].set_linvel(Vector::Y * 3.0, true);
        }
        let report = plugin.step(&mut world);
        let state = report.contacts.first().map(|contact| contact.state);
        let expected = if touched { ContactState::Persisted } else { ContactState::Started };
        assert!(state.is_none_or(|state| state == expected), "{step}");
        let stopped = touched && state.is_none();
        assert_eq!(report.stopped.len(), usize::from(stopped), "{step}");
        assert!(report.stopped.iter().all(|pair| pair.contains(&collider)));
        counts[0] += usize::from(state == Some(ContactState::Started));
        counts[1] += usize::from(state == Some(ContactState::Persisted));
        counts[2] += usize::from(stopped);
        touched = state.is_some();
    }
    assert!(counts[0] == counts[2] && counts[0] >= 1 && counts[1] > 50 && !touched, "{counts:?}");
}

#[test]
fn a_contact_that_slept_persists() {
    let (mut world, mut plugin) = grounded();
    let body = world.insert(dynamic(Vector::Y * 0.1), ball_collider()).0;
    run(&mut plugin, &mut world, 300);
    assert!(world.bodies[body].is_sleeping());
    world.bodies[body].apply_impulse(Vector::X * 0.1, true);
    let report = plugin.step(&mut world);
    assert_eq!(report.contacts[0].state, ContactState::Persisted);
}

#[test]
fn contacts_are_found_by_their_colliders() {
    let (mut world, mut plugin) = weightless();
    let (_, a) = world.insert(dynamic(Vector::ZERO), ball_collider());
    let (_, b) = world.insert(dynamic(Vector::X * 0.15), ball_collider());
    let (_, c) = world.insert(dynamic(Vector::X * 0.5), ball_collider());
    let report = plugin.step(&mut world);
    assert_eq!(report.contact(b, a).unwrap().colliders(), [a, b]);
    assert!(report.contact(a, b).is_some() && report.contact(a, c).is_none());
}
