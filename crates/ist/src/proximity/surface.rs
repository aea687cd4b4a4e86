//! The balls of a tree against a solid that is given by its signed distance, by branch and bound.
//!
//! Distances change by no more than the way: a node's ball of radius r about c holds nothing nearer than `d(c) − r`. The
//! distance at the parent's centre gives a bound for a child without asking.

use super::BallKind;
use super::placement::exact_ball;
use super::stack::Stack;
use crate::tree::WIDTH;
use crate::{InnerSphereTree, SignedDistance, SurfaceDistance};
use glam::Vec3;

/// The ball of a tree that is nearest to a surface, or deepest behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SurfaceSeparation {
    /// Distance of the ball from the surface (m), negative where they meet.
    pub gap: f32,
    /// Index of the sphere in its packing.
    pub sphere: usize,
    /// Centre of the ball (m).
    pub center: Vec3,
    /// Radius of the ball (m).
    pub radius: f32,
    /// The surface as the centre sees it.
    pub surface: SurfaceDistance,
}

impl SurfaceSeparation {
    /// The point of the ball nearest to the surface, or deepest behind it (m).
    #[must_use]
    pub fn point_on_ball(&self) -> Vec3 {
        self.center - self.radius * self.surface.outward
    }

    /// The point of the surface nearest to the centre (m).
    #[must_use]
    pub fn point_on_surface(&self) -> Vec3 {
        self.center - self.surface.distance * self.surface.outward
    }
}

impl InnerSphereTree {
    /// The ball with the least signed distance from a solid, of those nearer than `max_gap` (m).
    ///
    /// `surface` gives the solid's signed distance in the tree's frame. `None` where
    /// no ball is that near, where `max_gap` is NaN, and where distances are. Expected time is logarithmic in the number
    /// of spheres; linear for a surface that is equally far from all. Allocates nothing.
    #[must_use]
    pub fn nearest_to_surface(
        &self,
        balls: BallKind,
        max_gap: f32,
        surface: impl SignedDistance,
    ) -> Option<SurfaceSeparation> {
        Search { tree: self, balls, surface, enough: f32::NEG_INFINITY }.nearest(max_gap)
    }

    /// Whether a ball meets a solid of the given signed distance; touching counts. See [`Self::nearest_to_surface`].
    #[must_use]
    pub fn meets_surface(&self, balls: BallKind, surface: impl SignedDistance) -> bool {
        Search { tree: self, balls, surface, enough: 0.0 }.nearest(f32::MIN_POSITIVE).is_some()
    }
}

struct Search<'a, F> {
    tree: &'a InnerSphereTree,
    balls: BallKind,
    surface: F,
    /// A ball with a gap of at most this ends the search.
    enough: f32,
}

impl<F: SignedDistance> Search<'_, F> {
    fn nearest(&mut self, max_gap: f32) -> Option<SurfaceSeparation> {
        let tree = self.tree;
        let data = tree.data();
        let (mut limit, mut best) = (max_gap, None);
        let root = (data.height(), 0);
        let seen = self.see(root, f32::INFINITY)?;
        if data.height() == 0 {
            return (seen.gap < limit).then_some(seen);
        }
        let mut stack = Stack::new((seen, root));
        while let Some((parent, (level, node))) = stack.pop() {
            if parent.gap >= limit {
                continue;
            }
            let end = data.levels[level - 1].len().min((node + 1) * WIDTH);
            let mut nearest: Option<(SurfaceSeparation, (usize, usize))> = None;
            for child in node * WIDTH..end {
                let (center, radius) = ball(tree, self.balls, (level - 1, child));
                if parent.surface.distance - parent.center.distance(center) - radius >= limit {
                    continue;
                }
                let Some(seen) = self.see((level - 1, child), limit).filter(|seen| seen.gap < limit) else {
                    continue;
                };
                if level == 1 {
                    (limit, best) = (seen.gap, Some(seen));
                    if limit <= self.enough {
                        return best;
                    }
                    continue;
                }
                // The nearest child is looked at first.
                let entry = (seen, (level - 1, child));
                match nearest.replace(entry) {
                    Some(other) if other.0.gap < seen.gap => {
                        nearest = Some(other);
                        stack.push(entry);
                    }
                    Some(other) => stack.push(other),
                    None => {}
                }
            }
            if let Some(entry) = nearest {
                stack.push(entry);
            }
        }
        best
    }

    /// `None` where the gap is certainly not less than `limit`, and where the distance is no number.
    fn see(&mut self, (level, node): (usize, usize), limit: f32) -> Option<SurfaceSeparation> {
        let (center, radius) = ball(self.tree, self.balls, (level, node));
        // Touching counts where the limit is the least above 0.
        let reach = (limit + radius).next_up();
        let surface = self.surface.distance_within(center, reach);
        let gap = surface.distance - radius;
        let sphere = if level == 0 { self.tree.packing_index(node) } else { 0 };
        (surface.distance < reach).then_some(SurfaceSeparation { gap, sphere, center, radius, surface })
    }
}

/// Centre and radius (m) of a node's ball.
fn ball(tree: &InnerSphereTree, balls: BallKind, (level, node): (usize, usize)) -> (Vec3, f32) {
    if level == 0 {
        let (center, radius) = exact_ball(tree, balls, node);
        return (center.as_vec3(), radius as f32);
    }
    let (center, radius) = tree.data().levels[level].get(node);
    let skin = if balls == BallKind::Volume { tree.skin() } else { 0.0 };
    (center * tree.unit(), radius * tree.unit() + skin)
}
