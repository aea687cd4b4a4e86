//! Finding the overlapping pairs of two trees.
//!
//! B's tree is walked depth first; on the way down every ball of B carries the list of A's balls that it
//! meets, on B's own level. A list is filtered by the ball above before its eight children filter it each, so
//! that most tests run on dense arrays. Both trees descend in step; the taller one starts alone.

use super::lanes::{Ball, BlockLanes, live_lanes};
use super::pairs::{Lanes, PairSink};
use super::relative_pose::RelativePose;
use super::workspace::{Candidates, OverlapWorkspace, Siblings};
use crate::tree::{TreeData, WIDTH};
use fearless_simd::{Simd, prelude::*};

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
        pairs.append(simd, &children[0], &Lanes::block_of_b(placed, 0), (placed, sink));
        return pairs.flush(simd, placed, sink);
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
            pairs.append(simd, &children[0], &Lanes::block_of_b(placed, node), (placed, sink));
        } else {
            let end = b.levels[below].len().min((node + 1) * WIDTH);
            blocks[below] = Siblings { balls, next: node * WIDTH, end };
            level = below;
        }
    }
    pairs.flush(simd, placed, sink);
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
    let root = a.block(simd, a.data.height(), 0);
    root.append_where(simd, root.touches(ball), list);
    for level in (down_to..a.data.height()).rev() {
        core::mem::swap(spare, list);
        list.len = 0;
        expand(simd, a, (spare, level), ball, list);
    }
}

/// A's tree and the thickness by which its balls are enlarged.
#[derive(Clone, Copy)]
pub(super) struct Skinned<'a> {
    pub(super) data: &'a TreeData,
    pub(super) skin: f32,
}

impl Skinned<'_> {
    #[inline(always)]
    fn block<S: Simd>(self, simd: S, level: usize, block: usize) -> BlockLanes<S> {
        BlockLanes::new(simd, &self.data.levels[level].blocks[block], self.skin, block * WIDTH)
    }
}

/// Appends to `kept` the balls of `list` that meet `ball`.
#[inline(always)]
pub(super) fn keep_touching<S: Simd>(simd: S, list: &Candidates, ball: &Ball<S>, kept: &mut Candidates) {
    for first in (0..list.len).step_by(WIDTH) {
        let block = BlockLanes::of(simd, list, first);
        let mask = block.touches(ball) & live_lanes(simd, list.len, first);
        block.append_where(simd, mask, kept);
    }
}

/// Appends to `kept` the balls on `level` of A below those of `list` that meet `ball`.
#[inline(always)]
pub(super) fn expand<S: Simd>(
    simd: S,
    a: Skinned,
    (list, level): (&Candidates, usize),
    ball: &Ball<S>,
    kept: &mut Candidates,
) {
    for parent in &list.index[..list.len] {
        let block = a.block(simd, level, *parent as usize);
        let mask = block.touches(ball);
        if mask.any_true() {
            block.append_where(simd, mask, kept);
        }
    }
}
