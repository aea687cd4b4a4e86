//! Overlapping pairs of spheres on their way from an engine to a sink.

use super::lanes::{Ball, BlockLanes, live_lanes};
use super::workspace::Blocks;
use crate::tree::{BallBlock, WIDTH};
use fearless_simd::{Simd, mask32x8, prelude::*, u32x8};

/// Takes the overlapping pairs, a batch at a time.
pub(super) trait PairSink {
    /// Called with at least one pair.
    fn take<S: Simd>(&mut self, simd: S, pairs: &PairBuffer);
}

/// Pairs per batch; no effect on the time was measured from 128 to 512.
const BATCH: usize = 256;

/// A batch of overlapping pairs: positions in the orders of both trees.
///
/// Positions only: storing the balls of a pair as well costs more than reading them again, as four of the ten stores
/// that this takes per test are for nothing.
#[derive(Clone, Debug)]
pub(super) struct PairBuffer {
    pub(super) a: [u32; BATCH],
    pub(super) b: [u32; BATCH],
    len: usize,
}

/// Up to eight spheres of one solid, in A's frame, that are paired with a list of the other's.
pub(super) struct Lanes<'a> {
    pub(super) balls: &'a BallBlock,
    /// Positions in the order of their tree.
    pub(super) index: [u32; WIDTH],
    /// Spheres, from the first lane on.
    pub(super) count: usize,
    /// Whether they are A's, and the list B's.
    pub(super) of_a: bool,
}

impl<'a> Lanes<'a> {
    /// The leaves in `block` of B, which are at `balls` in A's frame.
    #[inline(always)]
    pub(super) fn block_of_b(balls: &'a BallBlock, block: usize) -> Self {
        let index = core::array::from_fn(|lane| (block * WIDTH + lane) as u32);
        Self { balls, index, count: WIDTH, of_a: false }
    }
}

impl Default for PairBuffer {
    fn default() -> Self {
        Self { a: [0; BATCH], b: [0; BATCH], len: 0 }
    }
}

impl PairBuffer {
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// The spheres of pair `i`.
    pub(super) fn spheres(&self, i: usize) -> [u32; 2] {
        [self.a[i], self.b[i]]
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

    /// Appends the pairs of spheres that overlap, each of `lanes` with each of `list`; `sink` takes them when
    /// the buffer is full.
    ///
    /// Nothing here branches on the outcome of a test: about two blocks in three hold a hit, and a wrong guess of the
    /// processor costs more than a store of nothing.
    #[inline(always)]
    pub(super) fn append<S: Simd>(&mut self, simd: S, list: Blocks, lanes: &Lanes, sink: &mut impl PairSink) {
        for i in 0..list.x.len() {
            let block = BlockLanes::of(simd, list, i);
            if self.lacks_room_for_blocks() {
                self.flush(simd, sink);
            }
            let (listed, paired) =
                if lanes.of_a { (&mut self.b, &mut self.a) } else { (&mut self.a, &mut self.b) };
            // Not in memory: every test needs the length that the one before it has made.
            let mut len = self.len;
            for lane in 0..lanes.count {
                let mask = block.touches(&Ball::of(simd, lanes.balls, lane));
                let at = len..len + WIDTH;
                simd.compress_u32x8(block.index, mask).store_slice(&mut listed[at.clone()]);
                u32x8::splat(simd, lanes.index[lane]).store_slice(&mut paired[at]);
                len += mask.to_bitmask().count_ones() as usize;
            }
            self.len = len;
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

    /// Whether a block of A's spheres with a block of B's may give more pairs than still fit.
    fn lacks_room_for_blocks(&self) -> bool {
        self.len + WIDTH * WIDTH > BATCH
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
fn eight(positions: &[u32; BATCH], first: usize) -> &[u32; WIDTH] {
    positions[first..].first_chunk().unwrap_or(&[0; WIDTH])
}
