//! A small ball around balls.

use glam::Vec3;

/// Room for the rounding of centres that are transformed before they are tested, relative to their distance
/// from the origin.
const ROUNDING: f32 = 1e-6;

/// Centre and radius of a ball around `balls`, a little larger than the smallest: the more `steps`, the less.
///
/// M. Bădoiu and K. L. Clarkson, *Smaller core-sets for balls* (SODA 2003): walk towards the farthest ball
/// with a step that shrinks as 1/i. The error of the radius falls as one over the number of steps.
pub(super) fn enclosing_ball(balls: impl Iterator<Item = (Vec3, f32)> + Clone, steps: usize) -> (Vec3, f32) {
    let (lower, upper) = balls
        .clone()
        .fold((Vec3::splat(f32::INFINITY), Vec3::splat(f32::NEG_INFINITY)), |(lower, upper), (c, r)| {
            (lower.min(c - r), upper.max(c + r))
        });
    let reach = |from: Vec3| {
        balls
            .clone()
            .map(|(c, r)| (from.distance(c) + r, c))
            .fold((0.0, from), |far, next| if next.0 > far.0 { next } else { far })
    };
    let mut center = 0.5 * (lower + upper);
    let (mut best_radius, mut farthest) = reach(center);
    let mut best = center;
    for step in 1..=steps {
        center += (farthest - center) / (step + 1) as f32;
        let (radius, next) = reach(center);
        farthest = next;
        if radius < best_radius {
            (best, best_radius) = (center, radius);
        }
    }
    (best, best_radius + ROUNDING * (best.abs().max_element() + best_radius))
}
