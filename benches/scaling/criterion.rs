//! Criterion's report of the queries that most users have, on one thread.

use crate::TURNS;
use crate::measure::{overlap, poses};
use crate::solids::Row;
use criterion::{BenchmarkId, Criterion, Throughput};
use ist::{Engine, OverlapWorkspace};
use rayon::ThreadPoolBuilder;
use std::error::Error;
use std::time::Duration;

/// Spheres of the solids that are reported.
const COUNTS: [usize; 3] = [1_000, 10_000, 100_000];

pub(crate) fn run(row: &Row) -> Result<(), Box<dyn Error>> {
    let pool = ThreadPoolBuilder::new().num_threads(1).build()?;
    let mut criterion = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2))
        .configure_from_args();
    let mut group = criterion.benchmark_group(format!("{} in itself, one thread", row.name));
    let mut workspace = OverlapWorkspace::default();
    for case in row.cases.iter().filter(|case| COUNTS.contains(&case.tree.len())) {
        let spheres = case.tree.len();
        let poses = poses(case, TURNS[2].angle(case));
        group.throughput(Throughput::Elements(2 * spheres as u64));
        for engine in [Engine::Grid, Engine::Tree] {
            let id = BenchmarkId::new(format!("{engine:?}"), spheres);
            group.bench_function(id, |bencher| {
                let mut turn = poses.iter().cycle();
                pool.install(|| {
                    bencher.iter(|| turn.next().map(|pose| overlap(case, pose, engine, &mut workspace)))
                });
            });
        }
    }
    group.finish();
    criterion.final_summary();
    Ok(())
}
