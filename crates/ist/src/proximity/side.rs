//! One of the two trees of a query, as the query sees it: its balls in the common frame.

use super::BallKind;
use super::placement::Placement;
use crate::InnerSphereTree;
use crate::tree::{TreeData, WIDTH, live_lanes};
use fearless_simd::{Simd, f32x8, prelude::*};
use glam::Vec3;

/// A tree, the kind of its balls, and where it stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side<'a> {
    pub(super) data: &'a TreeData,
    kind: BallKind,
    /// By how much balls are enlarged, in the common frame.
    skin: f32,
    /// None for the tree in whose frame the query runs.
    placement: Option<&'a Placement>,
}

/// Eight balls.
#[derive(Clone, Copy)]
pub(super) struct BlockLanes<S: Simd> {
    pub(super) x: f32x8<S>,
    pub(super) y: f32x8<S>,
    pub(super) z: f32x8<S>,
    pub(super) radius: f32x8<S>,
}

impl<'a> Side<'a> {
    /// The tree in whose unscaled frame the query runs.
    pub(super) fn fixed(tree: &'a InnerSphereTree, kind: BallKind) -> Self {
        Self { data: tree.data(), kind, skin: skin(tree, kind) / tree.unit(), placement: None }
    }

    /// A tree that stands at `placement` in the frame of `frame`.
    pub(super) fn placed(
        tree: &'a InnerSphereTree,
        kind: BallKind,
        frame: &InnerSphereTree,
        placement: &'a Placement,
    ) -> Self {
        Self { data: tree.data(), kind, skin: skin(tree, kind) / frame.unit(), placement: Some(placement) }
    }

    /// Number of balls on `level`.
    #[inline(always)]
    pub(super) fn len(&self, level: usize) -> usize {
        self.data.levels[level].len()
    }

    /// Ball `i` of `level`. On level 0 this is the ball that the query is about; above, one that wraps those of
    /// either kind, as inner balls lie inside volume balls.
    #[inline(always)]
    pub(super) fn ball(&self, level: usize, i: usize) -> (Vec3, f32) {
        let own = if level == 0 && self.kind == BallKind::Inner {
            (self.data.inner_center[i], self.data.inner_radius[i])
        } else {
            self.data.levels[level].get(i)
        };
        let (center, radius) = self.placement.map_or(own, |placement| placement.transform_ball(own));
        (center, radius + self.skin)
    }

    /// The block of `level` that begins at ball `first`, and which of its lanes hold a ball.
    ///
    /// On level 0 too these are balls that wrap those of either kind.
    #[inline(always)]
    pub(super) fn block<S: Simd>(&self, simd: S, level: usize, first: usize) -> (BlockLanes<S>, u32) {
        // No vector may pass through a closure that the standard library calls: it is compiled without the instruction
        // set that was chosen, and every operation on it becomes a call (a factor of 3 to 4 in all queries).
        let balls = &self.data.levels[level].blocks[first / WIDTH];
        let load = |array: [f32; WIDTH]| f32x8::load_array(simd, array);
        let lanes = [load(balls.x), load(balls.y), load(balls.z), load(balls.radius)];
        let [x, y, z, radius] = match self.placement {
            Some(placement) => placement.transform_lanes(lanes),
            None => lanes,
        };
        let block = BlockLanes { x, y, z, radius: radius + self.skin };
        (block, live_lanes(self.len(level), first))
    }
}

fn skin(tree: &InnerSphereTree, kind: BallKind) -> f32 {
    match kind {
        BallKind::Inner => 0.0,
        BallKind::Volume => tree.skin(),
    }
}

impl<S: Simd> BlockLanes<S> {
    /// Squared distances of the centres from `center`.
    #[inline(always)]
    pub(super) fn squared_distances(&self, center: Vec3) -> f32x8<S> {
        let (dx, dy, dz) = (self.x - center.x, self.y - center.y, self.z - center.z);
        dx * dx + dy * dy + dz * dz
    }

    /// Distances of the balls from a ball, negative where they meet.
    #[inline(always)]
    pub(super) fn gaps(&self, (center, radius): (Vec3, f32)) -> f32x8<S> {
        self.squared_distances(center).sqrt() - (self.radius + radius)
    }

    /// Which of the balls are less than `slack` from a ball, as a bit mask.
    #[inline(always)]
    pub(super) fn nearer_than(&self, slack: f32, (center, radius): (Vec3, f32)) -> u32 {
        let reach = self.radius + (radius + slack);
        self.squared_distances(center).simd_lt(reach * reach).to_bitmask() as u32
    }

    /// The ball in `lane`.
    #[inline(always)]
    pub(super) fn ball(&self, lane: usize) -> (Vec3, f32) {
        (Vec3::new(self.x[lane], self.y[lane], self.z[lane]), self.radius[lane])
    }
}

/// The positions of the bits of a mask, lowest first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bits(pub(super) u32);

impl Iterator for Bits {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        if self.0 == 0 {
            return None;
        }
        let bit = self.0.trailing_zeros() as usize;
        self.0 &= self.0 - 1;
        Some(bit)
    }
}

/// The lane of `mask` with the least of `values`; any lane where there is none.
#[inline(always)]
pub(super) fn least_lane(values: &[f32; WIDTH], mask: u32) -> usize {
    let mut least = (f32::INFINITY, 0);
    for lane in Bits(mask) {
        if values[lane] < least.0 {
            least = (values[lane], lane);
        }
    }
    least.1
}

/// The lanes of `mask`, the one with the least of `values` last: on top of a stack.
#[inline(always)]
pub(super) fn nearest_last(values: &[f32; WIDTH], mask: u32) -> impl Iterator<Item = usize> {
    let nearest = mask & (1 << least_lane(values, mask));
    Bits(mask & !nearest).chain(Bits(nearest))
}
