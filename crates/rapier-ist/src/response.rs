//! From pairs that may touch to forces on bodies.

use crate::bodies::Bodies;
use crate::candidates::Candidate;
use crate::contact_law::ContactLaw;
use crate::memory::Memory;
use crate::penalty::{JointForces, JointWrench, PairContacts, Screw, SolverBody};
use crate::query::{Contact, contacts};
use crate::remeasure::remeasure;
use crate::solution::{Solution, Solved, Start, solve};
use crate::user_forces::{BodyForce, JointForce, Pushes};
use crate::waking::wake_touched_bodies;
use crate::{ContactState, PairContact, PatchContact, StepReport, WorldParts};
use rapier3d::math::Real;
use std::time::Instant;

/// Solves for the contact forces of one step and reports them pair by pair.
pub(crate) fn respond(
    world: &mut WorldParts<'_>,
    mut candidates: Vec<Candidate>,
    law: ContactLaw<'_>,
    (report, memory): (&mut StepReport, &mut Memory),
) -> Pushes {
    let dt = f64::from(world.integration_parameters.dt);
    for candidate in &mut candidates {
        candidate.touched = memory.contains_key(&candidate.colliders);
    }
    let mut found = timed(&mut report.query_seconds, || contacts(world.colliders, &mut candidates));
    if candidates.is_empty() || dt.is_nan() || dt <= 0.0 {
        memory.clear();
        return Pushes::default();
    }
    wake_touched_bodies(world, &found);
    let bodies = Bodies::new(world, &candidates);
    let mut states: Vec<Screw> = bodies.states.iter().map(|state| state.unchanged).collect();
    let mut known: Vec<Option<PairContacts>> = vec![None; found.len()];
    // How contacts began is known from the steps before, the forces from the last solve.
    let before = std::mem::take(memory);
    *memory = before.iter().map(|(pair, known)| (*pair, known.next())).collect();
    let (mut round, mut rounds) = (1, MAX_ROUNDS);
    let mut solution = loop {
        let touching: Vec<&Contact> = found.iter().flatten().collect();
        let known_touching =
            known.drain(..).zip(&found).filter_map(|(known, found)| found.as_ref().map(|_| known));
        let start = Start { states: &states, known: known_touching.collect(), memories: [&before, memory] };
        let solution = timed(&mut report.solve_seconds, || solve(world, &bodies, &touching, start, law));
        solution.remember(&touching, memory);
        if round == rounds {
            break solution;
        }
        let stale = solution.stale(world, &bodies, &mut candidates, &found);
        let anew = timed(&mut report.query_seconds, || {
            remeasure(world.colliders, &solution, stale, (&mut candidates, &found))
        });
        if anew.is_empty() && !solution.has_rebounds() {
            break solution;
        }
        states.clone_from(&solution.states);
        let mut solved = solution.into_contacts();
        known.extend(found.iter().map(|found| found.as_ref().and_then(|_| solved.next().flatten())));
        drop(solved);
        if anew.iter().any(|(index, _)| found[*index].is_none()) {
            rounds = MAX_ROUNDS + 1;
        }
        for (index, next) in anew {
            (found[index], known[index]) = (Some(next), None);
        }
        round += 1;
    };
    let touching: Vec<&Contact> = found.iter().flatten().collect();
    if solution.make_passive() {
        solution.remember(&touching, memory);
    }
    collect(&bodies, solution, (&touching, dt), report)
}

/// Adds the wall time of `work` (s) to `seconds`.
fn timed<T>(seconds: &mut f64, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let done = work();
    *seconds += start.elapsed().as_secs_f64();
    done
}

/// Most measurements of the overlaps in a step; one more where something is pushed into what it did not touch.
///
/// A cube flies at 20 m/s against a row of five, 3 and 10 cm apart: without the one more the first in the row is passed.
///
/// Six rings fall on each other from 1 cm each, 3,000 spheres, 20 kg/m³: with one round they slide off each other from
/// 1e7 N/m³ on, with two at 1e8 in some runs, with three and four they stand at all of 1e4 to 1e8.
const MAX_ROUNDS: usize = 3;

/// Sums the wrenches per body, in the order of the pairs, and writes the report.
///
/// Where an island's system is too stiff to be solved, the sums are what is left of forces that should cancel: of some 1e10 N
/// on bodies of 0.5 kg, off by as much. Bodies then get the velocities that the iteration has come to, each step of which is
/// nearer to the solution.
fn collect(
    bodies: &Bodies,
    Solution { pairs, solved, states, is_solved, joint_wrenches, mut touches, joints }: Solution,
    (contacts, dt): (&[&Contact], f64),
    report: &mut StepReport,
) -> Pushes {
    let mut sums = vec![Screw::ZERO; bodies.states.len()];
    // Links of one multibody move together.
    let touched: Vec<_> = (0..bodies.handles.len())
        .filter(|&i| touches[i])
        .filter_map(|i| bodies.links[i])
        .map(|link| link.multibody)
        .collect();
    for (touches, link) in touches.iter_mut().zip(&bodies.links) {
        *touches |= link.is_some_and(|link| touched.contains(&link.multibody));
    }
    for Solved { pair, contacts: solved, twist, mut relative_velocity, .. } in solved {
        relative_velocity.linear += solved.turning;
        let (origin, wrench) = (solved.origin, solved.wrench(twist));
        let mut of_patches = solved.patches.iter().flat_map(|patch| {
            [patch.wrench(twist).wrench_from(-patch.arm), relative_velocity.twist_at(patch.arm)]
        });
        let mut places = solved.patches.iter().map(|patch| origin + patch.arm).chain([origin]);
        let fits = wrench.fits_f32()
            && relative_velocity.fits_f32()
            && of_patches.all(Screw::fits_f32)
            && places.all(|place| place.as_vec3().is_finite());
        if !fits {
            continue;
        }
        let [a, b] = pairs[pair];
        sums[b] += wrench.wrench_from(origin - bodies.states[b].center_of_mass);
        sums[a] += -wrench.wrench_from(origin - bodies.states[a].center_of_mass);
        report.patches.extend(solved.patches.iter().zip(solved.pushes()).map(|(patch, push)| {
            let wrench = patch.wrench(twist);
            PatchContact {
                pair: report.contacts.len(),
                volume: patch.volume as Real,
                depth: patch.depth as Real,
                centroid: (origin + patch.arm).as_vec3(),
                normal: push.normalize_or_zero().as_vec3(),
                force: wrench.linear.as_vec3(),
                torque: wrench.wrench_from(-patch.arm).angular.as_vec3(),
                relative_velocity: relative_velocity.twist_at(patch.arm).linear.as_vec3(),
            }
        }));
        report.contacts.push(PairContact {
            collider_a: contacts[pair].candidate.colliders[0],
            collider_b: contacts[pair].candidate.colliders[1],
            state: ContactState::Started,
            volume: contacts[pair].samples.iter().map(|s| s.volume).sum(),
            depth: solved.depth as Real,
            centroid: origin.as_vec3(),
            force: wrench.linear.as_vec3(),
            torque: wrench.angular.as_vec3(),
            relative_velocity: relative_velocity.linear.as_vec3(),
        });
    }
    let moved = (0..bodies.handles.len()).filter(|&i| touches[i] && bodies.states[i].is_movable());
    let force = |i: usize| {
        let body = &bodies.states[i];
        let joints = joint_wrenches[i];
        let last = body.impulse_of(states[i]) * (1.0 / dt);
        let contact = if is_solved[i] || !last.fits_f32() { sums[i] } else { last - joints.solved };
        let again = joints.again + joints.support * support_share(body, joints);
        let (beyond, held) = (joints.solved - again, body.external + again);
        let (joints, held) = if held.fits_f32() { (beyond, held) } else { (Screw::ZERO, body.external) };
        Some(BodyForce { handle: bodies.handles[i]?, contact, joints, held, link: bodies.links[i] })
    };
    let joint_forces = |(index, forces): (usize, JointForces)| {
        let handle = bodies.joints[index].impulse?;
        Some(JointForce { handle, rows: forces.applied().collect() })
    };
    let joints = joints.into_iter().filter_map(joint_forces).collect();
    Pushes { bodies: moved.filter_map(force).collect(), joints }
}

/// What a body is held against at most, with the support of Rapier's contacts, in parts of what it is held against without.
///
/// Rapier's contacts then carry, and tell, what lies on a body up to a load of some times its weight. The largest speed of light links in ropes
/// whose end lies on the ground is 2.4, 0.8, 0.9, 1.5 and 2.5 m/s with 1, 2, 4, 10 and 100, and with no bound they are thrown about:
/// held against what has stopped them, they have to be stopped again.
const MOST_HELD: f64 = 4.0;

/// The share of what Rapier's contacts do that a body is held against.
fn support_share(body: &SolverBody, joints: JointWrench) -> f64 {
    let [rest, support] =
        [body.external + joints.again, joints.support].map(|wrench| body.root_transpose_times(wrench));
    let size = support.dot(support);
    // From the share by which it is held least.
    let least = -rest.dot(support) / size;
    let further = least * least + (MOST_HELD * MOST_HELD - 1.0) * rest.dot(rest) / size;
    let share = least + further.sqrt();
    if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rapier3d::glamx::DVec3;

    fn vector() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-10.0_f64..10.0).prop_map(DVec3::from)
    }

    proptest! {
        /// And what stands is held by nothing.
        #[test]
        fn bodies_are_held_by_little(external in vector(), support in vector(), inverse_mass in 0.01_f64..100.0) {
            let linear = |linear| Screw { linear, ..Screw::ZERO };
            let body = SolverBody {
                root_linear: DVec3::splat(inverse_mass.sqrt()),
                external: linear(external),
                ..SolverBody::FIXED
            };
            let share = |support| support_share(&body, JointWrench { support: linear(support), ..JointWrench::ZERO });
            let held = external + support * share(support);
            prop_assert!((0.0..=1.0).contains(&share(support)));
            prop_assert!(held.length() <= MOST_HELD * external.length() * (1.0 + 1e-9));
            prop_assert_eq!(share(-external), 1.0);
            prop_assert_eq!(share(-external * 0.5), 1.0);
            prop_assert_eq!(share(DVec3::ZERO), 0.0);
        }
    }
}
