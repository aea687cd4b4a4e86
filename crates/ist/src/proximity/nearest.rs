//! The nearest pair of balls of two trees, by branch and bound.
//!
//! Best first: of all pairs of nodes that wait, the one with the smallest gap is opened, that is, the larger of its
//! two balls is replaced by its children. What waits bounds the result from below at any time. Before the first
//! pair of spheres is known, and where balls of nodes meet, the nearest child is opened at once instead.

use super::ProximityWorkspace;
use super::side::{Bits, Side, least_lane};
use crate::tree::WIDTH;
use alloc::collections::BinaryHeap;
use core::cmp::Ordering;
use fearless_simd::{Level, Simd, dispatch, prelude::*};
use glam::Vec3;

/// Ratio of radii up to which both nodes of a pair are opened.
const ALIKE: f32 = 3.0;

/// When a search may end, in the frame of the query.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// Pairs with a gap of at least this are of no interest.
    pub(super) cutoff: f32,
    /// A pair with a gap of at most this is good enough.
    pub(super) enough: f32,
    /// By how much the gap found may be larger than the smallest.
    pub(super) tolerance: f32,
    /// Pairs of nodes that may be opened.
    pub(super) visits: usize,
}

/// What a search found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    /// Positions in the trees' own orders.
    pub(super) pair: [usize; 2],
    /// No gap is smaller, but for rounding.
    pub(super) lower: f32,
}

/// A pair of nodes that waits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    /// No pair of spheres below has a smaller gap.
    gap: f32,
    nodes: Nodes,
}

/// A node of either tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Nodes {
    pub(super) level: [u8; 2],
    pub(super) node: [u32; 2],
}

impl Nodes {
    pub(super) fn roots(sides: [&Side; 2]) -> Self {
        Self { level: sides.map(|side| side.data.height() as u8), node: [0, 0] }
    }

    /// The same pair with child `child` in place of the node of tree `side`.
    #[inline(always)]
    pub(super) fn descend(self, side: usize, child: usize) -> Self {
        let mut nodes = self;
        nodes.level[side] -= 1;
        nodes.node[side] = child as u32;
        nodes
    }

    #[inline(always)]
    pub(super) fn balls(self, sides: &[Side; 2]) -> [(Vec3, f32); 2] {
        let ball = |side: usize| sides[side].ball(self.level[side].into(), self.node[side] as usize);
        [ball(0), ball(1)]
    }

    /// Which of the two nodes to open, by their radii: the larger one, or the one that has children.
    #[inline(always)]
    pub(super) fn larger<T: PartialOrd>(self, radius: [T; 2]) -> usize {
        match self.level {
            [_, 0] => 0,
            [0, _] => 1,
            _ => usize::from(radius[1] > radius[0]),
        }
    }

    /// Whether to open both nodes at once: where neither is much larger, and both have children.
    #[inline(always)]
    pub(super) fn open_both(self, radius: [f32; 2]) -> bool {
        self.level[0] > 0
            && self.level[1] > 0
            && radius[0] < ALIKE * radius[1]
            && radius[1] < ALIKE * radius[0]
    }

    pub(super) fn are_leaves(self) -> bool {
        self.level == [0, 0]
    }
}

/// The smallest gap is the greatest of a max-heap; the order is total, so that equal input gives equal results.
impl Ord for Candidate {
    #[inline(always)]
    fn cmp(&self, other: &Self) -> Ordering {
        other.gap.total_cmp(&self.gap).then_with(|| other.nodes.cmp(&self.nodes))
    }
}

impl PartialOrd for Candidate {
    #[inline(always)]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Candidate {}

/// The pair of spheres with the smallest gap below `limits.cutoff`; `None` where there is none.
pub(super) fn nearest_pair(
    sides: [Side; 2],
    limits: Limits,
    workspace: &mut ProximityWorkspace,
) -> Option<Nearest> {
    workspace.candidates.clear();
    let mut search = Search { sides, heap: &mut workspace.candidates, gap: limits.cutoff, pair: None };
    let (lower, exhausted) = dispatch!(Level::new(), simd => search.run(simd, limits));
    match search.pair {
        // Out of visits, and the first way down led beyond the cutoff: any pair tells something.
        None if exhausted => Some(Nearest { pair: [0, 0], lower }),
        pair => pair.map(|pair| Nearest { pair, lower }),
    }
}

struct Search<'a> {
    sides: [Side<'a>; 2],
    heap: &'a mut BinaryHeap<Candidate>,
    /// Gap of `pair`, or the cutoff.
    gap: f32,
    pair: Option<[usize; 2]>,
}

impl Search<'_> {
    /// The lower bound that was reached, and whether visits ran out.
    #[inline(always)]
    fn run<S: Simd>(&mut self, simd: S, limits: Limits) -> (f32, bool) {
        let mut next =
            Some(Candidate { gap: f32::NEG_INFINITY, nodes: Nodes::roots([&self.sides[0], &self.sides[1]]) });
        let (mut visits, mut first_descent) = (0, true);
        loop {
            first_descent &= next.is_some();
            let Some(candidate) = next.take().or_else(|| self.heap.pop()) else {
                return (self.gap, false);
            };
            if candidate.gap >= self.gap - limits.tolerance && self.pair.is_some() {
                return (candidate.gap.min(self.gap), false);
            }
            // The first way down does not count: a pair of spheres is worth more than any bound.
            if visits >= limits.visits && !first_descent {
                let waiting = self.heap.peek().map_or(f32::INFINITY, |c| c.gap);
                return (candidate.gap.min(waiting).min(self.gap), true);
            }
            visits += 1;
            next = self.open(simd, candidate);
            if self.pair.is_some() && self.gap <= limits.enough {
                return (self.gap, false);
            }
        }
    }

    /// Opens a pair of nodes; returns a child to go on with at once.
    #[inline(always)]
    fn open<S: Simd>(&mut self, simd: S, candidate: Candidate) -> Option<Candidate> {
        let nodes = candidate.nodes;
        let balls = nodes.balls(&self.sides);
        if nodes.level == [1, 1] {
            self.open_last(simd, nodes, balls);
            return None;
        }
        if nodes.are_leaves() {
            self.see(gap(balls[0], balls[1]), nodes.node.map(|node| node as usize));
            return None;
        }
        if self.pair.is_some() && nodes.open_both([balls[0].1, balls[1].1]) {
            self.open_pair(simd, candidate, balls);
            return None;
        }
        let opened = nodes.larger([balls[0].1, balls[1].1]);
        let level = usize::from(nodes.level[opened]) - 1;
        let first = nodes.node[opened] as usize * WIDTH;
        let (block, live) = self.sides[opened].block(simd, level, first);
        let gaps = block.gaps(balls[1 - opened]);
        let mask = gaps.simd_lt(self.gap).to_bitmask() as u32 & live;
        if nodes.descend(opened, 0).are_leaves() {
            for lane in Bits(mask) {
                let mut pair = nodes.node.map(|node| node as usize);
                pair[opened] = first + lane;
                let ball = self.sides[opened].ball(0, first + lane);
                self.see(gap(ball, balls[1 - opened]), pair);
            }
            return None;
        }
        if mask == 0 {
            return None;
        }
        let gaps = gaps.to_array();
        let child = |lane: usize| Candidate {
            // A child's ball may reach out of its parent's; the spheres in it do not.
            gap: gaps[lane].max(candidate.gap),
            nodes: nodes.descend(opened, first + lane),
        };
        let nearest = least_lane(&gaps, mask);
        let at_once = self.pair.is_none() || gaps[nearest] <= 0.0;
        let later = if at_once { mask & !(1 << nearest) } else { mask };
        for lane in Bits(later) {
            self.heap.push(child(lane));
        }
        at_once.then(|| child(nearest))
    }

    /// Opens both nodes.
    #[inline(always)]
    fn open_pair<S: Simd>(&mut self, simd: S, candidate: Candidate, balls: [(Vec3, f32); 2]) {
        let nodes = candidate.nodes;
        let first = nodes.node.map(|node| node as usize * WIDTH);
        let level = nodes.level.map(|level| usize::from(level) - 1);
        let (block_b, live_b) = self.sides[1].block(simd, level[1], first[1]);
        let rows = block_b.gaps(balls[0]).simd_lt(self.gap).to_bitmask() as u32 & live_b;
        if rows == 0 {
            return;
        }
        let (block_a, live_a) = self.sides[0].block(simd, level[0], first[0]);
        for row in Bits(rows) {
            let gaps = block_a.gaps(block_b.ball(row));
            let mask = gaps.simd_lt(self.gap).to_bitmask() as u32 & live_a;
            let gaps = gaps.to_array();
            let nodes = nodes.descend(1, first[1] + row);
            for lane in Bits(mask) {
                let gap = gaps[lane].max(candidate.gap);
                self.heap.push(Candidate { gap, nodes: nodes.descend(0, first[0] + lane) });
            }
        }
    }

    /// Looks at the spheres below two nodes of level 1.
    #[inline(always)]
    fn open_last<S: Simd>(&mut self, simd: S, nodes: Nodes, balls: [(Vec3, f32); 2]) {
        let first = nodes.node.map(|node| node as usize * WIDTH);
        let (block_b, live_b) = self.sides[1].block(simd, 0, first[1]);
        let rows = block_b.gaps(balls[0]).simd_lt(self.gap).to_bitmask() as u32 & live_b;
        if rows == 0 {
            return;
        }
        let (block_a, live_a) = self.sides[0].block(simd, 0, first[0]);
        for row in Bits(rows) {
            let gaps = block_a.gaps(block_b.ball(row));
            let ball_b = self.sides[1].ball(0, first[1] + row);
            for lane in Bits(gaps.simd_lt(self.gap).to_bitmask() as u32 & live_a) {
                let gap = gap(self.sides[0].ball(0, first[0] + lane), ball_b);
                self.see(gap, [first[0] + lane, first[1] + row]);
            }
        }
    }

    #[inline(always)]
    fn see(&mut self, gap: f32, pair: [usize; 2]) {
        if gap < self.gap {
            (self.gap, self.pair) = (gap, Some(pair));
        }
    }
}

/// Distance of two balls, negative where they meet.
#[inline(always)]
fn gap(a: (Vec3, f32), b: (Vec3, f32)) -> f32 {
    a.0.distance(b.0) - (a.1 + b.1)
}
