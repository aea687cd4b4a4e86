//! Eight spheres from anywhere in a tree as vectors.

use super::lens_lanes::Lanes3;
use crate::tree::{Leaf, WIDTH};
use fearless_simd::{Simd, f32x8, prelude::*};

/// Eight leaves of a tree, in its frame and without its skin.
pub(super) struct LeafLanes<S: Simd> {
    pub(super) center: Lanes3<S>,
    pub(super) radius: f32x8<S>,
    pub(super) normal: Lanes3<S>,
}

impl<S: Simd> LeafLanes<S> {
    /// The leaves at the eight positions of `index`.
    #[inline(always)]
    pub(super) fn gather(simd: S, leaves: &[Leaf], index: &[u32; WIDTH]) -> Self {
        // Written out, as no vector may pass through a closure.
        let rows = [
            row(simd, leaves, index[0]),
            row(simd, leaves, index[1]),
            row(simd, leaves, index[2]),
            row(simd, leaves, index[3]),
            row(simd, leaves, index[4]),
            row(simd, leaves, index[5]),
            row(simd, leaves, index[6]),
            row(simd, leaves, index[7]),
        ];
        let [x, y, z, radius, normal_x, normal_y, normal_z, _] = transposed(rows);
        Self { center: Lanes3 { x, y, z }, radius, normal: Lanes3 { x: normal_x, y: normal_y, z: normal_z } }
    }

    /// The leaves from `first` on.
    #[inline(always)]
    pub(super) fn load(simd: S, leaves: &[Leaf], first: usize) -> Self {
        let index = core::array::from_fn(|i| (first + i) as u32);
        Self::gather(simd, &leaves[..first + WIDTH], &index)
    }
}

#[inline(always)]
fn row<S: Simd>(simd: S, leaves: &[Leaf], index: u32) -> f32x8<S> {
    f32x8::load_array(simd, leaves[index as usize].0)
}

/// The columns of eight rows. To interleave the first four rows with the last four moves the number at `8 r + c` to twice
/// that place, modulo 63; three times is eight times, which is where the number at row c and column r was.
#[inline(always)]
fn transposed<S: Simd>(mut rows: [f32x8<S>; WIDTH]) -> [f32x8<S>; WIDTH] {
    for _ in 0..3 {
        let [a, b, c, d, e, f, g, h] = rows;
        let (a, e) = a.interleave(e);
        let (b, f) = b.interleave(f);
        let (c, g) = c.interleave(g);
        let (d, h) = d.interleave(h);
        rows = [a, e, b, f, c, g, d, h];
    }
    rows
}
