//! Finding the overlapping pairs of two trees.
//!
//! B's tree is walked depth first; on the way down every ball of B carries the list of A's balls that it
//! meets, on B's own level. A list is filtered by the ball above before its eight children filter it each, so
//! that most tests run on dense arrays. Both trees descend in step; the taller one starts alone.

use super::pairs::PairBuffer;
use super::relative_pose::RelativePose;
use super::workspace::{Block, Candidates, OverlapWorkspace};
use crate::tree::{TreeData, WIDTH};
use fearless_simd::{Simd, f32x8, mask32x8, prelude::*, u32x8};

/// Takes the overlapping pairs, a batch at a time.
pub(crate) trait PairSink {
    /// Called with at least one pair; lanes behind the last pair up to a whole block are padding that
    /// overlaps nothing.
    fn take<S: Simd>(&mut self, simd: S, pairs: &PairBuffer);
}

/// Hands every pair of overlapping volume balls to `sink`, each once, in an order that depends on
/// the trees and the pose only.
#[inline(always)]
pub(super) fn for_each_pair<S: Simd>(
    simd: S,
    (a, b): (&TreeData, &TreeData),
    pose: &RelativePose,
    workspace: &mut OverlapWorkspace,
    sink: &mut impl PairSink,
) {
    workspace.fit(a, b);
    let OverlapWorkspace { near, children, blocks, pairs, .. } = workspace;
    let top = b.height();
    blocks[top] = pose.transform_block(simd, b.root(), 0);
    let ball = Ball::of(simd, &blocks[top], 0);
    let a = Skinned { data: a, skin: pose.skin_a };
    descend_alone(simd, (a, top), &ball, &mut near[top], &mut children[top]);
    let mut level = top;
    loop {
        let block = &mut blocks[level];
        if block.next == block.end || children[level].len == 0 {
            if level == top {
                break;
            }
            level += 1;
            continue;
        }
        let node = block.next;
        block.next += 1;
        let ball = Ball::of(simd, block, node % WIDTH);
        if level == 0 {
            append_pairs(simd, &children[0], (ball, node), pairs, sink);
            continue;
        }
        near[level].len = 0;
        keep_touching(simd, &children[level], &ball, &mut near[level]);
        level -= 1;
        children[level].len = 0;
        if level < a.data.height() {
            expand(simd, a, (&near[level + 1], level), &ball, &mut children[level]);
        } else {
            keep_touching(simd, &near[level + 1], &ball, &mut children[level]);
        }
        blocks[level] = pose.transform_block(simd, &b.levels[level], node * WIDTH);
    }
    flush(simd, pairs, sink);
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
    let root = BlockLanes::load(simd, a, a.data.height(), 0);
    root.append_where(simd, root.touches(ball), list);
    for level in (down_to..a.data.height()).rev() {
        core::mem::swap(spare, list);
        list.len = 0;
        expand(simd, a, (spare, level), ball, list);
    }
}

/// A's tree and the thickness by which its balls are enlarged.
#[derive(Clone, Copy)]
pub(crate) struct Skinned<'a> {
    pub(crate) data: &'a TreeData,
    pub(crate) skin: f32,
}

/// One ball of B in A's frame, in every lane.
#[derive(Clone, Copy)]
pub(crate) struct Ball<S: Simd> {
    x: f32x8<S>,
    y: f32x8<S>,
    z: f32x8<S>,
    radius: f32x8<S>,
}

impl<S: Simd> Ball<S> {
    #[inline(always)]
    pub(crate) fn of(simd: S, block: &Block, lane: usize) -> Self {
        Self {
            x: f32x8::splat(simd, block.x[lane]),
            y: f32x8::splat(simd, block.y[lane]),
            z: f32x8::splat(simd, block.z[lane]),
            radius: f32x8::splat(simd, block.radius[lane]),
        }
    }
}

/// Eight balls of A.
#[derive(Clone, Copy)]
struct BlockLanes<S: Simd> {
    x: f32x8<S>,
    y: f32x8<S>,
    z: f32x8<S>,
    radius: f32x8<S>,
    index: u32x8<S>,
}

impl<S: Simd> BlockLanes<S> {
    #[inline(always)]
    fn load(simd: S, tree: Skinned, level: usize, first: usize) -> Self {
        let balls = &tree.data.levels[level];
        let load = |array: &[f32]| f32x8::from_slice(simd, &array[first..first + WIDTH]);
        Self {
            x: load(&balls.x),
            y: load(&balls.y),
            z: load(&balls.z),
            radius: load(&balls.radius) + tree.skin,
            index: u32x8::load_array(simd, [0, 1, 2, 3, 4, 5, 6, 7]) + first as u32,
        }
    }

    #[inline(always)]
    fn of(simd: S, list: &Candidates, first: usize) -> Self {
        let load = |array: &[f32]| f32x8::from_slice(simd, &array[first..first + WIDTH]);
        Self {
            x: load(&list.x),
            y: load(&list.y),
            z: load(&list.z),
            radius: load(&list.radius),
            index: u32x8::from_slice(simd, &list.index[first..first + WIDTH]),
        }
    }

    #[inline(always)]
    fn touches(&self, ball: &Ball<S>) -> mask32x8<S> {
        let (dx, dy, dz) = (self.x - ball.x, self.y - ball.y, self.z - ball.z);
        let reach = self.radius + ball.radius;
        (dx * dx + dy * dy + dz * dz).simd_lt(reach * reach)
    }

    #[inline(always)]
    fn append_where(&self, simd: S, mask: mask32x8<S>, list: &mut Candidates) {
        let at = list.len..list.len + WIDTH;
        simd.compress_f32x8(self.x, mask).store_slice(&mut list.x[at.clone()]);
        simd.compress_f32x8(self.y, mask).store_slice(&mut list.y[at.clone()]);
        simd.compress_f32x8(self.z, mask).store_slice(&mut list.z[at.clone()]);
        simd.compress_f32x8(self.radius, mask).store_slice(&mut list.radius[at.clone()]);
        simd.compress_u32x8(self.index, mask).store_slice(&mut list.index[at]);
        list.len += mask.to_bitmask().count_ones() as usize;
    }
}

/// Lanes of the block at `first` that hold one of the list's `len` balls.
#[inline(always)]
fn live_lanes<S: Simd>(simd: S, len: usize, first: usize) -> mask32x8<S> {
    let live = (len - first).min(WIDTH);
    mask32x8::from_bitmask(simd, (1 << live) - 1)
}

/// Appends to `kept` the balls of `list` that meet `ball`.
#[inline(always)]
fn keep_touching<S: Simd>(simd: S, list: &Candidates, ball: &Ball<S>, kept: &mut Candidates) {
    for first in (0..list.len).step_by(WIDTH) {
        let block = BlockLanes::of(simd, list, first);
        let mask = block.touches(ball) & live_lanes(simd, list.len, first);
        if mask.any_true() {
            block.append_where(simd, mask, kept);
        }
    }
}

/// Appends to `kept` the balls on `level` of A below those of `list` that meet `ball`.
#[inline(always)]
pub(crate) fn expand<S: Simd>(
    simd: S,
    a: Skinned,
    (list, level): (&Candidates, usize),
    ball: &Ball<S>,
    kept: &mut Candidates,
) {
    for parent in &list.index[..list.len] {
        let block = BlockLanes::load(simd, a, level, *parent as usize * WIDTH);
        let mask = block.touches(ball);
        if mask.any_true() {
            block.append_where(simd, mask, kept);
        }
    }
}

/// Appends the pairs of sphere `ball` of B (number `index` of its leaves) with the spheres of `list`.
#[inline(always)]
pub(crate) fn append_pairs<S: Simd>(
    simd: S,
    list: &Candidates,
    (ball, index): (Ball<S>, usize),
    pairs: &mut PairBuffer,
    sink: &mut impl PairSink,
) {
    for first in (0..list.len).step_by(WIDTH) {
        let block = BlockLanes::of(simd, list, first);
        let mask = block.touches(&ball) & live_lanes(simd, list.len, first);
        if !mask.any_true() {
            continue;
        }
        if pairs.is_full() {
            flush(simd, pairs, sink);
        }
        let at = pairs.len()..pairs.len() + WIDTH;
        simd.compress_f32x8(block.x, mask).store_slice(&mut pairs.a.x[at.clone()]);
        simd.compress_f32x8(block.y, mask).store_slice(&mut pairs.a.y[at.clone()]);
        simd.compress_f32x8(block.z, mask).store_slice(&mut pairs.a.z[at.clone()]);
        simd.compress_f32x8(block.radius, mask).store_slice(&mut pairs.a.radius[at.clone()]);
        simd.compress_u32x8(block.index, mask).store_slice(&mut pairs.a.index[at.clone()]);
        ball.x.store_slice(&mut pairs.b.x[at.clone()]);
        ball.y.store_slice(&mut pairs.b.y[at.clone()]);
        ball.z.store_slice(&mut pairs.b.z[at.clone()]);
        ball.radius.store_slice(&mut pairs.b.radius[at.clone()]);
        u32x8::splat(simd, index as u32).store_slice(&mut pairs.b.index[at]);
        pairs.advance(mask.to_bitmask().count_ones() as usize);
    }
}

#[inline(always)]
pub(crate) fn flush<S: Simd>(simd: S, pairs: &mut PairBuffer, sink: &mut impl PairSink) {
    if pairs.len() > 0 {
        pairs.pad();
        sink.take(simd, pairs);
        pairs.clear();
    }
}
