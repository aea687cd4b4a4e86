//! Bodies of all kinds.

use super::*;

#[test]
fn several_colliders_move_as_one_body() {
    let (mut world, mut plugin) = grounded();
    let body = world.insert_body(dynamic(Vector::Y * 0.15));
    for x in [-0.15, 0.15] {
        world.insert_collider(ball_collider().translation(Vector::X * x), Some(body));
    }
    // Overlapping colliders of one body do not touch.
    world.insert_collider(ball_collider().translation(Vector::X * 0.1), Some(body));
    for _ in 0..120 {
        let report = plugin.step(&mut world);
        assert!(report.contacts.len() <= 3, "only with the ground");
    }
    let body = &world.bodies[body];
    assert!((body.translation().y - 0.1).abs() < 0.01 && body.rotation().to_scaled_axis().length() < 0.05);
}

#[test]
fn locked_axes_stay_locked() {
    let (mut world, mut plugin) = grounded();
    let locked = dynamic(Vector::Y * 0.1)
        .locked_axes(LockedAxes::TRANSLATION_LOCKED | LockedAxes::ROTATION_LOCKED_X)
        .gyroscopic_forces_enabled(false);
    let locked = world.insert(locked, ball_collider()).0;
    let other = world.insert(dynamic(Vector::new(0.02, 0.5, 0.01)), ball_collider()).0;
    run(&mut plugin, &mut world, 120);
    assert_eq!(world.bodies[locked].translation(), Vector::Y * 0.1);
    assert_eq!(world.bodies[locked].angvel().x, 0.0);
    assert!(height(&world, other) < 0.2, "the other rolled off");
}

#[test]
fn gravity_scale_and_damping_work() {
    let (mut world, mut plugin) = grounded();
    let light = world.insert(dynamic(Vector::Y * 0.1).gravity_scale(0.0), ball_collider()).0;
    let damped = dynamic(Vector::new(1.0, 0.1, 0.0)).linvel(Vector::X).linear_damping(5.0);
    let damped = world.insert(damped, ball_collider().friction(0.0)).0;
    run(&mut plugin, &mut world, 120);
    assert!((height(&world, light) - 0.1).abs() < 1e-3);
    assert!(world.bodies[damped].linvel().x < 0.01);
}

#[test]
fn user_forces_act_and_stay() {
    let (mut world, mut plugin) = grounded();
    let smooth = ball_collider().friction(0.0).friction_combine_rule(CoefficientCombineRule::Min);
    let body = world.insert(dynamic(Vector::Y * 0.1), smooth).0;
    let (force, torque) = (Vector::new(8.0, 0.1, 0.0), Vector::new(0.0, 0.01, 0.0));
    world.bodies[body].add_force(force, true);
    world.bodies[body].add_torque(torque, true);
    run(&mut plugin, &mut world, 60);
    let body = &world.bodies[body];
    assert_eq!((body.user_force(), body.user_torque()), (force, torque));
    let expected = force.x / body.mass();
    assert!((body.linvel().x / expected - 1.0).abs() < 0.01, "{} m/s after 1 s", body.linvel().x);
}

#[test]
fn length_unit_scales_the_whole_scene() {
    let heights = [1.0, 100.0].map(|unit| {
        let (mut world, mut plugin) = grounded();
        world.integration_parameters.length_unit = unit;
        world.gravity *= unit;
        let collider = ball_of(RADIUS * unit).into_collider().density(DENSITY).restitution(0.5);
        let body =
            world.insert(dynamic(Vector::new(0.0, 0.5, 0.0) * unit).linvel(Vector::X * unit), collider).0;
        (0..90)
            .map(|_| {
                plugin.step(&mut world);
                world.bodies[body].translation() / unit
            })
            .collect::<Vec<_>>()
    });
    for (metres, centimetres) in heights[0].iter().zip(&heights[1]) {
        assert!((metres - centimetres).length() < 2e-3, "{metres} {centimetres}");
    }
}

#[test]
fn a_fixed_inner_sphere_tree_holds_bodies_of_rapier() {
    let mut world = PhysicsWorld::new();
    let mut plugin = IstPlugin::install(&mut world);
    world.insert(RigidBodyBuilder::fixed(), ball_of(1.0).into_collider());
    let upright = LockedAxes::TRANSLATION_LOCKED_X | LockedAxes::TRANSLATION_LOCKED_Z;
    let body = dynamic(Vector::Y * 1.3).locked_axes(upright | LockedAxes::ROTATION_LOCKED);
    let cube = world.insert(body, ColliderBuilder::cuboid(0.1, 0.1, 0.1).density(DENSITY)).0;
    run(&mut plugin, &mut world, 120);
    assert!((height(&world, cube) - 1.1).abs() < 0.02, "{}", height(&world, cube));
}

/// Rapier keeps the velocity that a fixed body was built with and does not move it. Here it dragged along what lay on it.
#[test]
fn issue_a_fixed_body_drags_nothing_along() {
    let mut world = PhysicsWorld::new();
    let mut plugin = IstPlugin::install(&mut world);
    let ground = RigidBodyBuilder::fixed().linvel(Vector::X * 5.0).angvel(Vector::Y);
    let (ground, _) = world.insert(ground, ColliderBuilder::new(SharedShape::halfspace(Vector::Y)));
    let (body, _) = world.insert(dynamic(Vector::Y * RADIUS), ball_collider());
    run(&mut plugin, &mut world, 60);
    assert_eq!(world.bodies[ground].linvel(), Vector::X * 5.0);
    let moved = world.bodies[body].translation() - Vector::Y * RADIUS;
    assert!(moved.length() < 1e-3, "it moved by {moved} m");
    run(&mut plugin, &mut world, 120);
    assert!(world.bodies[body].is_sleeping(), "what does not move keeps nothing awake");
}
