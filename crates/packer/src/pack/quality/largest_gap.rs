//! The largest ball that would still fit, searched for from points of the gaps.

use super::ball_tree::BallTree;
use super::gap_samples::GapSample;
use crate::Solid;
use crate::pack::noise::Noise;
use glam::DVec3;
use rayon::prelude::*;

/// Starts of the search. At 10 to 10,000 spheres of the five assets the gap found was at least 98.9 % of the radius
/// of the next ball of the sequence, which fits; with 32 starts 97.5 %, with no gain in time that showed.
const STARTS: usize = 96;
/// Most directions tried from one start; the step has fallen to nothing long before.
const TRIALS: u64 = 400;
/// The search ends when its step is this share of the radius found.
const FINEST_STEP: f64 = 1e-3;
/// How the step changes after a gain and after a failure: it keeps its size at one gain in nine trials, which is
/// about what a random direction towards a ridge is worth. A choice.
const GROWTH: f64 = 2.3;
const FALL: f64 = 0.9;

/// Room for one more ball.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde-serialize", derive(serde::Serialize))]
#[non_exhaustive]
pub struct LargestGap {
    /// Where its centre would be (m).
    pub center: DVec3,
    /// Its radius (m).
    pub radius: f64,
}

/// The largest gap that the samples lead to; none without samples.
pub(super) fn find(solid: &Solid, balls: &BallTree, samples: &[GapSample]) -> Option<LargestGap> {
    let found: Vec<LargestGap> =
        starts(samples).into_par_iter().map(|start| climb(start, solid, balls)).collect();
    // The first of equals, so that the answer is one.
    found.into_iter().reduce(|best, gap| if gap.radius > best.radius { gap } else { best })
}

/// The samples of largest clearance, but none within the room around a larger one: it leads to the same gap.
fn starts(samples: &[GapSample]) -> Vec<GapSample> {
    let mut order: Vec<usize> = (0..samples.len()).collect();
    order.sort_by(|a, b| samples[*b].clearance.total_cmp(&samples[*a].clearance).then(a.cmp(b)));
    let mut starts: Vec<GapSample> = Vec::new();
    for sample in order.into_iter().map(|index| samples[index]) {
        if starts.len() == STARTS {
            break;
        }
        if starts.iter().all(|start| start.point.distance(sample.point) > start.clearance) {
            starts.push(sample);
        }
    }
    starts
}

/// Climbs to a local maximum of the clearance by random steps that shrink when they fail: slower than the
/// packer's own ascent, and independent of it.
fn climb(start: GapSample, solid: &Solid, balls: &BallTree) -> LargestGap {
    let mut at = LargestGap { center: start.point, radius: start.clearance };
    let mut step = at.radius;
    let mut noise = Noise::new(0);
    for _ in 0..TRIALS {
        if step < FINEST_STEP * at.radius {
            break;
        }
        let center = at.center + (2.0 * noise.point() - 1.0) * step;
        let radius = clearance(center, at.radius, solid, balls);
        if radius > at.radius {
            at = LargestGap { center, radius };
            step *= GROWTH;
        } else {
            step *= FALL;
        }
    }
    at
}

/// How large a ball fits at `p`; not looked at closely where it is no more than `least`.
fn clearance(p: DVec3, least: f64, solid: &Solid, balls: &BallTree) -> f64 {
    let to_balls = balls.distance(p, f64::INFINITY);
    if to_balls <= least {
        return to_balls;
    }
    solid.closest_point_within(p, to_balls).map_or(to_balls, |surface| surface.depth)
}
