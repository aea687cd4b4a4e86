//! The clearance field: how large a ball fits at a point.
//!
//! `f(p) = min(depth of p under the surface, distance of p from the placed balls)` is 1-Lipschitz, and its
//! local maxima are the centres of the balls that fit in between.

use super::ascent::{self, Plane};
use super::ball_grid::{Ball, BallGrid};
use super::stop_signal::Watch;
use crate::Solid;
use crate::solid::closest_point_of_triangle;
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

/// Relative gain of the linear model under which an ascent has arrived; 1e-4 of the radius is 0.03 % of the
/// ball's volume.
const ARRIVED: f64 = 1e-4;
/// Most ascents arrive after a handful of evaluations; those that wander are cut off.
const MAX_EVALUATIONS: usize = 16;

/// Buffers, kept between calls.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    /// Balls near the cell that is refined.
    pub(super) nearby: Vec<Ball>,
    balls: Vec<Ball>,
    triangles: Vec<(u32, [DVec3; 3])>,
    planes: Vec<Plane>,
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

    /// Climbs from `start`, whose clearance is `clearance > 0`, to a local maximum of the clearance or to
    /// the boundary of the ball of radius `reach` about `start`.
    ///
    /// The linear model of [`ascent`] is exact for planes and a lower bound for balls, edges and corners, as
    /// the distance to a convex set is convex. So a step can only overestimate because of a
    /// triangle that the model does not know yet; that one is added and the step taken anew.
    pub(super) fn ascend(
        &self,
        start: DVec3,
        clearance: f64,
        reach: f64,
        scratch: &mut Scratch,
    ) -> Candidate {
        let Scratch { balls, triangles, planes, .. } = scratch;
        self.balls.gather(start, clearance + 2.0 * reach, balls);
        triangles.clear();
        let add = |p: DVec3, bound: f64, triangles: &mut Vec<(u32, [DVec3; 3])>| {
            let nearest = self.solid.closest_point_within(p, bound)?;
            if !triangles.iter().any(|(index, _)| *index == nearest.triangle) {
                triangles.push((nearest.triangle, self.solid.corners(nearest.triangle)));
            }
            Some(nearest.depth)
        };
        let _ = add(start, clearance + 2.0 * reach, triangles);
        let mut at = Candidate { center: start, radius: clearance, at_boundary: false };
        let mut trust = reach;
        for _ in 0..MAX_EVALUATIONS {
            let x = at.center;
            let relevant = at.radius + 2.0 * reach;
            planes.clear();
            planes.extend(balls.iter().filter_map(|ball| {
                let away = x - ball.center;
                let length = away.length();
                let value = length - ball.radius;
                (value < relevant).then(|| Plane { value, gradient: away / length })
            }));
            planes.extend(triangles.iter().filter_map(|(_, corners)| {
                let away = x - closest_point_of_triangle(corners, x).0;
                let value = away.length();
                (value < relevant && value > 0.0).then(|| Plane { value, gradient: away / value })
            }));
            let (center, radius) = if trust < reach { (DVec3::ZERO, trust) } else { (start - x, reach) };
            let top = ascent::climb(planes, center, radius);
            if top.value - at.radius <= ARRIVED * at.radius {
                at.at_boundary = top.at_boundary && top.value > at.radius * (1.0 + 1e-9);
                break;
            }
            let target = x + top.step;
            let to_balls = balls.iter().fold(f64::INFINITY, |d, ball| d.min(ball.distance(target)));
            let bound = to_balls.min(at.radius + 2.0 * reach);
            let there = add(target, bound, triangles).unwrap_or(bound);
            if there > at.radius && there >= top.value - ARRIVED * at.radius {
                at = Candidate { center: target, radius: there, at_boundary: top.at_boundary };
                trust = reach;
                if top.at_boundary && radius == reach {
                    break;
                }
            } else if there < 0.0 {
                // Beyond a wall that the model does not see.
                trust = 0.5 * top.step.length();
            } else if there > at.radius {
                at = Candidate { center: target, radius: there, at_boundary: top.at_boundary };
            }
        }
        at
    }
}
