//! Eight spheres from anywhere in a tree as vectors.

use super::lens_lanes::Lanes3;
use crate::tree::{Leaf, WIDTH};
use fearless_simd::{Simd, f32x4, f32x8, prelude::*};

/// Eight leaves of a tree, in its frame and without its skin.
pub(super) struct LeafLanes<S: Simd> {
    pub(super) center: Lanes3<S>,
    pub(super) radius: f32x8<S>,
    pub(super) normal: Lanes3<S>,
}

impl<S: Simd> LeafLanes<S> {
    /// The leaves at the eight positions of `index`.
    ///
    /// Four and four: eight rows at once are transposed by moves between the halves of vectors, which cost more than
    /// those within them. Queries of two rabbits take 5 % less time.
    #[inline(always)]
    pub(super) fn gather(simd: S, leaves: &[Leaf], index: &[u32; WIDTH]) -> Self {
        let [a, b, c, d, e, f, g, h] = *index;
        let [low, low_normals] = four(simd, leaves, [a, b, c, d]);
        let [high, high_normals] = four(simd, leaves, [e, f, g, h]);
        let [x, y, z, radius] = joined(low, high);
        let [normal_x, normal_y, normal_z, _] = joined(low_normals, high_normals);
        Self { center: Lanes3 { x, y, z }, radius, normal: Lanes3 { x: normal_x, y: normal_y, z: normal_z } }
    }

    /// The leaves from `first` on.
    #[inline(always)]
    pub(super) fn load(simd: S, leaves: &[Leaf], first: usize) -> Self {
        let index = core::array::from_fn(|i| (first + i) as u32);
        Self::gather(simd, &leaves[..first + WIDTH], &index)
    }
}

/// Centres and radii of four leaves; their normals and positions.
#[inline(always)]
fn four<S: Simd>(simd: S, leaves: &[Leaf], [a, b, c, d]: [u32; 4]) -> [[f32x4<S>; 4]; 2] {
    // Written out, as no vector may pass through a closure.
    let (a, b) = (halves(simd, leaves, a), halves(simd, leaves, b));
    let (c, d) = (halves(simd, leaves, c), halves(simd, leaves, d));
    [transposed([a[0], b[0], c[0], d[0]]), transposed([a[1], b[1], c[1], d[1]])]
}

#[inline(always)]
fn halves<S: Simd>(simd: S, leaves: &[Leaf], index: u32) -> [f32x4<S>; 2] {
    let (halves, _) = leaves[index as usize].0.as_chunks();
    [f32x4::load_array_ref(simd, &halves[0]), f32x4::load_array_ref(simd, &halves[1])]
}

/// The columns of four rows. To interleave the first two rows with the last two moves the number at `4 r + c` to twice that
/// place, modulo 15; two times is four times, which is where the number at row c and column r was.
#[inline(always)]
fn transposed<S: Simd>(mut rows: [f32x4<S>; 4]) -> [f32x4<S>; 4] {
    for _ in 0..2 {
        let [a, b, c, d] = rows;
        let (a, c) = a.interleave(c);
        let (b, d) = b.interleave(d);
        rows = [a, c, b, d];
    }
    rows
}

#[inline(always)]
fn joined<S: Simd>(low: [f32x4<S>; 4], high: [f32x4<S>; 4]) -> [f32x8<S>; 4] {
    [low[0].combine(high[0]), low[1].combine(high[1]), low[2].combine(high[2]), low[3].combine(high[3])]
}
