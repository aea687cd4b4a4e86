//! Finding the overlapping pairs of two trees.
//!
//! B's tree is walked depth first; on the way down every ball of B carries the list of A's balls that it
//! meets, on B's own level. A list is filtered by the ball above before its eight children filter it each, so
//! that most tests run on dense arrays. Both trees descend in step; the taller one starts alone.

use super::lanes::{Ball, BlockLanes, lanes_in};
use super::pairs::{NearLeaves, PairBuffer, PairSink, SphereBlock};
use super::relative_pose::RelativePose;
use super::workspace::{Candidates, OverlapWorkspace, Siblings, TraversalScratch};
use crate::simd_level::simd_level;
use crate::tree::{TreeData, WIDTH};
use fearless_simd::{Simd, dispatch, prelude::*};

/// Makes pairs of blocks and their neighbours, for a sink.
struct PairFinder<'a, K> {
    trees: (&'a TreeData, &'a TreeData),
    pose: &'a RelativePose,
    pairs: &'a mut PairBuffer,
    sink: &'a mut K,
}

impl<K: PairSink> PairFinder<'_, K> {
    /// `near` are the leaves of A, by their order, that meet the ball over block `block` of B's leaves: at least one.
    #[inline(always)]
    fn visit<S: Simd>(&mut self, simd: S, block: usize, near: &[u32]) {
        let (a, b) = self.trees;
        let near = NearLeaves { leaves: &a.leaves, skin: self.pose.skin_a, positions: near };
        let balls = self.pose.place(simd, &b.levels[0].blocks[block]);
        let block =
            SphereBlock { balls: BlockLanes::new(simd, &balls, 0), first: block * WIDTH, of_a: false };
        self.pairs.append(simd, &near, &block, self.sink);
    }
}

/// Hands every pair of overlapping volume balls to `sink`, each once, in an order that depends on
/// the trees and the pose only.
pub(super) fn for_each_pair(
    trees: (&TreeData, &TreeData),
    pose: &RelativePose,
    workspace: &mut OverlapWorkspace,
    sink: &mut impl PairSink,
) {
    dispatch!(simd_level(), simd => find_pairs(simd, trees, pose, workspace, sink));
}

#[inline(always)]
fn find_pairs<S: Simd>(
    simd: S,
    trees: (&TreeData, &TreeData),
    pose: &RelativePose,
    workspace: &mut OverlapWorkspace,
    sink: &mut impl PairSink,
) {
    let OverlapWorkspace { traversal: scratch, pairs, .. } = workspace;
    pairs.clear();
    let mut finder = PairFinder { trees, pose, pairs, sink };
    for_each_block(simd, &mut finder, scratch);
    finder.pairs.flush(simd, finder.sink);
}

/// Hands every block of B's leaves that has a leaf of A near it to `finder`, in B's order.
#[inline(always)]
fn for_each_block<S: Simd>(simd: S, finder: &mut PairFinder<impl PairSink>, scratch: &mut TraversalScratch) {
    let PairFinder { trees: (a, b), pose, .. } = *finder;
    scratch.fit(a, b);
    let TraversalScratch { near, spare, children, blocks } = scratch;
    let top = b.height();
    let enlarged = pose.with_margin(pose.enlargement((a, b)));
    let root = enlarged.place(simd, &b.root().blocks[0]);
    let a = Skinned { data: a, skin: pose.skin_a };
    descend_alone(simd, (a, top), &Ball::of(simd, &root, 0), spare, &mut children[top]);
    if top == 0 {
        if children[0].len > 0 {
            finder.visit(simd, 0, children[0].indices());
        }
        return;
    }
    blocks[top] = Siblings { balls: root, next: 0, end: 1 };
    let mut level = top;
    loop {
        let siblings = &mut blocks[level];
        if siblings.next == siblings.end || children[level].len == 0 {
            if level == top {
                break;
            }
            level += 1;
            continue;
        }
        let node = siblings.next;
        siblings.next += 1;
        let ball = Ball::of(simd, &siblings.balls, node % WIDTH);
        let below = level - 1;
        let [list, kept] = lists(children, [level, below]);
        kept.len = 0;
        near.len = 0;
        // Of leaves only the numbers are needed.
        match (below < a.data.height(), below) {
            (true, 0) => {
                number_touching(simd, list, &ball, near);
                number_leaves(simd, a, near.indices(), &ball, kept);
            }
            (true, _) => {
                number_touching(simd, list, &ball, near);
                expand(simd, a, (near.indices(), below), &ball, kept);
            }
            (false, 0) => number_touching(simd, list, &ball, kept),
            (false, _) => keep_touching(simd, list, &ball, kept),
        }
        if kept.len == 0 {
            continue;
        }
        if below == 0 {
            finder.visit(simd, node, children[0].indices());
        } else {
            let balls = enlarged.place(simd, &b.levels[below].blocks[node]);
            let end = b.levels[below].len().min((node + 1) * WIDTH);
            blocks[below] = Siblings { balls, next: node * WIDTH, end };
            level = below;
        }
    }
}

/// Fills `list` with A's balls of level `down_to` (or of the root, if that is lower) that meet `ball`.
#[inline(always)]
fn descend_alone<S: Simd>(
    simd: S,
    (a, down_to): (Skinned, usize),
    ball: &Ball<S>,
    spare: &mut Candidates,
    list: &mut Candidates,
) {
    spare.len = 0;
    list.len = 0;
    let root = BlockLanes::new(simd, &a.data.root().blocks[0], 0).enlarged(a.skin);
    let mut tail = list.tail();
    root.append_where(simd, root.touches(ball), &mut tail);
    list.len = tail.close();
    for level in (down_to..a.data.height()).rev() {
        core::mem::swap(spare, list);
        list.len = 0;
        expand(simd, a, (spare.indices(), level), ball, list);
    }
}

/// A's tree and the thickness by which its balls are enlarged.
#[derive(Clone, Copy)]
pub(super) struct Skinned<'a> {
    pub(super) data: &'a TreeData,
    pub(super) skin: f32,
}

/// Appends to `kept` the balls of `list` that meet `ball`.
#[inline(always)]
pub(super) fn keep_touching<S: Simd>(simd: S, list: &Candidates, ball: &Ball<S>, kept: &mut Candidates) {
    let mut tail = kept.tail();
    let blocks = list.blocks();
    for i in 0..blocks.x.len() {
        let block = BlockLanes::of(simd, blocks, i);
        block.append_where(simd, block.touches(ball), &mut tail);
    }
    kept.len = tail.close();
}

/// The lists of two levels, the second just below the first.
#[inline(always)]
fn lists(children: &mut [Candidates], [level, below]: [usize; 2]) -> [&mut Candidates; 2] {
    let (lower, upper) = children.split_at_mut(level);
    [&mut upper[0], &mut lower[below]]
}

/// Appends to `kept` the numbers of those balls of `list` that meet `ball`.
#[inline(always)]
fn number_touching<S: Simd>(simd: S, list: &Candidates, ball: &Ball<S>, kept: &mut Candidates) {
    let mut tail = kept.tail();
    let blocks = list.blocks();
    for i in 0..blocks.x.len() {
        let block = BlockLanes::of(simd, blocks, i);
        block.append_index_where(simd, block.touches(ball), &mut tail);
    }
    kept.len = tail.len;
}

/// Appends to `kept` the numbers of the leaves of A below `parents` that meet `ball`.
#[inline(always)]
fn number_leaves<S: Simd>(simd: S, a: Skinned, parents: &[u32], ball: &Ball<S>, kept: &mut Candidates) {
    let mut tail = kept.tail();
    let blocks = &*a.data.levels[0].blocks;
    let ball = ball.enlarged(a.skin);
    for parent in parents {
        let block = BlockLanes::new(simd, &blocks[*parent as usize], 0);
        let (hits, found) = lanes_in(simd, block.touches(&ball));
        (hits + parent * WIDTH as u32).store_slice(&mut tail.index[tail.len..tail.len + WIDTH]);
        tail.len += found;
    }
    kept.len = tail.len;
}

/// Appends to `kept` the balls on `level` of A below `parents` that meet `ball`.
#[inline(always)]
pub(super) fn expand<S: Simd>(
    simd: S,
    a: Skinned,
    (parents, level): (&[u32], usize),
    ball: &Ball<S>,
    kept: &mut Candidates,
) {
    let mut tail = kept.tail();
    let blocks = &*a.data.levels[level].blocks;
    for parent in parents {
        let parent = *parent as usize;
        let block = BlockLanes::new(simd, &blocks[parent], parent * WIDTH).enlarged(a.skin);
        let mask = block.touches(ball);
        if mask.any_true() {
            block.append_where(simd, mask, &mut tail);
        }
    }
    kept.len = tail.close();
}
