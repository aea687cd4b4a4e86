//! Nearest ball of any set, however unequal the radii and however far the point.
//!
//! The grids that serve the placing need a bound that fits the radii; the report knows none. So here is a
//! binary tree of boxes, split at the median of the widest axis: O(n log n) to build, O(log n) a query where
//! balls are disjoint.

use crate::pack::ball_grid::Ball;
use glam::DVec3;

/// Most balls in a leaf; a choice.
const LEAF: usize = 4;
/// Halving a 32-bit count leaves one node behind at every level.
const STACK: usize = 34;

#[derive(Debug)]
pub(super) struct BallTree {
    nodes: Vec<Node>,
    balls: Vec<Ball>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    lower: DVec3,
    upper: DVec3,
    /// Balls of a leaf; empty in an inner node.
    first: u32,
    count: u32,
    /// The second child of an inner node; the first one follows the node.
    second: u32,
}

impl Node {
    /// No ball below the node has its surface nearer, unless the point is inside that ball.
    #[inline]
    fn distance_squared(&self, p: DVec3) -> f64 {
        (self.lower - p).max(p - self.upper).max(DVec3::ZERO).length_squared()
    }
}

impl BallTree {
    pub(super) fn new(mut balls: Vec<Ball>) -> Self {
        let mut tree = Self { nodes: Vec::with_capacity(balls.len()), balls: Vec::new() };
        if !balls.is_empty() {
            tree.build(&mut balls, 0);
        }
        tree.balls = balls;
        tree
    }

    fn build(&mut self, balls: &mut [Ball], first: u32) {
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (lower, upper) =
            balls.iter().fold(empty, |(l, u), b| (l.min(b.center - b.radius), u.max(b.center + b.radius)));
        let at = self.nodes.len();
        self.nodes.push(Node { lower, upper, first, count: balls.len() as u32, second: 0 });
        if balls.len() <= LEAF {
            return;
        }
        let (low, high) = balls.iter().fold(empty, |(l, u), b| (l.min(b.center), u.max(b.center)));
        let widths = high - low;
        let axis = (0..3).fold(0, |best, axis| if widths[axis] > widths[best] { axis } else { best });
        let middle = balls.len() / 2;
        balls.select_nth_unstable_by(middle, |a, b| a.center[axis].total_cmp(&b.center[axis]));
        let (left, right) = balls.split_at_mut(middle);
        self.build(left, first);
        self.nodes[at].count = 0;
        self.nodes[at].second = self.nodes.len() as u32;
        self.build(right, first + middle as u32);
    }

    /// Distance from `p` to the nearest ball (m), or `bound` where none is nearer. Inside a ball the distance is
    /// negative; where several balls overlap there, it is that of any of them.
    pub(super) fn distance(&self, p: DVec3, bound: f64) -> f64 {
        let mut nearest = bound;
        if self.nodes.is_empty() || nearest <= 0.0 {
            return nearest;
        }
        let mut stack = [(0.0, 0_u32); STACK];
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let (squared, index) = stack[top];
            if squared >= nearest * nearest {
                continue;
            }
            let node = &self.nodes[index as usize];
            if node.count > 0 {
                for ball in &self.balls[node.first as usize..][..node.count as usize] {
                    nearest = nearest.min(ball.distance(p));
                }
                if nearest <= 0.0 {
                    return nearest;
                }
                continue;
            }
            let child = |index: u32| (self.nodes[index as usize].distance_squared(p), index);
            let (mut near, mut far) = (child(index + 1), child(node.second));
            if far.0 < near.0 {
                std::mem::swap(&mut near, &mut far);
            }
            for visit in [far, near] {
                if visit.0 < nearest * nearest {
                    stack[top] = visit;
                    top += 1;
                }
            }
        }
        nearest
    }

    /// Whether a ball contains `p`, its surface excluded.
    pub(super) fn contains(&self, p: DVec3) -> bool {
        // Boxes at any positive distance are left out.
        self.distance(p, f64::MIN_POSITIVE.sqrt()) < 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pack::noise::Noise;

    #[test]
    fn the_nearest_ball_is_that_of_a_search_through_all() {
        // Radii over six decades, some far away, many at one place.
        let ball = |i: u64| {
            let mut noise = Noise::new(i);
            let center = if i.is_multiple_of(7) { DVec3::ONE } else { 3.0 * noise.point() };
            Ball { center, radius: 0.3 * 10.0_f64.powf(-6.0 * noise.uniform()) }
        };
        for count in [0, 1, 2, 5, 64, 1_000] {
            let balls: Vec<Ball> = (0..count).map(ball).collect();
            let tree = BallTree::new(balls.clone());
            for i in 0..500 {
                let p = (5.0 * Noise::new(!i).point() - 1.0) * if i % 50 == 0 { 1e6 } else { 1.0 };
                let naive = balls.iter().map(|ball| ball.distance(p)).fold(f64::INFINITY, f64::min);
                let found = tree.distance(p, f64::INFINITY);
                assert!(found == naive || (found < 0.0 && naive < 0.0), "{found} {naive}");
                assert_eq!(tree.contains(p), naive < 0.0);
                if naive > 0.0 && naive.is_finite() {
                    assert_eq!(tree.distance(p, 0.5 * naive), 0.5 * naive);
                }
            }
        }
    }
}
