//! Tests of balls against eight balls at once, and lists of those that pass.
//!
//! Here and wherever vectors are computed with: no vector passes through a closure. The compiler may make a function of it,
//! without the instruction set that was chosen, and then every operation on the vector is a call.

use super::workspace::{Blocks, Tail};
use crate::tree::{self, BallBlock, Leaf, WIDTH};
use fearless_simd::{Simd, f32x8, mask32x8, prelude::*, u32x8};

/// One ball in A's frame, in every lane.
#[derive(Clone, Copy)]
pub(super) struct Ball<S: Simd> {
    pub(super) x: f32x8<S>,
    pub(super) y: f32x8<S>,
    pub(super) z: f32x8<S>,
    pub(super) radius: f32x8<S>,
}

impl<S: Simd> Ball<S> {
    /// A leaf of A, enlarged by `skin`.
    #[inline(always)]
    pub(super) fn leaf(simd: S, leaf: &Leaf, skin: f32) -> Self {
        let [x, y, z, radius, ..] = leaf.0;
        Self {
            x: f32x8::splat(simd, x),
            y: f32x8::splat(simd, y),
            z: f32x8::splat(simd, z),
            radius: f32x8::splat(simd, radius + skin),
        }
    }

    /// The same ball, larger by `thickness`.
    #[inline(always)]
    pub(super) fn enlarged(self, thickness: f32) -> Self {
        Self { radius: self.radius + thickness, ..self }
    }

    #[inline(always)]
    pub(super) fn of(simd: S, block: &BallBlock, lane: usize) -> Self {
        Self {
            x: f32x8::splat(simd, block.x[lane]),
            y: f32x8::splat(simd, block.y[lane]),
            z: f32x8::splat(simd, block.z[lane]),
            radius: f32x8::splat(simd, block.radius[lane]),
        }
    }
}

/// Eight balls in A's frame.
#[derive(Clone, Copy)]
pub(super) struct BlockLanes<S: Simd> {
    pub(super) x: f32x8<S>,
    pub(super) y: f32x8<S>,
    pub(super) z: f32x8<S>,
    pub(super) radius: f32x8<S>,
    pub(super) index: u32x8<S>,
}

impl<S: Simd> BlockLanes<S> {
    /// `balls`, of which the first is number `first`.
    #[inline(always)]
    pub(super) fn new(simd: S, balls: &BallBlock, first: usize) -> Self {
        Self {
            x: f32x8::load_array(simd, balls.x),
            y: f32x8::load_array(simd, balls.y),
            z: f32x8::load_array(simd, balls.z),
            radius: f32x8::load_array(simd, balls.radius),
            index: u32x8::load_array(simd, [0, 1, 2, 3, 4, 5, 6, 7]) + first as u32,
        }
    }

    /// The same balls, each larger by `thickness`.
    #[inline(always)]
    pub(super) fn enlarged(self, thickness: f32) -> Self {
        Self { radius: self.radius + thickness, ..self }
    }

    #[inline(always)]
    pub(super) fn balls(&self) -> BallBlock {
        BallBlock {
            x: self.x.to_array(),
            y: self.y.to_array(),
            z: self.z.to_array(),
            radius: self.radius.to_array(),
        }
    }

    /// Number `block` of `blocks`.
    #[inline(always)]
    pub(super) fn of(simd: S, blocks: Blocks, block: usize) -> Self {
        Self {
            x: f32x8::load_array(simd, blocks.x[block]),
            y: f32x8::load_array(simd, blocks.y[block]),
            z: f32x8::load_array(simd, blocks.z[block]),
            radius: f32x8::load_array(simd, blocks.radius[block]),
            index: u32x8::load_array(simd, blocks.index[block]),
        }
    }

    #[inline(always)]
    pub(super) fn touches(&self, ball: &Ball<S>) -> mask32x8<S> {
        let (dx, dy, dz) = (self.x - ball.x, self.y - ball.y, self.z - ball.z);
        let reach = self.radius + ball.radius;
        (dx * dx + dy * dy + dz * dz).simd_lt(reach * reach)
    }

    #[inline(always)]
    pub(super) fn append_where(&self, simd: S, mask: mask32x8<S>, list: &mut Tail) {
        let at = list.len..list.len + WIDTH;
        simd.compress_f32x8(self.x, mask).store_slice(&mut list.x[at.clone()]);
        simd.compress_f32x8(self.y, mask).store_slice(&mut list.y[at.clone()]);
        simd.compress_f32x8(self.z, mask).store_slice(&mut list.z[at.clone()]);
        simd.compress_f32x8(self.radius, mask).store_slice(&mut list.radius[at]);
        self.append_index_where(simd, mask, list);
    }

    /// Appends the numbers of the balls in `mask`, and not where they are.
    #[inline(always)]
    pub(super) fn append_index_where(&self, simd: S, mask: mask32x8<S>, list: &mut Tail) {
        list.append_index(simd.compress_u32x8(self.index, mask), mask);
    }
}

impl Tail<'_> {
    /// Appends the numbers in `compressed`, of which `mask` was compressed.
    #[inline(always)]
    pub(super) fn append_index<S: Simd>(&mut self, compressed: u32x8<S>, mask: mask32x8<S>) {
        compressed.store_slice(&mut self.index[self.len..self.len + WIDTH]);
        self.len += mask.to_bitmask().count_ones() as usize;
    }
}

/// [`tree::live_lanes`] as a mask.
#[inline(always)]
pub(super) fn live_lanes<S: Simd>(simd: S, len: usize, first: usize) -> mask32x8<S> {
    mask32x8::from_bitmask(simd, u64::from(tree::live_lanes(len, first)))
}

/// The numbers of the lanes in `mask`, from the first lane on, and how many there are.
///
/// To look them up takes half the instructions of compressing a vector that holds the numbers.
#[inline(always)]
pub(super) fn lanes_in<S: Simd>(simd: S, mask: mask32x8<S>) -> (u32x8<S>, usize) {
    let bits = mask.to_bitmask() as u8;
    (u32x8::load_array_ref(simd, &LANES_IN.0[usize::from(bits)]), bits.count_ones() as usize)
}

/// [`lanes_in`] for every mask, zeros behind.
static LANES_IN: LaneTable = LaneTable({
    let mut table = [[0; WIDTH]; 1 << WIDTH];
    let mut mask = 0;
    while mask < table.len() {
        let (mut lane, mut count) = (0, 0);
        while lane < WIDTH {
            if mask >> lane & 1 == 1 {
                table[mask][count] = lane as u32;
                count += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
});

/// Aligned: of the rows of a table that begins anywhere, half lie in two cache lines.
#[repr(align(32))]
struct LaneTable([[u32; WIDTH]; 1 << WIDTH]);
