//! Finding the overlapping pairs of two trees.
//!
//! B's tree is walked depth first; on the way down every ball of B carries the list of A's balls that it
//! meets, on B's own level. A list is filtered by the ball above before its eight children filter it each, so
//! that most tests run on dense arrays. Both trees descend in step; the taller one starts alone.

use super::pairs::PairBuffer;
use super::relative_pose::RelativePose;
use super::workspace::{Candidates, OverlapWorkspace, Siblings};
use crate::tree::{BallBlock, TreeData, WIDTH};
use fearless_simd::{Simd, f32x8, mask32x8, prelude::*, u32x8};

/// Takes the overlapping pairs, a batch at a time.
pub(super) trait PairSink {
    /// Called with at least one pair; `placed` holds the leaves of B in A's frame.
    fn take<S: Simd>(&mut self, simd: S, pairs: &PairBuffer, placed: &[BallBlock]);
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
    let OverlapWorkspace { near, children, blocks, placed, pairs, .. } = workspace;
    let top = b.height();
    let place = |level: usize, block: usize| pose.place(simd, &b.levels[level].blocks[block]);
    let root = place(top, 0);
    let a = Skinned { data: a, skin: pose.skin_a };
    descend_alone(simd, (a, top), &Ball::of(simd, &root, 0), &mut near[top], &mut children[top]);
    if top == 0 {
        placed[0] = root;
        append_pairs(simd, &children[0], (placed, 0), pairs, sink);
        return flush(simd, pairs, placed, sink);
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
        near[level].len = 0;
        keep_touching(simd, &children[level], &ball, &mut near[level]);
        children[below].len = 0;
        if below < a.data.height() {
            expand(simd, a, (&near[level], below), &ball, &mut children[below]);
        } else {
            keep_touching(simd, &near[level], &ball, &mut children[below]);
        }
        if children[below].len == 0 {
            continue;
        }
        let balls = place(below, node);
        if below == 0 {
            placed[node] = balls;
            append_pairs(simd, &children[0], (placed, node), pairs, sink);
        } else {
            let end = b.levels[below].len().min((node + 1) * WIDTH);
            blocks[below] = Siblings { balls, next: node * WIDTH, end };
            level = below;
        }
    }
    flush(simd, pairs, placed, sink);
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
struct Skinned<'a> {
    data: &'a TreeData,
    skin: f32,
}

/// One ball of B in A's frame, in every lane.
#[derive(Clone, Copy)]
struct Ball<S: Simd> {
    x: f32x8<S>,
    y: f32x8<S>,
    z: f32x8<S>,
    radius: f32x8<S>,
}

impl<S: Simd> Ball<S> {
    #[inline(always)]
    fn of(simd: S, block: &BallBlock, lane: usize) -> Self {
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
    fn load(simd: S, tree: Skinned, level: usize, block: usize) -> Self {
        let balls = &tree.data.levels[level].blocks[block];
        let load = |array: [f32; WIDTH]| f32x8::load_array(simd, array);
        Self {
            x: load(balls.x),
            y: load(balls.y),
            z: load(balls.z),
            radius: load(balls.radius) + tree.skin,
            index: u32x8::load_array(simd, [0, 1, 2, 3, 4, 5, 6, 7]) + (block * WIDTH) as u32,
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
        block.append_where(simd, mask, kept);
    }
}

/// Appends to `kept` the balls on `level` of A below those of `list` that meet `ball`.
#[inline(always)]
fn expand<S: Simd>(
    simd: S,
    a: Skinned,
    (list, level): (&Candidates, usize),
    ball: &Ball<S>,
    kept: &mut Candidates,
) {
    for parent in &list.index[..list.len] {
        let block = BlockLanes::load(simd, a, level, *parent as usize);
        let mask = block.touches(ball);
        if mask.any_true() {
            block.append_where(simd, mask, kept);
        }
    }
}

/// Appends the pairs of the eight spheres of block `block` of B's leaves with the spheres of `list`.
///
/// Nothing here branches on the outcome of a test: about two blocks in three hold a hit, and a wrong guess of the processor
/// costs more than a store of nothing.
#[inline(always)]
fn append_pairs<S: Simd>(
    simd: S,
    list: &Candidates,
    (placed, block): (&[BallBlock], usize),
    pairs: &mut PairBuffer,
    sink: &mut impl PairSink,
) {
    for first in (0..list.len).step_by(WIDTH) {
        let lanes = BlockLanes::of(simd, list, first);
        let live = live_lanes(simd, list.len, first);
        if pairs.lacks_room_for_blocks() {
            flush(simd, pairs, placed, sink);
        }
        for lane in 0..WIDTH {
            let mask = lanes.touches(&Ball::of(simd, &placed[block], lane)) & live;
            let at = pairs.len()..pairs.len() + WIDTH;
            simd.compress_u32x8(lanes.index, mask).store_slice(&mut pairs.a[at.clone()]);
            u32x8::splat(simd, (block * WIDTH + lane) as u32).store_slice(&mut pairs.b[at]);
            pairs.advance(mask.to_bitmask().count_ones() as usize);
        }
    }
}

#[inline(always)]
fn flush<S: Simd>(simd: S, pairs: &mut PairBuffer, placed: &[BallBlock], sink: &mut impl PairSink) {
    if pairs.len() > 0 {
        pairs.pad();
        sink.take(simd, pairs, placed);
        pairs.clear();
    }
}
