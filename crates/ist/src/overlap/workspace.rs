//! Memory that queries use again and again.

use super::grid_search::{GridScratch, Task};
use super::pairs::PairBuffer;
use super::samples::Lenses;
use super::totals::Totals;
use crate::tree::{BallBlock, TreeData, WIDTH};
use alloc::vec::Vec;

/// Scratch memory of an overlap query; keep one per thread and hand it to every query.
///
/// It grows with the largest pair of trees it has seen, and a query that fits allocates nothing; grids on several threads, once
/// each of them has met the longest list. Its content never affects a result.
#[derive(Clone, Debug, Default)]
pub struct OverlapWorkspace {
    pub(super) traversal: TraversalScratch,
    pub(super) pairs: PairBuffer,
    pub(super) lenses: Lenses,
    pub(super) grid: GridWorkspace,
    pub(super) patches: crate::patches::Scratch,
    /// Whether the force of the last query came from outward normals: that of the next is likely to.
    pub(super) outward: bool,
}

/// Memory of a query by grids.
#[derive(Clone, Debug, Default)]
pub(super) struct GridWorkspace {
    pub(super) tasks: Vec<Task>,
    /// What each of the tasks found.
    pub(super) parts: Vec<Totals>,
    /// One for each thread.
    pub(super) workers: Vec<GridScratch>,
}

/// Scratch memory of a walk over two trees.
#[derive(Clone, Debug, Default)]
pub(super) struct TraversalScratch {
    /// Numbers of the balls of A that meet the current ball of B.
    pub(super) near: Candidates,
    /// Takes turns with the list of B's root while A is descended alone: as large as that.
    pub(super) spare: Candidates,
    /// Per level of B's tree: children of the level above's `near` that meet the ball above.
    pub(super) children: Vec<Candidates>,
    /// Per level of B's tree: the current block of B in A's frame.
    pub(super) blocks: Vec<Siblings>,
}

/// Balls of A in struct-of-arrays order with their index in their level.
#[derive(Clone, Debug, Default)]
pub(super) struct Candidates {
    pub(super) x: Vec<f32>,
    pub(super) y: Vec<f32>,
    pub(super) z: Vec<f32>,
    pub(super) radius: Vec<f32>,
    pub(super) index: Vec<u32>,
    pub(super) len: usize,
}

/// Balls of a list in blocks: what fills up the last block is far from everything.
///
/// All of its arrays are as long as the first, which the compiler sees where they are made: it does not look once more.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blocks<'a> {
    pub(super) x: &'a [[f32; WIDTH]],
    pub(super) y: &'a [[f32; WIDTH]],
    pub(super) z: &'a [[f32; WIDTH]],
    pub(super) radius: &'a [[f32; WIDTH]],
    pub(super) index: &'a [[u32; WIDTH]],
}

/// Where balls are appended to a list. Its parts are borrowed one by one: were they reached through the list, every store of a
/// number might be one to where the length or an array is, and both would be read again for the next.
pub(super) struct Tail<'a> {
    pub(super) x: &'a mut [f32],
    pub(super) y: &'a mut [f32],
    pub(super) z: &'a mut [f32],
    pub(super) radius: &'a mut [f32],
    pub(super) index: &'a mut [u32],
    /// That of the list, which has to be told afterwards.
    pub(super) len: usize,
}

/// Up to eight siblings of B, transformed into A's frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Siblings {
    pub(super) balls: BallBlock,
    /// Index in its level of the next sibling to visit, and one past the last.
    pub(super) next: usize,
    pub(super) end: usize,
}

impl Siblings {
    const NONE: Self = Self { balls: BallBlock::FAR, next: 0, end: 0 };
}

impl TraversalScratch {
    /// Makes room for a walk over `a` and `b`.
    pub(super) fn fit(&mut self, a: &TreeData, b: &TreeData) {
        let levels = b.levels.len();
        if self.children.len() < levels {
            self.children.resize_with(levels, Candidates::default);
            self.blocks.resize(levels, Siblings::NONE);
        }
        for level in 0..levels {
            let most = a.levels[level.min(a.height())].blocks.len() * WIDTH;
            self.near.fit(most);
            self.children[level].fit(most);
            if level + 1 == levels {
                self.spare.fit(most);
            }
        }
    }
}

impl Candidates {
    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    /// Where to append; [`Self::len`] is to be set afterwards, to what [`Tail::close`] gives.
    #[inline(always)]
    pub(super) fn tail(&mut self) -> Tail<'_> {
        let room = self.x.len();
        Tail {
            x: &mut self.x,
            y: &mut self.y[..room],
            z: &mut self.z[..room],
            radius: &mut self.radius[..room],
            index: &mut self.index[..room],
            len: self.len,
        }
    }

    /// All of its balls, which a [`Tail`] has closed.
    #[inline(always)]
    pub(super) fn blocks(&self) -> Blocks<'_> {
        let count = self.len.div_ceil(WIDTH);
        Blocks {
            x: &self.x.as_chunks().0[..count],
            y: &self.y.as_chunks().0[..count],
            z: &self.z.as_chunks().0[..count],
            radius: &self.radius.as_chunks().0[..count],
            index: &self.index.as_chunks().0[..count],
        }
    }

    /// Those of the balls in the list.
    pub(super) fn indices(&self) -> &[u32] {
        &self.index[..self.len]
    }

    /// Room for `more` balls behind those in the list, whatever their number was.
    #[inline(always)]
    pub(super) fn make_room(&mut self, more: usize) {
        if self.len + more + WIDTH > self.x.len() {
            self.grow(2 * (self.len + more) + WIDTH);
        }
    }

    /// Room for `most` balls and the surplus lanes of a block store behind them.
    pub(super) fn fit(&mut self, most: usize) {
        let room = most + WIDTH;
        if self.x.len() < room {
            self.grow(room);
        }
        self.len = 0;
    }

    #[cold]
    fn grow(&mut self, room: usize) {
        for array in [&mut self.x, &mut self.y, &mut self.z, &mut self.radius] {
            array.resize(room, 0.0);
        }
        self.index.resize(room, 0);
    }
}

impl Tail<'_> {
    /// Fills up the last block with balls far from everything. The length of the list.
    #[inline(always)]
    pub(super) fn close(self) -> usize {
        self.x[self.len..self.len + WIDTH].copy_from_slice(&BallBlock::FAR.x);
        self.len
    }
}
