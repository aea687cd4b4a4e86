//! The share of a patch in the wrench of its pair.

use super::patch::Patch;
use super::twist::{Screw, Symmetric6};
use rapier3d::glamx::DVec3;

/// What a patch contributes to the wrench of its pair.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PatchSum {
    /// Number of its samples.
    pub(super) count: usize,
    pub(crate) volume: f64,
    /// As reported (m): V/A within the extent of the overlap.
    pub(crate) depth: f64,
    /// From the origin of the pair to the centroid of the patch.
    pub(crate) arm: DVec3,
    pub(super) offset: Screw,
    pub(super) damping: Symmetric6,
}

impl PatchSum {
    /// Without a wrench yet; `arm` leads from the pair's origin to where a point of the predicted contact acts.
    pub(super) fn of(patch: &Patch<'_>, arm: impl Fn(DVec3) -> DVec3) -> Self {
        let volume: f64 = patch.samples.iter().map(|s| f64::from(s.volume)).sum();
        let moment: DVec3 = patch.samples.iter().map(|s| s.point.as_dvec3() * f64::from(s.volume)).sum();
        Self {
            count: patch.samples.len(),
            volume,
            depth: patch.depth.min(patch.extent),
            arm: arm(moment / volume.max(f64::MIN_POSITIVE)),
            offset: Screw::ZERO,
            damping: Symmetric6::ZERO,
        }
    }

    /// Wrench on b about the origin of the pair at the given relative twist.
    pub(crate) fn wrench(&self, twist: Screw) -> Screw {
        self.offset - self.damping * twist
    }
}
