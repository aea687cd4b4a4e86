//! Overlapping pairs of spheres on their way from the traversal to a sink.

use crate::tree::WIDTH;

/// Pairs per batch: twelve arrays of this length stay in the first-level cache.
const BATCH: usize = 256;

/// A batch of overlapping pairs, struct-of-arrays, everything in A's frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct PairBuffer {
    pub(crate) a: BallLanes,
    pub(crate) b: BallLanes,
    len: usize,
}

/// One side of the pairs.
#[derive(Clone, Debug)]
pub(crate) struct BallLanes {
    pub(crate) x: [f32; BATCH],
    pub(crate) y: [f32; BATCH],
    pub(crate) z: [f32; BATCH],
    pub(crate) radius: [f32; BATCH],
    /// Position in the order of the side's tree.
    pub(crate) index: [u32; BATCH],
}

impl Default for BallLanes {
    fn default() -> Self {
        let zero = [0.0; BATCH];
        Self { x: zero, y: zero, z: zero, radius: zero, index: [0; BATCH] }
    }
}

impl PairBuffer {
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    pub(crate) fn clear(&mut self) {
        self.len = 0;
    }

    /// Whether a block of pairs may not fit any more.
    pub(super) fn is_full(&self) -> bool {
        self.len + WIDTH > BATCH
    }

    /// Counts `count` pairs that were stored behind the former end.
    pub(super) fn advance(&mut self, count: usize) {
        self.len += count;
    }

    /// Fills the last block with pairs that contribute nothing: two points far apart.
    pub(super) fn pad(&mut self) {
        let end = self.len.next_multiple_of(WIDTH);
        for side in [&mut self.a, &mut self.b] {
            for array in [&mut side.x, &mut side.y, &mut side.z, &mut side.radius] {
                array[self.len..end].fill(0.0);
            }
            side.index[self.len..end].fill(0);
        }
        self.b.x[self.len..end].fill(1.0);
    }
}
