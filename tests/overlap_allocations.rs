//! Overlap queries ask for no memory once their workspace has grown; on several threads, once that of each thread has.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use glam::Vec3;
use glamx::{Pose3, Rot3};
use ist::{
    Budget, Engine, InnerSphere, InnerSphereTree, OverlapCache, OverlapQuery, OverlapWorkspace,
    SolidProperties, SpherePacking, TimeCriticalWorkspace,
};
use rayon::ThreadPoolBuilder;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Spheres along an edge of a cube of them: enough for several tasks per thread.
const EDGE: usize = 20;
/// How often every query is asked before and while allocations are counted.
const WARM_UP: usize = 20;
const COUNTED: usize = 50;
/// Rounds of so many until the memory of many threads must have grown enough.
const MOST_ROUNDS: usize = 20;

fn cube() -> InnerSphereTree {
    let spheres = (0..EDGE.pow(3))
        .map(|i| {
            let at = [i % EDGE, i / EDGE % EDGE, i / (EDGE * EDGE)].map(|k| k as f32);
            InnerSphere::solid_ball(Vec3::from_array(at), if i % 3 == 0 { 0.5 } else { 0.2 }, Vec3::Y)
        })
        .collect();
    let packing = SpherePacking::new(spheres, SolidProperties::ball(1.0)).unwrap();
    InnerSphereTree::new(&packing).with_grid()
}

/// From deep to no overlap.
fn poses() -> [Pose3; 4] {
    [0.3, 4.0, 15.0, 40.0].map(|way| Pose3::from_parts(Vec3::X * way, Rot3::from_axis_angle(Vec3::Z, 0.1)))
}

#[test]
fn queries_allocate_nothing() {
    let tree = cube();
    let (mut workspace, mut cache) = (OverlapWorkspace::default(), OverlapCache::default());
    let (mut within, mut samples) = (TimeCriticalWorkspace::default(), Vec::new());
    let mut ask = |times: usize| {
        for pose in (0..times).flat_map(|_| poses()) {
            for engine in [Engine::Tree, Engine::Grid] {
                let query = OverlapQuery { engine, stiffness: true, ..OverlapQuery::default() };
                let _ = tree.overlap_with(&tree, &pose, query, &mut workspace);
            }
            let _ = tree.overlap_cached(&tree, &pose, OverlapQuery::default(), (&mut cache, &mut workspace));
            samples.clear();
            tree.contact_samples(&tree, &pose, &mut workspace, &mut samples);
            let _ = tree.overlap_within(&tree, &pose, Budget::Visits(1000), &mut within);
        }
    };
    for threads in [1, 2, 3] {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| ask(WARM_UP));
        // Tasks fall to the threads anew in every query: one of many threads may only now meet its first list, or one longer than
        // all before, and its memory then grows. Once all have met the longest, nothing does; one thread has already.
        let rounds = if threads == 1 { 1 } else { MOST_ROUNDS };
        let mut asks_for_no_memory = || {
            let region = Region::new(ALLOCATOR);
            ask(COUNTED);
            let change = region.change();
            println!("{threads} threads: {change:?}");
            change.allocations + change.reallocations == 0
        };
        assert!(pool.install(|| (0..rounds).any(|_| asks_for_no_memory())));
    }
}
