//! Overlap of two solids.

mod batch;
mod cache;
mod cap;
pub(crate) mod flush;
mod force_law;
mod grid_engine;
mod grid_search;
mod lanes;
mod leaf_lanes;
mod lens_lanes;
mod pairs;
pub(crate) mod parts;
mod query;
mod relative_pose;
mod sample_normals;
mod samples;
mod signed_distance;
mod stiffness;
#[cfg(feature = "std")]
mod time_critical;
mod totals;
mod traversal;
mod workspace;

use crate::InnerSphereTree;
use alloc::vec::Vec;
pub use batch::{OverlapPair, overlap_batch};
pub use cache::OverlapCache;
pub use force_law::ForceLaw;
use glam::Vec3;
use glamx::Pose3;
pub use query::{Engine, OverlapQuery};
use relative_pose::RelativePose;
pub use samples::ContactSample;
pub(crate) use samples::direction;
use samples::{Lens, LensSink};
pub use stiffness::StiffnessMatrix;
#[cfg(feature = "std")]
pub use time_critical::{Budget, OverlapEstimate, TimeCriticalWorkspace};
use totals::{Extras, Totals, TotalsSink};
use traversal::for_each_pair;
pub use workspace::OverlapWorkspace;

/// What two overlapping solids do to each other, in A's frame.
///
/// Forces are for a stiffness of 1 N/m³, those of [`ForceLaw::VolumeGradient`] for a pressure of 1 N/m²; multiply by your
/// own. All fields are zero where nothing overlaps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Overlap {
    /// Penetration volume (m³), from the volume balls, see [`InnerSphere::volume_ball`](crate::InnerSphere::volume_ball).
    pub volume: f32,
    /// Centroid of the penetration volume (m).
    pub centroid: Vec3,
    /// Derivative of the volume by a translation of B (m²): B leaves A fastest against it.
    pub gradient: Vec3,
    /// Derivative of the volume by a rotation of B about [`Self::centroid`] (m³/rad).
    pub rotation_gradient: Vec3,
    /// Force on B (N) by the force law; A feels the opposite.
    pub force: Vec3,
    /// Torque on B about [`Self::centroid`] (N·m) by the force law; A feels the opposite.
    pub torque: Vec3,
    /// How the wrench of the volume's gradient answers to displacements of B, if [`OverlapQuery::stiffness`] asked for it.
    pub stiffness: Option<StiffnessMatrix>,
    /// The deepest of the overlapping pairs of spheres, where there is one.
    pub deepest: Option<DeepestPair>,
    /// Overlapping pairs of spheres.
    pub pairs: u32,
    /// Whether two certified inner balls meet: never true for two packed solids that are apart.
    pub intersects: bool,
}

/// Two overlapping spheres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct DeepestPair {
    /// Indices of the spheres in the packings of A and B.
    pub spheres: [usize; 2],
    /// How far their volume balls overlap along the line of their centres (m), at most the diameter of the smaller one.
    pub depth: f32,
}

impl InnerSphereTree {
    /// Overlap of this solid (A) with `other` (B), whose frame stands at `pose` in A's frame, with the force of
    /// [`ForceLaw::Blended`].
    ///
    /// Expected time is linear in the overlapping spheres. Returns [`Overlap::default`] where nothing overlaps,
    /// where the pose is not finite or its quaternion not between 0.5 and 2 long (in between it is normalised), and where
    /// f32 ends: where B reaches about 1e16 times as far from its origin as A from its own, or 1e-12 times as far, or where
    /// skins are about 1e8 times as thick as that. Every field is finite unless it is too large for f32.
    #[must_use]
    pub fn overlap(&self, other: &Self, pose: &Pose3, workspace: &mut OverlapWorkspace) -> Overlap {
        self.overlap_with(other, pose, OverlapQuery::default(), workspace)
    }

    /// As [`Self::overlap`], as `query` says.
    #[must_use]
    pub fn overlap_with(
        &self,
        other: &Self,
        pose: &Pose3,
        query: OverlapQuery,
        workspace: &mut OverlapWorkspace,
    ) -> Overlap {
        let Some(pose) = RelativePose::new(self, other, pose) else { return Overlap::default() };
        let trees = (self.data(), other.data());
        let grids = query.engine.grids([self, other], &pose);
        let totals = totals(query, workspace, |extras, workspace| match grids {
            Some(grids) => grid_engine::totals(trees, grids, extras, workspace),
            None => {
                let mut sink = TotalsSink::new(trees, &pose, extras);
                for_each_pair(trees, &pose, workspace, &mut sink);
                sink.totals
            }
        });
        Overlap::new(&totals, query, [self, other])
    }

    /// As [`Self::overlap_with`] by [`Engine::Tree`], with what `cache` remembers of earlier queries of the same two solids:
    /// the same pairs and the same result but for rounding, sooner where B has moved little against A.
    ///
    /// The engine that `query` names has no effect.
    #[must_use]
    pub fn overlap_cached(
        &self,
        other: &Self,
        pose: &Pose3,
        query: OverlapQuery,
        (cache, workspace): (&mut OverlapCache, &mut OverlapWorkspace),
    ) -> Overlap {
        let Some(pose) = RelativePose::new(self, other, pose) else { return Overlap::default() };
        let trees = (self.data(), other.data());
        cache.move_to([self, other], &pose, workspace);
        let totals = totals(query, workspace, |extras, workspace| {
            let mut sink = TotalsSink::new(trees, &pose, extras);
            cache.for_each_pair(trees, &pose, workspace, &mut sink);
            sink.totals
        });
        Overlap::new(&totals, query, [self, other])
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
        self.samples_at(other, &pose, |lens, _| Some(*lens), (workspace, samples));
    }

    /// As [`Self::contact_samples`], but contact begins flush with the surfaces, where the inner balls of a pair meet along
    /// the normal of the sample, and not where volume balls do, which reach out of the solids: for a penalty, under which bodies with flat
    /// faces should stand on these.
    ///
    /// Contact begins by [`Self::contact_offset`] of both in front of the surfaces. Where it is some tenths of a radius
    /// deep, samples are those of [`Self::contact_samples`]; before that volumes rise from zero, and cross-sections are steeper by as
    /// much: a force in proportion to the volume, fitted by a square law, ends where the contact does.
    pub fn flush_contact_samples(
        &self,
        other: &Self,
        pose: &Pose3,
        workspace: &mut OverlapWorkspace,
        samples: &mut Vec<ContactSample>,
    ) {
        let Some(pose) = RelativePose::new(self, other, pose) else { return };
        let trees = (self.data(), other.data());
        self.samples_at(other, &pose, |lens, normal| lens.flush(trees, &pose, normal), (workspace, samples));
    }

    /// How far (m) in front of its surface contact with this solid begins, see [`Self::flush_contact_samples`]: a share of the mean
    /// radius of its spheres.
    #[must_use]
    pub fn contact_offset(&self) -> f32 {
        flush::allowance(self.data().mean_radius) * self.unit()
    }

    /// Samples by `law`, see [`samples::Lenses::append_samples`].
    fn samples_at(
        &self,
        other: &Self,
        pose: &RelativePose,
        law: impl Fn(&Lens, Vec3) -> Option<Lens>,
        (workspace, samples): (&mut OverlapWorkspace, &mut Vec<ContactSample>),
    ) {
        let trees = (self.data(), other.data());
        let mut lenses = core::mem::take(&mut workspace.lenses);
        lenses.clear();
        let mut sink = LensSink { lenses: &mut lenses, trees, pose };
        for_each_pair(trees, pose, workspace, &mut sink);
        lenses.append_samples(trees, (pose, self.unit()), law, samples);
        workspace.lenses = lenses;
    }
}

/// What `query` needs, by `sum`, which adds up all pairs.
///
/// Only the other sums tell whether the force comes from outward normals: for [`ForceLaw::Blended`] where one solid is inside the
/// other. If so, and the last query did not need them, all is summed twice.
fn totals(
    query: OverlapQuery,
    workspace: &mut OverlapWorkspace,
    mut sum: impl FnMut(Extras, &mut OverlapWorkspace) -> Totals,
) -> Totals {
    let extras = Extras { outward: workspace.outward, stiffness: query.stiffness };
    let totals = sum(extras, workspace);
    workspace.outward = query.law.needs_outward(&totals);
    if workspace.outward && !extras.outward {
        return sum(Extras { outward: true, ..extras }, workspace);
    }
    totals
}

impl Overlap {
    /// From sums in the unscaled frame of `a`.
    fn new(totals: &Totals, query: OverlapQuery, [a, b]: [&InnerSphereTree; 2]) -> Self {
        let scale = f64::from(a.unit());
        let all = Self::from_totals(totals, query.law, scale);
        if totals.volume <= 0.0 {
            return all;
        }
        let [in_a, in_b] = totals.deepest.spheres;
        let centroid = totals.moment / totals.volume;
        Self {
            stiffness: query.stiffness.then(|| {
                let pivot = centroid - stiffness::origin(a.data()).as_dvec3();
                totals.stiffness.about(pivot, totals.gradient.force, scale)
            }),
            deepest: Some(DeepestPair {
                spheres: [a.packing_index(in_a as usize), b.packing_index(in_b as usize)],
                depth: totals.deepest.depth * a.unit(),
            }),
            ..all
        }
    }

    /// From sums in the frame of an A that is `scale` times as large; without stiffness and deepest pair.
    fn from_totals(totals: &Totals, law: ForceLaw, scale: f64) -> Self {
        if totals.volume <= 0.0 {
            return Self { pairs: totals.pairs, intersects: totals.inner_balls_meet, ..Self::default() };
        }
        let (scale2, scale3) = (scale * scale, scale * scale * scale);
        let centroid = totals.moment / totals.volume;
        let about_centroid = |wrench: &totals::WrenchSum| wrench.torque - centroid.cross(wrench.force);
        let (wrench, growth) = (law.wrench(totals), law.growth(scale));
        Self {
            volume: (totals.volume * scale3) as f32,
            centroid: (centroid * scale).as_vec3(),
            gradient: (totals.gradient.force * -scale2).as_vec3(),
            rotation_gradient: (about_centroid(&totals.gradient) * -scale3).as_vec3(),
            force: (wrench.force * growth).as_vec3(),
            torque: (about_centroid(&wrench) * (growth * scale)).as_vec3(),
            stiffness: None,
            deepest: None,
            pairs: totals.pairs,
            intersects: totals.inner_balls_meet,
        }
    }
}

#[cfg(test)]
mod cache_tests;
#[cfg(test)]
mod grid_tests;
#[cfg(test)]
mod signed_distance_tests;
#[cfg(test)]
mod stiffness_tests;
#[cfg(test)]
pub(crate) mod tests;
