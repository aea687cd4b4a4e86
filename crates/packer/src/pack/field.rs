//! The clearance field: how large a ball fits at a point.
//!
//! `f(p) = min(depth of p under the surface, distance of p from the placed balls)` is 1-Lipschitz, and its
//! local maxima are the centres of the balls that fit in between.

use super::ball_grid::{Ball, BallGrid};
use super::search::Obstacles;
use super::stop_signal::Watch;
use crate::Solid;
use glam::DVec3;

/// The solid and the balls placed in it so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Field<'a> {
    pub(super) solid: &'a Solid,
    pub(super) balls: &'a BallGrid,
    /// Ends long searches early.
    pub(super) watch: &'a Watch<'a>,
}

/// A place for a ball.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub(super) center: DVec3,
    /// Clearance at the centre.
    pub(super) radius: f64,
    /// Whether the clearance still grows there, beyond the region that was searched.
    pub(super) at_boundary: bool,
}

/// Buffers, kept between calls.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    /// Balls near the cell that is refined.
    pub(super) nearby: Vec<Ball>,
    pub(super) obstacles: Obstacles,
}

impl Field<'_> {
    /// Clearance at `p` (negative outside the solid and inside balls), or `bound` where it is larger.
    pub(super) fn clearance(&self, p: DVec3, bound: f64) -> f64 {
        let to_balls = self.balls.clearance(p, bound);
        if to_balls <= 0.0 {
            return to_balls;
        }
        // Balls lie inside: from a point outside, the surface is nearer than any of them.
        match self.solid.closest_point_within(p, to_balls) {
            Some(surface) => surface.depth,
            None => to_balls,
        }
    }
}
