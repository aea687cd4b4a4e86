//! Overlap queries beside brute force and beside Rapier's own shapes, on the same poses in one run:
//! `cargo bench -p rapier-ist-benches --bench overlap`. With `-- tables` the tables alone.
//!
//! Criterion's groups time sweeps over some poses of a band, again and again: a processor gets to know them, so these times
//! are the shortest. The tables after them time single queries at all poses,
//! see [`stopwatch`], and put the errors against exact mesh booleans beside the times.

mod boolean;
mod engine;
mod pair;
mod peers;
mod spheres;
mod stopwatch;
mod table;

use boolean::MeshBoolean;
use criterion::{Criterion, SamplingMode, Throughput};
use engine::Engine;
use pair::{BANDS, MeshPair, NAMES};
use peers::Peer;
use rapier3d::prelude::TriMeshFlags;
use spheres::{BruteForce, Spheres};
use std::error::Error;
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Most poses of a band in a sweep of Criterion, and the longest sweep that it is given (s): ten of them must not take
/// minutes. Hollow meshes of many triangles are in the tables only.
const SWEEP: usize = 12;
const LONGEST_SWEEP: f64 = 0.1;
/// Meshes of fewer triangles are also compared with each of their triangles in nine: what one buys or scans has tens
/// of thousands, and a tree does not know how many there were.
const FEW_TRIANGLES: usize = 10_000;

fn main() -> Result<(), Box<dyn Error>> {
    // `cargo test --benches` runs this too, without the flag.
    let is_measuring = std::env::args().any(|argument| argument == "--bench");
    if !is_measuring {
        return Ok(());
    }
    // Queries run on one thread, whatever features other packages turn on.
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    let mut criterion = Criterion::default()
        .warm_up_time(Duration::from_millis(50))
        .measurement_time(Duration::from_millis(200))
        .sample_size(10)
        .without_plots()
        .configure_from_args();
    let mut tables = Vec::new();
    for name in NAMES {
        let pair = MeshPair::load(name)?;
        let mut engines = engines(&pair)?;
        sweeps(&mut criterion, &pair, &mut engines);
        tables.push(table::markdown(&pair, &mut engines));
    }
    criterion.final_summary();
    for table in tables {
        println!("\n{table}");
    }
    Ok(())
}

/// Everything that is compared, the trees first; a line each.
fn engines(pair: &MeshPair) -> Result<Vec<Box<dyn Engine>>, Box<dyn Error>> {
    let mut engines: Vec<Box<dyn Engine>> = Vec::new();
    for spheres in [300, 1_000, 3_000, 10_000] {
        engines.push(Box::new(Spheres::tree(pair, spheres)?));
    }
    engines.push(Box::new(Spheres::cached(pair, 1_000)?));
    for spheres in [300, 1_000, 3_000, 10_000] {
        engines.push(Box::new(Spheres::grid(pair, spheres)?));
    }
    for spheres in [300, 1_000] {
        engines.push(Box::new(BruteForce::new(pair, spheres)?));
    }
    engines.push(Box::new(Peer::convex_parts(pair)));
    let fixed = TriMeshFlags::FIX_INTERNAL_EDGES;
    engines.push(Box::new(Peer::triangles(pair, 1, TriMeshFlags::empty())?));
    engines.push(Box::new(Peer::triangles(pair, 1, fixed)?));
    if pair.triangles() < FEW_TRIANGLES {
        engines.push(Box::new(Peer::triangles(pair, 3, fixed)?));
    }
    engines.push(Box::new(Peer::voxels(pair)));
    for balls in [256, 1_024] {
        engines.push(Box::new(Peer::balls(pair, balls)?));
    }
    engines.push(Box::new(MeshBoolean::new(pair)?));
    Ok(engines)
}

/// A group of Criterion for each band.
fn sweeps(criterion: &mut Criterion, pair: &MeshPair, engines: &mut [Box<dyn Engine>]) {
    let names: Vec<String> = engines.iter().map(|engine| engine.name().to_owned()).collect();
    for band in BANDS {
        let all = pair.poses_in(band);
        let poses: Vec<_> = all.iter().step_by(all.len().div_ceil(SWEEP).max(1)).collect();
        let mut group = criterion.benchmark_group(format!("{} {}", pair.name, band.name()));
        group.throughput(Throughput::Elements(poses.len() as u64));
        group.sampling_mode(SamplingMode::Flat);
        for (index, engine) in engines.iter_mut().enumerate() {
            let mut sweep = || {
                for exact in &poses {
                    engine.jump();
                    engine.query(black_box(&exact.pose));
                }
            };
            let start = Instant::now();
            sweep();
            if start.elapsed().as_secs_f64() <= LONGEST_SWEEP {
                group.bench_function(names[index].as_str(), |bencher| bencher.iter(&mut sweep));
            }
        }
        group.finish();
    }
}
