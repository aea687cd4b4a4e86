//! Kinematic bodies push and are not pushed.

use super::*;

#[test]
fn a_velocity_based_body_carries_a_load() {
    let (mut world, mut plugin) = grounded();
    let lift =
        RigidBodyBuilder::kinematic_velocity_based().translation(Vector::Y * 0.5).linvel(Vector::Y * 0.5);
    let lift = world.insert(lift, ball_of(0.5).into_collider()).0;
    let upright = LockedAxes::TRANSLATION_LOCKED_X | LockedAxes::TRANSLATION_LOCKED_Z;
    let load = world.insert(dynamic(Vector::Y * 1.1).locked_axes(upright), ball_collider()).0;
    run(&mut plugin, &mut world, 120);
    assert!((height(&world, lift) - 1.5).abs() < 1e-4, "it is not slowed down");
    assert!((height(&world, load) - height(&world, lift) - 0.6).abs() < 0.02);
    assert!((world.bodies[load].linvel().y - 0.5).abs() < 0.01);
}

#[test]
fn a_position_based_body_carries_a_load_in_any_number_of_substeps() {
    for substeps in [1, 2, 5] {
        let (mut world, mut plugin) = grounded();
        plugin.substeps = substeps;
        let lift = RigidBodyBuilder::kinematic_position_based().translation(Vector::Y * 0.5);
        let lift = world.insert(lift, ball_of(0.5).into_collider()).0;
        let upright = LockedAxes::TRANSLATION_LOCKED_X | LockedAxes::TRANSLATION_LOCKED_Z;
        let load = world.insert(dynamic(Vector::Y * 1.1).locked_axes(upright), ball_collider()).0;
        for step in 1..=120 {
            let target = Vector::Y * (0.5 + 0.5 * step as f32 / 60.0);
            world.bodies[lift].set_next_kinematic_translation(target);
            plugin.step(&mut world);
            assert_eq!(world.bodies[lift].translation(), target, "{substeps} substeps");
        }
        assert!((height(&world, load) - height(&world, lift) - 0.6).abs() < 0.02, "{substeps} substeps");
        assert!((world.bodies[load].linvel().y - 0.5).abs() < 0.02, "{substeps} substeps");
    }
}

#[test]
fn a_turning_target_goes_its_way_evenly_in_substeps() {
    let turned = [1, 4].map(|substeps| {
        let (mut world, mut plugin) = weightless();
        plugin.substeps = substeps;
        let body = RigidBodyBuilder::kinematic_position_based();
        let body = world.insert(body, ball_collider().translation(Vector::X)).0;
        let target = Pose::from_parts(Vector::Y * 0.1, Rotation::from_rotation_z(0.3));
        world.bodies[body].set_next_kinematic_position(target);
        plugin.step(&mut world);
        assert_eq!(*world.bodies[body].position(), target);
        // The collider's centre is the centre of mass: it moves on a straight line at the same speed in every substep.
        world.bodies[body].velocity_at_point(world.bodies[body].center_of_mass())
    });
    assert!((turned[0] - turned[1]).length() < 0.05 * turned[0].length(), "{turned:?}");
}

#[test]
fn kinematic_bodies_ignore_each_other() {
    let (mut world, mut plugin) = weightless();
    let body = RigidBodyBuilder::kinematic_velocity_based().linvel(Vector::X);
    let moving = world.insert(body, ball_collider()).0;
    world.insert(RigidBodyBuilder::fixed().translation(Vector::X * 0.2), ball_collider());
    for _ in 0..60 {
        assert!(plugin.step(&mut world).contacts.is_empty());
    }
    assert!((world.bodies[moving].translation().x - 1.0).abs() < 1e-4);
}
