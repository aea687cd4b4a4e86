//! Temporal coherence: most of a walk over two trees finds what it found a step ago.
//!
//! The walk is done with every ball of B enlarged by a margin, and what it found is kept: per block of B's leaves the leaves of
//! A that meet one of them. As long as no point of B has moved farther than the margin since, the lists hold every pair
//! that a new walk would find.
//! After L. Verlet's neighbour lists for molecular dynamics (*Computer "experiments" on classical fluids*, 1967).

use super::lanes::{Ball, BlockLanes};
use super::pairs::PairSink;
use super::relative_pose::RelativePose;
use super::traversal::{BlockVisitor, PairFinder, for_each_block, for_each_pair};
use super::workspace::OverlapWorkspace;
use crate::InnerSphereTree;
use crate::simd_level::simd_level;
use crate::tree::{TreeData, WIDTH};
use alloc::sync::Arc;
use alloc::vec::Vec;
use core::f32::consts::FRAC_1_SQRT_2;
use fearless_simd::{Simd, dispatch, prelude::*};
use glam::{Mat3, Vec3};

/// Steps that a list should last, at the speed of the last one.
///
/// Two rabbits that move by 1e-4 of their size take 0.66 (1,000 spheres, mid and deep overlap) and 0.29 (little overlap) of a
/// new walk's time, 0.66 and 0.31 with 10,000 spheres. By 1e-3 it is 0.70 and 0.36 with 1,000; with 10,000, and with faster
/// motion, trees are walked every time, which takes a little longer than without a cache.
const STEPS: f32 = 12.0;

/// Largest margin, in mean radii of the balls over blocks of B: wider lists cost more than they save.
const WIDEST: f32 = 0.5;

/// Room for the rounding of displaced points, relative to their coordinates.
const ROUNDING: f32 = 4e-6;

/// What a pair of solids remembers from one overlap query to the next, see [`InnerSphereTree::overlap_cached`].
///
/// Keep one per pair of bodies. It takes about 4 bytes for each sphere of A near a block of eight spheres of B, and
/// holds on to both trees. Its content affects a result by no more than the order in which pairs are added up, about 1e-6 of
/// the terms; where equal bits matter, as after a restored snapshot, begin with a new one.
#[derive(Clone, Debug, Default)]
pub struct OverlapCache {
    lists: Lists,
    /// Where B stood at the last query, whether or not that made lists.
    last: Option<RelativePose>,
    walks: u64,
}

/// Neighbours of blocks of B's leaves.
#[derive(Clone, Debug, Default)]
struct Lists {
    trees: Option<[Arc<TreeData>; 2]>,
    /// Where B stood, and how far its points may be from there.
    pose: Option<RelativePose>,
    margin: f32,
    /// Blocks of B's leaves, and where the list of each begins.
    blocks: Vec<(u32, u32)>,
    near: Vec<u32>,
}

impl OverlapCache {
    /// How often the trees were walked: at every query where the solids move far from one to the next, rarely where not.
    #[must_use]
    pub fn walks(&self) -> u64 {
        self.walks
    }

    /// As [`for_each_pair`], from lists where they hold.
    pub(super) fn for_each_pair(
        &mut self,
        [a, b]: [&InnerSphereTree; 2],
        pose: &RelativePose,
        workspace: &mut OverlapWorkspace,
        sink: &mut impl PairSink,
    ) {
        let trees = (a.data(), b.data());
        let step = self.last.replace(*pose).map(|last| displacement(trees.1, &last, pose));
        if !self.lists.hold([a, b], pose) {
            self.walks += 1;
            let margin = step.filter(|_| trees.1.height() > 0).map_or(0.0, |step| STEPS * step);
            // A body at rest is never quite: a list without any margin would not last.
            let margin = margin.max(size(trees.1, pose) * 8.0 * ROUNDING);
            if step.is_none() || trees.1.height() == 0 || margin > WIDEST * block_radius(trees.1, pose) {
                self.lists.trees = None;
                return for_each_pair(trees, pose, workspace, sink);
            }
            self.lists.make([a, b], pose, margin, workspace);
        }
        dispatch!(simd_level(), simd => self.lists.for_each_pair(simd, (trees, pose), workspace, sink));
    }
}

impl Lists {
    /// Whether they were made for these solids and hold where B stands now.
    fn hold(&self, trees: [&InnerSphereTree; 2], pose: &RelativePose) -> bool {
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
        self.blocks.clear();
        self.near.clear();
        let pair = (trees[0].data(), trees[1].data());
        let wide = pose.with_margin(margin + pose.enlargement(pair));
        let mut maker = ListMaker { trees: pair, pose: &wide, lists: self };
        let scratch = &mut workspace.traversal;
        dispatch!(simd_level(), simd => for_each_block(simd, pair, &wide, scratch, &mut maker));
        self.blocks.push((u32::MAX, self.near.len() as u32));
        self.trees = Some(trees.map(InnerSphereTree::shared).map(Arc::clone));
        self.pose = Some(*pose);
        self.margin = margin;
    }

    #[inline(always)]
    fn for_each_pair<S: Simd>(
        &self,
        simd: S,
        (trees, pose): ((&TreeData, &TreeData), &RelativePose),
        workspace: &mut OverlapWorkspace,
        sink: &mut impl PairSink,
    ) {
        let OverlapWorkspace { pairs, .. } = workspace;
        pairs.clear();
        let mut finder = PairFinder { trees, pose, pairs, sink };
        for list in self.blocks.windows(2) {
            let [(block, start), (_, end)] = [list[0], list[1]];
            finder.visit(simd, block as usize, &self.near[start as usize..end as usize]);
        }
        finder.pairs.flush(simd, finder.sink);
    }
}

/// Makes lists from a walk.
struct ListMaker<'a> {
    trees: (&'a TreeData, &'a TreeData),
    /// With the margin, and room for the rounding of the lists' test and of that of the pairs.
    pose: &'a RelativePose,
    lists: &'a mut Lists,
}

impl BlockVisitor for ListMaker<'_> {
    #[inline(always)]
    fn visit<S: Simd>(&mut self, simd: S, block: usize, near: &[u32]) {
        let Lists { blocks, near: list, .. } = &mut *self.lists;
        let (a, b) = self.trees;
        let start = list.len();
        let balls = self.pose.place(simd, &b.levels[0].blocks[block]);
        let lanes = BlockLanes::new(simd, &balls, block * WIDTH);
        for leaf in near {
            let ball = Ball::leaf(simd, &a.leaves[*leaf as usize], self.pose.skin_a);
            if lanes.touches(&ball).any_true() {
                list.push(*leaf);
            }
        }
        if list.len() > start {
            blocks.push((block as u32, start as u32));
        }
    }
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

/// Mean radius of the balls over blocks of `b`'s leaves, in A's frame.
fn block_radius(b: &TreeData, pose: &RelativePose) -> f32 {
    let level = &b.levels[1];
    let sum: f32 = level.blocks.iter().flat_map(|block| block.radius).sum();
    sum / level.len() as f32 * pose.scale + pose.skin_b
}
