//! Times of queries: all sizes and ways in turn, round by round.
//!
//! The machine's state then changes for all of them alike. Small solids take part in every round, large ones in as many as their
//! time allows: whether two processors of a virtual machine are two cores or one changes within seconds, and the least of
//! few short measurements may never have met two. A query follows one at another pose, as the same query a second
//! time would find a processor that has learnt the branches of 1,000 spheres by heart, and cannot learn those of
//! 1,000,000. The least time of all rounds counts at each pose, as other programs only ever slow a query down, and the
//! mean over the poses.

use crate::solids::{Case, Row};
use crate::turn::Turn;
use glam::Vec3;
use glamx::{Pose3, Rot3};
use ist::{Engine, Overlap, OverlapQuery, OverlapWorkspace};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

/// Spread over the run, as a machine that others use too is slow for seconds.
///
/// With 8 rounds for every solid two threads were less than 1.7 times as fast as one in 23 of 39 rows; with these, of the same
/// code on the same day, in 8.
const ROUNDS: usize = 64;
/// Solids that need more time in a round (s) take part in every second, third, or at the least in every [`RAREST`]th, so
/// that the run takes minutes and not an hour.
const LONG_ROUND: f64 = 0.2;
const RAREST: usize = 4;
/// Axes about which a solid is turned.
const POSES: usize = 8;
/// Least time of the queries of a round (s): short ones are repeated.
const ROUND: f64 = 10e-3;

/// Threads to run on.
pub(crate) struct Pools {
    one: ThreadPool,
    two: ThreadPool,
}

/// What one solid in itself took.
pub(crate) struct Measurement {
    /// Spheres of one of the two solids.
    pub(crate) spheres: usize,
    /// Overlapping pairs, a mean over the poses.
    pub(crate) pairs: f64,
    /// Times (s).
    pub(crate) grid_one_thread: f64,
    pub(crate) grid_two_threads: f64,
    pub(crate) tree: f64,
    /// Two queries of the tree at the same time, one on each thread, which have nothing to do with each other.
    pub(crate) two_trees: f64,
}

/// A way to ask.
#[derive(Clone, Copy)]
enum Way {
    Grid,
    Tree,
    /// Two queries at once: what two threads come to on this machine, however work is shared.
    TwoTrees,
}

impl Pools {
    pub(crate) fn new() -> Result<Self, Box<dyn Error>> {
        let pool = |threads| ThreadPoolBuilder::new().num_threads(threads).build();
        Ok(Self { one: pool(1)?, two: pool(2)? })
    }

    fn ways(&self) -> [(Way, &ThreadPool); 4] {
        [(Way::Grid, &self.one), (Way::Grid, &self.two), (Way::Tree, &self.one), (Way::TwoTrees, &self.two)]
    }
}

/// One for each of two queries at once.
type Workspaces = [OverlapWorkspace; 2];

impl Way {
    fn ask(self, (case, pose): (&Case, &Pose3), [first, second]: &mut Workspaces) -> Overlap {
        match self {
            Self::Grid => overlap(case, pose, Engine::Grid, first),
            Self::Tree => overlap(case, pose, Engine::Tree, first),
            Self::TwoTrees => {
                rayon::join(
                    || overlap(case, pose, Engine::Tree, first),
                    || black_box(overlap(case, pose, Engine::Tree, second)),
                )
                .0
            }
        }
    }
}

/// All solids of `row` against themselves, turned by `turn`.
pub(crate) fn measure(row: &Row, turn: Turn, pools: &Pools) -> Result<Vec<Measurement>, Box<dyn Error>> {
    let mut workspaces = Default::default();
    let mut runs = Vec::new();
    for case in &row.cases {
        runs.push(Run::new(case, turn, pools, &mut workspaces)?);
    }
    for round in 0..ROUNDS {
        for run in runs.iter_mut().filter(|run| round.is_multiple_of(run.every)) {
            for (way, times) in pools.ways().into_iter().zip(&mut run.times) {
                times.take((run.case, &run.poses), way, &mut workspaces);
            }
        }
    }
    Ok(runs.iter().map(Run::measurement).collect())
}

/// One solid on its way through the rounds.
struct Run<'a> {
    case: &'a Case,
    poses: [Pose3; POSES],
    /// Mean over the poses.
    pairs: f64,
    times: [Times; 4],
    /// It takes part in one of so many rounds.
    every: usize,
}

impl<'a> Run<'a> {
    /// Looks whether all ways agree, and takes the first times.
    fn new(
        case: &'a Case,
        turn: Turn,
        pools: &Pools,
        workspaces: &mut Workspaces,
    ) -> Result<Self, Box<dyn Error>> {
        let poses = poses(case, turn.angle(case));
        let (mut pairs, mut times) = (0.0, [Times::default(); 4]);
        for pose in &poses {
            let mut ask =
                |(way, pool): (Way, &ThreadPool)| pool.install(|| way.ask((case, pose), workspaces));
            let results = pools.ways().map(&mut ask);
            check(&results)?;
            pairs += f64::from(results[0].pairs) / POSES as f64;
        }
        for (way, times) in pools.ways().into_iter().zip(&mut times) {
            times.take((case, &poses), way, workspaces);
            times.repeats = (ROUND / (times.mean() * POSES as f64)).ceil() as usize;
        }
        let round: f64 = times.iter().map(|times| times.mean() * (POSES * times.repeats) as f64).sum();
        let every = ((round / LONG_ROUND).ceil() as usize).clamp(1, RAREST);
        Ok(Self { case, poses, pairs, times, every })
    }

    fn measurement(&self) -> Measurement {
        let [grid_one_thread, grid_two_threads, tree, two_trees] = self.times.map(|times| times.mean());
        let (spheres, pairs) = (self.case.tree.len(), self.pairs);
        Measurement { spheres, pairs, grid_one_thread, grid_two_threads, tree, two_trees }
    }
}

/// Of one solid in one way.
#[derive(Clone, Copy)]
struct Times {
    /// Least time at each pose (s).
    least: [f64; POSES],
    /// How often a round goes over the poses.
    repeats: usize,
}

impl Default for Times {
    fn default() -> Self {
        Self { least: [f64::INFINITY; POSES], repeats: 1 }
    }
}

impl Times {
    /// One round.
    fn take(
        &mut self,
        (case, poses): (&Case, &[Pose3; POSES]),
        (way, pool): (Way, &ThreadPool),
        workspaces: &mut Workspaces,
    ) {
        // Inside the pool, so that no query waits for the pool's threads to take it over.
        pool.install(|| {
            for _ in 0..self.repeats {
                for (pose, least) in poses.iter().zip(&mut self.least) {
                    let start = Instant::now();
                    black_box(way.ask((case, pose), workspaces));
                    *least = least.min(start.elapsed().as_secs_f64());
                }
            }
        });
    }

    fn mean(&self) -> f64 {
        self.least.iter().sum::<f64>() / POSES as f64
    }
}

/// The solid turned by `angle` (rad) about axes through its centroid, which are spread over a sphere.
pub(crate) fn poses(case: &Case, angle: f32) -> [Pose3; POSES] {
    /// Fibonacci's spiral: equal steps along z, and golden angles around it.
    const GOLDEN_ANGLE: f32 = 2.399_963;
    let centroid = case.tree.solid().centroid.as_vec3();
    std::array::from_fn(|i| {
        let z = 1.0 - (2.0 * i as f32 + 1.0) / POSES as f32;
        let (sin, cos) = (GOLDEN_ANGLE * i as f32).sin_cos();
        let axis = Vec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + Vec3::Z * z;
        let rotation = Rot3::from_axis_angle(axis, angle);
        Pose3::from_parts(centroid - rotation * centroid, rotation)
    })
}

/// The solid at `pose` in itself.
pub(crate) fn overlap(
    case: &Case,
    pose: &Pose3,
    engine: Engine,
    workspace: &mut OverlapWorkspace,
) -> Overlap {
    let query = OverlapQuery { engine, ..OverlapQuery::default() };
    case.tree.overlap_with(&case.tree, black_box(pose), query, workspace)
}

/// A time is worth nothing if the result is wrong.
fn check([one, two, tree, at_once]: &[Overlap; 4]) -> Result<(), String> {
    if one != two {
        return Err(format!("the result depends on the threads: {one:?} and {two:?}"));
    }
    if tree != at_once {
        return Err(format!("queries disturb each other: {tree:?} and {at_once:?}"));
    }
    if one.pairs != tree.pairs || (one.volume - tree.volume).abs() > 1e-5 * tree.volume {
        return Err(format!("grids and tree do not agree: {one:?} and {tree:?}"));
    }
    Ok(())
}
