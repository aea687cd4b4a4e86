//! The balls of a tree that meet a given ball.

use super::BallKind;
use super::point::{exact_distance, unscaled};
use super::side::{Bits, Side, nearest_last};
use super::stack::Stack;
use crate::InnerSphereTree;
use crate::simd_level::simd_level;
use crate::tree::WIDTH;
use core::ops::ControlFlow;
use fearless_simd::{Simd, dispatch, prelude::*};
use glam::Vec3;

/// Room for rounding in f32, relative to the coordinates; balls that pass are tested again in f64.
const ROUNDING: f32 = 1e-6;

impl InnerSphereTree {
    /// Calls `visit` with the packing index of every sphere whose ball meets the ball of radius `radius` (m) about
    /// `center` (m, the tree's frame), each once, in an order that depends on the tree and the ball only, until `visit`
    /// breaks. Balls that just touch count.
    ///
    /// Nothing is visited where `center` is not finite or beyond 10¹⁸ times the tree's size, and where `radius` is
    /// negative or NaN. Time is linear in the spheres found and logarithmic in all.
    pub fn visit_spheres_in_ball<T>(
        &self,
        center: Vec3,
        radius: f32,
        balls: BallKind,
        mut visit: impl FnMut(usize) -> ControlFlow<T>,
    ) -> ControlFlow<T> {
        let Some(local) = unscaled(self, center).filter(|_| radius >= 0.0) else {
            return ControlFlow::Continue(());
        };
        // As far as anything can be: an infinite radius meets all.
        let local_radius = (radius / self.unit()).min(4e18);
        let mut meets = |i: usize| {
            if exact_distance(self, balls, i, center.as_dvec3()) <= f64::from(radius) {
                visit(self.packing_index(i))
            } else {
                ControlFlow::Continue(())
            }
        };
        let side = Side::fixed(self, balls);
        dispatch!(simd_level(), simd => visit_near(simd, side, (local, local_radius), &mut meets))
    }

    /// Whether a ball of the tree meets the ball of radius `radius` (m) about `center` (m, the tree's frame); touching
    /// counts. See [`Self::visit_spheres_in_ball`].
    #[must_use]
    pub fn meets_ball(&self, center: Vec3, radius: f32, balls: BallKind) -> bool {
        self.visit_spheres_in_ball(center, radius, balls, |_| ControlFlow::Break(())).is_break()
    }
}

/// Calls `visit` with the leaves that meet `ball` but for rounding.
#[inline(always)]
fn visit_near<S: Simd, T>(
    simd: S,
    side: Side,
    ball: (Vec3, f32),
    visit: &mut impl FnMut(usize) -> ControlFlow<T>,
) -> ControlFlow<T> {
    let height = side.data.height();
    if height == 0 {
        return visit(0);
    }
    let slack = ROUNDING * (ball.0.abs().max_element() + ball.1 + side.ball(height, 0).1);
    let mut stack = Stack::new((f32::NEG_INFINITY, height, 0));
    while let Some((_, level, node)) = stack.pop() {
        let first = node * WIDTH;
        let (block, live) = side.block(simd, level - 1, first);
        let gaps = block.gaps(ball);
        let mask = gaps.simd_le(slack).to_bitmask() as u32 & live;
        if level == 1 {
            for lane in Bits(mask) {
                visit(first + lane)?;
            }
            continue;
        }
        let gaps = gaps.to_array();
        for lane in nearest_last(&gaps, mask) {
            stack.push((gaps[lane], level - 1, first + lane));
        }
    }
    ControlFlow::Continue(())
}
