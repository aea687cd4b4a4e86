//! Bounding volume hierarchy over triangles for closest-point queries.
//!
//! A binary tree, split by the surface area heuristic over 16 bins (I. Wald, *On fast construction of
//! SAH-based bounding volume hierarchies*, 2007). Queries visit the nearer child first and take a bound
//! from the caller: the packer nearly always knows one.

use super::triangle::{Feature, closest_point};
use glam::DVec3;

/// Leaves of up to this many triangles.
const LEAF: usize = 3;
const BINS: usize = 16;

/// The nearest point of the surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest {
    pub(crate) distance_squared: f64,
    pub(crate) point: DVec3,
    /// Index of the triangle in the solid's mesh.
    pub(crate) triangle: u32,
    pub(crate) feature: Feature,
}

#[derive(Clone, Debug)]
pub(crate) struct Bvh {
    nodes: Vec<Node>,
    triangles: Vec<Leaf>,
}

#[derive(Clone, Debug)]
struct Leaf {
    corners: [DVec3; 3],
    index: u32,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Bounds,
    /// First triangle of a leaf, or first of the two children.
    first: u32,
    /// Triangles of a leaf; 0 marks an inner node.
    count: u32,
}

#[derive(Clone, Copy, Debug)]
struct Bounds {
    lower: DVec3,
    upper: DVec3,
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

    #[inline]
    fn distance_squared(&self, p: DVec3) -> f64 {
        (self.lower - p).max(p - self.upper).max(DVec3::ZERO).length_squared()
    }
}

impl Bvh {
    pub(crate) fn new(corners: impl Iterator<Item = [DVec3; 3]>) -> Self {
        let mut triangles: Vec<Leaf> =
            corners.enumerate().map(|(index, corners)| Leaf { corners, index: index as u32 }).collect();
        let mut nodes = Vec::with_capacity(triangles.len());
        nodes.push(Node { bounds: Bounds::EMPTY, first: 0, count: 0 });
        // (node, first triangle, one past the last)
        let mut open = vec![(0, 0, triangles.len())];
        while let Some((node, first, end)) = open.pop() {
            let range = &mut triangles[first..end];
            let bounds = range.iter().fold(Bounds::EMPTY, |b, t| b.include(t.bounds()));
            let split = if range.len() > LEAF { partition(range) } else { 0 };
            if split == 0 {
                nodes[node] = Node { bounds, first: first as u32, count: range.len() as u32 };
                continue;
            }
            let left = nodes.len();
            nodes[node] = Node { bounds, first: left as u32, count: 0 };
            nodes.extend([Node { bounds, first: 0, count: 0 }; 2]);
            open.push((left, first, first + split));
            open.push((left + 1, first + split, end));
        }
        Self { nodes, triangles }
    }

    /// The nearest triangle closer than `bound` (as a squared distance), if there is one.
    #[inline]
    pub(crate) fn nearest(&self, p: DVec3, bound: f64) -> Option<Nearest> {
        let mut best =
            Nearest { distance_squared: bound, point: p, triangle: u32::MAX, feature: Feature::Face };
        let mut stack = [(0_u32, 0.0_f64); 96];
        let mut top = 0;
        let mut node = &self.nodes[0];
        if node.bounds.distance_squared(p) >= bound {
            return None;
        }
        loop {
            if node.count > 0 {
                let first = node.first as usize;
                for triangle in &self.triangles[first..first + node.count as usize] {
                    let (point, feature) = closest_point(&triangle.corners, p);
                    let distance_squared = point.distance_squared(p);
                    if distance_squared < best.distance_squared {
                        best = Nearest { distance_squared, point, triangle: triangle.index, feature };
                    }
                }
            } else {
                let (left, right) = (&self.nodes[node.first as usize], &self.nodes[node.first as usize + 1]);
                let (dl, dr) = (left.bounds.distance_squared(p), right.bounds.distance_squared(p));
                let (near, far, dn, df) =
                    if dl <= dr { (left, node.first + 1, dl, dr) } else { (right, node.first, dr, dl) };
                if dn < best.distance_squared {
                    if df < best.distance_squared {
                        stack[top] = (far, df);
                        top += 1;
                    }
                    node = near;
                    continue;
                }
            }
            loop {
                if top == 0 {
                    return (best.triangle != u32::MAX).then_some(best);
                }
                top -= 1;
                let (index, distance) = stack[top];
                if distance < best.distance_squared {
                    node = &self.nodes[index as usize];
                    break;
                }
            }
        }
    }
}

impl Bvh {
    /// How often the surface winds around `p`: crossings of the ray from `p` along `direction`, outward ones
    /// counted up and inward ones down. Reliable unless the ray meets an edge.
    pub(crate) fn winding(&self, p: DVec3, direction: DVec3) -> i32 {
        let inverse = direction.recip();
        let mut stack = vec![0_u32];
        let mut winding = 0;
        while let Some(index) = stack.pop() {
            let node = &self.nodes[index as usize];
            if !node.bounds.meets_ray(p, inverse) {
                continue;
            }
            if node.count == 0 {
                stack.extend([node.first, node.first + 1]);
                continue;
            }
            let first = node.first as usize;
            for triangle in &self.triangles[first..first + node.count as usize] {
                winding += crossing(&triangle.corners, p, direction);
            }
        }
        winding
    }
}

impl Bounds {
    fn meets_ray(&self, p: DVec3, inverse: DVec3) -> bool {
        let (a, b) = ((self.lower - p) * inverse, (self.upper - p) * inverse);
        // Rounding must not lose a box that is as flat as the triangle in it.
        a.min(b).max_element() <= a.max(b).min_element() * (1.0 + 1e-12) + f64::MIN_POSITIVE
            && a.max(b).min_element() >= 0.0
    }
}

/// 1 where the ray leaves through the triangle, -1 where it enters, 0 where it misses (T. Moeller and
/// B. Trumbore, *Fast, minimum storage ray/triangle intersection*, 1997).
fn crossing([a, b, c]: &[DVec3; 3], p: DVec3, direction: DVec3) -> i32 {
    let (ab, ac, ap) = (*b - *a, *c - *a, p - *a);
    let normal = ab.cross(ac);
    let slope = normal.dot(direction);
    let v = ac.dot(ap.cross(direction)) * -slope.signum();
    let w = ab.dot(ap.cross(direction)) * slope.signum();
    let ahead = -ap.dot(normal) * slope.signum() >= 0.0;
    if slope == 0.0 || !ahead || v < 0.0 || w < 0.0 || v + w > slope.abs() {
        return 0;
    }
    if slope > 0.0 { 1 } else { -1 }
}

impl Leaf {
    fn bounds(&self) -> Bounds {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_crosses_a_triangle_once_and_with_the_right_sign() {
        let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let below = DVec3::new(0.2, 0.3, -1.0);
        assert_eq!(crossing(&triangle, below, DVec3::Z), 1);
        assert_eq!(crossing(&triangle, below, DVec3::NEG_Z), 0);
        assert_eq!(crossing(&triangle, below + 2.0 * DVec3::Z, DVec3::NEG_Z), -1);
        assert_eq!(crossing(&triangle, DVec3::new(0.8, 0.3, -1.0), DVec3::Z), 0);
        assert_eq!(crossing(&triangle, DVec3::new(-0.1, 0.3, -1.0), DVec3::Z), 0);
    }
}
