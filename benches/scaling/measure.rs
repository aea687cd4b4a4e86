//! Times of queries: all sizes and ways in turn, round by round.
//!
//! The machine's state then changes for all of them alike. A query follows those at all other poses, and small solids have
//! more of them: a processor learns the branches of a few thousand spheres by heart, and cannot learn those of 1,000,000. The
//! least time of all rounds counts at each pose, as other programs only ever slow a query down, and the
//! mean over the poses.
//!
//! Whether two processors of a virtual machine are two cores or share one changes within seconds to minutes. How much two
//! threads gain can only be seen while they are two: a solid is measured until two queries that have nothing to do with each
//! other have, in each of some sittings, gained that much from running at once.

use crate::solids::{Case, Row};
use crate::turn::Turn;
use glam::Vec3;
use glamx::{Pose3, Rot3};
use ist::{Engine, Overlap, OverlapQuery, OverlapWorkspace};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::error::Error;
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Least rounds of a sitting, which ends when two independent queries have gained as much as two cores let them.
const ROUNDS: usize = 8;
/// Sittings of every solid: with one of 16 rounds, 4 of 39 rows had met two cores for the independent queries and hardly for the
/// grids.
const SITTINGS: usize = 3;
/// How many times as fast as one after the other two independent queries are at once where two processors are two cores: 1.85
/// to 2.09 for all sizes in minutes in which the machine had two, 1.4 to 1.8 in others.
const TWO_CORES: f64 = 1.85;
/// After so long (s) a row ends with what it has, as on a machine with one core.
const PATIENCE: Duration = Duration::from_secs(300);
/// Least number of axes about which a solid is turned.
const POSES: usize = 8;
/// Least number of spheres in a query times the poses: an Intel processor needs 83 µs for a rabbit of 1,000 spheres that is
/// asked about one pose again and again, 97 about 8 in turn, and 101 to 105 about 32 to 256; 42, 51 and 53 to 56 with trees.
const SPHERES: usize = 64_000;
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

impl Measurement {
    /// How many times as fast as one after the other two independent queries are at once.
    pub(crate) fn gain_at_once(&self) -> f64 {
        2.0 * self.tree / self.two_trees
    }
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
    let start = Instant::now();
    while start.elapsed() < PATIENCE && runs.iter().any(|run| !run.is_over()) {
        for run in runs.iter_mut().filter(|run| !run.is_over()) {
            run.take_round(pools, &mut workspaces);
        }
    }
    Ok(runs.iter().map(Run::measurement).collect())
}

/// One solid on its way through the rounds.
struct Run<'a> {
    case: &'a Case,
    poses: Vec<Pose3>,
    /// Mean over the poses.
    pairs: f64,
    /// Of all rounds, and of those of the sitting.
    times: [Times; 4],
    sitting: [Times; 4],
    rounds: usize,
    sittings: usize,
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
        let mut pairs = 0.0;
        for pose in &poses {
            let mut ask =
                |(way, pool): (Way, &ThreadPool)| pool.install(|| way.ask((case, pose), workspaces));
            let results = pools.ways().map(&mut ask);
            check(&results)?;
            pairs += f64::from(results[0].pairs) / poses.len() as f64;
        }
        let mut times = [(); 4].map(|()| Times::new(poses.len()));
        for (way, times) in pools.ways().into_iter().zip(&mut times) {
            times.take((case, &poses), way, workspaces);
            times.repeats = (ROUND / (times.mean() * poses.len() as f64)).ceil() as usize;
        }
        let sitting = times.each_ref().map(Times::emptied);
        Ok(Self { case, poses, pairs, times, sitting, rounds: 0, sittings: 0 })
    }

    fn is_over(&self) -> bool {
        self.sittings >= SITTINGS
    }

    fn take_round(&mut self, pools: &Pools, workspaces: &mut Workspaces) {
        for (way, times) in pools.ways().into_iter().zip(&mut self.sitting) {
            times.take((self.case, &self.poses), way, workspaces);
        }
        self.times.iter_mut().zip(&self.sitting).for_each(|(all, times)| all.merge(times));
        self.rounds += 1;
        if self.rounds >= ROUNDS && self.with(&self.sitting).gain_at_once() >= TWO_CORES {
            (self.rounds, self.sittings) = (0, self.sittings + 1);
            self.sitting = self.times.each_ref().map(Times::emptied);
        }
    }

    fn measurement(&self) -> Measurement {
        self.with(&self.times)
    }

    fn with(&self, times: &[Times; 4]) -> Measurement {
        let [grid_one_thread, grid_two_threads, tree, two_trees] = times.each_ref().map(Times::mean);
        let (spheres, pairs) = (self.case.tree.len(), self.pairs);
        Measurement { spheres, pairs, grid_one_thread, grid_two_threads, tree, two_trees }
    }
}

/// Of one solid in one way.
struct Times {
    /// Least time at each pose (s).
    least: Vec<f64>,
    /// How often a round goes over the poses.
    repeats: usize,
}

impl Times {
    /// None yet, of so many poses.
    fn new(poses: usize) -> Self {
        Self { least: vec![f64::INFINITY; poses], repeats: 1 }
    }

    /// One round.
    fn take(
        &mut self,
        (case, poses): (&Case, &[Pose3]),
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

    /// None yet, for rounds as long.
    fn emptied(&self) -> Self {
        Self { repeats: self.repeats, ..Self::new(self.least.len()) }
    }

    fn merge(&mut self, other: &Self) {
        self.least.iter_mut().zip(&other.least).for_each(|(least, time)| *least = least.min(*time));
    }

    fn mean(&self) -> f64 {
        self.least.iter().sum::<f64>() / self.least.len() as f64
    }
}

/// The solid turned by `angle` (rad) about axes through its centroid, which are spread over a sphere.
pub(crate) fn poses(case: &Case, angle: f32) -> Vec<Pose3> {
    /// Fibonacci's spiral: equal steps along z, and golden angles around it.
    const GOLDEN_ANGLE: f32 = 2.399_963;
    let centroid = case.tree.solid().centroid.as_vec3();
    let count = POSES.max(SPHERES / case.tree.len());
    let pose = |i| {
        let z = 1.0 - (2.0 * i as f32 + 1.0) / count as f32;
        let (sin, cos) = (GOLDEN_ANGLE * i as f32).sin_cos();
        let axis = Vec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + Vec3::Z * z;
        let rotation = Rot3::from_axis_angle(axis, angle);
        Pose3::from_parts(centroid - rotation * centroid, rotation)
    };
    (0..count).map(pose).collect()
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
