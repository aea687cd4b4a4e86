//! Contact samples of all candidate pairs, in the world frame.

use crate::candidates::Candidate;
use crate::{IstShape, against_shape};
use ist::{ContactSample, OverlapWorkspace};
use rapier3d::geometry::ColliderSet;
use rapier3d::math::{Pose, Real};

/// A candidate that does overlap.
#[derive(Clone, Debug)]
pub(crate) struct Contact {
    pub(crate) candidate: Candidate,
    /// World frame; normals from the first collider to the second.
    pub(crate) samples: Vec<ContactSample>,
    /// Longest side (m) of the smaller collider's box, in its own frame.
    pub(crate) size: Real,
}

/// Runs the overlap query of every candidate, in parallel with feature `parallel`, and keeps the order.
pub(crate) fn contacts(colliders: &ColliderSet, candidates: &[Candidate]) -> Vec<Contact> {
    let query =
        |workspace: &mut OverlapWorkspace, candidate: &Candidate| contact(colliders, candidate, workspace);
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        candidates.par_iter().map_init(OverlapWorkspace::default, query).flatten_iter().collect()
    }
    #[cfg(not(feature = "parallel"))]
    {
        let mut workspace = OverlapWorkspace::default();
        candidates.iter().filter_map(|candidate| query(&mut workspace, candidate)).collect()
    }
}

fn contact(
    colliders: &ColliderSet,
    candidate: &Candidate,
    workspace: &mut OverlapWorkspace,
) -> Option<Contact> {
    let [pose_a, pose_b] = candidate.poses;
    let [a, b] = candidate.colliders.map(|handle| colliders.get(handle));
    let (a, b) = (a?.shape(), b?.shape());
    let mut samples = Vec::new();
    match (a.as_shape::<IstShape>(), b.as_shape::<IstShape>()) {
        (Some(solid_a), Some(solid_b)) => {
            let pose = pose_a.inv_mul(&pose_b);
            solid_a.tree().contact_samples(solid_b.tree(), &pose, workspace, &mut samples);
            to_world(&mut samples, &pose_a, 1.0);
        }
        (Some(solid_a), None) => {
            against_shape::contact_samples(solid_a, b, &pose_a.inv_mul(&pose_b), &mut samples);
            to_world(&mut samples, &pose_a, 1.0);
        }
        (None, Some(solid_b)) => {
            against_shape::contact_samples(solid_b, a, &pose_b.inv_mul(&pose_a), &mut samples);
            to_world(&mut samples, &pose_b, -1.0);
        }
        (None, None) => return None,
    }
    let longest =
        |shape: &dyn rapier3d::parry::shape::Shape| shape.compute_local_aabb().extents().max_element();
    let size = longest(a).min(longest(b));
    (!samples.is_empty()).then_some(Contact { candidate: *candidate, samples, size })
}

/// Moves `samples` from a collider's frame to the world's and orients their normals.
fn to_world(samples: &mut [ContactSample], pose: &Pose, sign: Real) {
    for sample in samples {
        sample.point = *pose * sample.point;
        sample.normal = pose.rotation * sample.normal * sign;
        sample.separation = pose.rotation * sample.separation * sign;
    }
}
