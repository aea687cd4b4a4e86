//! Steps of small worlds.
//!
//! Bodies of all kinds with trees and with Rapier's own shapes, joints, and a script of steps, insertions, removals and
//! changes between them. Whatever the finite numbers: no panic, no body lost, nothing that is not finite in bodies that
//! Rapier keeps enabled or in reports, but for velocities that Rapier makes of manifolds and joints; fixed bodies stay, and forces of
//! the user are what they were. With usual numbers, no joints and no manifolds on bodies that yield by turning alone, none is
//! disabled.

mod scene;

use super::numbers::{below, finite_float, moderate, moderate_vector, pose, power_of_two, raw};
use arbitrary::Unstructured;
use rapier_ist::{ContactModel, IstPlugin, IstShape, StepReport, Stiffness, VolumePenalty};
use rapier3d::prelude::*;
use scene::{Extremes, body, collider};

const MOST_BODIES: u8 = 6;
/// Most steps of a script; a substep counts as one.
const MOST_STEPS: u32 = 40;

/// A world and what happens in it, from bytes.
pub fn check(data: &[u8]) {
    let u = &mut Unstructured::new(data);
    let extremes = Extremes(below(u, 4) == 0);
    let mut run = Run::new(u, extremes);
    for _ in 0..1 + below(u, MOST_BODIES) {
        run.insert(u);
    }
    run.step();
    while !u.is_empty() && run.steps < MOST_STEPS {
        run.change(u);
        run.step();
    }
    while run.steps < 6 {
        run.step();
    }
}

struct Run {
    world: PhysicsWorld,
    plugin: IstPlugin,
    bodies: Vec<RigidBodyHandle>,
    colliders: usize,
    steps: u32,
    extremes: Extremes,
    has_joints: bool,
    /// Whether Rapier's contacts have touched a body that they may turn at millions of radians a second, as they do without
    /// the plugin.
    has_spun: bool,
}

impl Run {
    fn new(u: &mut Unstructured, extremes: Extremes) -> Self {
        let mut world = PhysicsWorld::new();
        let mut plugin = IstPlugin::install(&mut world);
        plugin.model = model(u, extremes);
        plugin.substeps = u32::from(below(u, 3));
        world.gravity = Vector::Y * [-9.81, 0.0, 9.81, -100.0][usize::from(below(u, 4))];
        world.integration_parameters.dt =
            [1.0 / 60.0, 1.0 / 240.0, 1.0 / 30.0, 0.0][usize::from(below(u, 4))];
        if extremes.0 {
            world.integration_parameters.dt = extreme_time_step(u);
        }
        Self {
            world,
            plugin,
            bodies: Vec::new(),
            colliders: 0,
            steps: 0,
            extremes,
            has_joints: false,
            has_spun: false,
        }
    }

    fn insert(&mut self, u: &mut Unstructured) {
        let body = self.world.insert_body(body(u, self.extremes));
        for _ in 0..[1, 1, 1, 0, 2][usize::from(below(u, 5))] {
            self.world.insert_collider(collider(u, self.extremes), Some(body));
            self.colliders += 1;
        }
        self.bodies.push(body);
    }

    /// One of the bodies that are there.
    fn pick(&self, u: &mut Unstructured) -> Option<RigidBodyHandle> {
        let index = usize::from(raw::<u8>(u)).checked_rem(self.bodies.len())?;
        self.bodies.get(index).copied()
    }

    fn change(&mut self, u: &mut Unstructured) {
        let kind = below(u, 12);
        if kind == 0 && self.bodies.len() < usize::from(2 * MOST_BODIES) {
            return self.insert(u);
        }
        let Some(handle) = self.pick(u) else { return };
        let extremes = self.extremes;
        // Rapier itself panics at a joint none of whose bodies moves, such as one of a fixed and a disabled body.
        let has_joints = self.world.impulse_joints.attached_joints(handle).next().is_some();
        // And where a body changes its type to fixed and back while a kinematic one that touches it sleeps: an assertion of its
        // islands.
        let any_sleeps = self.bodies.iter().any(|handle| self.world.bodies[*handle].is_sleeping());
        match kind {
            8 | 11 if has_joints => return,
            8 if any_sleeps => return,
            1 => return self.remove(handle),
            2 => return self.join(u, handle),
            3 => return self.world.wake_up(handle, raw(u)),
            _ => {}
        }
        let body = &mut self.world.bodies[handle];
        match kind {
            4 => body.set_position(pose(u, 2.0), raw(u)),
            5 => body.set_linvel(extremes.vector(u), raw(u)),
            6 => body.set_angvel(extremes.vector(u), raw(u)),
            7 => body.sleep(),
            8 => body.set_body_type(scene::body_type(u), raw(u)),
            9 => body.set_next_kinematic_position(pose(u, 2.0)),
            10 => body.add_force(extremes.vector(u), raw(u)),
            11 => body.set_enabled(raw(u)),
            _ => {}
        }
    }

    fn remove(&mut self, handle: RigidBodyHandle) {
        self.colliders -= self.world.bodies[handle].colliders().len();
        self.world.remove_body(handle);
        self.bodies.retain(|other| *other != handle);
    }

    fn join(&mut self, u: &mut Unstructured, handle: RigidBodyHandle) {
        let Some(other) = self.pick(u).filter(|other| *other != handle) else { return };
        let ends = [handle, other].map(|handle| &self.world.bodies[handle]);
        if !(ends.iter().all(|body| body.is_enabled()) && ends.iter().any(|body| body.is_dynamic())) {
            return;
        }
        let (anchor, contacts) = (moderate_vector(u) * 0.125, raw(u));
        self.has_joints = true;
        // No multibodies: Rapier itself panics at some changes of theirs, such as another joint between two links.
        match below(u, 3) {
            0 => {
                let mut joint =
                    RevoluteJointBuilder::new(Vector::Z).local_anchor1(anchor).contacts_enabled(contacts);
                if raw(u) {
                    let motor = moderate_vector(u);
                    joint = joint.motor_velocity(motor.x, motor.y.abs()).motor_max_force(motor.z.abs());
                }
                if raw(u) {
                    let limit = moderate_vector(u);
                    joint = joint.limits([limit.x.min(limit.y), limit.x.max(limit.y)]);
                }
                self.world.insert_impulse_joint(handle, other, joint);
            }
            1 => {
                let joint = SphericalJointBuilder::new().local_anchor2(anchor).contacts_enabled(contacts);
                self.world.insert_impulse_joint(handle, other, joint);
            }
            _ => {
                let joint = FixedJointBuilder::new().contacts_enabled(contacts);
                self.world.insert_impulse_joint(handle, other, joint);
            }
        }
    }

    fn step(&mut self) {
        let before: Vec<_> =
            self.bodies.iter().map(|handle| State::of(&self.world.bodies[*handle])).collect();
        self.steps += self.plugin.substeps.max(1);
        let report = self.plugin.step(&mut self.world).clone();
        check_report(&report, &self.world);
        assert_eq!(
            (self.world.bodies.len(), self.world.colliders.len()),
            (self.bodies.len(), self.colliders)
        );
        // Of manifolds and joints Rapier makes velocities, and those of bodies next to no mass may be too large for it.
        // Two of Rapier's own shapes make such manifolds under the volume penalty too.
        let is_penalty = matches!(self.plugin.model, ContactModel::VolumePenalty(_));
        let is_rapiers = |collider: &Collider| collider.shape().as_shape::<IstShape>().is_none();
        let rapiers = self.world.colliders.iter().filter(|(_, collider)| is_rapiers(collider)).count();
        let is_ours = !self.extremes.0 || (is_penalty && !self.has_joints && rapiers < 2);
        self.has_spun |= self.bodies.iter().any(|body| is_touched_and_spins(&self.world, *body));
        for (handle, before) in self.bodies.iter().zip(before) {
            let body = &self.world.bodies[*handle];
            before.check(body, is_ours, !(self.extremes.0 || self.has_joints || self.has_spun));
        }
    }
}

/// Whether a contact of Rapier's touches a body that yields to it by turning alone. One whose translations are locked finds
/// next to no mass at a contact through its centre, only rounding errors of the lever; a half-space has mass, but no inertia
/// for the distance at which it is touched.
fn is_touched_and_spins(world: &PhysicsWorld, handle: RigidBodyHandle) -> bool {
    let body = &world.bodies[handle];
    let has_half_space = || {
        let shape_type = |collider: &ColliderHandle| world.colliders[*collider].shape().shape_type();
        body.colliders().iter().any(|collider| shape_type(collider) == ShapeType::HalfSpace)
    };
    let spins = body.locked_axes().intersects(LockedAxes::TRANSLATION_LOCKED) || has_half_space();
    // Manifolds of pairs that the penalty solves tell Rapier's solver nothing.
    let is_solved =
        |manifold: &ContactManifold| !manifold.data.solver_flags.is_empty() && !manifold.points.is_empty();
    let is_touched = |collider: &ColliderHandle| {
        world.narrow_phase.contact_pairs_with(*collider).any(|pair| pair.manifolds().iter().any(is_solved))
    };
    body.is_dynamic() && spins && body.colliders().iter().any(is_touched)
}

/// What a step must not change.
struct State {
    position: Pose,
    force: Vector,
    is_enabled: bool,
}

impl State {
    fn of(body: &RigidBody) -> Self {
        Self { position: *body.position(), force: body.user_force(), is_enabled: body.is_enabled() }
    }

    fn check(&self, body: &RigidBody, is_ours: bool, is_usual: bool) {
        if body.is_enabled() {
            // Rapier computes the velocity of a kinematic body from its way, which may be too far for a time step.
            let moves =
                !(body.is_dynamic() && is_ours) || (body.linvel().is_finite() && body.angvel().is_finite());
            let what = (body.body_type(), body.linvel(), body.angvel());
            assert!(body.position().is_finite() && moves, "{:?} {what:?}", body.position());
            assert_eq!(body.user_force(), self.force, "a force of the user has changed");
        }
        assert!(!is_usual || body.is_enabled() == self.is_enabled, "{:?} was disabled", self.position);
        if body.is_fixed() {
            // Rapier normalises the rotation, and with it turns a body that has just become fixed about its centre of mass.
            let turned = body.rotation().angle_between(self.position.rotation);
            let reach = 1.0 + self.position.translation.length() + body.center_of_mass().length();
            let moved = body.translation().distance(self.position.translation);
            let stays = (moved == 0.0 || moved <= 1e-6 * reach) && turned < 1e-2;
            assert!(stays, "a fixed body has moved from {:?} to {:?}", self.position, body.position());
        }
    }
}

fn check_report(report: &StepReport, world: &PhysicsWorld) {
    assert!(!report.dispatcher_replaced);
    assert!(report.contacts.is_sorted_by_key(|contact| contact.colliders().map(|c| c.into_raw_parts())));
    for contact in &report.contacts {
        let [a, b] = contact.colliders();
        assert!(world.colliders.contains(a) && world.colliders.contains(b), "{contact:?}");
        let vectors = [contact.centroid, contact.force, contact.torque, contact.relative_velocity];
        let is_finite = contact.volume.is_finite() && contact.depth.is_finite();
        assert!(is_finite && vectors.iter().all(|v| v.is_finite()), "{contact:?}");
        assert!(contact.volume >= 0.0 && contact.depth >= 0.0, "{contact:?}");
    }
    for patch in &report.patches {
        assert!(patch.pair < report.contacts.len());
        let vectors = [patch.centroid, patch.force, patch.torque, patch.relative_velocity];
        let is_finite = patch.volume.is_finite() && patch.depth.is_finite();
        assert!(is_finite && vectors.iter().all(|v| v.is_finite()), "{patch:?}");
    }
}

/// None, backwards, or from a microsecond to a second.
fn extreme_time_step(u: &mut Unstructured) -> Real {
    match below(u, 8) {
        0 => 0.0,
        1 => -1.0,
        _ => finite_float(u).abs().clamp(1e-6, 1.0),
    }
}

fn model(u: &mut Unstructured, extremes: Extremes) -> ContactModel {
    if below(u, 4) == 0 {
        return ContactModel::VolumeManifold;
    }
    let mut penalty = VolumePenalty::default();
    if extremes.0 {
        penalty.dissipation = finite_float(u);
        penalty.recovery_speed = finite_float(u);
        penalty.creep_speed = finite_float(u);
    }
    if below(u, 2) == 0 {
        let stiffness =
            if extremes.0 { finite_float(u) } else { 1e4 * power_of_two(u, 12) * moderate(u).abs() };
        penalty.stiffness = Stiffness::Uniform(stiffness);
    }
    ContactModel::VolumePenalty(penalty)
}
