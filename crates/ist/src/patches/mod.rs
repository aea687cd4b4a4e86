//! The overlap split into its connected regions.
//!
//! Two lenses are of one region if the spheres of A that they lie in are connected with each other, and so are those of
//! B: spheres are connected if their volume balls, somewhat enlarged, meet, directly or over others that take part in the overlap
//! ([`touching`]). So the distance that still counts as close is the local resolution of the packings and needs no
//! length of its own: a shallow contact of coarse spheres, whose lenses lie far apart, stays in one piece, and a body as
//! thin as one sphere between two walls still has two contacts, as the walls' spheres do not meet.

mod touching;

use crate::overlap::direction;
use crate::overlap::parts::{LensCloud, PartSums, with_lenses};
use crate::{ForceLaw, InnerSphereTree, OverlapWorkspace};
use alloc::vec::Vec;
use glam::Vec3;
use glamx::Pose3;
use touching::TouchingSpheres;

/// A connected region of the overlap of two solids A and B, in A's frame.
///
/// Forces are for a stiffness of 1 N/m³; multiply by your own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct ContactPatch {
    /// Volume of the region (m³), positive.
    pub volume: f32,
    /// Centroid of the region (m).
    pub centroid: Vec3,
    /// Derivative of the volume by a translation of B (m²).
    pub gradient: Vec3,
    /// Derivative of the volume by a rotation of B about [`Self::centroid`] (m³/rad).
    pub rotation_gradient: Vec3,
    /// Sum of the areas inside the intersection circles of all pairs (m²); at least the length of [`Self::gradient`].
    pub area: f32,
    /// Force on B (N for 1 N/m³) by [`ForceLaw::Blended`], as if the region were the whole overlap: at most its volume.
    pub force: Vec3,
    /// Torque on B about [`Self::centroid`] (N·m for 1 N/m³) by the same law.
    pub torque: Vec3,
    /// Opposite corners of a box around the region (m).
    pub bounds: (Vec3, Vec3),
    /// Centroids of lenses as far apart as the region has them in two directions across the force (m): a manifold. Not
    /// all different if there are fewer than four lenses.
    pub points: [Vec3; 4],
    /// Overlapping pairs of spheres.
    pub pairs: u32,
}

/// Memory of a query.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scratch {
    touching: [TouchingSpheres; 2],
    runs: Vec<Run>,
    /// Runs by their groups, that is by regions.
    sorted: Vec<([u32; 2], u32)>,
    regions: Vec<Region>,
}

/// Lenses that follow each other and are of one region: most do, as the traversal moves through space.
#[derive(Clone, Copy, Debug)]
struct Run {
    /// Groups of the spheres of A and B.
    groups: [u32; 2],
    /// First lens, and one past the last.
    lenses: [u32; 2],
    region: u32,
}

/// What is summed up over a region, and the points of its patch.
#[derive(Clone, Debug)]
struct Region {
    sums: PartSums,
    patch: ContactPatch,
    /// Unit vector along the force, and two across it.
    normal: Vec3,
    along: Vec3,
    side: Vec3,
    /// How far out each point of the patch lies in its direction.
    heights: [f32; 4],
}

impl InnerSphereTree {
    /// The overlap of this solid (A) with `other` (B), whose frame stands at `pose` in A's frame, by connected regions,
    /// which replace the content of `patches`: the largest first, equal ones by the tree's order.
    ///
    /// Volumes, first moments, gradients and areas add up to those of [`InnerSphereTree::overlap`]. Forces need not: two
    /// walls that hold a body between them push in opposite directions, and the whole is pushed by neither.
    ///
    /// Takes O(k log k) time for k overlapping pairs, beyond the time to find them, and some bytes per sphere of both
    /// trees. Gives no patch where nothing overlaps and where the pose is not finite or its quaternion far from unit
    /// length.
    pub fn contact_patches(
        &self,
        other: &Self,
        pose: &Pose3,
        workspace: &mut OverlapWorkspace,
        patches: &mut Vec<ContactPatch>,
    ) {
        patches.clear();
        with_lenses(self, other, pose, workspace, |cloud, scratch| {
            scratch.split(&cloud, [self, other]);
            scratch.measure(&cloud, ForceLaw::Blended);
            patches.extend(scratch.regions.iter().map(|region| region.patch));
        });
        // In the trees' order so far, which decides between patches of one size: the sort is stable.
        patches.sort_by(|a, b| b.volume.total_cmp(&a.volume));
    }
}

impl Scratch {
    /// Finds the regions, in the order of the least spheres of A and B that they hold.
    fn split(&mut self, cloud: &LensCloud, trees: [&InnerSphereTree; 2]) {
        for (side, touching) in self.touching.iter_mut().enumerate() {
            touching.connect(trees[side], (0..cloud.len()).map(|i| cloud.spheres(i)[side]));
        }
        self.runs.clear();
        for i in 0..cloud.len() {
            let [a, b] = cloud.spheres(i);
            let groups = [self.touching[0].group(a), self.touching[1].group(b)];
            let lens = i as u32;
            match self.runs.last_mut() {
                Some(run) if run.groups == groups => run.lenses[1] = lens + 1,
                _ => self.runs.push(Run { groups, lenses: [lens, lens + 1], region: 0 }),
            }
        }
        self.sorted.clear();
        self.sorted.extend((0..).zip(&self.runs).map(|(index, run)| (run.groups, index)));
        self.sorted.sort_unstable();
        self.regions.clear();
        for region in self.sorted.chunk_by(|a, b| a.0 == b.0) {
            for (_, run) in region {
                self.runs[*run as usize].region = self.regions.len() as u32;
            }
            self.regions.push(Region::new());
        }
    }

    /// Sums up every region and finds its points.
    fn measure(&mut self, cloud: &LensCloud, law: ForceLaw) {
        self.for_each_lens(|lens, region| cloud.add(lens, &mut region.sums));
        for region in &mut self.regions {
            let patch = cloud.patch(&region.sums, law);
            region.normal = direction(patch.force).or(direction(patch.gradient)).unwrap_or(Vec3::Y);
            region.patch = patch;
        }
        self.for_each_lens(|lens, region| {
            region.raise(0, cloud.point(lens), |across| across.length_squared())
        });
        // The patch's axes across the force: towards the first point, and to the side of it.
        for region in &mut self.regions {
            region.along = region.across(region.patch.points[0]).normalize_or_zero();
            region.side = region.normal.cross(region.along);
        }
        self.for_each_lens(|lens, region| {
            let (point, along, side) = (cloud.point(lens), region.along, region.side);
            region.raise(1, point, |across| -across.dot(along));
            region.raise(2, point, |across| across.dot(side));
            region.raise(3, point, |across| -across.dot(side));
        });
    }

    /// Calls `act` with every lens and its region.
    fn for_each_lens(&mut self, mut act: impl FnMut(usize, &mut Region)) {
        for run in &self.runs {
            let region = &mut self.regions[run.region as usize];
            for lens in run.lenses[0]..run.lenses[1] {
                act(lens as usize, region);
            }
        }
    }
}

impl Region {
    fn new() -> Self {
        let (sums, patch, along, side) = Default::default();
        Self { sums, patch, normal: Vec3::Y, along, side, heights: [f32::NEG_INFINITY; 4] }
    }

    /// The part of the way from the patch's centroid to `point` that is across the force.
    fn across(&self, point: Vec3) -> Vec3 {
        (point - self.patch.centroid).reject_from_normalized(self.normal)
    }

    /// Makes `point` the patch's point `index` if it is higher; the first of equally high ones stays.
    fn raise(&mut self, index: usize, point: Vec3, height: impl Fn(Vec3) -> f32) {
        let height = height(self.across(point));
        if height > self.heights[index] {
            self.heights[index] = height;
            self.patch.points[index] = point;
        }
    }
}

#[cfg(test)]
mod tests;
