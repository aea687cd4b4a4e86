//! Overlap within a budget: an interval that certainly contains the volume, and what to expect.
//!
//! After the time-critical traversal of Weller and Zachmann (*A unified approach for physically-based simulations and
//! haptic rendering*, Sandbox 2009), which stops early with an expected overlap volume from the filling of the nodes.
//! Departures: bounds that hold with certainty, for balls that overlap each other within one tree ([`bounds`]); open
//! parts are rows, a node of B with all nodes of A that it meets, instead of single pairs, so that tests are as dense
//! as those of the full query and a bound holds for a row as a whole; sums are kept as parts are opened, so that
//! stopping costs nothing.

mod bounds;
mod budget;
mod frontier;
mod query;
mod row;
mod search;
mod workspace;

use super::relative_pose::RelativePose;
use super::{Overlap, OverlapQuery};
use crate::InnerSphereTree;
use crate::simd_level::simd_level;
pub use budget::Budget;
use budget::Meter;
use fearless_simd::dispatch;
use glamx::Pose3;
use query::Query;
use search::search;
pub use workspace::TimeCriticalWorkspace;

/// Widening of the interval on either side, relative: the full query sums in f32 in another order.
const MARGIN: f64 = 1e-5;

/// What a query within a budget has found; units and frames as in [`Overlap`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct OverlapEstimate {
    /// The expected overlap, with a volume within the bounds and no stiffness. Its `pairs` and `deepest` are those of the
    /// pairs that were looked at; its `intersects` is certain if true, and if false only when the query is complete.
    pub expected: Overlap,
    /// The volume (m³) that [`InnerSphereTree::overlap`] would give is at least this …
    pub lower: f32,
    /// … and at most this.
    pub upper: f32,
    /// Visits of pairs of nodes.
    pub visits: u32,
    /// Whether nothing was left to do: then `expected` is the full result, up to the rounding of its sums (1e-5), and
    /// the bounds are that much around its volume.
    pub complete: bool,
}

impl InnerSphereTree {
    /// Computes now what [`Self::overlap_within`] needs to know about the nodes of this tree: sums over the spheres below
    /// them, and how often volume balls cover a point. Otherwise the first such query does it, whatever its budget, or
    /// waits for another thread that is at it.
    ///
    /// Clones and scaled copies, earlier ones too, share the result. Time is linear in the spheres for packings, memory is 5
    /// bytes per sphere. A rabbit of 1,000 spheres takes 3 ms and one of 10,000 takes 32 ms; their trees are built in 2 and
    /// 30 ms.
    pub fn prepare_overlap_within(&self) {
        self.data().sums();
    }

    /// Overlap of this solid (A) with `other` (B), whose frame stands at `pose` in A's frame, as far as `budget` goes,
    /// with the force of [`ForceLaw::Blended`](crate::ForceLaw::Blended).
    ///
    /// A larger budget of visits never gives a wider interval. Where the pose is not finite or its quaternion far
    /// from unit length the result is complete and zero, as that of [`Self::overlap`].
    ///
    /// The bounds hold for any packing. They are narrowest without skins, or with skins of at most three quarters of the
    /// median volume radius, and where the smallest radius of B is more than 4e-4 of the largest coordinate; beyond
    /// that less is known about how often balls of one tree cover a point, and only more visits help.
    ///
    /// The first query with a tree prepares it, which takes longer than most budgets: see
    /// [`Self::prepare_overlap_within`].
    #[must_use]
    pub fn overlap_within(
        &self,
        other: &Self,
        pose: &Pose3,
        budget: Budget,
        workspace: &mut TimeCriticalWorkspace,
    ) -> OverlapEstimate {
        self.overlap_metered(other, pose, &mut Meter::new(budget), workspace)
    }

    fn overlap_metered(
        &self,
        other: &Self,
        pose: &Pose3,
        meter: &mut Meter,
        workspace: &mut TimeCriticalWorkspace,
    ) -> OverlapEstimate {
        let Some(pose) = RelativePose::new(self, other, pose) else {
            return OverlapEstimate { complete: true, ..OverlapEstimate::default() };
        };
        let query = Query::new((self.data(), other.data()), &pose);
        let found = dispatch!(simd_level(), simd => search(simd, &query, meter, workspace));
        let scale = f64::from(self.unit());
        let scale3 = scale * scale * scale;
        let mut expected = Overlap::new(&found.totals, OverlapQuery::default(), [self, other]);
        // A volume may be expected before any pair is known.
        expected.deepest = expected.deepest.filter(|pair| pair.depth > 0.0);
        OverlapEstimate {
            expected,
            lower: (found.lower * (1.0 - MARGIN) * scale3) as f32,
            upper: (found.upper * (1.0 + MARGIN) * scale3) as f32,
            visits: meter.visits(),
            complete: found.complete,
        }
    }
}

#[cfg(test)]
mod tests;
