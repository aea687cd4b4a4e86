//! Contact samples of all candidate pairs, in the world frame.

use crate::arrival::shares;
use crate::candidates::Candidate;
use crate::containment::agree_on_direction;
use crate::lookahead::Displacement;
use crate::{IstShape, against_shape};
use ist::{ContactSample, InnerSphereTree, OverlapWorkspace};
use rapier3d::geometry::ColliderSet;
use rapier3d::math::{Pose, Real};
use rapier3d::parry::shape::Shape;

/// A candidate that does overlap.
#[derive(Clone, Debug)]
pub(crate) struct Contact {
    pub(crate) candidate: Candidate,
    /// What leads from the bodies' poses to those at which the overlap was measured.
    pub(crate) displacements: [Displacement; 2],
    /// World frame; normals from the first collider to the second.
    pub(crate) samples: Vec<ContactSample>,
}

/// Runs the overlap query of every candidate, in parallel with feature `parallel`, and keeps the order.
pub(crate) fn contacts(colliders: &ColliderSet, candidates: &[Candidate]) -> Vec<Option<Contact>> {
    let query =
        |workspace: &mut OverlapWorkspace, candidate: &Candidate| contact(colliders, candidate, workspace);
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        candidates.par_iter().map_init(OverlapWorkspace::default, query).collect()
    }
    #[cfg(not(feature = "parallel"))]
    {
        let mut workspace = OverlapWorkspace::default();
        candidates.iter().map(|candidate| query(&mut workspace, candidate)).collect()
    }
}

/// The contact of a candidate at the end of the step, or earlier on the way where that is long.
fn contact(
    colliders: &ColliderSet,
    candidate: &Candidate,
    workspace: &mut OverlapWorkspace,
) -> Option<Contact> {
    let [a, b] = candidate.colliders.map(|handle| colliders.get(handle));
    let (a, b) = (a?, b?);
    let shapes = [a.shape(), b.shape()];
    let skin = a.contact_skin() + b.contact_skin();
    let solids = shapes.map(|shape| shape.as_shape::<IstShape>()?.tree().with_skin(skin));
    let mut samples = Vec::new();
    let displacements = shares(shapes, candidate, skin).find_map(|share| {
        let displacements = candidate.displacements.map(|displacement| displacement.part(share));
        let poses = [0, 1].map(|i| displacements[i].apply(&candidate.poses[i]));
        measure((&solids, shapes), &poses, workspace, &mut samples);
        (!samples.is_empty()).then_some(displacements)
    })?;
    Some(Contact { candidate: *candidate, displacements, samples })
}

/// Appends the contact samples of two shapes, of which one is an inner sphere tree, in the world frame. Of two trees
/// the second is taken without its skin, which the first one's includes.
fn measure(
    (solids, [a, b]): (&[Option<InnerSphereTree>; 2], [&dyn Shape; 2]),
    [pose_a, pose_b]: &[Pose; 2],
    workspace: &mut OverlapWorkspace,
    samples: &mut Vec<ContactSample>,
) {
    match (&solids[0], b.as_shape::<IstShape>(), &solids[1]) {
        (Some(solid_a), Some(solid_b), _) => {
            solid_a.contact_samples(solid_b.tree(), &pose_a.inv_mul(pose_b), workspace, samples);
            agree_on_direction([solid_a, solid_b.tree()], samples);
            to_world(samples, pose_a, 1.0);
        }
        (Some(solid_a), None, _) => {
            against_shape::contact_samples(solid_a, b, &pose_a.inv_mul(pose_b), samples);
            to_world(samples, pose_a, 1.0);
        }
        (None, _, Some(solid_b)) => {
            against_shape::contact_samples(solid_b, a, &pose_b.inv_mul(pose_a), samples);
            to_world(samples, pose_b, -1.0);
        }
        (None, _, None) => {}
    }
}

/// Moves `samples` from a collider's frame to the world's and orients their normals.
fn to_world(samples: &mut [ContactSample], pose: &Pose, sign: Real) {
    for sample in samples {
        sample.point = *pose * sample.point;
        sample.normal = pose.rotation * sample.normal * sign;
        sample.separation = pose.rotation * sample.separation * sign;
    }
}
