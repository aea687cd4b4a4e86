//! Substeps, lost dispatchers, and worlds in parts.

use super::*;
use rapier_ist::{IstDispatcher, WorldParts};
use rapier3d::parry::query::{DefaultQueryDispatcher, QueryDispatcher};
use std::sync::Mutex;

#[test]
fn substeps_are_steps_of_a_part_of_the_time() {
    let scene = || {
        let (mut world, plugin) = grounded();
        let bodies =
            [0.1, 0.32, 0.6].map(|y| world.insert(dynamic(Vector::new(y * 0.1, y, 0.0)), ball_collider()).0);
        world.bodies[bodies[2]].add_force(Vector::X * 3.0, true);
        (world, plugin, bodies)
    };
    let (mut whole, mut plugin, bodies) = scene();
    plugin.substeps = 3;
    let (mut parts, mut single, _) = scene();
    parts.integration_parameters.dt = whole.integration_parameters.dt / 3.0;
    for _ in 0..60 {
        plugin.step(&mut whole);
        run(&mut single, &mut parts, 3);
        assert_eq!(bodies.map(|body| bits(&whole, body)), bodies.map(|body| bits(&parts, body)));
    }
    assert_eq!(whole.integration_parameters.dt, 1.0 / 60.0);
}

#[test]
fn no_substeps_count_as_one() {
    let ends = [0, 1].map(|substeps| {
        let (mut world, mut plugin) = grounded();
        plugin.substeps = substeps;
        let body = world.insert(dynamic(Vector::Y * 0.3), ball_collider()).0;
        run(&mut plugin, &mut world, 30);
        bits(&world, body)
    });
    assert_eq!(ends[0], ends[1]);
}

/// Keeps what is logged.
struct Log(Mutex<Vec<String>>);

static LOG: Log = Log(Mutex::new(Vec::new()));

impl log::Log for Log {
    fn enabled(&self, _: &log::Metadata<'_>) -> bool {
        true
    }

    fn log(&self, record: &log::Record<'_>) {
        if record.target().starts_with("rapier_ist") {
            self.0.lock().unwrap().push(format!("{} {}", record.level(), record.args()));
        }
    }

    fn flush(&self) {}
}

#[test]
fn a_lost_dispatcher_is_replaced_and_told_once() {
    log::set_logger(&LOG).unwrap();
    log::set_max_level(log::LevelFilter::Trace);
    let (mut world, mut plugin) = grounded();
    let body = world.insert(dynamic(Vector::Y * 0.1), ball_collider()).0;
    assert!(!plugin.step(&mut world).dispatcher_replaced);
    assert!(LOG.0.lock().unwrap().is_empty());
    // As after restoring a snapshot.
    world.narrow_phase.set_query_dispatcher(DefaultQueryDispatcher);
    assert!(plugin.step(&mut world).dispatcher_replaced);
    for _ in 0..60 {
        assert!(!plugin.step(&mut world).dispatcher_replaced);
    }
    let messages = LOG.0.lock().unwrap().clone();
    assert!(
        messages.len() == 1 && messages[0].starts_with("WARN") && messages[0].contains("dispatcher"),
        "{messages:?}"
    );
    assert!(height(&world, body) > 0.08);
    assert_eq!(world.narrow_phase.contact_pairs().count(), 1, "Rapier sees the pair again");
}

#[test]
fn a_chained_dispatcher_stays() {
    let mut world = PhysicsWorld::new();
    world.narrow_phase.set_query_dispatcher(IstDispatcher.chain(DefaultQueryDispatcher));
    let mut plugin = IstPlugin::default();
    assert!(!plugin.step(&mut world).dispatcher_replaced);
}

#[test]
fn parts_of_a_world_step_like_the_world() {
    let scene = || {
        let (mut world, plugin) = grounded();
        let body = world.insert(dynamic(Vector::new(0.0, 0.3, 0.0)), ball_collider()).0;
        (world, plugin, body)
    };
    let (mut world, mut plugin, body) = scene();
    let (mut other, mut in_parts, _) = scene();
    for _ in 0..60 {
        plugin.step(&mut world);
        in_parts.step_parts(WorldParts::from(&mut other), &(), &());
        assert_eq!(bits(&world, body), bits(&other, body));
    }
}

#[test]
fn a_copy_of_the_plugin_goes_on_where_it_stood() {
    let (mut world, mut plugin) = grounded();
    let (mut same, mut copied) = grounded();
    let body = world.insert(dynamic(Vector::Y * 0.3), ball_collider()).0;
    same.insert(dynamic(Vector::Y * 0.3), ball_collider());
    for step in 0..60 {
        plugin.step(&mut world);
        copied = if step % 7 == 3 { copied.clone() } else { copied };
        copied.step(&mut same);
        assert_eq!(bits(&world, body), bits(&same, body));
    }
}

#[test]
fn runs_are_equal_bit_for_bit_on_any_number_of_threads() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let (mut world, mut plugin) = grounded();
            plugin.substeps = 2;
            let place =
                |i: u32| Vector::new(0.15 * (i % 4) as f32, 0.1 + 0.1 * i as f32, 0.13 * (i % 3) as f32);
            let body = |i| dynamic(place(i)).dominance_group((i % 2) as i8);
            let bodies: Vec<_> = (0..12).map(|i| world.insert(body(i), ball_collider()).0).collect();
            for _ in 0..60 {
                plugin.step(&mut world);
            }
            bodies.iter().map(|&body| bits(&world, body)).collect::<Vec<_>>()
        })
    };
    assert_eq!(run(1), run(2));
}

#[test]
fn bodies_move_the_same_whatever_touches_elsewhere() {
    let bounce = |others: usize| {
        let (mut world, mut plugin) = grounded();
        let ball = |x: f32, y: f32| {
            (dynamic(Vector::new(x, y, 0.0)).can_sleep(false), ball_collider().restitution(0.8))
        };
        let (body, collider) = ball(0.0, 0.5);
        let bouncing = world.insert(body, collider).0;
        for i in 0..others {
            let (body, collider) = ball(2.0 + i as f32, 0.1);
            world.insert(body, collider.restitution(0.0));
        }
        let heights = (0..240).map(|_| {
            plugin.step(&mut world);
            height(&world, bouncing)
        });
        heights.collect::<Vec<f32>>()
    };
    let alone = bounce(0);
    // The ground has no restitution of its own: e = 0.4.
    assert!(alone.iter().skip(18).any(|height| *height > 0.16), "{alone:?}");
    assert_eq!(alone, bounce(3));
}
