//! Stiffness for all, per collider and per pair.

use super::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Weight over overlap volume of a ball at rest on the ground (N/m³).
fn measured(configure: impl FnOnce(&mut IstPlugin, [ColliderHandle; 2])) -> f32 {
    let mut world = PhysicsWorld::new();
    let mut plugin = IstPlugin::install(&mut world);
    let ground = ColliderBuilder::new(SharedShape::halfspace(Vector::Y));
    let ground = world.insert(RigidBodyBuilder::fixed(), ground).1;
    let (body, collider) = world.insert(dynamic(Vector::Y * 0.1).can_sleep(false), ball_collider());
    configure(&mut plugin, [ground, collider]);
    run(&mut plugin, &mut world, 600);
    let body = &world.bodies[body];
    let h = RADIUS - body.translation().y;
    body.mass() * 9.81 / (std::f32::consts::PI * h * h * (3.0 * RADIUS - h) / 3.0)
}

#[test]
fn what_presses_a_body_down_does_not_press_it_in() {
    for (times, expected) in [(0.0_f32, 1.0_f32), (8.0, 9.0), (19.0, 10.0), (99.0, 10.0)] {
        let (mut world, mut plugin) = grounded();
        let (body, _) = world.insert(dynamic(Vector::Y * 0.1).can_sleep(false), ball_collider());
        let weight = 9.81 * world.bodies[body].mass();
        world.bodies[body].add_force(times * weight * Vector::NEG_Y, true);
        plugin.step(&mut world);
        // Nothing touched it when the force began.
        assert!(height(&world, body) > 0.9 * RADIUS, "{times}: {} m", height(&world, body));
        run(&mut plugin, &mut world, 300);
        // In units of 1/50,000 of the size cubed, the overlap by its own weight. It trembles: solves are right to a thousandth of the force.
        let mut overlap = || {
            plugin.step(&mut world);
            let h = RADIUS - height(&world, body);
            let volume = std::f32::consts::PI * h * h * (3.0 * RADIUS - h) / 3.0;
            5e4 * volume / (8.0 * RADIUS * RADIUS * RADIUS)
        };
        let mean = (0..300).map(|_| overlap()).sum::<f32>() / 300.0;
        assert!((mean / expected - 1.0).abs() < 0.1, "{times} times its weight: {mean}, wanted {expected}");
    }
}

fn assert_stiffness(measured: f32, expected: f32) {
    assert!((measured / expected - 1.0).abs() < 0.02, "{measured:e} N/m³, wanted {expected:e}");
}

#[test]
fn a_collider_with_its_own_beside_one_without() {
    assert_stiffness(measured(|plugin, [_, ball]| plugin.set_collider_stiffness(ball, Some(3e6))), 3e6);
    assert_stiffness(measured(|plugin, [ground, _]| plugin.set_collider_stiffness(ground, Some(3e6))), 3e6);
}

#[test]
fn two_colliders_are_springs_in_series() {
    let both = |plugin: &mut IstPlugin, [ground, ball]: [ColliderHandle; 2]| {
        plugin.set_collider_stiffness(ground, Some(6e6));
        plugin.set_collider_stiffness(ball, Some(3e6));
        assert_eq!(plugin.collider_stiffness(ball), Some(3e6));
    };
    assert_stiffness(measured(both), 2e6);
}

#[test]
fn the_model_is_for_all_others() {
    let taken_back = |plugin: &mut IstPlugin, [_, ball]: [ColliderHandle; 2]| {
        plugin.model = uniform(5e6);
        plugin.set_collider_stiffness(ball, Some(1e5));
        plugin.set_collider_stiffness(ball, None);
    };
    assert_stiffness(measured(taken_back), 5e6);
}

#[test]
fn the_callback_has_the_last_word() {
    let calls = Arc::new(AtomicUsize::new(0));
    let counter = calls.clone();
    let law = move |plugin: &mut IstPlugin, [ground, ball]: [ColliderHandle; 2]| {
        plugin.model = uniform(5e6);
        plugin.set_pair_stiffness(move |pair| {
            counter.fetch_add(1, Ordering::Relaxed);
            assert_eq!([pair.collider_a, pair.collider_b], [ground, ball]);
            assert!(pair.bodies[pair.body_b.unwrap()].is_dynamic() && pair.colliders.contains(ball));
            assert!(pair.volume > 0.0);
            2.0 * pair.stiffness
        });
    };
    assert_stiffness(measured(law), 1e7);
    assert!(calls.load(Ordering::Relaxed) > 100);
    let cleared = |plugin: &mut IstPlugin, _| {
        plugin.model = uniform(5e6);
        plugin.set_pair_stiffness(|_| f32::NAN);
        plugin.clear_pair_stiffness();
    };
    assert_stiffness(measured(cleared), 5e6);
}

#[test]
fn a_callback_without_an_answer_counts_as_zero() {
    let (mut world, mut plugin) = grounded();
    plugin.set_pair_stiffness(|_| f32::NAN);
    let body = world.insert(dynamic(Vector::Y * 0.1), ball_collider()).0;
    run(&mut plugin, &mut world, 60);
    assert!(height(&world, body) < -1.0);
    assert_finite(&world, "NaN");
}

#[test]
fn a_removed_collider_is_forgotten() {
    let (mut world, mut plugin) = grounded();
    let (body, collider) = world.insert(dynamic(Vector::Y), ball_collider());
    plugin.set_collider_stiffness(collider, Some(1e6));
    plugin.step(&mut world);
    assert_eq!(plugin.clone().collider_stiffness(collider), Some(1e6));
    world.remove_body(body);
    plugin.step(&mut world);
    assert_eq!(plugin.collider_stiffness(collider), None);
}
