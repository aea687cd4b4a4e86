//! Overlap of two solids.

mod caps;
mod force_law;
pub(crate) mod lens_lanes;
pub(crate) mod pairs;
pub(crate) mod relative_pose;
mod samples;
pub(crate) mod totals;
pub(crate) mod traversal;
pub(crate) mod workspace;

use crate::InnerSphereTree;
use alloc::vec::Vec;
pub use caps::SurfaceDistance;
use fearless_simd::{Level, dispatch};
pub use force_law::ForceLaw;
use glam::Vec3;
use glamx::Pose3;
use relative_pose::RelativePose;
pub use samples::ContactSample;
use totals::{Totals, TotalsSink};
use traversal::for_each_pair;
pub use workspace::OverlapWorkspace;

/// What two overlapping solids do to each other, in A's frame.
///
/// Forces are for a stiffness of 1 N/m³; multiply by your own. All fields are zero where nothing overlaps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Overlap {
    /// Penetration volume (m³), from the volume balls, see [`InnerSphere::volume_ball`](crate::InnerSphere::volume_ball).
    pub volume: f32,
    /// Centroid of the penetration volume (m).
    pub centroid: Vec3,
    /// Derivative of the volume by a translation of B (m²): B leaves A fastest against it.
    pub gradient: Vec3,
    /// Derivative of the volume by a rotation of B about [`Self::centroid`] (m³/rad).
    pub rotation_gradient: Vec3,
    /// Force on B (N for 1 N/m³) by the force law; A feels the opposite.
    pub force: Vec3,
    /// Torque on B about [`Self::centroid`] (N·m for 1 N/m³) by the force law; A feels the opposite.
    pub torque: Vec3,
    /// Overlapping pairs of spheres.
    pub pairs: u32,
    /// Whether two certified inner balls meet: never true for solids that are apart.
    pub intersects: bool,
}

impl InnerSphereTree {
    /// Overlap of this solid (A) with `other` (B), whose frame stands at `pose` in A's frame, with the force of
    /// [`ForceLaw::Blended`].
    ///
    /// Expected time is linear in the overlapping spheres. Returns [`Overlap::default`] where nothing overlaps and
    /// where the pose is not finite or its quaternion far from unit length.
    #[must_use]
    pub fn overlap(&self, other: &Self, pose: &Pose3, workspace: &mut OverlapWorkspace) -> Overlap {
        self.overlap_with_law(other, pose, ForceLaw::Blended, workspace)
    }

    /// As [`Self::overlap`], with the force of `law`.
    #[must_use]
    pub fn overlap_with_law(
        &self,
        other: &Self,
        pose: &Pose3,
        law: ForceLaw,
        workspace: &mut OverlapWorkspace,
    ) -> Overlap {
        let Some(pose) = RelativePose::new(self, other, pose) else { return Overlap::default() };
        let trees = (self.data(), other.data());
        let mut sink = TotalsSink::new(trees, &pose);
        dispatch!(Level::new(), simd => for_each_pair(simd, trees, &pose, workspace, &mut sink));
        Overlap::new(&sink.totals, law, self.scale())
    }

    /// The overlap of this solid (A) with `other` (B) as one sample per overlapping pair of spheres, in A's
    /// frame, appended to `samples`. Their volumes add up to [`Overlap::volume`].
    pub fn contact_samples(
        &self,
        other: &Self,
        pose: &Pose3,
        workspace: &mut OverlapWorkspace,
        samples: &mut Vec<ContactSample>,
    ) {
        let Some(pose) = RelativePose::new(self, other, pose) else { return };
        let trees = (self.data(), other.data());
        let mut lenses = core::mem::take(&mut workspace.lenses);
        lenses.clear(trees.0, trees.1);
        dispatch!(Level::new(), simd => for_each_pair(simd, trees, &pose, workspace, &mut lenses));
        lenses.append_samples(trees, &pose, self.scale(), samples);
        workspace.lenses = lenses;
    }
}

impl Overlap {
    /// From sums in A's unscaled frame, for A at `scale`.
    pub(crate) fn new(totals: &Totals, law: ForceLaw, scale: f32) -> Self {
        if totals.volume <= 0.0 {
            return Self { pairs: totals.pairs, intersects: totals.inner_balls_meet, ..Self::default() };
        }
        let scale = f64::from(scale);
        let (scale2, scale3) = (scale * scale, scale * scale * scale);
        let centroid = totals.moment / totals.volume;
        let about_centroid = |wrench: &totals::WrenchSum| wrench.torque - centroid.cross(wrench.force);
        let wrench = law.wrench(totals);
        Self {
            volume: (totals.volume * scale3) as f32,
            centroid: (centroid * scale).as_vec3(),
            gradient: (totals.gradient.force * -scale2).as_vec3(),
            rotation_gradient: (about_centroid(&totals.gradient) * -scale3).as_vec3(),
            force: (wrench.force * scale3).as_vec3(),
            torque: (about_centroid(&wrench) * (scale3 * scale)).as_vec3(),
            pairs: totals.pairs,
            intersects: totals.inner_balls_meet,
        }
    }
}

#[cfg(test)]
mod tests;
