//! From a solve to its report and the forces on bodies.

use crate::bodies::Bodies;
use crate::penalty::{JointWrench, Screw, SolverBody};
use crate::query::Contact;
use crate::solution::{Solution, Solved};
use crate::user_forces::{BodyForce, JointForce, Pushes};
use crate::{ContactState, PairContact, PatchContact, StepReport};
use rapier3d::glamx::DVec3;
use rapier3d::math::Real;

/// Writes the report of `contacts`, those that were solved, and returns what bodies and joints get in a step of `dt` seconds.
///
/// Where an island's system is too stiff to be solved, the sums of wrenches are what is left of forces that should cancel: of some
/// 1e10 N on bodies of 0.5 kg, off by as much. Bodies then get the velocities that the iteration has come to, each step of which
/// is nearer to the solution.
pub(crate) fn collect(
    bodies: &Bodies,
    solution: Solution,
    (contacts, dt): (&[&Contact], f64),
    report: &mut StepReport,
) -> Pushes {
    let mut sums = vec![Screw::ZERO; bodies.states.len()];
    for solved in &solution.solved {
        let Some((origin, wrench)) = enter(solved, contacts[solved.pair], report) else { continue };
        let [a, b] = solution.pairs[solved.pair];
        sums[b] += wrench.wrench_from(origin - bodies.states[b].center_of_mass);
        sums[a] += -wrench.wrench_from(origin - bodies.states[a].center_of_mass);
    }
    let touches = with_all_links(bodies, solution.touches);
    let moved = (0..bodies.handles.len()).filter(|&i| touches[i] && bodies.states[i].is_movable());
    let force = |i: usize| {
        let body = &bodies.states[i];
        let joints = solution.joint_wrenches[i];
        let last = body.impulse_of(solution.states[i]) * (1.0 / dt);
        let contact = if solution.is_solved[i] || !last.fits_f32() { sums[i] } else { last - joints.solved };
        let again = joints.again + joints.support * support_share(body, joints);
        let (beyond, held) = (joints.solved - again, body.external + again);
        let (joints, held) = if held.fits_f32() { (beyond, held) } else { (Screw::ZERO, body.external) };
        Some(BodyForce { handle: bodies.handles[i]?, contact, joints, held, link: bodies.links[i] })
    };
    let joints = solution.joints.into_iter().filter_map(|(index, forces)| {
        let handle = bodies.joints[index].impulse?;
        Some(JointForce { handle, rows: forces.applied().collect() })
    });
    Pushes { bodies: moved.filter_map(force).collect(), joints: joints.collect() }
}

/// Enters a pair and its patches into the report, and returns where its wrench on the second body acts; nothing of what does not fit
/// into f32.
fn enter(solved: &Solved, contact: &Contact, report: &mut StepReport) -> Option<(DVec3, Screw)> {
    let Solved { ref contacts, twist, mut relative_velocity, .. } = *solved;
    relative_velocity.linear += contacts.turning;
    let (origin, wrench) = (contacts.origin, contacts.wrench(twist));
    let of_patches = contacts.patches.iter().flat_map(|patch| {
        [patch.wrench(twist).wrench_from(-patch.arm), relative_velocity.twist_at(patch.arm)]
    });
    let mut screws = of_patches.chain([wrench, relative_velocity]);
    let mut places = contacts.patches.iter().map(|patch| origin + patch.arm).chain([origin]);
    if !screws.all(Screw::fits_f32) || !places.all(|place| place.as_vec3().is_finite()) {
        return None;
    }
    report.patches.extend(contacts.patches.iter().zip(contacts.pushes()).map(|(patch, push)| {
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
        collider_a: contact.candidate.colliders[0],
        collider_b: contact.candidate.colliders[1],
        state: ContactState::Started,
        volume: contact.samples.iter().map(|s| s.volume).sum(),
        depth: contacts.depth as Real,
        centroid: origin.as_vec3(),
        force: wrench.linear.as_vec3(),
        torque: wrench.angular.as_vec3(),
        relative_velocity: relative_velocity.linear.as_vec3(),
    });
    Some((origin, wrench))
}

/// Which bodies touch something, with all links of multibodies of which one does: they move together.
fn with_all_links(bodies: &Bodies, mut touches: Vec<bool>) -> Vec<bool> {
    let touched: Vec<_> = (0..bodies.handles.len())
        .filter(|&i| touches[i])
        .filter_map(|i| bodies.links[i])
        .map(|link| link.multibody)
        .collect();
    for (touches, link) in touches.iter_mut().zip(&bodies.links) {
        *touches |= link.is_some_and(|link| touched.contains(&link.multibody));
    }
    touches
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
