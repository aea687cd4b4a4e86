//! Overlapping pairs of spheres on their way from an engine to a sink.

use super::lanes::{Ball, BlockLanes, lanes_in, live_lanes};
use crate::tree::{Leaf, WIDTH};
use fearless_simd::{Simd, mask32x8, prelude::*, u32x8};

/// Takes pairs, a batch at a time: from the engines those that overlap, from a cache others too.
pub(super) trait PairSink {
    /// Called with at least one pair.
    fn take<S: Simd>(&mut self, simd: S, pairs: &PairBuffer);
}

/// Pairs from which on a batch is full; no effect on the time was measured from 128 to 512.
pub(super) const BATCH: usize = 256;

/// Tests between two looks at how full the batch is: more than most blocks have neighbours. A look for as many tests as there is
/// room for makes ever shorter loops towards the end of a batch, whose ends the processor does not foresee, and queries take 4 %
/// longer.
const TESTS: usize = 32;

/// Room for a batch that is almost full, and for what is found until the next look at it.
const ROOM: usize = BATCH + TESTS * WIDTH;

/// A batch of pairs that overlap, or may: positions in the orders of both trees, or among the entries of both grids.
///
/// Positions only: storing the balls of a pair as well costs more than reading them again, as most of what a test stores
/// is for nothing.
#[derive(Clone, Debug)]
pub(super) struct PairBuffer {
    pub(super) a: [u32; ROOM],
    pub(super) b: [u32; ROOM],
    len: usize,
}

/// Eight spheres of one solid, in A's frame, that stand together in the order of its tree or among the entries of its grid.
pub(super) struct SphereBlock<S: Simd> {
    pub(super) balls: BlockLanes<S>,
    /// Position of the first of them.
    pub(super) first: usize,
    pub(super) of_a: bool,
}

/// Spheres of one solid, in A's frame, that are paired with eight of the other's at a time.
pub(super) trait NearSpheres {
    /// How many there are.
    fn count(&self) -> usize;
    /// One of them, and its position in the order of its tree or among the entries of its grid in every lane.
    fn get<S: Simd>(&self, simd: S, i: usize) -> (Ball<S>, u32x8<S>);
}

/// Leaves of A by their positions.
pub(super) struct NearLeaves<'a> {
    pub(super) leaves: &'a [Leaf],
    pub(super) skin: f32,
    pub(super) positions: &'a [u32],
}

impl NearSpheres for NearLeaves<'_> {
    #[inline(always)]
    fn count(&self) -> usize {
        self.positions.len()
    }

    #[inline(always)]
    fn get<S: Simd>(&self, simd: S, i: usize) -> (Ball<S>, u32x8<S>) {
        let leaf = &self.leaves[self.positions[i] as usize];
        (Ball::leaf(simd, leaf, self.skin), leaf.positions(simd))
    }
}

impl Default for PairBuffer {
    fn default() -> Self {
        Self { a: [0; ROOM], b: [0; ROOM], len: 0 }
    }
}

impl PairBuffer {
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// A's spheres of the block at `first`.
    #[inline(always)]
    pub(super) fn a_at(&self, first: usize) -> &[u32; WIDTH] {
        eight(&self.a, first)
    }

    /// B's spheres of the block at `first`.
    #[inline(always)]
    pub(super) fn b_at(&self, first: usize) -> &[u32; WIDTH] {
        eight(&self.b, first)
    }

    /// Lanes of the block at `first` that hold a pair.
    #[inline(always)]
    pub(super) fn live<S: Simd>(&self, simd: S, first: usize) -> mask32x8<S> {
        live_lanes(simd, self.len, first)
    }

    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    /// Holds nothing but the pairs of `a[i]` and `b[i]`, at most [`BATCH`] of them.
    pub(super) fn fill(&mut self, a: &[u32], b: &[u32]) {
        self.len = a.len();
        self.a[..a.len()].copy_from_slice(a);
        self.b[..a.len()].copy_from_slice(b);
    }

    /// Appends the pairs of spheres that overlap, each of `near` with each of `block`; `sink` takes them when the
    /// buffer is full.
    ///
    /// Nothing here branches on the outcome of a test: most tests hold a hit, and a wrong guess of the processor costs more
    /// than a store of nothing.
    #[inline(always)]
    pub(super) fn append<S: Simd>(
        &mut self,
        simd: S,
        near: &impl NearSpheres,
        block: &SphereBlock<S>,
        sink: &mut impl PairSink,
    ) {
        let (mut next, count) = (0, near.count());
        let first = block.first as u32;
        while next < count {
            let end = count.min(next + TESTS);
            let (ours, theirs) =
                if block.of_a { (&mut self.a, &mut self.b) } else { (&mut self.b, &mut self.a) };
            // Not in memory: every test needs the length that the one before it has made.
            let mut len = self.len;
            for i in next..end {
                let (ball, position) = near.get(simd, i);
                let (hits, found) = lanes_in(simd, block.balls.touches(&ball));
                (hits + first).store_slice(&mut ours[len..len + WIDTH]);
                position.store_slice(&mut theirs[len..len + WIDTH]);
                len += found;
            }
            self.len = len;
            next = end;
            if self.len >= BATCH {
                self.flush(simd, sink);
            }
        }
    }

    /// Hands all pairs to `sink` and forgets them.
    #[inline(always)]
    pub(super) fn flush<S: Simd>(&mut self, simd: S, sink: &mut impl PairSink) {
        if self.len > 0 {
            self.pad();
            // Two places of every walk flush. What `vectorize` makes is one function for all of them: the crate compiles in
            // little more than half the time, and queries with stiffness take 15 % less, others the same.
            simd.vectorize(
                #[inline(always)]
                || sink.take(simd, self),
            );
            self.len = 0;
        }
    }

    /// Repeats the last pair up to the end of its block, so that blocks can be read whole; `len` stays.
    fn pad(&mut self) {
        for side in [&mut self.a, &mut self.b] {
            let last = side[self.len.saturating_sub(1)];
            side[self.len..self.len.next_multiple_of(WIDTH)].fill(last);
        }
    }
}

/// The block of `positions` at `first`.
#[inline(always)]
fn eight(positions: &[u32], first: usize) -> &[u32; WIDTH] {
    positions[first..].first_chunk().unwrap_or(&[0; WIDTH])
}
