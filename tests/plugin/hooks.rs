//! The user's physics hooks.

use super::*;
use rapier3d::pipeline::ModifiableContacts;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Answers with the same flags for every pair and counts what it is asked.
struct Answer {
    flags: Option<SolverFlags>,
    filtered: AtomicUsize,
    modified: AtomicUsize,
}

impl Answer {
    fn new(flags: Option<SolverFlags>) -> Self {
        Self { flags, filtered: AtomicUsize::new(0), modified: AtomicUsize::new(0) }
    }
}

impl PhysicsHooks for Answer {
    fn filter_contact_pair(&self, _: &PairFilterContext) -> Option<SolverFlags> {
        self.filtered.fetch_add(1, Ordering::Relaxed);
        self.flags
    }

    fn modify_solver_contacts(&self, _: &mut ContactModificationContext) {
        self.modified.fetch_add(1, Ordering::Relaxed);
    }
}

/// Height of a ball that lay on the ground a second ago, and the times that the hooks were called.
fn after_a_second(hooks: ActiveHooks, flags: Option<SolverFlags>) -> (f32, [usize; 2]) {
    let (mut world, mut plugin) = grounded();
    let answer = Answer::new(flags);
    let collider = ball_collider().active_hooks(hooks);
    let body = world.insert(dynamic(Vector::Y * 0.09).can_sleep(false), collider).0;
    for _ in 0..60 {
        plugin.step_with_events(&mut world, &answer, &());
    }
    let asked = [&answer.filtered, &answer.modified].map(|count| count.load(Ordering::Relaxed));
    (height(&world, body), asked)
}

#[test]
fn filters_decide_and_only_those_that_want_to() {
    let filter = ActiveHooks::FILTER_CONTACT_PAIRS;
    assert!(after_a_second(filter, None).0 < 0.0);
    assert!(after_a_second(filter, Some(SolverFlags::empty())).0 < 0.0);
    let (height, asked) = after_a_second(filter, Some(SolverFlags::COMPUTE_RIGID_IMPULSES));
    assert!(height > 0.08 && asked[0] >= 60);
    let (height, asked) = after_a_second(ActiveHooks::empty(), None);
    assert!(height > 0.08 && asked == [0, 0], "nobody asked");
    let (height, asked) = after_a_second(ActiveHooks::MODIFY_SOLVER_CONTACTS, None);
    assert!(height > 0.08 && asked[0] == 0 && asked[1] > 50);
}

#[test]
fn a_hook_that_is_switched_on_later_is_asked() {
    let (mut world, mut plugin) = grounded();
    let (body, collider) = world.insert(dynamic(Vector::Y * 0.1).can_sleep(false), ball_collider());
    let forbid = Answer::new(None);
    for step in 0..60 {
        if step == 30 {
            assert!(height(&world, body) > 0.09);
            world.colliders[collider].set_active_hooks(ActiveHooks::FILTER_CONTACT_PAIRS);
        }
        plugin.step_with_events(&mut world, &forbid, &());
    }
    assert!(height(&world, body) < 0.0);
}

#[test]
fn the_manifold_model_leaves_hooks_as_they_were() {
    let (mut world, mut plugin) = grounded();
    let (_, collider) = world.insert(dynamic(Vector::Y * 0.1), ball_collider());
    plugin.step(&mut world);
    plugin.model = ContactModel::VolumeManifold;
    plugin.step(&mut world);
    assert_eq!(world.colliders[collider].active_hooks(), ActiveHooks::empty());
}

/// Lets bodies through from below.
struct OneWay(ColliderHandle);

impl PhysicsHooks for OneWay {
    fn modify_solver_contacts(&self, context: &mut ContactModificationContext) {
        let up = if context.collider1 == self.0 { Vector::Y } else { -Vector::Y };
        context.update_as_oneway_platform(up, 0.5);
    }
}

#[test]
fn a_one_way_platform_works_in_both_models() {
    one_way_platform(ContactModel::default());
    one_way_platform(ContactModel::VolumeManifold);
}

fn one_way_platform(model: ContactModel) {
    let (mut world, mut plugin) = grounded();
    plugin.model = model;
    let platform = ColliderBuilder::cuboid(1.0, 0.2, 1.0).active_hooks(ActiveHooks::MODIFY_SOLVER_CONTACTS);
    let platform = world.insert(RigidBodyBuilder::fixed().translation(Vector::Y), platform).1;
    let hooks = OneWay(platform);
    let upright = LockedAxes::TRANSLATION_LOCKED_X | LockedAxes::TRANSLATION_LOCKED_Z;
    let body = dynamic(Vector::Y * 0.5).linvel(Vector::Y * 5.0).locked_axes(upright);
    let body = world.insert(body, ball_collider()).0;
    let mut highest = 0.0_f32;
    for _ in 0..180 {
        plugin.step_with_events(&mut world, &hooks, &());
        highest = highest.max(height(&world, body));
    }
    // From 0.5 m at 5 m/s a free body rises by v²/2g = 1.27 m.
    assert!(highest > 1.7, "nothing stops it on its way up: {highest}");
    assert!((height(&world, body) - 1.3).abs() < 0.02, "it comes to rest on top: {}", height(&world, body));
}

/// Sets friction and restitution, and moves what lies on the collider along x.
struct Belt {
    collider: ColliderHandle,
    speed: f32,
    friction: f32,
    restitution: f32,
}

impl PhysicsHooks for Belt {
    fn modify_solver_contacts(&self, context: &mut ContactModificationContext) {
        // The wanted velocity is that of the second collider relative to the first.
        let sign = if context.collider1 == self.collider { 1.0 } else { -1.0 };
        let ModifiableContacts::Rigid(contacts) = &mut context.contacts else { return };
        *contacts.friction = self.friction;
        *contacts.restitution = self.restitution;
        for contact in contacts.solver_contacts.iter_mut() {
            contact.tangent_velocity = Vector::X * (sign * self.speed);
        }
    }
}

/// Position and velocity after a second of a body that begins at `start` over a belt without friction of its own.
fn on_a_belt(
    (speed, friction, restitution): (f32, f32, f32),
    start: RigidBodyBuilder,
    body_first: bool,
) -> (Vector, Vector) {
    let mut world = PhysicsWorld::new();
    let mut plugin = IstPlugin::install(&mut world);
    let body = |world: &mut PhysicsWorld| {
        let start = start.clone().lock_rotations();
        world.insert(start, ball_collider().friction(0.0)).0
    };
    let first = body_first.then(|| body(&mut world));
    let belt = ColliderBuilder::new(SharedShape::halfspace(Vector::Y)).friction(0.0);
    let belt = belt.active_hooks(ActiveHooks::MODIFY_SOLVER_CONTACTS);
    let collider = world.insert(RigidBodyBuilder::fixed(), belt).1;
    let body = first.unwrap_or_else(|| body(&mut world));
    let hooks = Belt { collider, speed, friction, restitution };
    for _ in 0..60 {
        plugin.step_with_events(&mut world, &hooks, &());
    }
    (world.bodies[body].translation(), world.bodies[body].linvel())
}

#[test]
fn a_conveyor_belt_carries_in_both_orders() {
    for body_first in [true, false] {
        let start = dynamic(Vector::Y * RADIUS);
        // Friction of 0.5 brings it to 2 m/s in 0.41 s, in 0.41 m; then it goes along.
        let (at, velocity) = on_a_belt((2.0, 0.5, 0.0), start.clone(), body_first);
        assert!((velocity.x - 2.0).abs() < 0.01, "{velocity}");
        let expected = 2.0 - 2.0 / (2.0 * 0.5 * 9.81) * 2.0;
        assert!((at.x - expected).abs() < 0.15, "{at}, {expected}");
        let (at, velocity) = on_a_belt((2.0, 0.0, 0.0), start, body_first);
        assert!(at.x.abs() < 1e-4 && velocity.x.abs() < 1e-4, "without friction it is not moved, {at}");
    }
}

#[test]
fn friction_and_restitution_of_the_hook_are_felt() {
    let sliding = dynamic(Vector::Y * RADIUS).linvel(Vector::X * 3.0);
    let (_, velocity) = on_a_belt((0.0, 0.1, 0.0), sliding.clone(), false);
    assert!((velocity.x - (3.0 - 0.981)).abs() < 0.1, "{velocity}");
    let (_, velocity) = on_a_belt((0.0, 0.0, 0.0), sliding, false);
    assert!((velocity.x - 3.0).abs() < 1e-3, "{velocity}");
    // Dropped from 1 m it hits the ground after 0.45 s and after another e · 0.9 s.
    let heights = [0.0, 0.8].map(|restitution| {
        on_a_belt((0.0, 0.0, restitution), dynamic(Vector::Y * (RADIUS + 1.0)), false).0.y
    });
    assert!(heights[0] < RADIUS + 0.01 && heights[1] > RADIUS + 0.4, "{heights:?}");
}
