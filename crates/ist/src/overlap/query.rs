//! What an overlap query is asked for.

use super::ForceLaw;

/// What to compute, and how, beyond what every [`Overlap`](super::Overlap) holds.
///
/// ```
/// use ist::{ForceLaw, OverlapQuery};
/// let query = OverlapQuery { law: ForceLaw::VolumeGradient, stiffness: true, ..OverlapQuery::default() };
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OverlapQuery {
    /// How the force follows from the overlap.
    pub law: ForceLaw,
    /// Whether to compute [`Overlap::stiffness`](super::Overlap::stiffness); a query takes a fifth longer with it.
    pub stiffness: bool,
    /// How the overlapping pairs of spheres are found; no effect on the result beyond rounding.
    pub engine: Engine,
}

/// Ways to find overlapping pairs of spheres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Engine {
    /// The tree; the grids where both solids have them, with feature `parallel`, for large overlaps of many spheres.
    #[default]
    Auto,
    /// The hierarchy, on one core: time in proportion to the pairs that overlap.
    Tree,
    /// The grids, on all cores with feature `parallel`: time in proportion to all spheres. The tree, if one of the
    /// solids has no grids.
    Grid,
}
