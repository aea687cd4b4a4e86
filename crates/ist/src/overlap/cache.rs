//! Temporal coherence: most of a walk over two trees finds what it found a step ago.
//!
//! The walk is done with every ball of B enlarged by a margin, and the pairs that it found are kept. As long as no point of B has
//! moved farther than the margin since, they hold every pair that a new walk would find.
//! After L. Verlet's neighbour lists for molecular dynamics (*Computer "experiments" on classical fluids*, 1967).

use super::pairs::{BATCH, PairBuffer, PairSink};
use super::relative_pose::RelativePose;
use super::traversal::for_each_pair;
use super::workspace::OverlapWorkspace;
use crate::InnerSphereTree;
use crate::simd_level::simd_level;
use crate::tree::TreeData;
use alloc::sync::Arc;
use alloc::vec::Vec;
use core::f32::consts::FRAC_1_SQRT_2;
use fearless_simd::{Simd, dispatch};
use glam::{Mat3, Vec3};

/// Time of a walk over that of its lenses.
///
/// Two rabbits of 1,000 spheres that move by 1e-4 of their size take 0.40 / 0.44 / 0.46 of a new walk's time (little, mid and deep
/// overlap), by 1e-3 0.58 / 0.63 / 0.61, by 3e-3 0.75 / 0.79 / 0.81; with 10,000 spheres by 1e-3 0.7. With half of this or twice as much,
/// up to 0.05 more.
const WALK: f32 = 1.5;

/// Room for the rounding of displaced points, relative to their coordinates.
const ROUNDING: f32 = 4e-6;

/// What a pair of solids remembers from one overlap query to the next, see [`InnerSphereTree::overlap_cached`].
///
/// Keep one per pair of bodies. It takes 8 bytes for each pair of spheres that overlap or are about to, and holds on to both trees.
/// Its content affects a result by no more than the order in which pairs are added up, about 1e-6 of
/// the terms; where equal bits matter, as after a restored snapshot, begin with a new one.
#[derive(Clone, Debug, Default)]
pub struct OverlapCache {
    list: PairList,
    /// Where B stood at the last query, whether or not that made a list.
    last: Option<RelativePose>,
    walks: u64,
}

/// The pairs of spheres that overlap or are about to: positions in the orders of both trees.
#[derive(Clone, Debug, Default)]
struct PairList {
    trees: Option<[Arc<TreeData>; 2]>,
    /// Where B stood, and how far its points may be from there.
    pose: Option<RelativePose>,
    margin: f32,
    a: Vec<u32>,
    b: Vec<u32>,
}

impl OverlapCache {
    /// How often the trees were walked: at every query where the solids move far from one to the next, rarely where not.
    #[must_use]
    pub fn walks(&self) -> u64 {
        self.walks
    }

    /// Makes a list for `pose`, unless the last one holds or none would pay.
    pub(super) fn move_to(
        &mut self,
        [a, b]: [&InnerSphereTree; 2],
        pose: &RelativePose,
        workspace: &mut OverlapWorkspace,
    ) {
        let trees = (a.data(), b.data());
        let step = self.last.replace(*pose).map(|last| displacement(trees.1, &last, pose));
        if self.list.holds([a, b], pose) {
            return;
        }
        self.walks += 1;
        match step.and_then(|step| margin(step, trees, pose)) {
            Some(margin) => self.list.make([a, b], pose, margin, workspace),
            None => self.list.trees = None,
        }
    }

    /// As [`for_each_pair`], where [`Self::move_to`] has moved: from a list also pairs that do not overlap.
    pub(super) fn for_each_pair(
        &self,
        trees: (&TreeData, &TreeData),
        pose: &RelativePose,
        workspace: &mut OverlapWorkspace,
        sink: &mut impl PairSink,
    ) {
        if self.list.trees.is_none() {
            return for_each_pair(trees, pose, workspace, sink);
        }
        dispatch!(simd_level(), simd => self.list.for_each_pair(simd, &mut workspace.pairs, sink));
    }
}

impl PairList {
    /// Whether it was made for these solids and holds where B stands now.
    fn holds(&self, trees: [&InnerSphereTree; 2], pose: &RelativePose) -> bool {
        let (Some(known), Some(from)) = (&self.trees, &self.pose) else { return false };
        let [a, b] = trees.map(InnerSphereTree::shared);
        let same = Arc::ptr_eq(&known[0], a) && Arc::ptr_eq(&known[1], b);
        let sizes = |pose: &RelativePose| [pose.scale, pose.skin_a, pose.skin_b];
        same && sizes(from) == sizes(pose) && displacement(b, from, pose) <= self.margin
    }

    fn make(
        &mut self,
        trees: [&InnerSphereTree; 2],
        pose: &RelativePose,
        margin: f32,
        workspace: &mut OverlapWorkspace,
    ) {
        self.a.clear();
        self.b.clear();
        let pair = (trees[0].data(), trees[1].data());
        // With room for the rounding of this test and of that of the pairs.
        let wide = pose.with_margin(margin + pose.enlargement(pair));
        for_each_pair(pair, &wide, workspace, self);
        self.trees = Some(trees.map(InnerSphereTree::shared).map(Arc::clone));
        self.pose = Some(*pose);
        self.margin = margin;
    }

    #[inline(always)]
    fn for_each_pair<S: Simd>(&self, simd: S, buffer: &mut PairBuffer, sink: &mut impl PairSink) {
        for (a, b) in self.a.chunks(BATCH).zip(self.b.chunks(BATCH)) {
            buffer.fill(a, b);
            buffer.flush(simd, sink);
        }
    }
}

impl PairSink for PairList {
    #[inline(always)]
    fn take<S: Simd>(&mut self, _: S, pairs: &PairBuffer) {
        self.a.extend_from_slice(&pairs.a[..pairs.len()]);
        self.b.extend_from_slice(&pairs.b[..pairs.len()]);
    }
}

/// How much larger B is made for a list where it moves by `step` from one query to the next; `None` where it moves so far that no
/// list pays.
///
/// Let w be [`WALK`], s the step, and r the distance at which two spheres touch. A margin m lasts m/s steps, each of which costs
/// ws/m for the walk and 1 + 3m/r for the lenses, as pairs become more by that. The sum is least with m² = wrs/3, and then less than
/// the 1 + w of a walk at every step where s < wr/12.
fn margin(step: f32, (a, b): (&TreeData, &TreeData), pose: &RelativePose) -> Option<f32> {
    let touching = a.mean_radius + b.mean_radius * pose.scale + pose.skin_a + pose.skin_b;
    // A body at rest is never quite: a list without any margin would not last.
    let least = size(b, pose) * 8.0 * ROUNDING;
    (step < WALK / 12.0 * touching).then(|| libm::sqrtf(WALK / 3.0 * touching * step).max(least))
}

/// A bound on how far any point of the balls of `b` is in one pose from where it is in another, rounding included.
///
/// The point c + s with |s| ≤ ρ moves by the displacement of c and by (L − L₀)s, where L = σR. R − R₀ stretches by at
/// most 2 sin(θ/2), which is its Frobenius norm over √2.
fn displacement(b: &TreeData, from: &RelativePose, to: &RelativePose) -> f32 {
    let (center, radius) = b.root().get(0);
    let moved = to.transform_point(center).distance(from.transform_point(center));
    let Mat3 { x_axis, y_axis, z_axis } = to.rotation - from.rotation;
    let turned = Vec3::new(x_axis.length(), y_axis.length(), z_axis.length()).length() * FRAC_1_SQRT_2;
    moved + turned * to.scale * radius + ROUNDING * (size(b, from) + size(b, to))
}

/// Largest coordinate of a point of `b` in A's frame.
fn size(b: &TreeData, pose: &RelativePose) -> f32 {
    let (center, radius) = b.root().get(0);
    pose.transform_point(center).abs().max_element() + radius * pose.scale
}
