//! The ball of a tree that is nearest to a point.

use super::BallKind;
use super::placement::exact_ball;
use super::projection::BallPair;
use super::side::{Bits, Side, nearest_last};
use super::stack::Stack;
use crate::InnerSphereTree;
use crate::simd_level::simd_level;
use crate::tree::WIDTH;
use fearless_simd::{Simd, dispatch, prelude::*};
use glam::{DVec3, Vec3};

/// The ball nearest to a point, in the tree's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct NearestSphere {
    /// Index of the sphere in its packing.
    pub sphere: usize,
    /// Distance of the point from the ball (m), negative inside.
    ///
    /// Outside it is the distance from the union of all balls. Inside it is that from the surface of the
    /// union for inner balls, which are disjoint; volume balls overlap, and the point is at least that deep.
    pub distance: f32,
    /// The point of the ball's surface nearest to the query's point (m).
    pub point: Vec3,
    /// Outward unit normal of the ball there.
    pub normal: Vec3,
}

impl InnerSphereTree {
    /// The ball with the least signed distance from `point` (m, the tree's frame).
    ///
    /// The nearest one up to the rounding of coordinates to f32; its distance is computed in f64. `None` where `point` is
    /// not finite or beyond 10¹⁸ times the tree's size. Expected time is logarithmic in the
    /// number of spheres.
    #[must_use]
    pub fn nearest_sphere(&self, point: Vec3, balls: BallKind) -> Option<NearestSphere> {
        let nearest = self.nearest_position(point, balls)?;
        let (center, radius) = exact_ball(self, balls, nearest);
        let fallback = self.data().leaves[nearest].normal().as_dvec3();
        let pair = BallPair::new((center, radius), (point.as_dvec3(), 0.0), fallback);
        Some(NearestSphere {
            sphere: self.packing_index(nearest),
            distance: pair.gap as f32,
            point: (center + radius * pair.normal).as_vec3(),
            normal: pair.normal.as_vec3(),
        })
    }

    /// Whether `point` (m, the tree's frame) lies in one of the balls, their surfaces included.
    ///
    /// With [`BallKind::Inner`] a point for which this holds lies in the solid. False for points that are not finite.
    #[must_use]
    pub fn contains_point(&self, point: Vec3, balls: BallKind) -> bool {
        self.visit_spheres_in_ball(point, 0.0, balls, |_| core::ops::ControlFlow::Break(())).is_break()
    }

    fn nearest_position(&self, point: Vec3, balls: BallKind) -> Option<usize> {
        let center = unscaled(self, point)?;
        Some(dispatch!(simd_level(), simd => nearest(simd, Side::fixed(self, balls), center)))
    }
}

/// `point` in the unscaled frame of `tree`; `None` where it is not finite or too far away to be squared.
pub(super) fn unscaled(tree: &InnerSphereTree, point: Vec3) -> Option<Vec3> {
    let point = point / tree.unit();
    // False for NaN as well.
    (point.abs().max_element() < 1e18 && !point.is_nan()).then_some(point)
}

#[inline(always)]
fn nearest<S: Simd>(simd: S, side: Side, center: Vec3) -> usize {
    let mut best = (f32::INFINITY, 0);
    let height = side.data.height();
    let mut stack = Stack::new((f32::NEG_INFINITY, height, 0));
    while let Some((gap, level, node)) = stack.pop() {
        if gap >= best.0 {
            continue;
        }
        if level == 0 {
            // Only the root can be a leaf here.
            return 0;
        }
        let first = node * WIDTH;
        let (block, live) = side.block(simd, level - 1, first);
        let gaps = block.gaps((center, 0.0));
        let mask = gaps.simd_lt(best.0).to_bitmask() as u32 & live;
        if level == 1 {
            for lane in Bits(mask) {
                let (ball, radius) = side.ball(0, first + lane);
                let gap = ball.distance(center) - radius;
                if gap < best.0 {
                    best = (gap, first + lane);
                }
            }
            continue;
        }
        let gaps = gaps.to_array();
        for lane in nearest_last(&gaps, mask) {
            stack.push((gaps[lane], level - 1, first + lane));
        }
    }
    best.1
}

/// Signed distance (m) of ball `i` from `point`.
pub(super) fn exact_distance(tree: &InnerSphereTree, balls: BallKind, i: usize, point: DVec3) -> f64 {
    let (center, radius) = exact_ball(tree, balls, i);
    center.distance(point) - radius
}
