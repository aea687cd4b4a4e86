//! Bodies and colliders that come, go and change between steps.

use super::*;

#[test]
fn bodies_come_and_go() {
    let (mut world, mut plugin) = grounded();
    let mut alive: Vec<RigidBodyHandle> = Vec::new();
    for step in 0..300 {
        if step % 10 == 0 {
            let x = (step / 10 % 5) as f32 * 0.19;
            alive.push(world.insert(dynamic(Vector::new(x, 0.6, 0.0)), ball_collider()).0);
        }
        if step % 25 == 24 {
            world.remove_body(alive.remove(alive.len() / 2));
        }
        plugin.step(&mut world);
        assert_finite(&world, step);
    }
    assert!(alive.iter().all(|&body| height(&world, body) > 0.05));
}

#[test]
fn a_moved_body_touches_where_it_is_now() {
    let (mut world, mut plugin) = weightless();
    let fixed = world.insert(RigidBodyBuilder::fixed().translation(Vector::X * 5.0), ball_collider());
    let (moved, collider) = world.insert(dynamic(Vector::ZERO), ball_collider());
    run(&mut plugin, &mut world, 3);
    world.bodies[moved].set_translation(Vector::X * 4.85, true);
    let contact = *plugin.step(&mut world).contact(fixed.1, collider).unwrap();
    assert!((contact.centroid.x - 4.925).abs() < 0.01 && world.bodies[moved].linvel().x < 0.0);
    world.bodies[moved].set_translation(Vector::ZERO, true);
    world.bodies[moved].set_linvel(Vector::ZERO, true);
    let report = plugin.step(&mut world);
    assert!(report.contacts.is_empty() && report.stopped == [[fixed.1, collider]]);
}

#[test]
fn a_collider_without_a_body_can_be_moved() {
    let (mut world, mut plugin) = weightless();
    let free = world.insert_collider(ball_collider(), None);
    let body = world.insert(dynamic(Vector::X * 0.5), ball_collider()).0;
    assert!(plugin.step(&mut world).contacts.is_empty());
    world.colliders[free].set_translation(Vector::X * 0.35);
    assert_eq!(plugin.step(&mut world).contacts.len(), 1);
    assert!(world.bodies[body].linvel().x > 0.0);
}

#[test]
fn a_collider_can_be_rescaled() {
    let (mut world, mut plugin) = grounded();
    let (body, collider) = world.insert(dynamic(Vector::Y * 0.1).can_sleep(false), ball_collider());
    run(&mut plugin, &mut world, 30);
    let mass = world.bodies[body].mass();
    world.colliders[collider].set_shape(ball().scaled(2.0).unwrap().into_shared());
    run(&mut plugin, &mut world, 240);
    assert!((world.bodies[body].mass() / mass - 8.0).abs() < 1e-3);
    assert!((height(&world, body) - 0.2).abs() < 0.01, "{}", height(&world, body));
    world.colliders[collider].set_shape(SharedShape::cuboid(0.3, 0.3, 0.3));
    run(&mut plugin, &mut world, 240);
    assert!((height(&world, body) - 0.3).abs() < 0.01, "as a cuboid: {}", height(&world, body));
    world.colliders[collider].set_shape(ball().into_shared());
    run(&mut plugin, &mut world, 240);
    assert!((height(&world, body) - 0.1).abs() < 0.01, "as a ball again: {}", height(&world, body));
}

#[test]
fn what_is_disabled_touches_nothing() {
    let (mut world, mut plugin) = weightless();
    let disabled = world.insert(dynamic(Vector::ZERO), ball_collider()).0;
    let (body, collider) = world.insert(dynamic(Vector::X * 0.15), ball_collider());
    world.bodies[disabled].set_enabled(false);
    for _ in 0..3 {
        assert!(plugin.step(&mut world).contacts.is_empty());
    }
    assert_eq!(world.bodies[body].linvel(), Vector::ZERO);
    world.bodies[disabled].set_enabled(true);
    world.colliders[collider].set_enabled(false);
    for _ in 0..3 {
        assert!(plugin.step(&mut world).contacts.is_empty());
    }
    world.colliders[collider].set_enabled(true);
    run(&mut plugin, &mut world, 2);
    assert!(world.bodies[body].linvel().x > 0.0 && world.bodies[disabled].linvel().x < 0.0);
}

#[test]
fn a_body_can_change_its_type() {
    let (mut world, mut plugin) = grounded();
    let body = world.insert(RigidBodyBuilder::fixed().translation(Vector::Y * 0.5), ball_collider()).0;
    run(&mut plugin, &mut world, 10);
    world.bodies[body].set_body_type(RigidBodyType::Dynamic, true);
    run(&mut plugin, &mut world, 90);
    assert!((height(&world, body) - 0.1).abs() < 0.01);
    world.bodies[body].set_body_type(RigidBodyType::Fixed, true);
    let pose = *world.bodies[body].position();
    world.insert(dynamic(Vector::new(0.03, 0.5, 0.0)), ball_collider());
    run(&mut plugin, &mut world, 60);
    assert_eq!(*world.bodies[body].position(), pose);
}
