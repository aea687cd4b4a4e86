//! Many pairs at once.

use super::{Overlap, OverlapQuery, OverlapWorkspace};
use crate::InnerSphereTree;
use alloc::vec::Vec;
use glamx::Pose3;

/// Two solids and where the second stands.
#[derive(Clone, Copy, Debug)]
pub struct OverlapPair<'a> {
    /// The first solid.
    pub a: &'a InnerSphereTree,
    /// The second solid.
    pub b: &'a InnerSphereTree,
    /// Pose of B's frame in A's frame.
    pub pose: Pose3,
}

/// The overlap of every pair, in the order of `pairs`; on all cores with feature `parallel`.
///
/// The results are those of [`InnerSphereTree::overlap_with`], whatever the number of threads.
#[must_use]
pub fn overlap_batch(pairs: &[OverlapPair], query: OverlapQuery) -> Vec<Overlap> {
    let overlap = |workspace: &mut OverlapWorkspace, pair: &OverlapPair| {
        pair.a.overlap_with(pair.b, &pair.pose, query, workspace)
    };
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        pairs.par_iter().map_init(OverlapWorkspace::default, overlap).collect()
    }
    #[cfg(not(feature = "parallel"))]
    {
        let mut workspace = OverlapWorkspace::default();
        pairs.iter().map(|pair| overlap(&mut workspace, pair)).collect()
    }
}
