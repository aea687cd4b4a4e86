//! Memory that queries use again and again.

use super::impact::Due;
use super::nearest::{Candidate, Nodes};
use super::penetration::Contact;
use crate::OverlapWorkspace;
use alloc::collections::BinaryHeap;
use alloc::vec::Vec;

/// Scratch memory of queries on two trees; keep one per thread and hand it to every query.
///
/// It grows with the hardest query it has seen, and one that fits allocates nothing. Its content never affects
/// a result.
#[derive(Clone, Debug, Default)]
pub struct ProximityWorkspace {
    /// Pairs of nodes that meet.
    pub(super) stack: Vec<Nodes>,
    /// Pairs of nodes that may hold the nearest spheres, the next one last.
    pub(super) candidates: Vec<Candidate>,
    /// The same in the order of their gaps.
    pub(super) by_gap: BinaryHeap<Candidate>,
    /// Pairs of nodes by the time before which they do not meet.
    pub(super) due: BinaryHeap<Due>,
    /// Those that pass by close to the other solid, and since when.
    pub(super) grazing: Vec<Due>,
    /// Pairs of spheres that bound a separating translation.
    pub(super) contacts: Vec<Contact>,
    pub(super) overlap: OverlapWorkspace,
}
