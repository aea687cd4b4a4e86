//! Local search for the place of a ball: up to a local maximum of the clearance, and along a plateau to the balls
//! that are there.

use super::ascent::{self, Plane, Top};
use super::ball_grid::Ball;
use super::field::{Candidate, Field};
use super::plateau;
use crate::solid::closest_point_of_triangle;
use glam::DVec3;

/// Relative gain of the linear model under which an ascent has arrived. 1e-4 filled the assets by 0.02 points less.
const ARRIVED: f64 = 1e-5;
/// Most ascents arrive after a handful of evaluations; those that wander are cut off.
const MAX_EVALUATIONS: usize = 24;

/// Buffers, kept between searches.
#[derive(Debug, Default)]
pub(super) struct Obstacles {
    balls: Vec<Ball>,
    triangles: Vec<(u32, [DVec3; 3])>,
    /// The first `ball_planes` of them belong to balls, the others to triangles.
    planes: Vec<Plane>,
    ball_planes: usize,
}

/// A search within a ball about its start.
struct Search<'a, 'f> {
    field: &'a Field<'f>,
    start: DVec3,
    reach: f64,
    known: &'a mut Obstacles,
}

/// Climbs from `start`, whose clearance is `clearance > 0`, to a local maximum of the clearance or to the boundary
/// of the ball of radius `reach` about `start`; on a plateau, on to the balls near it.
///
/// The linear model of [`ascent`] is exact for planes and a lower bound for balls, edges and corners, as
/// the distance to a convex set is convex. So a step can only overestimate because of a
/// triangle that the model does not know yet; that one is added and the step taken anew.
pub(super) fn ascend(
    field: &Field,
    start: DVec3,
    clearance: f64,
    reach: f64,
    known: &mut Obstacles,
) -> Candidate {
    field.balls.gather(start, clearance + 2.0 * reach, &mut known.balls);
    known.triangles.clear();
    let mut search = Search { field, start, reach, known };
    let _ = search.evaluate(start, clearance + 2.0 * reach);
    let top = search.climb(Candidate { center: start, radius: clearance, at_boundary: false });
    if top.at_boundary { top } else { search.slide(top) }
}

impl Search<'_, '_> {
    /// Clearance of the surface at `p`, or `bound` where it is larger; takes note of the nearest triangle.
    fn evaluate(&mut self, p: DVec3, bound: f64) -> f64 {
        let Some(nearest) = self.field.solid.closest_point_within(p, bound) else { return bound };
        if !self.known.triangles.iter().any(|(index, _)| *index == nearest.triangle) {
            self.known.triangles.push((nearest.triangle, self.field.solid.corners(nearest.triangle)));
        }
        nearest.depth
    }

    /// Clearance at `p`, or `bound` where it is larger.
    fn clearance(&mut self, p: DVec3, bound: f64) -> f64 {
        let to_balls = self.known.balls.iter().fold(bound, |d, ball| d.min(ball.distance(p)));
        self.evaluate(p, to_balls)
    }

    /// Linearises the obstacles that are nearer than `relevant` to `x`.
    fn linearise(&mut self, x: DVec3, relevant: f64) {
        let Obstacles { balls, triangles, planes, ball_planes } = &mut *self.known;
        planes.clear();
        planes.extend(balls.iter().filter_map(|ball| {
            let away = x - ball.center;
            let length = away.length();
            let value = length - ball.radius;
            (value < relevant).then(|| Plane { value, gradient: away / length })
        }));
        *ball_planes = planes.len();
        planes.extend(triangles.iter().filter_map(|(_, corners)| {
            let away = x - closest_point_of_triangle(corners, x).0;
            let value = away.length();
            (value < relevant && value > 0.0).then(|| Plane { value, gradient: away / value })
        }));
    }

    fn climb(&mut self, mut at: Candidate) -> Candidate {
        let reach = self.reach;
        let mut trust = reach;
        for _ in 0..MAX_EVALUATIONS {
            let x = at.center;
            let relevant = at.radius + 2.0 * reach;
            self.linearise(x, relevant);
            let (center, radius) = if trust < reach { (DVec3::ZERO, trust) } else { (self.start - x, reach) };
            let top = ascent::climb(&self.known.planes, center, radius);
            if top.value - at.radius <= ARRIVED * at.radius {
                at.at_boundary = top.at_boundary && top.value > at.radius * (1.0 + 1e-9);
                break;
            }
            let target = x + top.step;
            let there = self.clearance(target, relevant);
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

    /// Slides a place on a plateau to the balls near it.
    fn slide(&mut self, top: Candidate) -> Candidate {
        let least = top.radius * (1.0 - plateau::LOSS);
        let mut best = top;
        let mut at = top;
        for _ in 0..plateau::SLIDES {
            self.linearise(at.center, top.radius + 2.0 * self.reach);
            let (balls, walls) = self.known.planes.split_at(self.known.ball_planes);
            let Some(step) = plateau::next_contact(at.radius, balls, walls) else { break };
            let step = step.clamp_length_max(plateau::STEP * top.radius);
            // Curved walls bend away from the step: back to the middle between them.
            at = self.centre(at.center + step, top.radius);
            if at.radius < least || at.center.distance(self.start) > self.reach {
                break;
            }
            best = at;
        }
        best
    }

    /// The place of largest clearance close to `p`, by one step of the linear model.
    fn centre(&mut self, p: DVec3, radius: f64) -> Candidate {
        let here = self.clearance(p, 2.0 * radius);
        self.linearise(p, 2.0 * radius);
        let Top { step, .. } = ascent::climb(&self.known.planes, DVec3::ZERO, plateau::CENTRE * radius);
        let there = self.clearance(p + step, 2.0 * radius);
        let (center, radius) = if there > here { (p + step, there) } else { (p, here) };
        Candidate { center, radius, at_boundary: false }
    }
}
