//! Impulse joints and multibody joints.

use super::*;

#[test]
fn joints_decide_about_contacts_between_their_bodies() {
    for multibody in [false, true] {
        for contacts in [false, true] {
            let (mut world, mut plugin) = weightless();
            let (a, collider_a) = world.insert(dynamic(Vector::ZERO), ball_collider());
            let (b, collider_b) = world.insert(dynamic(Vector::X * 0.15), ball_collider());
            let joint = RevoluteJointBuilder::new(Vector::Z)
                .local_anchor1(Vector::X * 0.075)
                .local_anchor2(Vector::X * -0.075)
                .contacts_enabled(contacts);
            if multibody {
                world.insert_multibody_joint(a, b, joint).unwrap();
            } else {
                world.insert_impulse_joint(a, b, joint);
            }
            let report = plugin.step(&mut world);
            assert_eq!(report.contact(collider_a, collider_b).is_some(), contacts, "multibody: {multibody}");
        }
    }
}

#[test]
fn a_pendulum_of_impulse_joints_swings_against_a_wall() {
    let (mut world, mut plugin) = grounded();
    let anchor = world.insert_body(RigidBodyBuilder::fixed().translation(Vector::Y * 2.0));
    let bob = world.insert(dynamic(Vector::new(1.0, 2.0, 0.0)).can_sleep(false), ball_collider()).0;
    let joint = SphericalJointBuilder::new().local_anchor2(Vector::X * -1.0);
    world.insert_impulse_joint(anchor, bob, joint);
    world.insert(
        RigidBodyBuilder::fixed(),
        ball_of(0.5).into_collider().translation(Vector::new(-0.5, 1.0, 0.0)),
    );
    for _ in 0..600 {
        plugin.step(&mut world);
        let bob = world.bodies[bob].translation();
        assert!((bob.distance(Vector::Y * 2.0) - 1.0).abs() < 0.02, "the joint holds: {bob}");
        assert!(bob.distance(Vector::new(-0.5, 1.0, 0.0)) > 0.55, "so does the wall: {bob}");
    }
    assert!(world.bodies[bob].linvel().length() < 0.2);
}

/// An arm of `links` links, hinged at 0.5 m over the ground, that falls on a fixed ball under its last link.
fn arm(links: usize) -> (PhysicsWorld, IstPlugin, Vec<RigidBodyHandle>) {
    let (mut world, plugin) = grounded();
    let base = world.insert_body(RigidBodyBuilder::fixed().translation(Vector::Y * 0.5));
    let rest = Vector::new(0.4 * links as f32 - 0.2, 0.2, 0.0);
    world.insert(RigidBodyBuilder::fixed().translation(rest), ball_of(0.2).into_collider().friction(0.0));
    let mut bodies = vec![base];
    for index in 0..links {
        let body = dynamic(Vector::new(0.4 * index as f32 + 0.2, 0.5, 0.0)).can_sleep(false);
        let last = index + 1 == links;
        let collider =
            if last { ball_collider() } else { ColliderBuilder::cuboid(0.1, 0.02, 0.02).density(DENSITY) };
        let body = world.insert(body, collider.friction(0.0)).0;
        let offset = if index == 0 { 0.0 } else { 0.2 };
        let joint = RevoluteJointBuilder::new(Vector::Z)
            .local_anchor1(Vector::X * offset)
            .local_anchor2(Vector::X * -0.2);
        world.insert_multibody_joint(*bodies.last().unwrap(), body, joint).unwrap();
        bodies.push(body);
    }
    (world, plugin, bodies)
}

#[test]
fn a_multibody_arm_rests_on_an_inner_sphere_tree() {
    for links in [1, 3] {
        let (mut world, mut plugin, bodies) = arm(links);
        let (base, last) = (bodies[0], bodies[links]);
        let mut lowest = f32::INFINITY;
        for _ in 0..300 {
            plugin.step(&mut world);
            assert_finite(&world, links);
            lowest = lowest.min(height(&world, last));
        }
        let center = Vector::new(0.4 * links as f32 - 0.2, 0.2, 0.0);
        if links == 1 {
            let tip = world.bodies[last].translation();
            assert!(
                (tip.distance(world.bodies[base].translation()) - 0.2).abs() < 1e-3,
                "the joint holds: {tip}"
            );
            assert!((tip.distance(center) - 0.3).abs() < 0.01, "it rests on the ball: {tip}");
            let speed = world.bodies[last].linvel().length();
            assert!(speed < 1e-3, "it lies still: {speed} m/s");
        }
        assert!(lowest > 0.05, "it does not sink through: {lowest}");
    }
}

#[test]
fn a_link_at_rest_is_held_with_the_force_of_its_lever() {
    // A ball on a hinge of 0.4 m pressed on a half-space: the moments about the hinge are in balance.
    let (mut world, mut plugin) = grounded();
    let base = world.insert_body(RigidBodyBuilder::fixed().translation(Vector::Y * 0.1));
    let (link, collider) =
        world.insert(dynamic(Vector::new(0.4, 0.1, 0.0)).can_sleep(false), ball_collider());
    let joint = RevoluteJointBuilder::new(Vector::Z).local_anchor2(Vector::X * -0.4);
    world.insert_multibody_joint(base, link, joint).unwrap();
    run(&mut plugin, &mut world, 240);
    let report = plugin.report();
    let contact = report.contacts.iter().find(|contact| contact.collider_b == collider).unwrap();
    let weight = world.bodies[link].mass() * 9.81;
    assert!((contact.force.y / weight - 1.0).abs() < 0.02, "{} N, weight {weight} N", contact.force.y);
    assert!(world.bodies[link].angvel().length() < 1e-2);
}

#[test]
fn a_body_lands_on_a_free_multibody() {
    let (mut world, mut plugin) = weightless();
    let a = world.insert(dynamic(Vector::ZERO), ball_collider()).0;
    let b = world.insert(dynamic(Vector::X * 0.3), ball_collider()).0;
    let joint = SphericalJointBuilder::new().local_anchor1(Vector::X * 0.15).local_anchor2(Vector::X * -0.15);
    world.insert_multibody_joint(a, b, joint).unwrap();
    let shot = world.insert(dynamic(Vector::X * -0.5).linvel(Vector::X * 2.0), ball_collider()).0;
    run(&mut plugin, &mut world, 60);
    let momentum: f32 = [a, b, shot].iter().map(|&body| world.bodies[body].linvel().x).sum();
    assert!((momentum - 2.0).abs() < 0.02, "momentum is kept: {momentum}");
    let velocities = [a, b, shot].map(|body| world.bodies[body].linvel().x);
    assert!(
        (velocities[0] - velocities[1]).abs() < 1e-3 && velocities[0] > velocities[2] - 1e-3,
        "{velocities:?}"
    );
}
