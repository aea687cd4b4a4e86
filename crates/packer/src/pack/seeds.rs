//! Places for the largest balls, found without descending the octree: Voronoi seeds.
//!
//! The Voronoi vertices of dense surface samples lie near the medial axis or near the surface; of those in the
//! Voronoi cell of one sample, the farthest on the inner side, its *pole*, lies near the medial axis
//! (N. Amenta and M. Bern, *Surface reconstruction by Voronoi filtering*, 1999). Each pole climbs to a local
//! maximum of the clearance, and these are the seeds. Balls between placed balls are not among them: those are the
//! octree's.
//!
//! Share of the volume at 100 / 1,000 / 10,000 balls with seeds, and the gain over the octree alone, in points:
//!
//! | bunny | femur | pelvis | pinion gear | spider gear |
//! |---|---|---|---|---|
//! | 71.0 / 81.7 / 88.6 | 64.0 / 76.5 / 85.3 | 43.5 / 65.7 / 78.4 | 50.5 / 71.0 / 81.9 | 46.4 / 68.2 / 80.2 |
//! | 0.0 / 0.0 / 0.0 | +0.1 / +0.1 / 0.0 | +0.2 / +0.1 / 0.0 | 0.0 / 0.0 / 0.0 | −1.7 / −0.3 / −0.2 |
//!
//! The loss on the spider gear is not explained: exact greedy packing fills 47.6 / 70.0 of it, the octree alone
//! 48.1 / 68.5. The number of closest-point queries for 10,000 balls grew by 1 to 2 % on the bones and the
//! bunny; finding the seeds took 0.1 to 0.3 s of a busy machine.

use super::ball_grid::{Ball, BallGrid};
use super::field::{Candidate, Field, Scratch};
use super::{samples, voronoi};
use glam::DVec3;
use rayon::prelude::*;

/// Surface samples. 10,000 took twice the time and filled the assets the same to 0.03 points, but for the spider
/// gear: 0.4 more at 100 balls, 0.1 at 1,000.
const SAMPLES: usize = 5_000;
/// A seed is placed before the octree is asked if its radius is at least this share of the largest that may be
/// left. With 0.9 seeds stood in the way of larger balls that no sample had led to: 0.6 points lost at 100 balls and
/// 0.4 at 1,000 on the pinion gear.
pub(super) const SHARE: f64 = 0.97;
/// A climb goes on from the boundary of its trust ball at most this often; one that is not there then is given up.
const CLIMBS: usize = 16;
/// Of seeds nearer to each other than this share of the larger radius, only the larger one is kept.
const APART: f64 = 0.1;

/// Local maxima of the clearance of the empty solid, in descending order.
pub(super) fn find(field: &Field) -> Vec<Candidate> {
    let starts: Vec<Candidate> = inner_poles(field)
        .into_par_iter()
        .filter_map(|center| {
            let radius = field.clearance(center, f64::INFINITY);
            (radius > 0.0).then_some(Candidate { center, radius, at_boundary: true })
        })
        .collect();
    let seeds = thin_out(starts)
        .into_par_iter()
        .map_init(Scratch::default, |scratch, start| climb(start, field, scratch))
        .flatten_iter()
        .collect();
    thin_out(seeds)
}

/// Sorts in descending order and drops what lies close to a larger one.
fn thin_out(mut places: Vec<Candidate>) -> Vec<Candidate> {
    // The sort is stable, so that equals keep their order.
    places.sort_by(|a, b| b.radius.total_cmp(&a.radius));
    let mut kept = BallGrid::default();
    places.retain(|place| {
        let ball = Ball { center: place.center, radius: APART * place.radius };
        let is_apart = kept.clearance(ball.center, ball.radius) > 0.0;
        if is_apart {
            kept.insert(ball);
        }
        is_apart
    });
    places
}

/// For every sample the farthest vertex of its Voronoi cell on the inner side, without repetition.
fn inner_poles(field: &Field) -> Vec<DVec3> {
    let samples = samples::on_surface(field.solid, SAMPLES);
    let points: Vec<DVec3> = samples.iter().map(|sample| sample.point).collect();
    let vertices = voronoi::vertices(&points);
    let mut poles = vec![(0.0, usize::MAX); samples.len()];
    for (index, vertex) in vertices.iter().enumerate() {
        for sample in vertex.of {
            let toward = vertex.position - samples[sample].point;
            let squared = toward.length_squared();
            if toward.dot(samples[sample].normal) < 0.0 && squared > poles[sample].0 {
                poles[sample] = (squared, index);
            }
        }
    }
    let mut indices: Vec<usize> =
        poles.iter().map(|pole| pole.1).filter(|pole| *pole != usize::MAX).collect();
    indices.sort_unstable();
    indices.dedup();
    indices.into_iter().map(|index| vertices[index].position).collect()
}

/// Climbs on from `at`, whose clearance is its radius.
fn climb(mut at: Candidate, field: &Field, scratch: &mut Scratch) -> Option<Candidate> {
    for _ in 0..CLIMBS {
        if at.radius <= 0.0 || field.watch.is_over() {
            return None;
        }
        at = field.ascend(at.center, at.radius, at.radius, scratch);
        if !at.at_boundary {
            return Some(at);
        }
    }
    None
}

/// Brings a seed up to date with the balls placed since: it is still there, or climbs again from where it
/// stood, or is gone.
pub(super) fn update(seed: Candidate, field: &Field, scratch: &mut Scratch) -> Option<Candidate> {
    let clearance = field.balls.clearance(seed.center, seed.radius);
    if clearance >= seed.radius {
        return Some(seed);
    }
    climb(Candidate { radius: clearance, ..seed }, field, scratch)
}
