//! From overlapping pairs to forces on bodies.

use crate::penalty::{Island, Material, PairContacts, PatchSum, Screw, SolverBody, islands};
use crate::query::Contact;
use crate::stiffness::{StiffnessTable, valid};
use crate::{
    ContactState, PairContact, PatchContact, StepReport, Stiffness, StiffnessContext, VolumePenalty,
    WorldParts,
};
use rapier3d::dynamics::{CoefficientCombineRule, RigidBody, RigidBodyHandle};
use rapier3d::geometry::Collider;
use rapier3d::math::{Real, Vector};
use std::cmp::Ordering;

/// Stiffness of [`Stiffness::Automatic`] in units of weight per cubed size; see [`automatic_stiffness`].
///
/// With 5e4 the pile example (seeds 1 to 4) is asleep within 10 s and no exact mesh is deeper in another than 1.6 to
/// 2.2 % of the smaller body. Before contacts were measured
/// at the present velocity, 2e4 left up to 7.6 %, and from 2e5 on some bodies kept creeping at a few cm/s.
const RELATIVE_STIFFNESS: f64 = 5e4;

/// Approach speed (m/s, times `length_unit`) under which nothing rebounds, so that resting bodies come to rest: a little
/// more than gravity adds in a step of 1/60 s. Not tuned.
const REBOUND_SPEED: f64 = 0.2;

/// Speed (m/s, times `length_unit`) of a contact point from which on it wakes a sleeping body.
const WAKE_SPEED: f64 = 0.05;

/// Friction from which on more makes no difference: a slope this steep is a wall.
const MOST_FRICTION: Real = 100.0;

/// Stiffness from which on a contact is rigid, and the linear system only worse for it, in units of m/(h² L²), with
/// the lighter body's mass m, the time step h and the smaller body's size L. Balls of 0.1 m under 1e12 N/m³ are at 3e6.
const RIGID: f64 = 1e8;

/// What the contacts do to one body in a step, about its centre of mass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BodyForce {
    handle: RigidBodyHandle,
    /// Mean contact force (N) and torque (N·m).
    contact: Screw,
    /// Gravity and the user's own force and torque.
    external: Screw,
    /// Whether the body is a link of a multibody.
    is_link: bool,
}

/// What decides about the materials of pairs.
#[derive(Clone, Copy)]
pub(crate) struct ContactLaw<'a> {
    pub(crate) penalty: &'a VolumePenalty,
    pub(crate) stiffness: &'a StiffnessTable,
}

/// Solves for the contact forces of one step and reports them pair by pair.
pub(crate) fn respond(
    world: &mut WorldParts<'_>,
    contacts: Vec<Contact>,
    law: ContactLaw<'_>,
    report: &mut StepReport,
) -> Vec<BodyForce> {
    let dt = f64::from(world.integration_parameters.dt);
    if contacts.is_empty() || dt.is_nan() || dt <= 0.0 {
        return Vec::new();
    }
    wake_touched_bodies(world, &contacts);
    let bodies = Bodies::new(world, &contacts);
    let pairs: Vec<[usize; 2]> = contacts.iter().map(|contact| bodies.pair(world, contact)).collect();
    let movable: Vec<bool> = bodies.states.iter().map(SolverBody::is_movable).collect();
    let (pairs, contacts): (Vec<_>, Vec<_>) =
        pairs.into_iter().zip(&contacts).filter(|([a, b], _)| movable[*a] || movable[*b]).unzip();
    let materials: Vec<Material> = contacts.iter().map(|contact| material(world, contact, law)).collect();
    let islands = islands(&pairs, &movable);
    let solve = |members: &Vec<usize>| solve_island(&bodies, members, &pairs, (&contacts, &materials), dt);
    #[cfg(feature = "parallel")]
    let solved: Vec<Vec<Solved>> = {
        use rayon::prelude::*;
        islands.par_iter().map(solve).collect()
    };
    #[cfg(not(feature = "parallel"))]
    let solved: Vec<Vec<Solved>> = islands.iter().map(solve).collect();
    collect(&bodies, solved, &pairs, &contacts, report)
}

/// The bodies that take part, each once, in the order of their handles. Index 0 is the world itself.
struct Bodies {
    handles: Vec<Option<RigidBodyHandle>>,
    /// First those of `handles`, then all of them once more as what a dominated body sees: they move and do not give
    /// way.
    states: Vec<SolverBody>,
    is_link: Vec<bool>,
}

impl Bodies {
    fn new(world: &WorldParts<'_>, contacts: &[Contact]) -> Self {
        let colliders = contacts.iter().flat_map(|contact| contact.candidate.colliders);
        let mut handles: Vec<_> = colliders.filter_map(|c| world.colliders.get(c)?.parent()).collect();
        handles.sort_unstable_by_key(|handle| handle.into_raw_parts());
        handles.dedup();
        let state = |handle: &RigidBodyHandle| {
            let body = &world.bodies[*handle];
            let movable = body.is_dynamic() && !body.is_sleeping() && body.is_enabled();
            SolverBody::new(body, movable, world.gravity, world.integration_parameters.dt)
        };
        let mut states: Vec<_> =
            std::iter::once(SolverBody::FIXED).chain(handles.iter().map(state)).collect();
        states.extend_from_within(..);
        states[handles.len() + 1..].iter_mut().for_each(|state| *state = state.unyielding());
        let handles: Vec<_> = std::iter::once(None).chain(handles.into_iter().map(Some)).collect();
        let is_link = |handle: &Option<RigidBodyHandle>| {
            handle.is_some_and(|handle| world.multibody_joints.rigid_body_link(handle).is_some())
        };
        Self { is_link: handles.iter().map(is_link).collect(), handles, states }
    }

    fn pair(&self, world: &WorldParts<'_>, contact: &Contact) -> [usize; 2] {
        let parents = contact
            .candidate
            .colliders
            .map(|collider| world.colliders.get(collider).and_then(Collider::parent));
        let [a, b] = parents.map(|parent| {
            let key = parent.map(RigidBodyHandle::into_raw_parts);
            self.handles.binary_search_by_key(&key, |h| h.map(RigidBodyHandle::into_raw_parts)).unwrap_or(0)
        });
        // As in Rapier: what is not dynamic dominates everything that is.
        let dominance = |parent: Option<RigidBodyHandle>| {
            let body = parent.and_then(|parent| world.bodies.get(parent));
            body.map_or(i16::MAX, RigidBody::effective_dominance_group)
        };
        match dominance(parents[0]).cmp(&dominance(parents[1])) {
            Ordering::Greater => [a + self.handles.len(), b],
            Ordering::Less => [a, b + self.handles.len()],
            Ordering::Equal => [a, b],
        }
    }
}

/// One pair after the solve: its index, its point of reference and the wrench on its second body about that.
struct Solved {
    pair: usize,
    origin: rapier3d::glamx::DVec3,
    depth: f64,
    wrench: Screw,
    relative_velocity: Screw,
    /// With the wrenches on the second body about the pair's origin.
    patches: Vec<(PatchSum, Screw)>,
}

fn solve_island(
    bodies: &Bodies,
    members: &[usize],
    pairs: &[[usize; 2]],
    (contacts, materials): (&[&Contact], &[Material]),
    dt: f64,
) -> Vec<Solved> {
    let mut used: Vec<usize> = members.iter().flat_map(|&pair| pairs[pair]).collect();
    used.sort_unstable();
    used.dedup();
    let local = |body: usize| used.binary_search(&body).unwrap_or(0);
    let contacts = members.iter().map(|&pair| {
        let states = pairs[pair].map(|body| &bodies.states[body]);
        PairContacts::new(pairs[pair].map(local), states, materials[pair], contacts[pair], dt)
    });
    let contacts = contacts.collect();
    let mut island = Island::new(used.iter().map(|&body| bodies.states[body]).collect(), contacts);
    island.solve(dt);
    let solved = members.iter().enumerate().map(|(index, &pair)| {
        let (contacts, twist) = (&island.pairs[index], island.pair_twist(index));
        Solved {
            pair,
            origin: contacts.origin,
            depth: contacts.depth,
            wrench: contacts.wrench(twist),
            relative_velocity: contacts.relative_twist(&island.bodies, |i| island.bodies[i].velocity),
            patches: contacts.patches.iter().map(|patch| (*patch, patch.wrench(twist))).collect(),
        }
    });
    solved.collect()
}

/// Sums the wrenches per body, in the order of the pairs, and writes the report.
fn collect(
    bodies: &Bodies,
    solved: Vec<Vec<Solved>>,
    pairs: &[[usize; 2]],
    contacts: &[&Contact],
    report: &mut StepReport,
) -> Vec<BodyForce> {
    let mut solved: Vec<Solved> = solved.into_iter().flatten().filter(|s| s.wrench.is_finite()).collect();
    solved.sort_unstable_by_key(|s| s.pair);
    let mut sums = vec![Screw::ZERO; bodies.states.len()];
    for Solved { pair, origin, depth, wrench, relative_velocity, patches } in solved {
        let [a, b] = pairs[pair];
        sums[b] += wrench.wrench_from(origin - bodies.states[b].center_of_mass);
        sums[a] += -wrench.wrench_from(origin - bodies.states[a].center_of_mass);
        report.patches.extend(patches.into_iter().map(|(patch, wrench)| PatchContact {
            pair: report.contacts.len(),
            volume: patch.volume as Real,
            depth: patch.depth as Real,
            centroid: (origin + patch.arm).as_vec3(),
            force: wrench.linear.as_vec3(),
            torque: wrench.wrench_from(-patch.arm).angular.as_vec3(),
            relative_velocity: relative_velocity.twist_at(patch.arm).linear.as_vec3(),
        }));
        report.contacts.push(PairContact {
            collider_a: contacts[pair].candidate.colliders[0],
            collider_b: contacts[pair].candidate.colliders[1],
            state: ContactState::Started,
            volume: contacts[pair].samples.iter().map(|s| s.volume).sum(),
            depth: depth as Real,
            centroid: origin.as_vec3(),
            force: wrench.linear.as_vec3(),
            torque: wrench.angular.as_vec3(),
            relative_velocity: relative_velocity.linear.as_vec3(),
        });
    }
    let moved = (0..bodies.handles.len()).filter(|&i| bodies.states[i].is_movable());
    let force = |i: usize| {
        let (contact, external, is_link) = (sums[i], bodies.states[i].external, bodies.is_link[i]);
        Some(BodyForce { handle: bodies.handles[i]?, contact, external, is_link })
    };
    moved.filter_map(force).collect()
}

fn material(world: &WorldParts<'_>, contact: &Contact, law: ContactLaw<'_>) -> Material {
    let penalty = law.penalty;
    let [a, b] = contact.candidate.colliders.map(|handle| world.colliders[handle].material());
    let combine = CoefficientCombineRule::combine;
    let unit = f64::from(world.integration_parameters.length_unit);
    Material {
        stiffness: stiffness(world, contact, law),
        dissipation: f64::from(penalty.dissipation),
        friction: combine(a.friction, b.friction, a.friction_combine_rule, b.friction_combine_rule)
            .clamp(0.0, MOST_FRICTION)
            // NaN passes through a clamp.
            .max(0.0)
            .into(),
        restitution: combine(
            a.restitution,
            b.restitution,
            a.restitution_combine_rule,
            b.restitution_combine_rule,
        )
        .clamp(0.0, 1.0)
        .into(),
        creep_speed: (f64::from(penalty.creep_speed) * unit).max(f64::MIN_POSITIVE),
        recovery_speed: (f64::from(penalty.recovery_speed) * unit).max(f64::MIN_POSITIVE),
        rebound_speed: REBOUND_SPEED * unit,
    }
}

/// Stiffness (N/m³) of a pair: the callback's, else the colliders' own, else the model's.
fn stiffness(world: &WorldParts<'_>, contact: &Contact, law: ContactLaw<'_>) -> f64 {
    let [collider_a, collider_b] = contact.candidate.colliders;
    let stiffness =
        law.stiffness.of_colliders([collider_a, collider_b]).unwrap_or_else(|| match law.penalty.stiffness {
            Stiffness::Automatic => automatic_stiffness(world, contact),
            Stiffness::Uniform(stiffness) => valid(stiffness),
        });
    let parent = |collider| world.colliders.get(collider).and_then(Collider::parent);
    let stiffness = law.stiffness.of_pair(stiffness, |stiffness| StiffnessContext {
        bodies: world.bodies,
        colliders: world.colliders,
        collider_a,
        collider_b,
        body_a: parent(collider_a),
        body_b: parent(collider_b),
        volume: contact.samples.iter().map(|s| s.volume).sum(),
        stiffness,
    });
    let (dt, size) = (f64::from(world.integration_parameters.dt), f64::from(contact.size));
    stiffness.min(RIGID * lighter_mass(world, contact) / (dt * dt * size * size))
}

/// Stiffness (N/m³) at which the lighter body's weight makes it sink by a small share of the smaller body's size L:
/// weight = k A d, with the contact's cross-section A and depth d in units of L² and L.
fn automatic_stiffness(world: &WorldParts<'_>, contact: &Contact) -> f64 {
    let lighter = lighter_mass(world, contact);
    let unit = f64::from(world.integration_parameters.length_unit);
    // Without gravity something must stop a body all the same: a metre per second squared, in units of length.
    let gravity = f64::from(world.gravity.length()).max(unit);
    let size = f64::from(contact.size);
    let stiffness = RELATIVE_STIFFNESS * lighter * gravity / (size * size * size);
    if stiffness.is_finite() { stiffness } else { 0.0 }
}

/// Mass (kg) of the lighter dynamic body of a pair.
fn lighter_mass(world: &WorldParts<'_>, contact: &Contact) -> f64 {
    let mass = |handle| {
        let body = world.bodies.get(world.colliders.get(handle)?.parent()?).filter(|b| b.is_dynamic())?;
        Some(f64::from(body.mass()))
    };
    contact.candidate.colliders.into_iter().filter_map(mass).fold(f64::INFINITY, f64::min)
}

/// Wakes sleeping bodies that something moving touches.
fn wake_touched_bodies(world: &mut WorldParts<'_>, contacts: &[Contact]) {
    let speed = WAKE_SPEED as Real * world.integration_parameters.length_unit;
    for contact in contacts {
        let parents =
            contact.candidate.colliders.map(|handle| world.colliders.get(handle).and_then(Collider::parent));
        let body = |i: usize| parents[i].and_then(|handle| world.bodies.get(handle));
        let asleep = |i: usize| body(i).is_some_and(|b| b.is_dynamic() && b.is_sleeping());
        let Some(sleeper) = (0..2).find(|&i| asleep(i)) else { continue };
        let moving = |b: &RigidBody| {
            !b.is_sleeping() && b.velocity_at_point(contact.samples[0].point).length() > speed
        };
        if let (true, Some(handle)) = (body(1 - sleeper).is_some_and(moving), parents[sleeper]) {
            world.islands.wake_up(world.bodies, handle, true);
        }
    }
}

/// The user's own forces and torques on the bodies that contacts act on.
pub(crate) struct UserForces(Vec<(RigidBodyHandle, Vector, Vector)>);

impl UserForces {
    /// Gives every body its final velocity now and holds it against gravity and the user's forces during the step.
    ///
    /// The solve is for a body that moves at its final velocity through the whole step. Rapier moves bodies in
    /// substeps and adds external forces bit by bit, so an impulse alone would lift a resting body before gravity
    /// brings it down again, and a force alone would let an arriving body move on through the contact.
    pub(crate) fn suspend(world: &mut WorldParts<'_>, forces: Vec<BodyForce>) -> Self {
        let dt = world.integration_parameters.dt;
        let mut before = Vec::with_capacity(forces.len());
        for BodyForce { handle, contact, external, is_link } in forces {
            let Some(body) = world.bodies.get_mut(handle) else { continue };
            before.push((handle, body.user_force(), body.user_torque()));
            if is_link {
                // Rapier computes the velocities of links from their joints: impulses on links are lost, forces are not.
                body.add_force(contact.linear.as_vec3(), false);
                body.add_torque(contact.angular.as_vec3(), false);
                continue;
            }
            let impulse = (contact + external) * f64::from(dt);
            body.apply_impulse(impulse.linear.as_vec3(), false);
            body.apply_torque_impulse(impulse.angular.as_vec3(), false);
            body.add_force(-external.linear.as_vec3(), false);
            body.add_torque(-external.angular.as_vec3(), false);
        }
        Self(before)
    }

    /// Gives the user's forces back, bit for bit.
    pub(crate) fn restore(self, world: &mut WorldParts<'_>) {
        for (handle, force, torque) in self.0 {
            // What Rapier took out of the simulation in this step has lost its forces by that.
            let enabled = |body: &&mut RigidBody| body.is_enabled();
            let Some(body) = world.bodies.get_mut(handle).filter(enabled) else { continue };
            body.reset_forces(false);
            body.reset_torques(false);
            body.add_force(force, false);
            body.add_torque(torque, false);
        }
    }
}
