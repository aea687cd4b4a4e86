//! Falling asleep and waking up.

use super::*;

/// Two balls at rest, one on the other, held upright.
fn tower() -> (PhysicsWorld, IstPlugin, [RigidBodyHandle; 2]) {
    let (mut world, mut plugin) = grounded();
    let upright = LockedAxes::TRANSLATION_LOCKED_X | LockedAxes::TRANSLATION_LOCKED_Z;
    let bodies = [0.1, 0.3].map(|y| {
        let body = dynamic(Vector::Y * y).locked_axes(upright | LockedAxes::ROTATION_LOCKED);
        world.insert(body, ball_collider()).0
    });
    run(&mut plugin, &mut world, 300);
    assert!(bodies.iter().all(|&body| world.bodies[body].is_sleeping()), "they fall asleep");
    (world, plugin, bodies)
}

#[test]
fn a_sleeping_tower_stays_where_it_is() {
    let (mut world, mut plugin, bodies) = tower();
    let before = bodies.map(|body| bits(&world, body));
    for _ in 0..60 {
        let report = plugin.step(&mut world);
        assert!(report.contacts.is_empty() && report.stopped.is_empty(), "asleep is not separated");
        assert_eq!((report.candidates, report.solve_seconds), (0, 0.0), "nothing is measured or solved");
    }
    assert_eq!(before, bodies.map(|body| bits(&world, body)));
}

#[test]
fn what_lies_on_a_removed_body_wakes_and_falls() {
    let (mut world, mut plugin, [lower, upper]) = tower();
    world.remove_body(lower);
    let report = plugin.step(&mut world);
    assert_eq!(report.stopped.len(), 2, "both contacts of the removed body have stopped");
    run(&mut plugin, &mut world, 60);
    assert!((height(&world, upper) - 0.1).abs() < 0.01, "{}", height(&world, upper));
}

#[test]
fn what_lies_on_a_moved_body_wakes_and_falls() {
    let (mut world, mut plugin, [lower, upper]) = tower();
    world.bodies[lower].set_translation(Vector::new(2.0, 0.1, 0.0), true);
    run(&mut plugin, &mut world, 60);
    assert!((height(&world, upper) - 0.1).abs() < 0.01, "{}", height(&world, upper));
}

#[test]
fn what_lies_on_a_disabled_body_wakes_and_falls() {
    let (mut world, mut plugin, [lower, upper]) = tower();
    world.bodies[lower].set_enabled(false);
    run(&mut plugin, &mut world, 60);
    assert!((height(&world, upper) - 0.1).abs() < 0.01, "{}", height(&world, upper));
}

#[test]
fn what_lies_on_a_rescaled_collider_wakes_and_falls() {
    let (mut world, mut plugin, [lower, upper]) = tower();
    let collider = world.bodies[lower].colliders()[0];
    world.colliders[collider].set_shape(ball().scaled(0.5).unwrap().into_shared());
    run(&mut plugin, &mut world, 90);
    assert!((height(&world, upper) - 0.2).abs() < 0.02, "{}", height(&world, upper));
}

#[test]
fn what_lies_on_a_kinematic_body_wakes_when_that_moves() {
    let (mut world, mut plugin) = grounded();
    let floor = RigidBodyBuilder::kinematic_position_based().translation(Vector::Y * 0.5);
    let floor = world.insert(floor, ColliderBuilder::cuboid(1.0, 0.1, 1.0)).0;
    let body = world.insert(dynamic(Vector::Y * 0.7), ball_collider()).0;
    run(&mut plugin, &mut world, 300);
    assert!(world.bodies[body].is_sleeping());
    for step in 1..=60 {
        world.bodies[floor].set_next_kinematic_translation(Vector::Y * (0.5 - 0.005 * step as f32));
        plugin.step(&mut world);
    }
    assert!((height(&world, body) - 0.4).abs() < 0.02, "{}", height(&world, body));
}

#[test]
fn a_body_put_down_gently_wakes_what_it_lies_on() {
    let (mut world, mut plugin) = grounded();
    let (lower, collider) = world.insert(dynamic(Vector::Y * 0.1), ball_collider().friction(0.0));
    run(&mut plugin, &mut world, 300);
    assert!(world.bodies[lower].is_sleeping());
    let _ = collider;
    // Beside the middle: the lower one has to be pushed aside.
    world.insert(dynamic(Vector::new(0.06, 0.29, 0.0)), ball_collider().friction(0.0));
    run(&mut plugin, &mut world, 60);
    assert!(world.bodies[lower].translation().x < -0.01, "{}", world.bodies[lower].translation());
}

#[test]
fn a_woken_body_goes_to_sleep_again() {
    let (mut world, mut plugin, [lower, upper]) = tower();
    world.bodies[upper].apply_impulse(Vector::Y * 4.0, true);
    run(&mut plugin, &mut world, 6);
    assert!(!world.bodies[upper].is_sleeping() && height(&world, upper) > 0.31);
    run(&mut plugin, &mut world, 400);
    assert!([lower, upper].iter().all(|&body| world.bodies[body].is_sleeping()));
}

#[test]
fn a_sleeping_pile_costs_nothing_and_wakes_where_it_is_touched() {
    let (mut world, mut plugin) = grounded();
    for i in 0..12 {
        let (x, z) = ((i % 3) as f32, (i / 3 % 2) as f32);
        let at = Vector::new(0.15 * x, 0.1 + 0.21 * (i / 6) as f32, 0.15 * z);
        // Balls that roll never stop.
        world.insert(dynamic(at).angular_damping(10.0), ball_collider().friction(1.0));
    }
    run(&mut plugin, &mut world, 1200);
    let asleep = |world: &PhysicsWorld| world.bodies.iter().filter(|(_, body)| body.is_sleeping()).count();
    assert_eq!(asleep(&world), 12);
    for _ in 0..30 {
        let report = plugin.step(&mut world);
        assert_eq!((report.candidates, report.solve_seconds), (0, 0.0));
        assert!(report.contacts.is_empty() && report.patches.is_empty());
    }
    // Far from the pile nothing wakes.
    world.insert(dynamic(Vector::new(5.0, 0.1, 0.0)), ball_collider());
    run(&mut plugin, &mut world, 10);
    assert_eq!(asleep(&world), 12);
    let thrown = dynamic(Vector::new(-1.0, 0.2, 0.0)).linvel(Vector::X * 5.0);
    world.insert(thrown, ball_collider());
    run(&mut plugin, &mut world, 30);
    assert!(asleep(&world) < 12, "{}", asleep(&world));
    let report = plugin.step(&mut world);
    assert!(report.candidates > 0 && !report.contacts.is_empty());
}

#[test]
fn a_force_that_wakes_moves_and_one_that_does_not_stays_without_effect() {
    let (mut world, mut plugin, [lower, upper]) = tower();
    let weight = world.bodies[upper].mass() * 9.81;
    world.bodies[upper].add_force(Vector::Y * 3.0 * weight, false);
    run(&mut plugin, &mut world, 30);
    assert!(world.bodies[upper].is_sleeping(), "as in Rapier");
    world.bodies[upper].reset_forces(false);
    world.bodies[upper].add_force(Vector::Y * 3.0 * weight, true);
    run(&mut plugin, &mut world, 30);
    // 2 g upwards for half a second.
    assert!(!world.bodies[upper].is_sleeping() && height(&world, upper) > 1.0, "{}", height(&world, upper));
    // A body that is pressed down is heavier for what it lies on.
    world.bodies[upper].reset_forces(true);
    run(&mut plugin, &mut world, 400);
    assert!(world.bodies[lower].is_sleeping() && world.bodies[upper].is_sleeping());
    let before = height(&world, lower);
    world.bodies[upper].add_force(Vector::Y * -10.0 * weight, true);
    run(&mut plugin, &mut world, 60);
    assert!(height(&world, lower) < before, "{} {before}", height(&world, lower));
}
