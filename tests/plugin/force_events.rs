//! Collision events and contact-force events.

use super::*;
use rapier3d::utils::OrthonormalBasis;
use std::sync::Mutex;
use std::sync::mpsc::{Receiver, channel};

fn collector() -> (ChannelEventCollector, Receiver<CollisionEvent>, Receiver<ContactForceEvent>) {
    let ((collisions, collision_events), (forces, force_events)) = (channel(), channel());
    let (tears, _) = channel();
    (ChannelEventCollector::new(collisions, forces, tears), collision_events, force_events)
}

#[test]
fn collisions_start_and_stop() {
    let (mut world, mut plugin) = grounded();
    let (handler, collisions, _) = collector();
    let collider = ball_collider().active_events(ActiveEvents::COLLISION_EVENTS);
    let (body, collider) = world.insert(dynamic(Vector::Y * 0.1), collider);
    for step in 0..90 {
        if step == 60 {
            world.bodies[body].set_linvel(Vector::Y * 3.0, true);
        }
        plugin.step_with_events(&mut world, &(), &handler);
    }
    let events: Vec<_> = collisions.try_iter().collect();
    assert_eq!(events.iter().map(|event| event.started()).collect::<Vec<_>>(), [true, false]);
    assert!(events.iter().all(|event| [event.collider1(), event.collider2()].contains(&collider)));
}

/// Force events of a ball that falls from a height and comes to rest, with what the report says at the time.
fn falling(height: f32, threshold: f32, events: ActiveEvents) -> (Vec<(ContactForceEvent, Vector)>, f32) {
    let mut above = false;
    let (mut world, mut plugin) = grounded();
    let (handler, _, forces) = collector();
    let collider = ball_collider().active_events(events).contact_force_event_threshold(threshold);
    let body = world.insert(dynamic(Vector::Y * (RADIUS + height)).can_sleep(false), collider).0;
    let mut sent = Vec::new();
    for _ in 0..120 {
        let report = plugin.step_with_events(&mut world, &(), &handler);
        let force = report.contacts.first().map_or(Vector::ZERO, |contact| contact.force);
        let events: Vec<_> = forces.try_iter().collect();
        assert!(
            events.len() <= 1 && events.iter().all(|event| event.started != above),
            "new where it was not above"
        );
        above = !events.is_empty();
        sent.extend(events.into_iter().map(|event| (event, force)));
    }
    (sent, world.bodies[body].mass() * 9.81)
}

#[test]
fn forces_over_the_threshold_are_told() {
    let (resting, weight) = falling(0.0, 20.0, ActiveEvents::CONTACT_FORCE_EVENTS);
    assert!(weight > 20.0 && resting.len() > 60, "its weight is over the threshold");
    assert!(resting.iter().rev().take(60).all(|(event, _)| !event.started), "and stays there");
    for (event, force) in &resting {
        assert!((event.total_force - force).length() < 1e-3 * force.length(), "{event:?} {force}");
        assert!(event.total_force_magnitude >= 0.999 * force.length());
        assert!(event.max_force_magnitude <= 1.001 * event.total_force_magnitude);
        assert!(event.max_force_direction.y > 0.9);
    }
    let (last, _) = resting.last().unwrap();
    assert!((last.total_force.y / weight - 1.0).abs() < 0.02);
    let (impact, _) = falling(0.4, 3.0 * weight, ActiveEvents::CONTACT_FORCE_EVENTS);
    assert!(
        !impact.is_empty() && impact.len() < 5 && impact[0].0.started,
        "only the impact is over three times that"
    );
}

#[test]
fn force_events_are_sent_only_where_asked_for() {
    assert!(falling(0.4, 0.0, ActiveEvents::COLLISION_EVENTS).0.is_empty());
    assert!(falling(0.4, 1e9, ActiveEvents::CONTACT_FORCE_EVENTS).0.is_empty());
    assert!(falling(0.4, f32::NAN, ActiveEvents::CONTACT_FORCE_EVENTS).0.is_empty());
}

#[test]
fn the_lower_threshold_of_a_pair_counts() {
    let (mut world, mut plugin) = weightless();
    let (handler, _, forces) = collector();
    let asking = |threshold: f32| {
        ball_collider()
            .active_events(ActiveEvents::CONTACT_FORCE_EVENTS)
            .contact_force_event_threshold(threshold)
    };
    world.insert(dynamic(Vector::ZERO), asking(1e9));
    world.insert(dynamic(Vector::X * 0.15), asking(0.1));
    plugin.step_with_events(&mut world, &(), &handler);
    assert_eq!(forces.try_iter().count(), 1);
}

#[test]
fn rapiers_own_pairs_send_one_event_each() {
    let (mut world, mut plugin) = grounded();
    let (handler, _, forces) = collector();
    let cuboid = ColliderBuilder::cuboid(0.1, 0.1, 0.1).density(DENSITY);
    let cuboid = cuboid.active_events(ActiveEvents::CONTACT_FORCE_EVENTS);
    world.insert(dynamic(Vector::Y * 0.1).can_sleep(false), cuboid);
    for _ in 0..30 {
        plugin.step_with_events(&mut world, &(), &handler);
        assert!(forces.try_iter().count() <= 1);
    }
}

/// A contact that went on was told as a new one after a step without length, and after a sleep.
#[test]
fn issue_a_contact_that_goes_on_is_told_as_new_once() {
    let (mut world, mut plugin) = grounded();
    let (handler, _, forces) = collector();
    let collider =
        ball_collider().active_events(ActiveEvents::CONTACT_FORCE_EVENTS).contact_force_event_threshold(1.0);
    let body = world.insert(dynamic(Vector::Y * RADIUS), collider).0;
    let mut started = Vec::new();
    let mut slept = false;
    let dt = world.integration_parameters.dt;
    for step in 0..600 {
        world.integration_parameters.dt = if step == 20 { 0.0 } else { dt };
        if step == 500 {
            slept = world.bodies[body].is_sleeping();
            world.bodies[body].wake_up(true);
        }
        plugin.step_with_events(&mut world, &(), &handler);
        started.extend(forces.try_iter().filter(|event| event.started).map(|_| step));
    }
    assert!(slept);
    assert_eq!(started.len(), 1, "{started:?}");
    // Once it has come apart it is new again.
    world.bodies[body].set_linvel(Vector::Y * 2.0, true);
    for _ in 0..60 {
        plugin.step_with_events(&mut world, &(), &handler);
    }
    assert!(forces.try_iter().any(|event| event.started));
}

/// Keeps the last contact-force event, and the force on the second collider as its contacts tell it.
#[derive(Default)]
struct LastForce(Mutex<Option<(ContactForceEvent, Vector)>>);

impl EventHandler for LastForce {
    fn handle_collision_event(
        &self,
        _: &RigidBodySet,
        _: &ColliderSet,
        _: CollisionEvent,
        _: Option<&ContactPair>,
    ) {
    }

    fn handle_contact_force_event(
        &self,
        dt: f32,
        _: &RigidBodySet,
        _: &ColliderSet,
        pair: &ContactPair,
        total: f32,
    ) {
        let on_first = |manifold: &ContactManifold| -> Vector {
            let push = -manifold.data.normal;
            let tangent = push.orthonormal_vector();
            let contact = |contact: &ContactData| {
                let [along, across] = [contact.tangent_impulse.x, contact.tangent_impulse.y];
                push * contact.impulse + tangent * along + push.cross(tangent) * across
            };
            manifold.points.iter().map(|point| contact(&point.data)).sum()
        };
        let impulse: Vector = pair.solver_manifolds().iter().map(on_first).sum();
        let event = ContactForceEvent::from_contact_pair(dt, pair, total);
        *self.0.lock().unwrap() = Some((event, -impulse / dt));
    }

    fn handle_soft_body_tear_event(&self, _: &SoftBodySet, _: &SoftBodyTearEvent) {}
}

/// Friction was told as normal force, with a normal that pointed backwards.
#[test]
fn issue_sliding_bodies_tell_their_normal_force_as_with_rapiers_shapes() {
    let told = [ball_collider(), ColliderBuilder::ball(RADIUS).density(DENSITY)].map(|collider| {
        let (mut world, mut plugin) = grounded();
        // With the other model Rapier tells nothing of friction.
        world.integration_parameters.friction_model = FrictionModel::Coulomb;
        let body = dynamic(Vector::Y * RADIUS).lock_rotations().linvel(Vector::new(6.0, 0.0, 2.0));
        let collider = collider.active_events(ActiveEvents::CONTACT_FORCE_EVENTS).friction(1.0);
        world.insert(body, collider);
        let last = LastForce::default();
        // As long as it slides, with friction 1 on ground of 1/2.
        for _ in 0..30 {
            plugin.step_with_events(&mut world, &(), &last);
        }
        last.0.into_inner().unwrap().unwrap()
    });
    let [(ours, our_force), (rapiers, rapiers_force)] = told;
    let weight = rapiers.total_force_magnitude;
    let close = |a: Vector, b: Vector| a.distance(b) < 0.02 * weight;
    assert!((ours.total_force_magnitude / weight - 1.0).abs() < 0.02, "{ours:?} {rapiers:?}");
    assert!((ours.max_force_magnitude / weight - 1.0).abs() < 0.02, "{ours:?} {rapiers:?}");
    assert!(close(ours.total_force, rapiers.total_force), "{ours:?} {rapiers:?}");
    assert!(ours.max_force_direction.distance(rapiers.max_force_direction) < 0.01, "{ours:?} {rapiers:?}");
    // And with friction both are the whole force on the body.
    assert!(our_force.x < -0.7 * weight && our_force.z < -0.2 * weight, "{our_force}");
    assert!(close(our_force, rapiers_force), "{our_force} {rapiers_force}");
}
