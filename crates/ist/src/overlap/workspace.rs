//! Memory that queries use again and again.

use super::pairs::PairBuffer;
use super::samples::Lenses;
use crate::tree::{TreeData, WIDTH};
use alloc::vec::Vec;

/// Scratch memory of an overlap query; keep one per thread and hand it to every query.
///
/// It grows with the largest pair of trees it has seen and a query
/// that fits allocates nothing. Its content never affects a result.
#[derive(Clone, Debug, Default)]
pub struct OverlapWorkspace {
    /// Per level of B's tree: balls of A that meet the current ball of B.
    pub(super) near: Vec<Candidates>,
    /// Per level of B's tree: children of the level above's `near` that meet the ball above.
    pub(super) children: Vec<Candidates>,
    /// Per level of B's tree: the current block of B in A's frame.
    pub(super) blocks: Vec<Block>,
    pub(super) pairs: PairBuffer,
    pub(super) lenses: Lenses,
}

/// Balls of A in struct-of-arrays order with their index in their level.
#[derive(Clone, Debug, Default)]
pub(crate) struct Candidates {
    pub(crate) x: Vec<f32>,
    pub(crate) y: Vec<f32>,
    pub(crate) z: Vec<f32>,
    pub(crate) radius: Vec<f32>,
    pub(crate) index: Vec<u32>,
    pub(crate) len: usize,
}

/// Up to eight siblings of B, transformed into A's frame.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Block {
    pub(crate) x: [f32; WIDTH],
    pub(crate) y: [f32; WIDTH],
    pub(crate) z: [f32; WIDTH],
    pub(crate) radius: [f32; WIDTH],
    /// Index in its level of the next sibling to visit, and one past the last.
    pub(crate) next: usize,
    pub(crate) end: usize,
}

impl OverlapWorkspace {
    /// Makes room for a query of `a` against `b`.
    pub(super) fn fit(&mut self, a: &TreeData, b: &TreeData) {
        let levels = b.levels.len();
        if self.near.len() < levels {
            self.near.resize_with(levels, Candidates::default);
            self.children.resize_with(levels, Candidates::default);
            self.blocks.resize_with(levels, Block::default);
        }
        for level in 0..levels {
            let most = a.levels[level.min(a.height())].x.len();
            self.near[level].fit(most);
            self.children[level].fit(most);
        }
        self.pairs.clear();
    }
}

impl Candidates {
    /// Room for `most` balls and the surplus lanes of a block store behind them.
    pub(crate) fn fit(&mut self, most: usize) {
        let room = most + WIDTH;
        if self.x.len() < room {
            for array in [&mut self.x, &mut self.y, &mut self.z, &mut self.radius] {
                array.resize(room, 0.0);
            }
            self.index.resize(room, 0);
        }
        self.len = 0;
    }
}
