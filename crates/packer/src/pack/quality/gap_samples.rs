//! Points spread evenly over the gaps: the part of the solid that no inner ball fills.
//!
//! Cubes are refined level by level; those wholly outside the solid or wholly in one ball are dropped, until
//! enough are left; of more, a random part is refined further. All have the same volume, so the same number of random
//! points in each, less those that are in no gap, is a uniform sample of the gaps, even in a rod that fills a
//! millionth of its bounding box.

use super::ball_tree::BallTree;
use crate::Solid;
use crate::pack::noise::Noise;
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// Cubes are refined until there are this many; the next level may have up to eight times as many.
const CUBES: usize = 4_000;
/// They are refined further, a random part of them, while fewer than one in this many random points of them lies in
/// a gap, as in a needle or among many small balls.
const LEAST_YIELD: usize = 16;
/// Points wanted in gaps: shares of the gaps then have a standard error of half a per cent of the gaps.
const WANTED: usize = 8_000;
/// Most points drawn from each cube.
const MOST_DRAWN: usize = 32;
/// Most halvings; cubes as small as this are a thousandth of the thinnest plate that is accepted.
const FINEST: u32 = 24;

/// A point in a gap.
#[derive(Clone, Copy, Debug)]
pub(super) struct GapSample {
    pub(super) point: DVec3,
    /// Distance to the surface or to the nearest inner ball (m).
    pub(super) clearance: f64,
}

/// Points of the gaps between `balls` in `solid`, always the same ones.
pub(super) fn draw(solid: &Solid, balls: &BallTree) -> Vec<GapSample> {
    let (lower, upper) = solid.bounds();
    let half = 0.5 * (upper - lower).max_element();
    let root = Cube { center: 0.5 * (lower + upper), half, surface: Surface::Within(f64::INFINITY) };
    let gaps = Gaps { solid, balls };
    let (mut cubes, mut first) = (vec![root], Vec::new());
    for level in 0..FINEST {
        cubes = gaps.refine(&thin_out(cubes, level));
        if cubes.len() < CUBES {
            continue;
        }
        first = gaps.draw(&cubes, 0..1);
        if first.len() * LEAST_YIELD >= cubes.len() {
            break;
        }
    }
    let more = (WANTED.div_ceil(first.len().max(1)) - 1).min(MOST_DRAWN - 1);
    let rest = gaps.draw(&cubes, 1..1 + more);
    first.into_iter().chain(rest).collect()
}

/// Random cubes, if there are more than the wanted number: one of each run of neighbours, so that all parts keep
/// their share.
fn thin_out(cubes: Vec<Cube>, level: u32) -> Vec<Cube> {
    if cubes.len() <= CUBES {
        return cubes;
    }
    let mut noise = Noise::new(!u64::from(level));
    let width = cubes.len() as f64 / CUBES as f64;
    (0..CUBES)
        .map(|run| cubes[(((run as f64 + noise.uniform()) * width) as usize).min(cubes.len() - 1)])
        .collect()
}

/// Where the surface is, seen from a cube.
#[derive(Clone, Copy, Debug)]
enum Surface {
    /// Nowhere in the cube, which is in the solid; no nearer than this to its centre.
    Beyond(f64),
    /// No farther than this from the centre, perhaps through the cube.
    Within(f64),
}

#[derive(Clone, Copy, Debug)]
struct Cube {
    center: DVec3,
    half: f64,
    surface: Surface,
}

impl Cube {
    fn half_diagonal(&self) -> f64 {
        self.half * 3.0_f64.sqrt()
    }

    fn children(&self) -> impl Iterator<Item = Self> + use<> {
        let Self { center, half, surface } = *self;
        let half = 0.5 * half;
        let offset = half * 3.0_f64.sqrt();
        let surface = match surface {
            Surface::Beyond(distance) => Surface::Beyond(distance - offset),
            Surface::Within(distance) => Surface::Within(distance + offset),
        };
        (0..8_u32).map(move |i| {
            let side = |bit: u32| if i >> bit & 1 == 1 { half } else { -half };
            Self { center: center + DVec3::new(side(0), side(1), side(2)), half, surface }
        })
    }
}

#[derive(Clone, Copy)]
struct Gaps<'a> {
    solid: &'a Solid,
    balls: &'a BallTree,
}

impl Gaps<'_> {
    fn refine(self, cubes: &[Cube]) -> Vec<Cube> {
        cubes
            .par_iter()
            .with_min_len(16)
            .flat_map_iter(|cube| cube.children().filter_map(move |child| self.keep(child)))
            .collect()
    }

    /// The cube, unless it is wholly in one ball or wholly outside.
    fn keep(self, mut cube: Cube) -> Option<Cube> {
        let reach = cube.half_diagonal();
        // Farther balls say nothing.
        if self.balls.distance(cube.center, reach) < -reach {
            return None;
        }
        if let Surface::Within(bound) = cube.surface {
            let depth = self.depth(cube.center, bound)?;
            if depth < -reach {
                return None;
            }
            cube.surface = if depth > reach { Surface::Beyond(depth) } else { Surface::Within(depth.abs()) };
        }
        Some(cube)
    }

    /// Those of the random points of these numbers in each cube that are in gaps.
    fn draw(self, cubes: &[Cube], numbers: Range<usize>) -> Vec<GapSample> {
        cubes
            .par_iter()
            .with_min_len(64)
            .enumerate()
            .flat_map_iter(|(index, cube)| {
                numbers.clone().filter_map(move |number| {
                    let jitter = Noise::new((index * MOST_DRAWN + number) as u64).point();
                    self.sample(cube, cube.center + (2.0 * jitter - 1.0) * cube.half)
                })
            })
            .collect()
    }

    /// The point, if it is in a gap.
    fn sample(&self, cube: &Cube, point: DVec3) -> Option<GapSample> {
        let to_balls = self.balls.distance(point, f64::INFINITY);
        if to_balls <= 0.0 {
            return None;
        }
        let offset = cube.half_diagonal();
        let clearance = match cube.surface {
            Surface::Beyond(distance) if to_balls <= distance - offset => to_balls,
            Surface::Beyond(_) => {
                self.solid.closest_point_within(point, to_balls).map_or(to_balls, |s| s.depth.abs())
            }
            Surface::Within(distance) => self.depth(point, distance + offset)?.min(to_balls),
        };
        (clearance > 0.0).then_some(GapSample { point, clearance })
    }

    /// Depth of a point that has the surface within `bound`.
    fn depth(&self, point: DVec3, bound: f64) -> Option<f64> {
        // Rounding must not put the surface beyond its bound.
        self.solid.closest_point_within(point, bound * (1.0 + 1e-6)).map(|surface| surface.depth)
    }
}
