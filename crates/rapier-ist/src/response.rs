//! From overlapping pairs to forces on bodies.

use crate::candidates::Candidate;
use crate::lookahead::Displacement;
use crate::memory::{Memory, PairMemory};
use crate::penalty::{Island, Material, PairContacts, Screw, SolverBody, islands};
use crate::query::{Contact, contacts};
use crate::{PairContact, StepReport, Stiffness, VolumePenalty, WorldParts};
use rapier3d::dynamics::{CoefficientCombineRule, RigidBody, RigidBodyHandle};
use rapier3d::geometry::Collider;
use rapier3d::math::{Real, Vector};
use std::time::Instant;

/// Stiffness of [`Stiffness::Automatic`] in units of weight per cubed size; see [`automatic_stiffness`].
///
/// With 5e4 the pile example (seeds 1 to 4) is asleep within 10 s and no exact mesh is deeper in another than 1.6 to
/// 2.2 % of the smaller body. Before contacts were measured
/// at the present velocity, 2e4 left up to 7.6 %, and from 2e5 on some bodies kept creeping at a few cm/s.
const RELATIVE_STIFFNESS: f64 = 5e4;

/// Approach speed (m/s, times `length_unit`) under which nothing rebounds, so that resting bodies come to rest: a little
/// more than gravity adds in a step of 1/60 s. Not tuned.
const REBOUND_SPEED: f64 = 0.2;

/// Overlap pushes no faster than by the smaller body's longest side in this time (s).
///
/// A bunny of 0.2 m inside one of 1 m gets out of all 73 poses: at up to 24 rad/s without this limit, 20 with 0.3 s and 17 with 0.4 s.
const RECOVERY_TIME: f64 = 0.4;

/// Speed (m/s, times `length_unit`) of a contact point from which on it wakes a sleeping body.
const WAKE_SPEED: f64 = 0.05;

/// What the contacts do to one body in a step, about its centre of mass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BodyForce {
    handle: RigidBodyHandle,
    /// Mean contact force (N) and torque (N·m).
    contact: Screw,
    /// Gravity and the user's own force and torque.
    external: Screw,
}

/// Solves for the contact forces of one step and reports them pair by pair.
pub(crate) fn respond(
    world: &mut WorldParts<'_>,
    mut candidates: Vec<Candidate>,
    penalty: &VolumePenalty,
    (report, memory): (&mut StepReport, &mut Memory),
) -> Vec<BodyForce> {
    let dt = f64::from(world.integration_parameters.dt);
    let mut found = timed(&mut report.query_seconds, || contacts(world.colliders, &candidates));
    if found.iter().all(Option::is_none) || dt.is_nan() || dt <= 0.0 {
        memory.clear();
        return Vec::new();
    }
    wake_touched_bodies(world, &found);
    let bodies = Bodies::new(world, &candidates);
    let mut start: Vec<Screw> = bodies.states.iter().map(|state| state.unchanged).collect();
    // How contacts began is known from the steps before, the forces from the last solve.
    let before = std::mem::take(memory);
    *memory = before.clone();
    let mut round = 1;
    let solution = loop {
        let touching: Vec<&Contact> = found.iter().flatten().collect();
        let solution = timed(&mut report.solve_seconds, || {
            solve(world, (&bodies, &start), (&touching, &before, memory), penalty)
        });
        solution.remember(&touching, memory);
        if round == MAX_ROUNDS {
            break solution;
        }
        let stale = solution.stale(world, &bodies, &mut candidates, &found);
        let moved: Vec<Candidate> = stale.iter().map(|&index| candidates[index]).collect();
        let next = timed(&mut report.query_seconds, || contacts(world.colliders, &moved));
        // Where nothing overlaps any more the tangent that pushed the pair apart still holds.
        let mut anew: Vec<_> = stale.into_iter().zip(next).filter(|(_, next)| next.is_some()).collect();
        if anew.is_empty() && !solution.solved.iter().any(|pair| pair.should_rebound) {
            break solution;
        }
        for (index, next) in anew.drain(..) {
            found[index] = next;
        }
        start = solution.states;
        round += 1;
    };
    let touching: Vec<&Contact> = found.iter().flatten().collect();
    collect(&bodies, &solution, &touching, &mut report.contacts)
}

/// Adds the wall time of `work` (s) to `seconds`.
fn timed<T>(seconds: &mut f64, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let done = work();
    *seconds += start.elapsed().as_secs_f64();
    done
}

/// Most measurements of the overlaps in a step.
///
/// Six rings fall on each other from 1 cm each, 3,000 spheres, 20 kg/m³: with one round they slide off each other from
/// 1e7 N/m³ on, with two at 1e8 in some runs, with three and four they stand at all of 1e4 to 1e8.
const MAX_ROUNDS: usize = 3;

/// The pairs after a solve, and the velocities of the bodies that it found.
struct Solution {
    pairs: Vec<[usize; 2]>,
    solved: Vec<Solved>,
    /// The unknowns of all bodies.
    states: Vec<Screw>,
}

/// A contact is measured again where it moved by more than this share of its depth from where it was measured.
const STALE: f64 = 0.25;

/// A pair that did not touch is looked at again where it moved by more than this share of its size from where it was.
const STALE_GAP: f64 = 1e-3;

impl Solution {
    /// Replaces what is remembered of all pairs.
    fn remember(&self, contacts: &[&Contact], memory: &mut Memory) {
        memory.clear();
        memory.extend(self.solved.iter().map(|s| (contacts[s.pair].candidate.colliders, s.memory)));
    }

    /// Candidates that do not end up near the poses at which they were measured; moves them there.
    fn stale(
        &self,
        world: &WorldParts<'_>,
        bodies: &Bodies,
        candidates: &mut [Candidate],
        found: &[Option<Contact>],
    ) -> Vec<usize> {
        let dt = f64::from(world.integration_parameters.dt);
        let displacement = |body: usize| {
            let state = &bodies.states[body];
            Displacement::new(
                state.center_of_mass,
                (state.predicted + state.root_times(self.states[body])) * dt,
            )
        };
        let mut strains = vec![0.0; candidates.len()];
        let touching = (0..found.len()).filter(|&index| found[index].is_some());
        for (solved, index) in self.solved.iter().zip(touching) {
            strains[index] = solved.strain;
        }
        let mut stale = Vec::new();
        for (index, candidate) in candidates.iter_mut().enumerate() {
            let displacements = bodies.pair(world, candidate).map(displacement);
            let far = match found[index] {
                Some(_) => strains[index] > STALE,
                None => {
                    let [a, b] = [0, 1].map(|i| displacements[i] - candidate.displacements[i]);
                    a.reach(&b, candidate.size) > STALE_GAP * f64::from(candidate.size)
                }
            };
            if far {
                candidate.displacements = displacements;
                stale.push(index);
            }
        }
        stale
    }
}

fn solve(
    world: &WorldParts<'_>,
    (bodies, start): (&Bodies, &[Screw]),
    (contacts, before, memory): (&[&Contact], &Memory, &Memory),
    penalty: &VolumePenalty,
) -> Solution {
    let dt = f64::from(world.integration_parameters.dt);
    let pairs: Vec<[usize; 2]> =
        contacts.iter().map(|contact| bodies.pair(world, &contact.candidate)).collect();
    let movable: Vec<bool> = bodies.states.iter().map(SolverBody::is_movable).collect();
    let inputs: Vec<(Material, PairMemory)> = contacts
        .iter()
        .map(|contact| {
            let of = |memory: &Memory| memory.get(&contact.candidate.colliders).copied().unwrap_or_default();
            let memory = PairMemory { impact: of(before).impact, ..of(memory) };
            (material(world, contact, penalty), memory)
        })
        .collect();
    let islands = islands(&pairs, &movable);
    let solve =
        |members: &Vec<usize>| solve_island((bodies, start), members, &pairs, (contacts, &inputs), dt);
    #[cfg(feature = "parallel")]
    let solved: Vec<_> = {
        use rayon::prelude::*;
        islands.par_iter().map(solve).collect()
    };
    #[cfg(not(feature = "parallel"))]
    let solved: Vec<_> = islands.iter().map(solve).collect();
    let mut states: Vec<Screw> = vec![Screw::ZERO; bodies.states.len()];
    let mut all = Vec::with_capacity(pairs.len());
    for (pairs, island) in solved {
        all.extend(pairs);
        for (body, state) in island {
            states[body] = state;
        }
    }
    all.sort_unstable_by_key(|solved| solved.pair);
    Solution { pairs, solved: all, states }
}

/// The bodies that take part, each once, in the order of the contacts. Index 0 is the world itself.
struct Bodies {
    handles: Vec<Option<RigidBodyHandle>>,
    states: Vec<SolverBody>,
}

impl Bodies {
    fn new(world: &WorldParts<'_>, candidates: &[Candidate]) -> Self {
        let colliders = candidates.iter().flat_map(|candidate| candidate.colliders);
        let mut handles: Vec<_> = colliders.filter_map(|c| world.colliders.get(c)?.parent()).collect();
        handles.sort_unstable_by_key(|handle| handle.into_raw_parts());
        handles.dedup();
        let state = |handle: &RigidBodyHandle| {
            let body = &world.bodies[*handle];
            let movable = body.is_dynamic() && !body.is_sleeping() && body.is_enabled();
            SolverBody::new(body, movable, world.gravity, world.integration_parameters.dt)
        };
        let states = std::iter::once(SolverBody::FIXED).chain(handles.iter().map(state)).collect();
        Self { handles: std::iter::once(None).chain(handles.into_iter().map(Some)).collect(), states }
    }

    fn pair(&self, world: &WorldParts<'_>, candidate: &Candidate) -> [usize; 2] {
        candidate.colliders.map(|collider| {
            let parent = world.colliders.get(collider).and_then(Collider::parent);
            let key = parent.map(RigidBodyHandle::into_raw_parts);
            self.handles.binary_search_by_key(&key, |h| h.map(RigidBodyHandle::into_raw_parts)).unwrap_or(0)
        })
    }
}

/// One pair after the solve: its index, its point of reference and the wrench on its second body about that.
struct Solved {
    pair: usize,
    origin: rapier3d::glamx::DVec3,
    depth: f64,
    wrench: Screw,
    relative_velocity: Screw,
    memory: PairMemory,
    should_rebound: bool,
    /// How far from where it was measured the contact ends up, in units of its depth.
    strain: f64,
}

fn solve_island(
    (bodies, start): (&Bodies, &[Screw]),
    members: &[usize],
    pairs: &[[usize; 2]],
    (contacts, inputs): (&[&Contact], &[(Material, PairMemory)]),
    dt: f64,
) -> (Vec<Solved>, Vec<(usize, Screw)>) {
    let mut used: Vec<usize> = members.iter().flat_map(|&pair| pairs[pair]).collect();
    used.sort_unstable();
    used.dedup();
    let local = |body: usize| used.binary_search(&body).unwrap_or(0);
    let contacts = members.iter().map(|&pair| {
        let states = pairs[pair].map(|body| &bodies.states[body]);
        PairContacts::new(pairs[pair].map(local), states, inputs[pair], contacts[pair], dt)
    });
    let contacts = contacts.collect();
    let mut island = Island::new(
        used.iter().map(|&body| bodies.states[body]).collect(),
        contacts,
        used.iter().map(|&body| start[body]).collect(),
    );
    island.solve(dt);
    let solved = members.iter().enumerate().map(|(index, &pair)| Solved {
        pair,
        origin: island.pairs[index].origin,
        depth: island.pairs[index].depth,
        wrench: island.pair_wrench(index),
        memory: island.pairs[index].memory(island.pair_twist(index)),
        should_rebound: island.pairs[index].should_rebound(island.pair_twist(index)),
        strain: island.pairs[index].strain(island.pair_twist(index)),
        relative_velocity: island.pairs[index].relative_twist(&island.bodies, |i| island.bodies[i].velocity),
    });
    let solved = solved.collect();
    (solved, used.iter().enumerate().map(|(i, &body)| (body, island.state(i))).collect())
}

/// Sums the wrenches per body, in the order of the pairs, and writes the report.
fn collect(
    bodies: &Bodies,
    Solution { pairs, solved, .. }: &Solution,
    contacts: &[&Contact],
    report: &mut Vec<PairContact>,
) -> Vec<BodyForce> {
    let solved: Vec<&Solved> = solved.iter().filter(|s| s.wrench.is_finite()).collect();
    let mut sums = vec![Screw::ZERO; bodies.states.len()];
    for &&Solved { pair, origin, depth, wrench, relative_velocity, .. } in &solved {
        let [a, b] = pairs[pair];
        sums[b] += wrench.wrench_from(origin - bodies.states[b].center_of_mass);
        sums[a] += -wrench.wrench_from(origin - bodies.states[a].center_of_mass);
        report.push(PairContact {
            collider_a: contacts[pair].candidate.colliders[0],
            collider_b: contacts[pair].candidate.colliders[1],
            volume: contacts[pair].samples.iter().map(|s| s.volume).sum(),
            depth: depth as Real,
            centroid: origin.as_vec3(),
            force: wrench.linear.as_vec3(),
            torque: wrench.angular.as_vec3(),
            relative_velocity: relative_velocity.linear.as_vec3(),
        });
    }
    let moved = (0..sums.len()).filter(|&i| bodies.states[i].is_movable());
    let force = |i: usize| {
        Some(BodyForce { handle: bodies.handles[i]?, contact: sums[i], external: bodies.states[i].external })
    };
    moved.filter_map(force).collect()
}

fn material(world: &WorldParts<'_>, contact: &Contact, penalty: &VolumePenalty) -> Material {
    let [a, b] = contact.candidate.colliders.map(|handle| world.colliders[handle].material());
    let combine = CoefficientCombineRule::combine;
    let unit = f64::from(world.integration_parameters.length_unit);
    let stiffness = match penalty.stiffness {
        Stiffness::Automatic => automatic_stiffness(world, contact),
        Stiffness::Uniform(stiffness) => f64::from(stiffness.max(0.0)),
    };
    Material {
        stiffness,
        dissipation: f64::from(penalty.dissipation.max(0.0)),
        friction: combine(a.friction, b.friction, a.friction_combine_rule, b.friction_combine_rule)
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
        recovery_speed: (f64::from(penalty.recovery_speed) * unit)
            .min(f64::from(contact.candidate.size) / RECOVERY_TIME)
            .max(f64::MIN_POSITIVE),
        rebound_speed: REBOUND_SPEED * unit,
    }
}

/// Stiffness (N/m³) at which the lighter body's weight makes it sink by a small share of the smaller body's size L:
/// weight = k A d, with the contact's cross-section A and depth d in units of L² and L.
fn automatic_stiffness(world: &WorldParts<'_>, contact: &Contact) -> f64 {
    let mass = |handle| {
        let body = world.bodies.get(world.colliders.get(handle)?.parent()?).filter(|b| b.is_dynamic())?;
        Some(f64::from(body.mass()))
    };
    let lighter = contact.candidate.colliders.into_iter().filter_map(mass).fold(f64::INFINITY, f64::min);
    let unit = f64::from(world.integration_parameters.length_unit);
    // Without gravity something must stop a body all the same: a metre per second squared, in units of length.
    let gravity = f64::from(world.gravity.length()).max(unit);
    let size = f64::from(contact.candidate.size);
    let stiffness = RELATIVE_STIFFNESS * lighter * gravity / (size * size * size);
    if stiffness.is_finite() { stiffness } else { 0.0 }
}

/// Wakes sleeping bodies that something moving touches.
fn wake_touched_bodies(world: &mut WorldParts<'_>, contacts: &[Option<Contact>]) {
    let speed = WAKE_SPEED as Real * world.integration_parameters.length_unit;
    for contact in contacts.iter().flatten() {
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
        for BodyForce { handle, contact, external } in forces {
            let Some(body) = world.bodies.get_mut(handle) else { continue };
            before.push((handle, body.user_force(), body.user_torque()));
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
            let Some(body) = world.bodies.get_mut(handle) else { continue };
            body.reset_forces(false);
            body.reset_torques(false);
            body.add_force(force, false);
            body.add_torque(torque, false);
        }
    }
}
