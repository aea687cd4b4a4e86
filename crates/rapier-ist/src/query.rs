//! Contact samples of all candidate pairs, in the world frame.

use crate::arrival::{self, has_another, may_hold, shares};
use crate::candidates::Candidate;
use crate::containment::agree_on_direction;
use crate::dispatcher::with_workspace;
use crate::lookahead::Displacement;
use crate::{IstShape, against_shape};
use ist::{ContactSample, InnerSphereTree};
use rapier3d::geometry::ColliderSet;
use rapier3d::math::{Pose, Real};
use rapier3d::parry::shape::Shape;

/// Poses along the way that are left out between two at which a second contact is looked for: these are half a thickness apart then, and
/// a wall is two thick. With three left out bodies get out of drums that turn. The slowest 5 % of the pile's steps take 15.7, 14.5
/// and 17.7 ms or more (seeds 1 to 3), 16.1, 16.2 and 18.8 with none left out, 12.4, 13.8 and 17.0 without second contacts.
const SKIPPED: usize = 1;

/// A candidate that does overlap.
#[derive(Clone, Debug)]
pub(crate) struct Contact {
    pub(crate) candidate: Candidate,
    /// What leads from the bodies' poses to those at which the overlap was measured.
    pub(crate) displacements: [Displacement; 2],
    /// World frame; normals from the first collider to the second.
    pub(crate) samples: Vec<ContactSample>,
    /// Whether it is shallow, on the way, and over where the way was looked at next.
    pub(crate) is_graze: bool,
}

/// Runs the overlap query of every candidate, in parallel with feature `parallel`, and keeps the order. Tells the candidates
/// their clearance.
pub(crate) fn contacts(colliders: &ColliderSet, candidates: &mut [Candidate]) -> Vec<Option<Contact>> {
    let query = |candidate: &mut Candidate| contact(colliders, candidate);
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        candidates.par_iter_mut().map(query).collect()
    }
    #[cfg(not(feature = "parallel"))]
    {
        candidates.iter_mut().map(query).collect()
    }
}

/// The contact of a candidate at the end of the step, or earlier on the way where that is long.
fn contact(colliders: &ColliderSet, candidate: &mut Candidate) -> Option<Contact> {
    if candidate.is_distant {
        return None;
    }
    candidate.clearance = 0.0;
    let [a, b] = candidate.colliders.map(|handle| colliders.get(handle));
    let (a, b) = (a?, b?);
    let shapes = [a.shape(), b.shape()];
    let skin = a.contact_skin() + b.contact_skin();
    let with_skin = |tree: &InnerSphereTree| tree.with_skin(tree.skin() + skin);
    let solids = shapes.map(|shape| with_skin(shape.as_shape::<IstShape>()?.tree()));
    let mut found: Option<Contact> = None;
    let mut clearance = 0.0;
    let mut skipped = 0;
    // A contact that has just begun may be the rim of one: the next look decides.
    let mut is_shallow = false;
    for share in shares(shapes, candidate, skin) {
        let is_later = found.is_some() && !is_shallow;
        if is_later && skipped < SKIPPED && share < 1.0 {
            skipped += 1;
            continue;
        }
        skipped = 0;
        let displacements = candidate.displacements.map(|displacement| displacement.part(share));
        let poses = [0, 1].map(|i| displacements[i].apply(&candidate.poses[i]));
        let mut samples = Vec::new();
        clearance = measure((&solids, shapes), &poses, &mut samples);
        let is_wanted = match &found {
            Some(first) if is_later => has_another(shapes, candidate, share, [&first.samples, &samples]),
            _ => !samples.is_empty(),
        };
        if is_wanted {
            is_shallow = !is_later && arrival::is_shallow(shapes, candidate, &samples);
            found = Some(Contact { candidate: *candidate, displacements, samples, is_graze: false });
            if is_later || !is_shallow && !may_hold(shapes) {
                break;
            }
        } else if is_shallow {
            found.iter_mut().for_each(|contact| contact.is_graze = true);
            break;
        }
    }
    if found.is_none() {
        candidate.clearance = clearance;
    }
    found
}

/// Appends the contact samples of two shapes, of which one is an inner sphere tree, in the world frame. Of two trees
/// the second is taken without the contact skins, which the first one's include. Returns a distance (m) of which they are apart
/// where there are none.
fn measure(
    (solids, [a, b]): (&[Option<InnerSphereTree>; 2], [&dyn Shape; 2]),
    [pose_a, pose_b]: &[Pose; 2],
    samples: &mut Vec<ContactSample>,
) -> Real {
    match (&solids[0], b.as_shape::<IstShape>(), &solids[1]) {
        (Some(solid_a), Some(solid_b), _) => {
            let pose = pose_a.inv_mul(pose_b);
            let ((center_a, radius_a), (center_b, radius_b)) =
                (solid_a.bounding_ball(), solid_b.tree().bounding_ball());
            with_workspace(|workspace| {
                solid_a.flush_contact_samples(solid_b.tree(), &pose, &mut workspace.overlap, samples);
            });
            agree_on_direction([solid_a, solid_b.tree()], samples);
            to_world(samples, pose_a, 1.0);
            (center_a.distance(pose * center_b) - radius_a - radius_b).max(0.0)
        }
        (Some(solid_a), None, _) => {
            let clearance = against_shape::contact_samples(solid_a, b, &pose_a.inv_mul(pose_b), samples);
            to_world(samples, pose_a, 1.0);
            clearance
        }
        (None, _, Some(solid_b)) => {
            let clearance = against_shape::contact_samples(solid_b, a, &pose_b.inv_mul(pose_a), samples);
            to_world(samples, pose_b, -1.0);
            clearance
        }
        (None, _, None) => Real::INFINITY,
    }
}

/// Moves `samples` from a collider's frame to the world's and orients their normals.
fn to_world(samples: &mut [ContactSample], pose: &Pose, sign: Real) {
    for sample in samples {
        sample.point = *pose * sample.point;
        sample.normal = pose.rotation * sample.normal * sign;
        sample.vector_area = pose.rotation * sample.vector_area * sign;
        sample.outward = pose.rotation * sample.outward * sign;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ist::{InnerSphere, SolidProperties, SpherePacking};
    use rapier3d::math::{Rotation, Vector};
    use rapier3d::prelude::{Ball, HalfSpace};

    const RADIUS: Real = 0.1;

    fn tree() -> IstShape {
        let sphere = InnerSphere::solid_ball(Vector::ZERO, RADIUS, Vector::new(0.6, 0.0, 0.8));
        let solid = SolidProperties::ball(f64::from(RADIUS));
        IstShape::from_packing(&SpherePacking::new(vec![sphere], solid).unwrap())
    }

    fn samples(shapes: [&dyn Shape; 2], poses: &[Pose; 2]) -> Vec<ContactSample> {
        let solids = shapes.map(|shape| shape.as_shape::<IstShape>().map(|shape| shape.tree().clone()));
        let mut samples = Vec::new();
        measure((&solids, shapes), poses, &mut samples);
        samples
    }

    #[test]
    fn samples_turn_with_the_pair() {
        let turn = Pose::from_parts(Vector::new(3.0, -1.0, 2.0), Rotation::from_rotation_z(1.2));
        let poses = [
            Pose::from_parts(Vector::ZERO, Rotation::from_rotation_x(0.7)),
            Pose::from_parts(Vector::X * 0.06, Rotation::from_rotation_y(-0.4)),
        ];
        let (tree, ball, half_space) = (tree(), Ball::new(RADIUS), HalfSpace::new(Vector::NEG_X));
        let pairs: [[&dyn Shape; 2]; 4] =
            [[&tree, &tree], [&tree, &ball], [&ball, &tree], [&tree, &half_space]];
        for pair in pairs {
            let still = samples(pair, &poses);
            let turned = samples(pair, &poses.map(|pose| turn * pose));
            assert!(!still.is_empty() && still.len() == turned.len(), "{still:?} {turned:?}");
            for (before, after) in still.iter().zip(&turned) {
                let close = |a: Vector, b: Vector, size: Real| a.distance(b) < 1e-4 * size;
                assert!(close(turn * before.point, after.point, 1.0), "{before:?} {after:?}");
                assert!(close(turn.rotation * before.normal, after.normal, 1.0), "{before:?} {after:?}");
                assert!(close(turn.rotation * before.outward, after.outward, 1.0), "{before:?} {after:?}");
                let area = before.vector_area.length();
                assert!(
                    close(turn.rotation * before.vector_area, after.vector_area, area),
                    "{before:?} {after:?}"
                );
            }
        }
    }

    #[test]
    fn exchanged_shapes_exchange_their_normals() {
        let poses = [Pose::IDENTITY, Pose::from_parts(Vector::X * 0.12, Rotation::from_rotation_y(-0.4))];
        let (tree, ball) = (tree(), Ball::new(RADIUS));
        let (first, second) =
            (samples([&tree, &ball], &poses), samples([&ball, &tree], &[poses[1], poses[0]]));
        assert!(first.len() == 1 && second.len() == 1, "{first:?} {second:?}");
        assert!(first[0].normal.distance(-second[0].normal) < 1e-5, "{first:?} {second:?}");
        assert!(first[0].vector_area.distance(-second[0].vector_area) < 1e-6, "{first:?} {second:?}");
        assert!(first[0].outward.distance(-second[0].outward) < 1e-5, "{first:?} {second:?}");
        assert!(first[0].point.distance(second[0].point) < 1e-6, "{first:?} {second:?}");
    }
}
