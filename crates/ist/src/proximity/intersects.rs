//! Whether two solids meet.

use super::BallKind;
use super::nearest::Nodes;
use super::placement::Placement;
use super::side::{Side, bits};
use super::stack::Stack;
use crate::InnerSphereTree;
use crate::tree::WIDTH;
use fearless_simd::{Level, Simd, dispatch, prelude::*};
use glamx::Pose3;

impl InnerSphereTree {
    /// Whether an inner ball of this solid (A) meets one of `other` (B), whose frame stands at `pose` in A's frame:
    /// the answer of [`Overlap::intersects`](crate::Overlap::intersects) without the overlap.
    ///
    /// True for no two solids that are apart. False where the pose is not finite, its quaternion far from unit
    /// length, or B farther than 10¹⁸ times A's unscaled coordinates. The search goes deep first and ends at the first
    /// two balls that meet.
    #[must_use]
    pub fn intersects(&self, other: &Self, pose: &Pose3) -> bool {
        let Some(placement) = Placement::new(self, other, pose) else { return false };
        let kind = BallKind::Inner;
        let sides = [Side::fixed(self, kind), Side::placed(other, kind, self, &placement)];
        dispatch!(Level::new(), simd => some_pair_meets(simd, sides, placement.rounding))
    }
}

/// Whether two balls meet; nodes count as meeting when they are less than `slack` apart.
#[inline(always)]
fn some_pair_meets<S: Simd>(simd: S, sides: [Side; 2], slack: f32) -> bool {
    let mut stack = Stack::new((f32::NEG_INFINITY, Nodes::roots([&sides[0], &sides[1]])));
    while let Some((_, nodes)) = stack.pop() {
        let balls = [0, 1].map(|side| sides[side].ball(nodes.level[side].into(), nodes.node[side] as usize));
        if nodes.are_leaves() {
            let reach = balls[0].1 + balls[1].1;
            if balls[0].0.distance_squared(balls[1].0) < reach * reach {
                return true;
            }
            continue;
        }
        if nodes.level == [1, 1] {
            let first = nodes.node.map(|node| node as usize * WIDTH);
            let (block_b, live_b) = sides[1].block(simd, 0, first[1]);
            let (block_a, live_a) = sides[0].block(simd, 0, first[0]);
            let rows = block_b.gaps(balls[0]).simd_lt(slack).to_bitmask() as u32 & live_b;
            if bits(rows).any(|row| block_a.meeting(block_b.ball(row)) & live_a != 0) {
                return true;
            }
            continue;
        }
        let opened = nodes.larger([balls[0].1, balls[1].1]);
        let level = usize::from(nodes.level[opened]) - 1;
        let first = nodes.node[opened] as usize * WIDTH;
        let (block, live) = sides[opened].block(simd, level, first);
        if nodes.descend(opened, 0).are_leaves() {
            if block.meeting(balls[1 - opened]) & live != 0 {
                return true;
            }
            continue;
        }
        let gaps = block.gaps(balls[1 - opened]);
        let base = stack.len();
        for lane in bits(gaps.simd_lt(slack).to_bitmask() as u32 & live) {
            stack.push((gaps[lane], nodes.descend(opened, first + lane)));
        }
        stack.nearest_on_top(base, |(gap, _)| *gap);
    }
    false
}
