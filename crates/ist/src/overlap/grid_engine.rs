//! Totals by grids: tasks in parallel, sums in their order.

use super::Engine;
use super::grid_search::{GridPair, GridScratch, Task};
use super::relative_pose::RelativePose;
use super::totals::{Extras, Totals, TotalsSink};
use super::workspace::{GridWorkspace, OverlapWorkspace};
use crate::InnerSphereTree;
use crate::lens::Lens;
use crate::simd_level::simd_level;
use crate::tree::TreeData;
use alloc::vec::Vec;
use fearless_simd::dispatch;
use glam::Vec3;

/// Spheres of both solids from which on [`Engine::Auto`] thinks of the grids.
const MANY_SPHERES: usize = 50_000;

impl Engine {
    /// The grids of both solids, if they are to be used.
    ///
    /// The choice rests on the solids and their pose alone: were it to rest on the number of threads, so would the last bits
    /// of the result. On one core the grids take 1.7 to 3.6 times the time of the tree where solids overlap wholly, and more
    /// where they hardly do, as the grids look at every sphere; so they are worth it for large overlaps, and on two cores
    /// only where the solids nearly coincide.
    pub(super) fn grids<'a>(
        self,
        [a, b]: [&'a InnerSphereTree; 2],
        pose: &'a RelativePose,
    ) -> Option<GridPair<'a>> {
        let grids = GridPair { a: a.grid()?.data(), b: b.grid()?.data(), pose };
        let large = || a.len() + b.len() >= MANY_SPHERES && bounding_balls_overlap_by_half([a, b], pose);
        match self {
            Self::Tree => None,
            Self::Grid => Some(grids),
            Self::Auto => (cfg!(feature = "parallel") && large()).then_some(grids),
        }
    }
}

/// Whether the bounding balls share half of the smaller one.
fn bounding_balls_overlap_by_half([a, b]: [&InnerSphereTree; 2], pose: &RelativePose) -> bool {
    let [(center_a, radius_a), (center_b, radius_b)] = bounding_balls((a.data(), b.data()), pose);
    let lens = Lens::new(f64::from(radius_a), f64::from(radius_b), f64::from(center_a.distance(center_b)));
    let smaller = f64::from(radius_a.min(radius_b));
    lens.volume >= 0.5 * Lens::new(smaller, smaller, 0.0).volume
}

/// The balls around all of A and all of B, skins included, in A's unscaled frame.
fn bounding_balls((a, b): (&TreeData, &TreeData), pose: &RelativePose) -> [(Vec3, f32); 2] {
    let ((center_a, radius_a), (center_b, radius_b)) = (a.root().get(0), b.root().get(0));
    let ball_b = (pose.transform_point(center_b), radius_b * pose.scale + pose.skin_b);
    [(center_a, radius_a + pose.skin_a), ball_b]
}

/// Sums over all pairs of overlapping spheres.
pub(super) fn totals(
    trees: (&TreeData, &TreeData),
    grids: GridPair,
    extras: Extras,
    workspace: &mut OverlapWorkspace,
) -> Totals {
    let [(center_a, radius_a), (center_b, radius_b)] = bounding_balls(trees, grids.pose);
    if center_a.distance(center_b) > radius_a + radius_b + grids.pose.enlargement(trees) {
        return Totals::default();
    }
    let run = |task: &Task, scratch: &mut GridScratch| {
        let entries = [&*grids.a.entries, &*grids.b.entries];
        let mut sink = TotalsSink::new(trees, grids.pose, extras).of_entries(entries);
        dispatch!(simd_level(), simd => grids.find_pairs(simd, task, scratch, &mut sink));
        sink.totals
    };
    sum_of_tasks(grids, run, &mut workspace.grid)
}

/// Tasks on all threads; their sums are added up in their order, so that the result does not depend on the threads.
fn sum_of_tasks(
    grids: GridPair,
    run: impl Fn(&Task, &mut GridScratch) -> Totals + Sync,
    workspace: &mut GridWorkspace,
) -> Totals {
    let GridWorkspace { tasks, parts, workers } = workspace;
    grids.list_tasks(tasks);
    parts.clear();
    parts.resize(tasks.len(), Totals::default());
    run_all(tasks, parts, run, workers);
    let mut totals = Totals::default();
    for part in parts {
        totals.add(part);
    }
    totals
}

#[cfg(not(feature = "parallel"))]
fn run_all(
    tasks: &[Task],
    parts: &mut [Totals],
    run: impl Fn(&Task, &mut GridScratch) -> Totals,
    workers: &mut Vec<GridScratch>,
) {
    workers.resize_with(1, GridScratch::default);
    for (task, part) in tasks.iter().zip(parts) {
        *part = run(task, &mut workers[0]);
    }
}

/// Every thread takes the next task as soon as it has done its last.
#[cfg(feature = "parallel")]
fn run_all(
    tasks: &[Task],
    parts: &mut [Totals],
    run: impl Fn(&Task, &mut GridScratch) -> Totals + Sync,
    workers: &mut Vec<GridScratch>,
) {
    use rayon::prelude::*;
    use std::sync::Mutex;
    let threads = rayon::current_num_threads().min(tasks.len());
    if workers.len() < threads {
        workers.resize_with(threads, GridScratch::default);
    }
    let queue = Mutex::new(tasks.iter().zip(parts));
    // Poisoned if taking a task panicked, which then goes on in the thread that asked.
    let next = || queue.lock().ok()?.next();
    workers[..threads].par_iter_mut().with_max_len(1).for_each(|scratch| {
        while let Some((task, part)) = next() {
            *part = run(task, scratch);
        }
    });
}
