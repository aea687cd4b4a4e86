//! The overlap taken apart: its lenses one by one, and sums over some of them.

use super::relative_pose::RelativePose;
use super::samples::{Lens, LensSink};
use super::totals::Totals;
use super::traversal::for_each_pair;
use super::{ForceLaw, Overlap, OverlapWorkspace};
use crate::InnerSphereTree;
use crate::patches::{ContactPatch, Scratch};
use crate::tree::TreeData;
use glam::Vec3;
use glamx::Pose3;

/// All lenses of two overlapping solids A and B.
#[derive(Clone, Copy)]
pub(crate) struct LensCloud<'a> {
    lenses: &'a [Lens],
    trees: [&'a TreeData; 2],
    pose: &'a RelativePose,
    /// Size of A.
    scale: f32,
}

/// Sums over some of the lenses, in A's unscaled frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PartSums {
    totals: Totals,
    area: f64,
    bounds: (Vec3, Vec3),
}

impl Default for PartSums {
    fn default() -> Self {
        let bounds = (Vec3::splat(f32::INFINITY), Vec3::splat(f32::NEG_INFINITY));
        Self { totals: Totals::default(), area: 0.0, bounds }
    }
}

/// Hands the lenses of `a` and `b` to `act`, unless the pose is none.
pub(crate) fn with_lenses(
    a: &InnerSphereTree,
    b: &InnerSphereTree,
    pose: &Pose3,
    workspace: &mut OverlapWorkspace,
    act: impl FnOnce(LensCloud, &mut Scratch),
) {
    let Some(pose) = RelativePose::new(a, b, pose) else { return };
    let trees = (a.data(), b.data());
    let mut lenses = core::mem::take(&mut workspace.lenses);
    let mut scratch = core::mem::take(&mut workspace.patches);
    lenses.clear();
    let mut sink = LensSink { lenses: &mut lenses, trees, pose: &pose };
    for_each_pair(trees, &pose, workspace, &mut sink);
    let cloud = LensCloud { lenses: &lenses.lenses, trees: [trees.0, trees.1], pose: &pose, scale: a.unit() };
    act(cloud, &mut scratch);
    workspace.lenses = lenses;
    workspace.patches = scratch;
}

impl LensCloud<'_> {
    pub(crate) fn len(&self) -> usize {
        self.lenses.len()
    }

    /// Positions of the two spheres of lens `i` in the orders of their trees.
    pub(crate) fn spheres(&self, i: usize) -> [u32; 2] {
        self.lenses[i].spheres
    }

    /// Centroid of lens `i` (m), in A's frame.
    pub(crate) fn point(&self, i: usize) -> Vec3 {
        self.lenses[i].centroid * self.scale
    }

    /// Adds what lens `i` contributes.
    pub(crate) fn add(&self, i: usize, sums: &mut PartSums) {
        let (lens, [a, b]) = (&self.lenses[i], self.trees);
        let normal_b = self.pose.rotation * b.leaves[lens.spheres[1] as usize].normal();
        let (volume, point) = (f64::from(lens.volume), lens.centroid.as_dvec3());
        let totals = &mut sums.totals;
        totals.pairs += 1;
        totals.volume += volume;
        totals.moment += volume * point;
        // All points of the axis are as good for the torque, and the centroid is one.
        totals.gradient.add_force(lens.axis.as_dvec3() * f64::from(lens.area), point);
        let outward = a.leaves[lens.spheres[0] as usize].normal() - normal_b;
        totals.outward.add_force(outward.as_dvec3() * volume, point);
        sums.area += f64::from(lens.area);
        let (lower, upper) = self.bounds(lens);
        sums.bounds = (sums.bounds.0.min(lower), sums.bounds.1.max(upper));
    }

    /// The patch of some of the lenses from their sums; its `points` are left for later.
    pub(crate) fn patch(&self, sums: &PartSums, law: ForceLaw) -> ContactPatch {
        let scale = f64::from(self.scale);
        let all = Overlap::from_totals(&sums.totals, law, scale);
        ContactPatch {
            volume: all.volume,
            centroid: all.centroid,
            gradient: all.gradient,
            rotation_gradient: all.rotation_gradient,
            area: (sums.area * scale * scale) as f32,
            force: all.force,
            torque: all.torque,
            bounds: (sums.bounds.0 * self.scale, sums.bounds.1 * self.scale),
            points: [Vec3::ZERO; 4],
            pairs: all.pairs,
        }
    }

    /// Corners of a box around a lens: what the boxes of its balls have in common.
    fn bounds(&self, lens: &Lens) -> (Vec3, Vec3) {
        let [a, b] = lens.spheres.map(|sphere| sphere as usize);
        let (center_a, radius_a) = self.trees[0].levels[0].get(a);
        let (center_b, radius_b) = self.trees[1].levels[0].get(b);
        let center_b = self.pose.transform_point(center_b);
        let (radius_a, radius_b) =
            (radius_a + self.pose.skin_a, radius_b * self.pose.scale + self.pose.skin_b);
        let lower = (center_a - radius_a).max(center_b - radius_b);
        (lower, (center_a + radius_a).min(center_b + radius_b).max(lower))
    }
}
