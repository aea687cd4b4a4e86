//! Places for the largest balls, found without descending the octree: Voronoi seeds.
//!
//! The Voronoi vertices of dense surface samples lie near the medial axis or near the surface; of those in the
//! Voronoi cell of one sample, the farthest on the inner side, its *pole*, lies near the medial axis
//! (N. Amenta and M. Bern, *Surface reconstruction by Voronoi filtering*, 1999). Each pole climbs to a local
//! maximum of the clearance, and these are the seeds. A sample whose pole lies outside, as in parts that are thinner
//! than samples are apart, has its tangent ball instead (see [`super::tangent_ball`]). Balls between placed balls are
//! not among the seeds: those are the octree's.
//!
//! Share of the volume at 100 / 1,000 / 10,000 balls with seeds, and the gain over the octree alone, in points:
//!
//! | bunny | femur | pelvis | pinion gear | spider gear |
//! |---|---|---|---|---|
//! | 71.0 / 81.7 / 88.6 | 64.0 / 76.5 / 85.4 | 43.5 / 65.8 / 78.4 | 50.3 / 71.0 / 81.8 | 50.3 / 69.4 / 80.8 |
//! | 0.0 / 0.0 / 0.0 | 0.0 / 0.0 / 0.0 | +0.2 / 0.0 / 0.0 | +0.1 / +0.1 / 0.0 | +0.5 / 0.0 / 0.0 |
//!
//! The gain is on plateaus (see [`super::plateau`]), where the seeds begin the rows of balls, and in thin parts: the
//! largest seed tells where the search begins, without which a thin plate takes minutes. Finding them takes 0.1 to
//! 0.3 s.

use super::ball_grid::{Ball, BallGrid};
use super::field::{Candidate, Field, Scratch};
use super::{samples, search, tangent_ball, voronoi};
use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashSet;

/// Surface samples. 10,000 took twice the time and filled the assets no better.
const SAMPLES: usize = 5_000;
/// A seed is placed before the octree is asked if its radius is at least this share of the largest that may be
/// left. With 0.9 seeds stood in the way of larger balls that no sample had led to: 0.6 points lost at 100 balls and
/// 0.4 at 1,000 on the pinion gear; with 0.99 the spider gear lost 1.4 and 0.3.
pub(super) const SHARE: f64 = 0.97;
/// A climb goes on from the boundary of its trust ball at most this often; one that is not there then is given up.
const CLIMBS: usize = 16;
/// Of seeds nearer to each other than this share of the larger radius, only the larger one is kept.
const APART: f64 = 0.1;
/// Of medial points nearer to each other than this share of the larger radius, only one is looked at. With 0.005 a ball of 160,000
/// triangles is packed sooner, but a bar in a groove came to rest 2.2° aslant instead of 2°.
const SAME: f64 = 1e-6;

/// Local maxima of the clearance of the empty solid, in descending order. Not all of them once the field's watch is over.
pub(super) fn find(field: &Field) -> Vec<Candidate> {
    let starts = thin_out(medial_points(field), SAME)
        .into_par_iter()
        .filter(|_| !field.watch.is_over())
        .filter_map(|start| {
            let radius = field.clearance(start.center, f64::INFINITY);
            (radius > 0.0).then_some(Candidate { radius, ..start })
        })
        .collect();
    let seeds = thin_out(starts, APART)
        .into_par_iter()
        .map_init(Scratch::default, |scratch, start| climb(start, field, scratch))
        .flatten_iter()
        .collect();
    thin_out(seeds, APART)
}

/// Sorts in descending order and drops what lies within `share` of its radius of a larger one.
fn thin_out(mut places: Vec<Candidate>, share: f64) -> Vec<Candidate> {
    // The sort is stable, so that equals keep their order.
    places.sort_by(|a, b| b.radius.total_cmp(&a.radius));
    let mut kept = BallGrid::default();
    places.retain(|place| {
        let ball = Ball { center: place.center, radius: share * place.radius };
        let is_apart = kept.clearance(ball.center, ball.radius) > 0.0;
        if is_apart {
            kept.insert(ball);
        }
        is_apart
    });
    places
}

/// For every sample a point near the medial axis: its inner pole or, if that lies outside the solid, the centre of its
/// tangent ball; each once. With the distances from their samples, which are hardly less than the clearance.
fn medial_points(field: &Field) -> Vec<Candidate> {
    let samples = samples::on_surface(field.solid, SAMPLES);
    let points: Vec<DVec3> = samples.iter().map(|sample| sample.point).collect();
    let vertices = voronoi::vertices(&points);
    let mut poles = vec![(0.0, None); samples.len()];
    for (index, vertex) in vertices.iter().enumerate() {
        for sample in vertex.of {
            let toward = vertex.position - samples[sample].point;
            let squared = toward.length_squared();
            if toward.dot(samples[sample].normal) < 0.0 && squared > poles[sample].0 {
                poles[sample] = (squared, Some(index));
            }
        }
    }
    let mut of_poles: Vec<(usize, f64)> =
        poles.iter().filter_map(|(squared, index)| Some(((*index)?, squared.sqrt()))).collect();
    of_poles.sort_unstable_by_key(|pole| pole.0);
    of_poles.dedup_by_key(|pole| pole.0);
    // Not by the nearest point of the surface: where that is nearly as far as all others, as in a ball, it takes a thousand times
    // as long as a ray.
    let is_inside =
        |index: usize| !field.watch.is_over() && field.solid.winds_around(vertices[index].position);
    of_poles = of_poles.into_par_iter().filter(|pole| is_inside(pole.0)).collect();
    let inside: FxHashSet<usize> = of_poles.iter().map(|pole| pole.0).collect();
    let place = |center: DVec3, radius: f64| Candidate { center, radius, at_boundary: true };
    let tangent: Vec<Candidate> = samples
        .par_iter()
        .zip(&poles)
        .filter(|(_, pole)| pole.1.is_none_or(|index| !inside.contains(&index)) && !field.watch.is_over())
        .filter_map(|(sample, _)| {
            let center = tangent_ball::center(field.solid, sample)?;
            Some(place(center, center.distance(sample.point)))
        })
        .collect();
    of_poles.iter().map(|(index, radius)| place(vertices[*index].position, *radius)).chain(tangent).collect()
}

/// Climbs on from `at`, whose clearance is its radius.
fn climb(mut at: Candidate, field: &Field, scratch: &mut Scratch) -> Option<Candidate> {
    for _ in 0..CLIMBS {
        if at.radius <= 0.0 || field.watch.is_over() {
            return None;
        }
        at = search::ascend(field, at.center, at.radius, at.radius, &mut scratch.obstacles);
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

#[cfg(test)]
mod tests {
    use super::super::stop_signal::{StopSignal, Watch};
    use super::*;
    use crate::{Solid, TriangleMesh};

    /// A ball of 101,760 triangles: all poles are about the middle.
    fn ball() -> TriangleMesh {
        let (rings, sides) = (160_u32, 320_u32);
        let turn = std::f64::consts::PI / f64::from(rings);
        let mut mesh = TriangleMesh { vertices: vec![DVec3::Z, DVec3::NEG_Z], triangles: Vec::new() };
        for ring in 1..rings {
            let (radius, height) = (turn * f64::from(ring)).sin_cos();
            let of = |side: u32| {
                DVec3::new(libm::cos(turn * f64::from(side)), libm::sin(turn * f64::from(side)), 0.0)
            };
            mesh.vertices.extend((0..sides).map(|side| radius * of(side) + DVec3::Z * height));
        }
        let at = |ring: u32, side: u32| 2 + (ring - 1) * sides + side % sides;
        for side in 0..sides {
            mesh.triangles.push([0, at(1, side), at(1, side + 1)]);
            mesh.triangles.push([1, at(rings - 1, side + 1), at(rings - 1, side)]);
            for ring in 1..rings - 1 {
                let [a, b] = [0, 1].map(|next| at(ring, side + next));
                let [c, d] = [0, 1].map(|next| at(ring + 1, side + next));
                mesh.triangles.extend([[a, c, d], [a, d, b]]);
            }
        }
        mesh
    }

    /// For 5,000 poles in the middle of a ball the nearest of all its triangles was looked for: 55 s for 81,920 triangles, whatever the
    /// time limit.
    #[test]
    fn issue_nothing_is_looked_for_once_time_is_over() {
        let solid = Solid::new(&ball()).unwrap();
        let signal = StopSignal::new();
        let watch = Watch::new(&signal, None);
        let balls = BallGrid::default();
        let field = Field { solid: &solid, balls: &balls, watch: &watch };
        assert!(medial_points(&field).len() > SAMPLES / 2);
        watch.end();
        assert!(medial_points(&field).is_empty(), "nothing is looked for once time is over");
    }
}
