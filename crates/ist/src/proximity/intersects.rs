//! Whether two solids meet.

use super::nearest::Nodes;
use super::placement::Placement;
use super::side::{Bits, Side, nearest_last};
use super::{BallKind, ProximityWorkspace};
use crate::InnerSphereTree;
use crate::certified::{CertifiedBalls, CertifiedPlacement};
use crate::simd_level::simd_level;
use crate::tree::WIDTH;
use alloc::vec::Vec;
use fearless_simd::{Simd, dispatch, prelude::*};
use glam::Vec3;
use glamx::Pose3;

impl InnerSphereTree {
    /// Whether an inner ball of this solid (A) meets one of `other` (B), whose frame stands at `pose` in A's frame:
    /// the answer of [`Overlap::intersects`](crate::Overlap::intersects) without the overlap.
    ///
    /// True for no two solids that are apart. False where the pose is not finite, its quaternion far from unit
    /// length, or a coordinate beyond 10¹⁸ times A's size. The search goes deep first and ends at the first two
    /// balls that meet.
    #[must_use]
    pub fn intersects(&self, other: &Self, pose: &Pose3, workspace: &mut ProximityWorkspace) -> bool {
        let Some(placement) = Placement::new(self, other, pose) else { return false };
        let kind = BallKind::Inner;
        let sides = [Side::fixed(self, kind), Side::placed(other, kind, self, &placement)];
        let roots = [0, 1].map(|side: usize| sides[side].ball(sides[side].data.height(), 0));
        if !meet(roots[0], (roots[1].0, roots[1].1 + placement.rounding)) {
            return false;
        }
        let certified =
            CertifiedBalls::new([self.data(), other.data()], CertifiedPlacement::new(self, other, pose));
        let pair = Pair { sides, slack: placement.rounding, certified };
        dispatch!(simd_level(), simd => some_pair_meets(simd, &pair, &mut workspace.stack))
    }
}

/// Ratio of radii up to which both nodes of a pair are opened at once.
///
/// For equal bodies of 1,000 and 10,000 spheres close to contact, opening both saves 40 to 50 % of the time against opening the
/// larger one; 2, 3 and 8 are equally good. Beyond, the smaller one would be opened too early, again and again.
const ALIKE: f32 = 3.0;

fn are_alike(nodes: Nodes, [a, b]: [(Vec3, f32); 2]) -> bool {
    nodes.level[0] > 0 && nodes.level[1] > 0 && a.1 < ALIKE * b.1 && b.1 < ALIKE * a.1
}

/// What is searched.
struct Pair<'a> {
    sides: [Side<'a>; 2],
    /// Nodes count as meeting when they are less than this apart.
    slack: f32,
    certified: CertifiedBalls<'a>,
}

impl Pair<'_> {
    /// The test of the overlap, operation by operation: whether two balls of the lowest level meet.
    #[inline(always)]
    fn meet(&self, positions: [usize; 2], a: (Vec3, f32), b: (Vec3, f32)) -> bool {
        meet(a, b) && self.certified.meet(positions)
    }
}

#[inline(always)]
fn meet(a: (Vec3, f32), b: (Vec3, f32)) -> bool {
    let reach = a.1 + b.1;
    a.0.distance_squared(b.0) < reach * reach
}

/// Whether two balls meet.
#[inline(always)]
fn some_pair_meets<S: Simd>(simd: S, pair: &Pair, stack: &mut Vec<Nodes>) -> bool {
    let Pair { sides, slack, .. } = *pair;
    stack.clear();
    stack.push(Nodes::roots([&sides[0], &sides[1]]));
    while let Some(nodes) = stack.pop() {
        let balls = nodes.balls(&sides);
        if nodes.are_leaves() {
            if pair.meet(nodes.node.map(|node| node as usize), balls[0], balls[1]) {
                return true;
            }
            continue;
        }
        if nodes.level == [1, 1] {
            if some_sphere_meets(simd, pair, nodes, balls[0]) {
                return true;
            }
            continue;
        }
        if are_alike(nodes, balls) {
            push_pairs(simd, sides, (nodes, balls[0], slack), stack);
            continue;
        }
        let opened = nodes.larger([balls[0].1, balls[1].1]);
        let level = usize::from(nodes.level[opened]) - 1;
        let first = nodes.node[opened] as usize * WIDTH;
        let (block, live) = sides[opened].block(simd, level, first);
        let gaps = block.gaps(balls[1 - opened]);
        let mask = gaps.simd_lt(slack).to_bitmask() as u32 & live;
        let gaps = gaps.to_array();
        for lane in nearest_last(&gaps, mask) {
            stack.push(nodes.descend(opened, first + lane));
        }
    }
    false
}

/// Pushes the pairs of children of two nodes that meet, a near pair last; `node_a` is A's ball.
#[inline(always)]
fn push_pairs<S: Simd>(
    simd: S,
    sides: [Side; 2],
    (nodes, node_a, slack): (Nodes, (Vec3, f32), f32),
    stack: &mut Vec<Nodes>,
) {
    let first = nodes.node.map(|node| node as usize * WIDTH);
    let level = nodes.level.map(|level| usize::from(level) - 1);
    let (block_b, live_b) = sides[1].block(simd, level[1], first[1]);
    let rows = block_b.gaps(node_a);
    let mask = rows.simd_lt(slack).to_bitmask() as u32 & live_b;
    if mask == 0 {
        return;
    }
    let (block_a, live_a) = sides[0].block(simd, level[0], first[0]);
    for row in nearest_last(&rows.to_array(), mask) {
        let gaps = block_a.gaps(block_b.ball(row));
        let mask = gaps.simd_lt(slack).to_bitmask() as u32 & live_a;
        let nodes = nodes.descend(1, first[1] + row);
        for lane in nearest_last(&gaps.to_array(), mask) {
            stack.push(nodes.descend(0, first[0] + lane));
        }
    }
}

/// Whether two spheres below nodes of level 1 meet; `node_a` is A's ball.
#[inline(always)]
fn some_sphere_meets<S: Simd>(simd: S, pair: &Pair, nodes: Nodes, node_a: (Vec3, f32)) -> bool {
    let Pair { sides, slack, .. } = *pair;
    let first = nodes.node.map(|node| node as usize * WIDTH);
    let (block_b, live_b) = sides[1].block(simd, 0, first[1]);
    let rows = block_b.nearer_than(slack, node_a) & live_b;
    if rows == 0 {
        return false;
    }
    let (block_a, live_a) = sides[0].block(simd, 0, first[0]);
    for row in Bits(rows) {
        let ball_b = sides[1].ball(0, first[1] + row);
        for lane in Bits(block_a.nearer_than(slack, block_b.ball(row)) & live_a) {
            let positions = [first[0] + lane, first[1] + row];
            if pair.meet(positions, sides[0].ball(0, positions[0]), ball_b) {
                return true;
            }
        }
    }
    false
}
