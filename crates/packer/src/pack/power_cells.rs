//! Volumes and centroids of the power cells, clipped by the mesh.
//!
//! The power cell of ball `i` is where `|p − cᵢ|² − rᵢ²` is least (F. Aurenhammer, *Power diagrams*, 1987).
//! It contains the ball, as the balls are disjoint, so only the gaps between them have to be shared out:
//! `vᵢ = 4/3·π·rᵢ³ + V_gap·(gap samples in cell i)/(all gap samples)`. The ball's part and the total are
//! exact, and the sampling error is that of the gaps alone. Likewise for the first moments, from which the
//! centroids come.
//!
//! Samples stand on a jittered lattice. It is refined as an octree, and each box keeps only the balls
//! whose cell may reach into it: the difference of two power distances is linear in `p`, so it varies by no
//! more than `2·|cᵢ − cⱼ|·h` within `h` of the centre. Boxes inside one ball or outside the mesh end early.

use super::ball_grid::Ball;
use super::noise::Noise;
use super::stop_signal::Watch;
use crate::Solid;
use glam::DVec3;
use rayon::prelude::*;

/// Doublings after which the boxes are shared out as tasks.
const TASK_LEVEL: u32 = 3;
/// Most doublings of the lattice.
const FINEST: u32 = 12;

/// The power cell of a ball, clipped by the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PowerCell {
    /// Volume (m³), at least that of the ball.
    pub(super) volume: f64,
    /// Centroid (m).
    pub(super) centroid: DVec3,
}

/// The cells of `balls`, whose volumes sum to that of `solid`, from about `samples` gap samples. Once `watch` is
/// cancelled they are worth nothing.
pub(super) fn measure(solid: &Solid, balls: &[Ball], samples: usize, watch: &Watch) -> Vec<PowerCell> {
    let filled = balls.iter().map(Ball::volume).sum::<f64>();
    let total = solid.properties().volume;
    let gap = (total - filled).max(0.0);
    let gaps = sample_gaps(&Sampler { solid, balls, watch }, gap / samples.max(1) as f64);
    let sum: u64 = gaps.iter().map(|gap| gap.count).sum();
    if sum == 0 {
        // No sample met a gap: share by size.
        let scale = total / filled;
        let cell = |ball: &Ball| PowerCell { volume: ball.volume() * scale, centroid: ball.center };
        return balls.iter().map(cell).collect();
    }
    let per_sample = gap / sum as f64;
    balls
        .iter()
        .zip(&gaps)
        .map(|(ball, gap)| {
            let volume = ball.volume() + per_sample * gap.count as f64;
            PowerCell { volume, centroid: ball.center + gap.offset * (per_sample / volume) }
        })
        .collect()
}

/// Samples in the gap around one ball.
#[derive(Clone, Copy, Debug, Default)]
struct Gap {
    count: u64,
    /// Sum of their positions relative to the ball's centre (m).
    offset: DVec3,
}

impl Gap {
    fn add(&mut self, other: &Self) {
        self.count += other.count;
        self.offset += other.offset;
    }
}

fn sample_gaps(sampler: &Sampler, volume_per_sample: f64) -> Vec<Gap> {
    let Sampler { solid, balls, .. } = sampler;
    let (lower, upper) = solid.bounds();
    let side = (upper - lower).max_element() * (1.0 + 1e-9);
    // The finest lattice bounds the work where balls leave next to no gap.
    let spacing = libm::cbrt(volume_per_sample).max(side / f64::from(1_u32 << FINEST));
    // A lattice of 2^depth samples a side.
    let depth =
        (TASK_LEVEL..FINEST).find(|depth| side / f64::from(1_u32 << depth) <= spacing).unwrap_or(FINEST);
    // Stretch the cube so that the spacing is met and not just undercut.
    let side = spacing * f64::from(1_u32 << depth);
    let root = Box { center: 0.5 * (lower + upper), half: 0.5 * side, depth, key: 0 };
    let all: Vec<u32> = (0..balls.len() as u32).collect();
    let mut tasks = vec![(root, all)];
    for _ in 0..TASK_LEVEL {
        tasks = tasks
            .par_iter()
            .flat_map_iter(|(parent, list)| {
                parent.children().map(|child| {
                    let kept = sampler.filter(&child, list);
                    (child, kept)
                })
            })
            .collect();
    }
    let found: Vec<Vec<(u32, Gap)>> = tasks
        .into_par_iter()
        .with_max_len(1)
        .map(|(task, list)| {
            let mut hits = Vec::new();
            sampler.descend(&task, &list, Place::Near(f64::INFINITY), &mut hits);
            // The sort is stable, so that the sums have one order.
            hits.sort_by_key(|hit| hit.0);
            let mut runs: Vec<(u32, Gap)> = Vec::new();
            for (ball, p) in hits {
                let gap = Gap { count: 1, offset: p - balls[ball as usize].center };
                match runs.last_mut() {
                    Some(run) if run.0 == ball => run.1.add(&gap),
                    _ => runs.push((ball, gap)),
                }
            }
            runs
        })
        .collect();
    let mut gaps = vec![Gap::default(); balls.len()];
    for (ball, gap) in found.iter().flatten() {
        gaps[*ball as usize].add(gap);
    }
    gaps
}

/// A cube of `2^depth` samples a side.
struct Box {
    center: DVec3,
    half: f64,
    depth: u32,
    /// Path from the root, three bits a level: the number of the sample, from which its jitter comes.
    key: u64,
}

impl Box {
    fn children(&self) -> impl Iterator<Item = Self> + '_ {
        (0..8_u32).map(|i| {
            let half = 0.5 * self.half;
            let side = |bit: u32| if i >> bit & 1 == 1 { half } else { -half };
            Self {
                center: self.center + DVec3::new(side(0), side(1), side(2)),
                half,
                depth: self.depth - 1,
                key: self.key << 3 | u64::from(i),
            }
        })
    }

    fn half_diagonal(&self) -> f64 {
        self.half * 3.0_f64.sqrt()
    }

    /// The sample of a box of one: a random point of it.
    fn sample(&self) -> DVec3 {
        let jitter = Noise::new(self.key).point();
        self.center + (2.0 * jitter - 1.0) * self.half
    }
}

/// Where a box lies.
#[derive(Clone, Copy, Debug)]
enum Place {
    /// Wholly in the solid.
    Inside,
    /// Anywhere; but each of its points has the surface within this distance.
    Near(f64),
}

struct Sampler<'a> {
    solid: &'a Solid,
    balls: &'a [Ball],
    watch: &'a Watch<'a>,
}

impl Sampler<'_> {
    fn power(&self, ball: u32, p: DVec3) -> f64 {
        let ball = &self.balls[ball as usize];
        ball.center.distance_squared(p) - ball.radius * ball.radius
    }

    /// The ball of least power distance; the first of equals.
    fn nearest(&self, p: DVec3, list: &[u32]) -> (u32, f64) {
        list.iter().fold((u32::MAX, f64::INFINITY), |best, ball| {
            let power = self.power(*ball, p);
            if power < best.1 { (*ball, power) } else { best }
        })
    }

    /// The balls of `list` whose cell may reach into `within`.
    fn filter(&self, within: &Box, list: &[u32]) -> Vec<u32> {
        let (nearest, least) = self.nearest(within.center, list);
        let slope = 2.0 * within.half_diagonal() * (1.0 + 1e-9);
        let hub = self.balls[nearest as usize].center;
        let reaches = |ball: &&u32| {
            let distance = hub.distance(self.balls[**ball as usize].center);
            self.power(**ball, within.center) <= least + slope * distance
        };
        list.iter().filter(reaches).copied().collect()
    }

    /// Whether the surface, no farther than `bound` from `p`, encloses it.
    fn contains(&self, p: DVec3, bound: f64) -> bool {
        // Rounding must not put the surface beyond its bound.
        self.solid.closest_point_within(p, bound * (1.0 + 1e-6)).is_some_and(|nearest| nearest.depth >= 0.0)
    }

    /// Adds every gap sample in `within` to `hits`, with its ball; `place` tells what is known of the box.
    fn descend(&self, within: &Box, list: &[u32], mut place: Place, hits: &mut Vec<(u32, DVec3)>) {
        let reach = within.half_diagonal();
        if within.depth > 1 && self.watch.is_cancelled() {
            return;
        }
        if within.depth == 0 {
            let p = within.sample();
            let (ball, power) = self.nearest(p, list);
            let is_inside = || match place {
                Place::Inside => true,
                Place::Near(bound) => self.contains(p, bound),
            };
            if power > 0.0 && is_inside() {
                hits.push((ball, p));
            }
            return;
        }
        // Wholly inside one ball: no gap.
        let (nearest, _) = self.nearest(within.center, list);
        if self.balls[nearest as usize].distance(within.center) < -reach {
            return;
        }
        if let Place::Near(bound) = place {
            // Nothing within reach means that the box is wholly inside or wholly outside.
            place = match self.solid.closest_point_within(within.center, reach) {
                Some(nearest) => Place::Near(nearest.depth.abs() + reach),
                None if self.contains(within.center, bound) => Place::Inside,
                None => return,
            };
        }
        for child in within.children() {
            let kept;
            let list = if child.depth > 0 && list.len() > 4 {
                kept = self.filter(&child, list);
                &kept
            } else {
                list
            };
            self.descend(&child, list, place, hits);
        }
    }
}
