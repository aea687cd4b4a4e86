//! From pairs of grid entries to totals.
//!
//! Balls and normals are read in the order of the grids: the search has just read the balls there. Those of the trees are
//! elsewhere and would have to be fetched as well, and large solids do not fit into a cache. A query of two solids of 343,000
//! / 1,000,000 spheres takes 34 / 101 ms; with the trees' normals 35 / 106 ms, and with the trees' balls too about 39 / 123 ms.

use super::grid_search::GridPair;
use super::lens_lanes::{Lanes3, PairLanes};
use super::pairs::{PairBuffer, PairSink};
use super::totals::{PairSource, TotalsSink, gather};
use crate::grid::Entries;
use crate::tree::{BallBlock, WIDTH};
use fearless_simd::{Simd, f32x8, prelude::*};

/// Adds every pair to the totals.
pub(super) struct GridSink<'a, const STIFFNESS: bool> {
    pub(super) totals: TotalsSink<'a, STIFFNESS>,
    pub(super) grids: GridPair<'a>,
}

impl<const STIFFNESS: bool> PairSink for GridSink<'_, STIFFNESS> {
    #[inline(always)]
    fn take<S: Simd>(&mut self, simd: S, pairs: &PairBuffer, _: &[BallBlock]) {
        self.totals.add(simd, pairs.len(), &EntrySource { pairs, grids: self.grids });
    }
}

/// Pairs of entries.
struct EntrySource<'a> {
    pairs: &'a PairBuffer,
    grids: GridPair<'a>,
}

impl PairSource for EntrySource<'_> {
    #[inline(always)]
    fn balls<S: Simd>(&self, simd: S, first: usize) -> PairLanes<S> {
        let Self { pairs, grids } = *self;
        let (center_a, radius_a) = balls(simd, &grids.a.entries, &pairs.a[first..first + WIDTH]);
        let (center_b, radius_b) = balls(simd, &grids.b.entries, &pairs.b[first..first + WIDTH]);
        let (center_b, radius_b) = grids.pose.place_lanes(center_b, radius_b);
        let radius_a = radius_a + grids.pose.skin_a;
        PairLanes { center_a, center_b, radius_a, radius_b, live: pairs.live(simd, first) }
    }

    #[inline(always)]
    fn normals<S: Simd>(&self, simd: S, first: usize) -> (Lanes3<S>, Lanes3<S>) {
        let Self { pairs, grids: GridPair { a, b, .. } } = self;
        let block = first..first + WIDTH;
        let of_a = gather(simd, &a.entries.normal, &pairs.a[block.clone()]);
        (of_a, gather(simd, &b.entries.normal, &pairs.b[block]))
    }

    fn spheres(&self, pair: usize) -> [u32; 2] {
        let Self { pairs, grids: GridPair { a, b, .. } } = self;
        [a.entries.index[pairs.a[pair] as usize], b.entries.index[pairs.b[pair] as usize]]
    }
}

/// Centres and radii at the eight positions of `index`.
#[inline(always)]
fn balls<S: Simd>(simd: S, entries: &Entries, index: &[u32]) -> (Lanes3<S>, f32x8<S>) {
    let Entries { x, y, z, radius, .. } = entries;
    let center = Lanes3 {
        x: f32x8::from_fn(simd, |lane| x[index[lane] as usize]),
        y: f32x8::from_fn(simd, |lane| y[index[lane] as usize]),
        z: f32x8::from_fn(simd, |lane| z[index[lane] as usize]),
    };
    (center, f32x8::from_fn(simd, |lane| radius[index[lane] as usize]))
}
