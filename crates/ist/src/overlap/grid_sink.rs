//! From pairs of grid entries to totals.
//!
//! The balls are read where the search has just read them. Those of the trees are in another order: they would have to be
//! fetched from memory once more, as large solids do not fit into a cache.

use super::grid_search::GridPair;
use super::lens_lanes::{Lanes3, PairBalls, PairLanes};
use super::pairs::{PairBuffer, PairSink};
use super::totals::TotalsSink;
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
        let grids = self.grids;
        let in_trees = pairs.renumbered(&grids.a.entries.index, &grids.b.entries.index);
        self.totals.add(simd, &in_trees, &EntryBalls { pairs, grids });
    }
}

/// Balls in the grids' order.
struct EntryBalls<'a> {
    pairs: &'a PairBuffer,
    grids: GridPair<'a>,
}

impl PairBalls for EntryBalls<'_> {
    #[inline(always)]
    fn gather<S: Simd>(&self, simd: S, first: usize) -> PairLanes<S> {
        let Self { pairs, grids } = *self;
        let (center_a, radius_a) = balls(simd, &grids.a.entries, &pairs.a[first..first + WIDTH]);
        let (center_b, radius_b) = balls(simd, &grids.b.entries, &pairs.b[first..first + WIDTH]);
        let (center_b, radius_b) = grids.pose.place_lanes(center_b, radius_b);
        let radius_a = radius_a + grids.pose.skin_a;
        PairLanes { center_a, center_b, radius_a, radius_b, live: pairs.live(simd, first) }
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
