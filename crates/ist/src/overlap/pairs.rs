//! Overlapping pairs of spheres on their way from an engine to a sink.

use crate::tree::WIDTH;

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

impl Default for PairBuffer {
    fn default() -> Self {
        Self { a: [0; BATCH], b: [0; BATCH], len: 0 }
    }
}

impl PairBuffer {
    pub(super) fn len(&self) -> usize {
        self.len
    }

    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    /// Whether a block of A's spheres with a block of B's may give more pairs than still fit.
    pub(super) fn lacks_room_for_blocks(&self) -> bool {
        self.len + WIDTH * WIDTH > BATCH
    }

    /// Repeats the last pair up to the end of its block, so that blocks can be read whole; `len` stays.
    pub(super) fn pad(&mut self) {
        for side in [&mut self.a, &mut self.b] {
            let last = side[self.len.saturating_sub(1)];
            side[self.len..self.len.next_multiple_of(WIDTH)].fill(last);
        }
    }

    /// Counts `count` pairs that were stored behind the former end.
    pub(super) fn advance(&mut self, count: usize) {
        self.len += count;
    }
}
