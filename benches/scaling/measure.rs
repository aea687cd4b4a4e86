//! Times of queries: all sizes and ways in turn, round by round.
//!
//! The machine's state then changes for all of them alike. The least time of all rounds counts, as other programs only ever
//! slow a query down.

use crate::solids::{Case, Row};
use glamx::{Pose3, Rot3};
use ist::{Engine, Overlap, OverlapQuery, OverlapWorkspace};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

const ROUNDS: usize = 12;
/// Least time of one sample (s): short queries are repeated.
const SAMPLE: f64 = 4e-3;

/// Threads to run on.
pub(crate) struct Pools {
    pub(crate) one: ThreadPool,
    two: ThreadPool,
}

/// What one solid in itself took.
pub(crate) struct Measurement {
    /// Spheres of one of the two solids.
    pub(crate) spheres: usize,
    pub(crate) pairs: u32,
    /// Least times (s).
    pub(crate) grid_one_thread: f64,
    pub(crate) grid_two_threads: f64,
    pub(crate) tree: f64,
}

impl Pools {
    pub(crate) fn new() -> Result<Self, Box<dyn Error>> {
        let pool = |threads| ThreadPoolBuilder::new().num_threads(threads).build();
        Ok(Self { one: pool(1)?, two: pool(2)? })
    }

    fn ways(&self) -> [(Engine, &ThreadPool); 3] {
        [(Engine::Grid, &self.one), (Engine::Grid, &self.two), (Engine::Tree, &self.one)]
    }
}

/// All solids of `row` against themselves, turned by `angle` (rad).
pub(crate) fn measure(row: &Row, angle: f32, pools: &Pools) -> Result<Vec<Measurement>, Box<dyn Error>> {
    let mut workspace = OverlapWorkspace::default();
    let mut runs = Vec::new();
    for case in &row.cases {
        let mut results = [Overlap::default(); 3];
        let mut repeats = [1; 3];
        for (i, way) in pools.ways().into_iter().enumerate() {
            results[i] = overlap(case, angle, way.0, &mut workspace);
            repeats[i] = (SAMPLE / sample((case, angle), way, 2, &mut workspace)).ceil().max(1.0) as usize;
        }
        check(&results)?;
        runs.push((case, results[0].pairs, repeats));
    }
    let mut least = vec![[f64::INFINITY; 3]; runs.len()];
    for _ in 0..ROUNDS {
        for ((case, _, repeats), least) in runs.iter().zip(&mut least) {
            for (i, way) in pools.ways().into_iter().enumerate() {
                least[i] = least[i].min(sample((case, angle), way, repeats[i], &mut workspace));
            }
        }
    }
    let measurements = runs.iter().zip(least).map(|((case, pairs, _), least)| {
        let [grid_one_thread, grid_two_threads, tree] = least;
        Measurement { spheres: case.tree.len(), pairs: *pairs, grid_one_thread, grid_two_threads, tree }
    });
    Ok(measurements.collect())
}

/// The solid in itself, turned about its centroid, not about an axis of the mesh.
pub(crate) fn overlap(case: &Case, angle: f32, engine: Engine, workspace: &mut OverlapWorkspace) -> Overlap {
    let tree = &case.tree;
    let axis = glam::Vec3::new(1.0, 2.0, 3.0).normalize();
    let rotation = Rot3::from_axis_angle(axis, angle);
    let centroid = tree.solid().centroid.as_vec3();
    let pose = Pose3::from_parts(centroid - rotation * centroid, rotation);
    let query = OverlapQuery { engine, ..OverlapQuery::default() };
    tree.overlap_with(tree, black_box(&pose), query, workspace)
}

/// Mean time (s) of a query that is repeated on the pool's threads.
fn sample(
    (case, angle): (&Case, f32),
    (engine, pool): (Engine, &ThreadPool),
    repeats: usize,
    workspace: &mut OverlapWorkspace,
) -> f64 {
    pool.install(|| {
        let start = Instant::now();
        for _ in 0..repeats {
            black_box(overlap(case, angle, engine, workspace));
        }
        start.elapsed().as_secs_f64() / repeats as f64
    })
}

/// A time is worth nothing if the result is wrong.
fn check([one, two, tree]: &[Overlap; 3]) -> Result<(), String> {
    if one != two {
        return Err(format!("the result depends on the threads: {one:?} and {two:?}"));
    }
    if one.pairs != tree.pairs || (one.volume - tree.volume).abs() > 1e-5 * tree.volume {
        return Err(format!("grids and tree do not agree: {one:?} and {tree:?}"));
    }
    Ok(())
}
