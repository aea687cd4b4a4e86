//! Building: a binary tree, split by the surface area heuristic over 16 bins (I. Wald, *On fast construction of
//! SAH-based bounding volume hierarchies*, 2007), of which every second level is then left out.

use super::{Child, Frame, Leaf, WIDTH, Wide};
use glam::DVec3;

/// Leaves of up to this many triangles; 1 and 3 took a tenth more time on the pinion gear.
const LEAF: usize = 2;
const BINS: usize = 16;
/// Levels of the binary tree. Where the heuristic would need more, the rest is split in halves.
pub(super) const DEPTH: u32 = 42;

#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) lower: DVec3,
    pub(super) upper: DVec3,
}

impl Bounds {
    const EMPTY: Self = Self { lower: DVec3::INFINITY, upper: DVec3::NEG_INFINITY };

    fn include(self, other: Self) -> Self {
        Self { lower: self.lower.min(other.lower), upper: self.upper.max(other.upper) }
    }

    fn half_area(self) -> f64 {
        let d = (self.upper - self.lower).max(DVec3::ZERO);
        d.x * d.y + d.y * d.z + d.z * d.x
    }
}

/// Bounds of all triangles.
pub(super) fn bounds(triangles: &[Leaf]) -> Bounds {
    triangles.iter().fold(Bounds::EMPTY, |bounds, triangle| bounds.include(triangle.bounds()))
}

/// A node of the binary tree.
#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Bounds,
    /// First triangle of a leaf, or first of the two children.
    first: u32,
    /// Triangles of a leaf; 0 marks an inner node.
    count: u32,
}

/// Sorts `triangles` into leaves and returns the nodes above them, the root first.
pub(super) fn build(triangles: &mut [Leaf], frame: &Frame) -> Vec<Wide> {
    let binary = binary_tree(triangles);
    let mut wide = Vec::with_capacity(binary.len() / 2);
    wide.push(Wide::EMPTY);
    // (node of the binary tree, its place in the wide one)
    let mut open = vec![(binary[0], 0)];
    while let Some((node, place)) = open.pop() {
        for (slot, child) in descendants(&binary, node).into_iter().flatten().enumerate() {
            let first = if child.count > 0 {
                child.first
            } else {
                open.push((child, wide.len()));
                wide.push(Wide::EMPTY);
                wide.len() as u32 - 1
            };
            wide[place].set(slot, frame.enclose(&child.bounds), Child::new(first, child.count));
        }
    }
    wide
}

/// The leaf itself, or up to four nodes below `node` that share out its triangles: the largest ones are opened.
fn descendants(binary: &[Node], node: Node) -> [Option<Node>; WIDTH] {
    let mut found = [None; WIDTH];
    found[0] = Some(node);
    for size in 1..WIDTH {
        let inner = found[..size]
            .iter()
            .enumerate()
            .filter_map(|(slot, node)| node.filter(|node| node.count == 0).map(|node| (slot, node)));
        let largest = inner.max_by(|a, b| a.1.bounds.half_area().total_cmp(&b.1.bounds.half_area()));
        let Some((slot, opened)) = largest else { break };
        found[slot] = Some(binary[opened.first as usize]);
        found[size] = Some(binary[opened.first as usize + 1]);
    }
    found
}

fn binary_tree(triangles: &mut [Leaf]) -> Vec<Node> {
    let mut nodes = Vec::with_capacity(triangles.len());
    nodes.push(Node { bounds: Bounds::EMPTY, first: 0, count: 0 });
    // (node, first triangle, one past the last, depth)
    let mut open = vec![(0, 0, triangles.len(), 0)];
    while let Some((node, first, end, depth)) = open.pop() {
        let range = &mut triangles[first..end];
        let bounds = bounds(range);
        if range.len() <= LEAF {
            nodes[node] = Node { bounds, first: first as u32, count: range.len() as u32 };
            continue;
        }
        let levels_in_halves = usize::BITS - range.len().leading_zeros();
        let split = if depth + levels_in_halves < DEPTH { partition(range) } else { range.len() / 2 };
        let left = nodes.len();
        nodes[node] = Node { bounds, first: left as u32, count: 0 };
        nodes.extend([Node { bounds, first: 0, count: 0 }; 2]);
        open.push((left, first, first + split, depth + 1));
        open.push((left + 1, first + split, end, depth + 1));
    }
    nodes
}

impl Leaf {
    pub(super) fn bounds(&self) -> Bounds {
        let [a, b, c] = self.corners;
        Bounds { lower: a.min(b).min(c), upper: a.max(b).max(c) }
    }

    fn centroid(&self) -> DVec3 {
        let [a, b, c] = self.corners;
        (a + b + c) / 3.0
    }
}

/// Reorders `range` into two parts of least surface-area cost; returns the size of the first.
fn partition(range: &mut [Leaf]) -> usize {
    let (lower, upper) = range.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, u), t| {
        let c = t.centroid();
        (l.min(c), u.max(c))
    });
    let extent = upper - lower;
    let axis = if extent.x >= extent.y.max(extent.z) {
        0
    } else if extent.y >= extent.z {
        1
    } else {
        2
    };
    if extent[axis] <= 0.0 {
        // All centroids coincide: halve the list, or the depth would not be bounded.
        return range.len() / 2;
    }
    let bin_of =
        |t: &Leaf| (((t.centroid()[axis] - lower[axis]) / extent[axis] * BINS as f64) as usize).min(BINS - 1);
    let mut bins = [(Bounds::EMPTY, 0_usize); BINS];
    for triangle in range.iter() {
        let bin = &mut bins[bin_of(triangle)];
        *bin = (bin.0.include(triangle.bounds()), bin.1 + 1);
    }
    let mut right_cost = [0.0; BINS];
    let (mut bounds, mut count) = (Bounds::EMPTY, 0);
    for i in (1..BINS).rev() {
        (bounds, count) = (bounds.include(bins[i].0), count + bins[i].1);
        right_cost[i] = bounds.half_area() * count as f64;
    }
    let (mut best, mut cost) = (BINS / 2, f64::INFINITY);
    let (mut bounds, mut count) = (Bounds::EMPTY, 0);
    for i in 1..BINS {
        (bounds, count) = (bounds.include(bins[i - 1].0), count + bins[i - 1].1);
        let total = bounds.half_area() * count as f64 + right_cost[i];
        if count > 0 && count < range.len() && total < cost {
            (best, cost) = (i, total);
        }
    }
    let mut split = 0;
    for i in 0..range.len() {
        if bin_of(&range[i]) < best {
            range.swap(i, split);
            split += 1;
        }
    }
    // Bins can all fall on one side only if rounding put every centroid into one bin.
    if split == 0 || split == range.len() { range.len() / 2 } else { split }
}
