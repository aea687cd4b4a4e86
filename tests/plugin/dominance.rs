//! Dominance groups.

use super::*;

#[test]
fn the_dominated_body_gets_all_the_motion() {
    for [left_group, right_group] in [[1, 0], [0, 1], [127, -127]] {
        let (mut world, mut plugin) = weightless();
        let mut insert = |x: f32, v: f32, group: i8| {
            let body = dynamic(Vector::X * x).linvel(Vector::X * v).dominance_group(group);
            world.insert(body, ball_collider()).0
        };
        let left = insert(-0.15, 1.0, left_group);
        let right = insert(0.15, -1.0, right_group);
        run(&mut plugin, &mut world, 60);
        let [left, right] = [left, right].map(|body| world.bodies[body].linvel().x);
        let (dominator, dominated) = if left_group > right_group { (left, right) } else { (right, left) };
        let before = if left_group > right_group { 1.0 } else { -1.0 };
        assert_eq!(dominator, before, "nothing stops the dominator");
        assert!(dominated * before > 0.99, "what it meets has to go along: {dominated}");
    }
}

#[test]
fn equal_groups_are_as_no_groups() {
    let velocities = [0, 5].map(|group| {
        let (mut world, mut plugin) = weightless();
        let mut insert = |x: f32| {
            let body = dynamic(Vector::X * x).linvel(Vector::X * -x).dominance_group(group);
            world.insert(body, ball_collider()).0
        };
        let bodies = [insert(-0.15), insert(0.15)];
        run(&mut plugin, &mut world, 120);
        bodies.map(|body| bits(&world, body))
    });
    assert_eq!(velocities[0], velocities[1]);
}

#[test]
fn a_dominator_still_stands_on_the_ground() {
    let (mut world, mut plugin) = grounded();
    let body = dynamic(Vector::Y * 0.11).dominance_group(100);
    let lower = world.insert(body, ball_collider()).0;
    let upper = world.insert(dynamic(Vector::Y * 0.32), ball().into_collider().density(1e5)).0;
    run(&mut plugin, &mut world, 60);
    assert!((height(&world, lower) - 0.1).abs() < 0.01);
    assert!(height(&world, upper) > 0.25, "a hundred times its weight does not press it down");
}
