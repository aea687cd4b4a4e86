//! The nearest pair of balls of two trees, by branch and bound.
//!
//! Depth first: of the pair of nodes at hand, the larger ball is replaced by its children, and the nearest child is
//! looked at next. Pairs that cannot hold anything nearer are left out. Best first, by a heap over all pairs that
//! wait, visits fewer pairs and takes 1.4 to 2.5 times as long (1,000 and 10,000 spheres, apart to touching); but a
//! search that is interrupted has the best bound from below that way. So it is used where visits are bounded, from
//! the first pair of spheres on.

use super::ProximityWorkspace;
use super::side::{Bits, Side};
use crate::simd_level::simd_level;
use crate::tree::WIDTH;
use alloc::collections::BinaryHeap;
use alloc::vec::Vec;
use core::cmp::Ordering;
use fearless_simd::{Simd, dispatch, prelude::*};
use glam::Vec3;

/// Pairs on the way down from the roots of the tallest trees to two spheres, at most.
const DESCENT: usize = 22;

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
    workspace.by_gap.clear();
    let mut search = Search {
        sides,
        stack: &mut workspace.candidates,
        heap: &mut workspace.by_gap,
        gap: limits.cutoff,
        pair: None,
    };
    let (lower, exhausted) = dispatch!(simd_level(), simd => search.run(simd, limits));
    match search.pair {
        // Out of visits before anything below the cutoff was seen: any pair tells something.
        None if exhausted => Some(Nearest { pair: [0, 0], lower }),
        None => None,
        Some(pair) => Some(Nearest { pair, lower }),
    }
}

struct Search<'a> {
    sides: [Side<'a>; 2],
    /// Pairs of nodes that wait, the next one last.
    stack: &'a mut Vec<Candidate>,
    /// Those that wait in the order of their gaps.
    heap: &'a mut BinaryHeap<Candidate>,
    /// Gap of `pair`, or the cutoff.
    gap: f32,
    pair: Option<[usize; 2]>,
}

impl Search<'_> {
    /// The lower bound that was reached, and whether visits ran out.
    #[inline(always)]
    fn run<S: Simd>(&mut self, simd: S, limits: Limits) -> (f32, bool) {
        let is_bounded = limits.visits < usize::MAX;
        let nodes = Nodes::roots([&self.sides[0], &self.sides[1]]);
        self.stack.push(Candidate { gap: f32::NEG_INFINITY, nodes });
        let (mut visits, mut lower) = (0, f32::INFINITY);
        while let Some(candidate) = self.next(is_bounded) {
            if self.pair.is_some() && candidate.gap >= self.gap - limits.tolerance {
                lower = lower.min(candidate.gap);
                continue;
            }
            // The way down to the first pair does not count: a distance is worth more than any bound.
            if visits >= limits.visits
                && (self.pair.is_some() || visits >= limits.visits.saturating_add(DESCENT))
            {
                let waiting = self.stack.iter().chain(self.heap.iter()).map(|c| c.gap);
                return (waiting.fold(candidate.gap.min(self.gap), f32::min).min(lower), true);
            }
            visits += 1;
            self.open(simd, candidate);
            if self.pair.is_some() && self.gap <= limits.enough {
                return (self.gap, false);
            }
        }
        (lower.min(self.gap), false)
    }

    /// The pair of nodes to look at next.
    #[inline(always)]
    fn next(&mut self, is_bounded: bool) -> Option<Candidate> {
        if is_bounded && self.pair.is_some() {
            self.heap.extend(self.stack.drain(..));
            return self.heap.pop();
        }
        self.stack.pop()
    }

    /// Opens a pair of nodes.
    #[inline(always)]
    fn open<S: Simd>(&mut self, simd: S, candidate: Candidate) {
        let nodes = candidate.nodes;
        let balls = nodes.balls(&self.sides);
        if nodes.level == [1, 1] {
            self.open_last(simd, nodes, balls);
            return;
        }
        if nodes.are_leaves() {
            self.see(gap(balls[0], balls[1]), nodes.node.map(|node| node as usize));
            return;
        }
        let opened = nodes.larger([balls[0].1, balls[1].1]);
        let level = usize::from(nodes.level[opened]) - 1;
        let first = nodes.node[opened] as usize * WIDTH;
        let (block, live) = self.sides[opened].block(simd, level, first);
        let gaps = block.gaps(balls[1 - opened]);
        let mask = gaps.simd_lt(self.gap).to_bitmask() as u32 & live;
        let gaps = gaps.to_array();
        let last = nodes.descend(opened, 0).are_leaves();
        let base = self.stack.len();
        for lane in Bits(mask) {
            let nodes = nodes.descend(opened, first + lane);
            if last {
                let ball = self.sides[opened].ball(0, first + lane);
                self.see(gap(ball, balls[1 - opened]), nodes.node.map(|node| node as usize));
            } else {
                // A child's ball may reach out of its parent's; the spheres in it do not.
                self.insert(base, Candidate { gap: gaps[lane].max(candidate.gap), nodes });
            }
        }
    }

    /// Pushes a candidate among those above `base`, which stand in the order of falling gaps.
    #[inline(always)]
    fn insert(&mut self, base: usize, candidate: Candidate) {
        let mut at = self.stack.len();
        self.stack.push(candidate);
        while at > base && self.stack[at - 1].gap < candidate.gap {
            self.stack[at] = self.stack[at - 1];
            at -= 1;
        }
        self.stack[at] = candidate;
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
