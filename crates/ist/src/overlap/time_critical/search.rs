//! Opening one part of the overlap after the other, until the budget is spent.

use super::super::lanes::{Ball, BlockLanes};
use super::super::pairs::{NearLeaves, SphereBlock};
use super::super::totals::{Extras, Totals, TotalsSink};
use super::super::traversal::{Skinned, expand, keep_touching};
use super::super::workspace::Candidates;
use super::bounds::{ROW, RowMaker};
use super::budget::Meter;
use super::query::Query;
use super::row::{Row, add_open};
use super::workspace::TimeCriticalWorkspace;
use crate::tree::{BallBlock, WIDTH};
use core::ops::Range;
use fearless_simd::{Simd, f32x8, prelude::*};

/// Of a node of B and nodes of A with radii further apart than this only the larger are opened. With 2.5, 4, 8 and no
/// limit a complete query of two rabbits of 10,000 spheres in mid overlap takes 8301, 6087, 3889 and 3756 visits; with
/// a limit a small solid inside a large one is placed sooner.
const ALIKE: f32 = 8.0;

/// Pairs and parts that are resolved together. A search that stops drops those that wait, so that it has seen the same
/// as one with a larger budget has at that point. With 1, 64 and 200 pairs a complete query of two rabbits of 10,000
/// spheres takes 157, 133 and 138 µs in mid overlap, 433, 378 and 402 µs in deep.
const PENDING_PAIRS: usize = 64;
const PENDING_PARTS: usize = 32;

/// What a search has found, in A's unscaled frame.
pub(super) struct Found {
    /// Bounds of the volume, rounding not included.
    pub(super) lower: f64,
    pub(super) upper: f64,
    /// Resolved pairs exactly and all others as expected.
    pub(super) totals: Totals,
    pub(super) complete: bool,
}

/// Opens rows until none is left or the budget is spent.
#[inline(always)]
pub(super) fn search<S: Simd>(
    simd: S,
    query: &Query,
    meter: &mut Meter,
    workspace: &mut TimeCriticalWorkspace,
) -> Found {
    workspace.clear();
    // No stiffness, as there is none for what is only expected.
    let extras = Extras { outward: true, stiffness: false };
    let resolved = TotalsSink::new((query.a.tree, query.b.tree), query.pose, extras);
    let mut search = Search { query, meter, workspace, resolved };
    let (mut lower, mut upper) = (0.0_f64, f64::INFINITY);
    search.begin(simd);
    let complete = loop {
        let (sums, volume) = (&search.workspace.frontier.sums, search.resolved.totals.volume);
        let slack = sums.rounding() + query.vanishing;
        lower = lower.max(volume + sums.lower - slack);
        upper = upper.min(volume + sums.upper + slack);
        let Some(len) = search.workspace.frontier.next_len() else {
            search.settle(simd);
            break true;
        };
        if !(search.meter.spend(len) && search.open_next(simd)) {
            break false;
        }
    };
    let mut totals = search.resolved.totals;
    if complete {
        let (lower, upper) = (lower.max(totals.volume), upper.min(totals.volume));
        return Found { lower, upper, totals, complete };
    }
    let open = &search.workspace.frontier.sums.expected;
    // Bounds may be tighter than those of the parts that are open now: they never widen.
    let expected = (totals.volume + open.volume).clamp(lower, upper.max(lower)) - totals.volume;
    let factor = if open.volume > 0.0 { expected / open.volume } else { 0.0 };
    add_open(&mut totals, open, factor.max(0.0));
    Found { lower, upper, totals, complete }
}

/// A search on its way.
struct Search<'s, 'q> {
    query: &'q Query<'q>,
    meter: &'s mut Meter,
    workspace: &'s mut TimeCriticalWorkspace,
    resolved: TotalsSink<'q>,
}

impl Search<'_, '_> {
    /// The pair of the roots: there must be something that is known, whatever the time.
    #[inline(always)]
    fn begin<S: Simd>(&mut self, simd: S) {
        let levels = (self.query.a.tree.height(), self.query.b.tree.height());
        let TimeCriticalWorkspace { nodes_a, children_a, .. } = &mut *self.workspace;
        nodes_a.index[0] = 0;
        nodes_a.len = 1;
        copy_nodes(self.query, levels.0, nodes_a, children_a);
        // The clock is not yet read.
        self.test_children(simd, levels, 0..1);
        self.workspace.frontier.accept();
        // Two single spheres are resolved by this.
        self.settle(simd);
    }

    /// Opens the next row, of which there must be one. Whether there was time for it; if not, sums are as before.
    #[inline(always)]
    fn open_next<S: Simd>(&mut self, simd: S) -> bool {
        let query = self.query;
        let TimeCriticalWorkspace { frontier, nodes_a, children_a, .. } = &mut *self.workspace;
        let Some((row, len)) = frontier.pop(&mut nodes_a.index) else { return false };
        nodes_a.len = len;
        let [open_a, open_b] = sides_to_open(&row);
        let (level_a, level_b) = (row.level_a as usize, row.level_b as usize);
        let (below_a, below_b) = (level_a - usize::from(open_a), level_b - usize::from(open_b));
        children_a.len = 0;
        if open_a {
            let [x, y, z, radius] = row.ball;
            let ball = Ball {
                x: f32x8::splat(simd, x),
                y: f32x8::splat(simd, y),
                z: f32x8::splat(simd, z),
                radius: f32x8::splat(simd, radius),
            };
            let a = Skinned { data: query.a.tree, skin: query.a.skin };
            for parents in nodes_a.indices().chunks(WIDTH) {
                expand(simd, a, (parents, below_a), &ball, children_a);
                if self.meter.work(parents.len()) {
                    return false;
                }
            }
        } else {
            copy_nodes(query, level_a, nodes_a, children_a);
        }
        let node = row.node as usize;
        let nodes_b = if open_b {
            node * WIDTH..((node + 1) * WIDTH).min(query.b.tree.levels[below_b].len())
        } else {
            node..node + 1
        };
        let settled = self.resolved.totals.pairs;
        let in_time = self.test_children(simd, (below_a, below_b), nodes_b);
        // Pairs that are resolved count, whatever the time.
        let some_resolved = self.resolved.totals.pairs != settled;
        if !(in_time || some_resolved) {
            return false;
        }
        if (below_a, below_b) != (0, 0) {
            self.workspace.frontier.sums.subtract(&row.part);
            self.workspace.frontier.accept();
            return true;
        }
        let TimeCriticalWorkspace { leaf_pairs, pending, .. } = &mut *self.workspace;
        pending.push(row.part);
        let full = leaf_pairs.len() >= PENDING_PAIRS || pending.len() >= PENDING_PARTS;
        if full || some_resolved {
            self.settle(simd);
        }
        true
    }

    /// Resolves the pairs of leaves that wait, and takes the parts that they make out of the open ones.
    #[inline(always)]
    fn settle<S: Simd>(&mut self, simd: S) {
        let TimeCriticalWorkspace { frontier, leaf_pairs, pending, .. } = &mut *self.workspace;
        let blocks = leaf_pairs.len().div_ceil(WIDTH);
        leaf_pairs.flush(simd, &mut self.resolved);
        for part in pending.drain(..) {
            frontier.sums.subtract(&part);
        }
        // The clock is read before the next row anyway.
        self.meter.work(blocks * Meter::LENS as usize);
    }

    /// Tests nodes of B, siblings on their level, against the workspace's `children_a` on theirs: resolves pairs of leaves
    /// and makes rows of all others that meet. Whether there was time for it.
    #[inline(always)]
    fn test_children<S: Simd>(
        &mut self,
        simd: S,
        (level_a, level_b): (usize, usize),
        nodes_b: Range<usize>,
    ) -> bool {
        let query = self.query;
        let TimeCriticalWorkspace { frontier, children_a, near, leaf_pairs, .. } = &mut *self.workspace;
        let block = nodes_b.start / WIDTH;
        let mut balls = query.pose.place(simd, &query.b.tree.levels[level_b].blocks[block]);
        let tests = children_a.len.div_ceil(WIDTH);
        if level_a == 0 && level_b == 0 {
            // The others of its block are in rows of their own.
            if nodes_b.len() == 1 {
                balls = lone_ball(&balls, nodes_b.start % WIDTH);
            }
            let block =
                SphereBlock { balls: BlockLanes::new(simd, &balls, 0), first: block * WIDTH, of_a: false };
            let positions = children_a.indices();
            let near = NearLeaves { leaves: &query.a.tree.leaves, skin: query.a.skin, positions };
            let waiting = leaf_pairs.len() + self.resolved.totals.pairs as usize;
            leaf_pairs.append(simd, &near, &block, &mut self.resolved);
            let found = leaf_pairs.len() + self.resolved.totals.pairs as usize - waiting;
            return !self.meter.work(children_a.len + found);
        }
        balls.radius = balls.radius.map(|radius| radius + query.enlargement);
        let mut rows = RowMaker::new(query, frontier, self.meter, (level_a, level_b));
        for node in nodes_b {
            let lane = node % WIDTH;
            near.len = 0;
            keep_touching(simd, children_a, &Ball::of(simd, &balls, lane), near);
            pad(near);
            let ball = [balls.x[lane], balls.y[lane], balls.z[lane], balls.radius[lane]];
            if rows.meter.work(tests) || !rows.add(simd, near, (node, ball)) {
                return false;
            }
        }
        true
    }
}

/// Whether the nodes of A and that of B are opened: both, or the larger alone.
fn sides_to_open(row: &Row) -> [bool; 2] {
    let radius_b = row.ball[3];
    match (row.level_a > 0, row.level_b > 0) {
        (true, true) if row.largest > ALIKE * radius_b => [true, false],
        (true, true) if radius_b > ALIKE * row.largest => [false, true],
        sides => sides.into(),
    }
}

/// Ball `lane` of `balls`, where it is, and nothing else.
fn lone_ball(balls: &BallBlock, lane: usize) -> BallBlock {
    let mut lone = BallBlock::FAR;
    (lone.x[lane], lone.y[lane], lone.z[lane]) = (balls.x[lane], balls.y[lane], balls.z[lane]);
    lone.radius[lane] = balls.radius[lane];
    lone
}

/// Repeats the last ball up to the end of its block: what lists held before may be anything.
fn pad(list: &mut Candidates) {
    let Some(last) = list.len.checked_sub(1) else { return };
    let rest = list.len..list.len.next_multiple_of(WIDTH);
    for array in [&mut list.x, &mut list.y, &mut list.z, &mut list.radius] {
        let ball = array[last];
        array[rest.clone()].fill(ball);
    }
    let index = list.index[last];
    list.index[rest].fill(index);
}

/// Copies the balls of A's nodes `nodes` of `level` to `balls`.
fn copy_nodes(query: &Query, level: usize, nodes: &Candidates, balls: &mut Candidates) {
    let of = &query.a.tree.levels[level];
    for (at, index) in nodes.index[..nodes.len.min(ROW)].iter().enumerate() {
        let (center, radius) = of.get(*index as usize);
        (balls.x[at], balls.y[at], balls.z[at]) = center.into();
        balls.radius[at] = radius + query.a.skin;
        balls.index[at] = *index;
    }
    balls.len = nodes.len;
    balls.len = balls.tail().close();
}
