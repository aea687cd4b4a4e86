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
    /// Whether to compute [`Overlap::stiffness`](super::Overlap::stiffness); a query takes a quarter longer with it.
    pub stiffness: bool,
}
