//! Memory that time-critical queries use again and again.

use super::super::pairs::PairBuffer;
use super::super::workspace::Candidates;
use super::bounds::ROW;
use super::frontier::Frontier;
use super::row::Part;
use crate::tree::WIDTH;
use alloc::vec::Vec;

/// Scratch memory of [`InnerSphereTree::overlap_within`](crate::InnerSphereTree::overlap_within); keep one per thread
/// and hand it to every query.
///
/// It grows with what it has seen, up to some 25 MB, and a query that fits allocates nothing; call
/// [`Self::reserve`] or make one query of no hurry first. Its content never affects a result.
#[derive(Clone, Debug)]
pub struct TimeCriticalWorkspace {
    pub(super) frontier: Frontier,
    /// The nodes of A of the row that is being opened; indices only.
    pub(super) nodes_a: Candidates,
    /// Those of A's nodes that B's are tested against.
    pub(super) children_a: Candidates,
    /// Those of `children_a` that one of B's meets.
    pub(super) near: Candidates,
    /// Pairs of leaves that wait for their lenses.
    pub(super) leaf_pairs: PairBuffer,
    /// The parts that these pairs are of.
    pub(super) pending: Vec<Part>,
}

impl Default for TimeCriticalWorkspace {
    fn default() -> Self {
        let list = |most: usize| {
            let mut list = Candidates::default();
            list.fit(most);
            list
        };
        Self {
            frontier: Frontier::default(),
            nodes_a: list(ROW),
            children_a: list(ROW * WIDTH),
            near: list(ROW * WIDTH),
            leaf_pairs: PairBuffer::default(),
            pending: Vec::new(),
        }
    }
}

impl TimeCriticalWorkspace {
    /// Allocates what queries with a tree of `spheres` spheres as the second usually need, and forgets what it holds.
    pub fn reserve(&mut self, spheres: usize) {
        self.frontier.reserve(spheres);
    }

    /// Makes ready for a query.
    pub(super) fn clear(&mut self) {
        self.frontier.clear();
        self.nodes_a.len = 0;
        self.children_a.len = 0;
        self.near.len = 0;
        self.leaf_pairs.clear();
        self.pending.clear();
    }
}
