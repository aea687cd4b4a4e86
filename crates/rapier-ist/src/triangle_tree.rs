//! The triangles of a mesh in a tree of boxes, eight to a node.
//!
//! A node's eight boxes are looked at four at a time: I. Wald, C. Benthin and S. Boulos, *Getting
//! rid of packets: efficient SIMD single-ray traversal using multi-branching BVHs* (2008).

use crate::nearest_triangle::NearestTriangle;
use rapier3d::glamx::Vec4;
use rapier3d::math::Vector;
use rapier3d::parry::bounding_volume::{Aabb, BoundingVolume};
use rapier3d::parry::shape::{TriMesh, Triangle};

/// Boxes of a node.
const WIDTH: usize = 2 * LANES;

/// Boxes in a vector.
const LANES: usize = 4;

/// Marks a child that is a triangle.
const IS_TRIANGLE: u32 = 1 << 31;

/// Room for all but one of the boxes on each of the at most eleven levels of 2³¹ triangles, and one more.
const MOST_PENDING: usize = 11 * WIDTH;

/// Search tree over the triangles of a mesh; about 100 bytes a triangle.
#[derive(Debug)]
pub(crate) struct TriangleTree {
    /// The root is first.
    nodes: Vec<Node>,
    /// In the order of the leaves, each with its index in the mesh.
    triangles: Vec<(Triangle, u32)>,
}

/// Boxes, by axis. Those of missing children are empty.
#[derive(Clone, Debug)]
struct Node {
    mins: [[Vec4; WIDTH / LANES]; 3],
    maxs: [[Vec4; WIDTH / LANES]; 3],
    /// Indices of nodes, and of triangles with [`IS_TRIANGLE`].
    children: [u32; WIDTH],
}

impl TriangleTree {
    /// `None` for more triangles than indices can tell from nodes. Expected time O(n log n).
    pub(crate) fn new(mesh: &TriMesh) -> Option<Self> {
        let mut leaves: Vec<Leaf> = (0_u32..).zip(mesh.triangles()).map(Leaf::new).collect();
        if leaves.is_empty() || leaves.len() >= IS_TRIANGLE as usize {
            return None;
        }
        let mut tree = Self { nodes: Vec::new(), triangles: Vec::with_capacity(leaves.len()) };
        tree.add_node(&mut leaves);
        Some(tree)
    }

    /// Shows `search` all triangles that may be the nearest.
    pub(crate) fn search(&self, search: &mut NearestTriangle) {
        // Missing boxes would be as near as others.
        if !search.point().is_finite() {
            return;
        }
        let mut pending = [(0.0, 0_u32); MOST_PENDING];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let (square, child) = pending[count];
            if search.may_hold_nearest(Vec4::splat(square)) == 0 {
                continue;
            }
            if child & IS_TRIANGLE != 0 {
                let (triangle, index) = &self.triangles[(child & !IS_TRIANGLE) as usize];
                search.see(*index, triangle);
                continue;
            }
            let node = &self.nodes[child as usize];
            let first = count;
            for half in 0..WIDTH / LANES {
                let squares = node.squared_distances(half, search.point());
                let mut near = search.may_hold_nearest(squares);
                let squares = squares.to_array();
                while near != 0 {
                    let lane = near.trailing_zeros() as usize;
                    near &= near - 1;
                    let square = squares[lane];
                    // The nearest comes last and is looked at first.
                    let mut place = count;
                    while place > first && pending[place - 1].0 < square {
                        pending[place] = pending[place - 1];
                        place -= 1;
                    }
                    pending[place] = (square, node.children[half * LANES + lane]);
                    count += 1;
                }
            }
        }
    }

    /// Adds a node over `leaves` and all below it, and returns its index.
    fn add_node(&mut self, leaves: &mut [Leaf]) -> u32 {
        let index = self.nodes.len();
        self.nodes.push(Node::EMPTY);
        // Subtrees are full but for the last.
        let mut capacity = 1;
        while capacity * WIDTH < leaves.len() {
            capacity *= WIDTH;
        }
        let mut rest = leaves;
        let mut parts: [&mut [Leaf]; WIDTH] = Default::default();
        let used = rest.len().div_ceil(capacity);
        split(std::mem::take(&mut rest), capacity, &mut parts[..used]);
        for (slot, part) in parts.into_iter().take(used).enumerate() {
            let bounds = bounds(part);
            let child = match part {
                [leaf] => {
                    self.triangles.push((leaf.triangle, leaf.index));
                    (self.triangles.len() - 1) as u32 | IS_TRIANGLE
                }
                part => self.add_node(part),
            };
            self.nodes[index].set(slot, &bounds, child);
        }
        index as u32
    }
}

impl Node {
    const EMPTY: Self = Self {
        mins: [[Vec4::INFINITY; WIDTH / LANES]; 3],
        maxs: [[Vec4::NEG_INFINITY; WIDTH / LANES]; 3],
        children: [0; WIDTH],
    };

    fn set(&mut self, slot: usize, bounds: &Aabb, child: u32) {
        for (axis, (min, max)) in bounds.mins.to_array().into_iter().zip(bounds.maxs.to_array()).enumerate() {
            let (vector, lane) = (slot / LANES, slot % LANES);
            (self.mins[axis][vector][lane], self.maxs[axis][vector][lane]) = (min, max);
        }
        self.children[slot] = child;
    }

    /// Of one half of the boxes; infinite for missing ones.
    fn squared_distances(&self, half: usize, point: Vector) -> Vec4 {
        let way = |axis: usize| {
            let at = Vec4::splat(point[axis]);
            (self.mins[axis][half] - at).max(at - self.maxs[axis][half]).max(Vec4::ZERO)
        };
        let [x, y, z] = [0, 1, 2].map(way);
        x * x + y * y + z * z
    }
}

/// A triangle on its way into the tree.
#[derive(Clone, Copy, Debug)]
struct Leaf {
    triangle: Triangle,
    index: u32,
    bounds: Aabb,
}

impl Leaf {
    fn new((index, triangle): (u32, Triangle)) -> Self {
        Self { triangle, index, bounds: triangle.local_aabb() }
    }
}

/// Divides `leaves` among `parts`, each but the last of `capacity`, by their centres along the longest axes.
fn split<'a>(leaves: &'a mut [Leaf], capacity: usize, parts: &mut [&'a mut [Leaf]]) {
    if let [part] = parts {
        *part = leaves;
        return;
    }
    let (first, second) = parts.split_at_mut(parts.len() / 2);
    let middle = capacity * first.len();
    let extents = bounds(leaves).extents();
    let axis = extents.max_position();
    let center = |leaf: &Leaf| leaf.bounds.mins[axis] + leaf.bounds.maxs[axis];
    leaves.select_nth_unstable_by(middle, |a, b| center(a).total_cmp(&center(b)).then(a.index.cmp(&b.index)));
    let (left, right) = leaves.split_at_mut(middle);
    split(left, capacity, first);
    split(right, capacity, second);
}

fn bounds(leaves: &[Leaf]) -> Aabb {
    let mut bounds = Aabb::new_invalid();
    leaves.iter().for_each(|leaf| bounds.merge(&leaf.bounds));
    bounds
}
