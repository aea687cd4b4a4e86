//! What every packing promises, on random meshes and on every asset, checked in double precision by code that shares
//! nothing with the packer: distances to all triangles, winding numbers, all pairs of balls.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

mod common;
#[path = "common/random.rs"]
mod random;

use common::surface;
use glam::DVec3;
use ist::InnerSphere;
use packer::{PackOptions, Packed, Solid, StopReason, TriangleMesh, pack};
use proptest::prelude::*;
use std::f64::consts::PI;

/// Inside, disjoint, cells as large as the balls and the solid: what holds for every packing.
fn check(spheres: &[InnerSphere], mesh: &TriangleMesh) -> Result<(), TestCaseError> {
    let (lower, upper) = mesh.bounds();
    let rounding = 1e-12 * lower.distance(upper);
    let balls: Vec<(DVec3, f64)> = spheres.iter().map(|s| (s.center.as_dvec3(), s.radius.into())).collect();
    for (i, (center, radius)) in balls.iter().enumerate() {
        let distance = surface::distance(mesh, *center);
        // Rounding of another formula for the distance, far under the promised 1e-6.
        prop_assert!(distance >= radius - rounding, "ball {i}: {radius} at a depth of {distance}");
        let winding = surface::winding_number(mesh, *center);
        prop_assert!((winding - 1.0).abs() < 1e-3, "ball {i} is outside: winding number {winding}");
        for (j, (other, other_radius)) in balls[..i].iter().enumerate() {
            let overlap = radius + other_radius - center.distance(*other);
            prop_assert!(
                overlap <= 1e-9 * radius.min(*other_radius),
                "balls {j} and {i} overlap by {overlap}"
            );
        }
        let (own, cell) = (4.0 / 3.0 * PI * radius.powi(3), f64::from(spheres[i].cell_volume));
        prop_assert!(cell >= own * (1.0 - 1e-6), "cell {i} of {cell} is smaller than its ball of {own}");
        prop_assert!((spheres[i].normal.length() - 1.0).abs() < 1e-5, "normal {i}");
    }
    let sum: f64 = spheres.iter().map(|s| f64::from(s.cell_volume)).sum();
    let volume = surface::volume(mesh);
    prop_assert!((sum / volume - 1.0).abs() < 1e-6, "cells of {sum} fill {volume}");
    Ok(())
}

/// Beginnings of one sequence, with coverage that never falls.
fn check_prefix(small: &Packed, large: &Packed) -> Result<(), TestCaseError> {
    let (few, many) = (small.packing.spheres(), large.packing.spheres());
    prop_assert!(few.len() <= many.len());
    for (i, (a, b)) in few.iter().zip(many).enumerate() {
        prop_assert_eq!((a.center, a.radius, a.normal), (b.center, b.radius, b.normal), "sphere {}", i);
    }
    prop_assert!(small.report.coverage <= large.report.coverage);
    Ok(())
}

fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

/// Everything that is promised, for packings of `count` and of half as many spheres.
fn check_solid(solid: &Solid, count: usize) -> Result<(), TestCaseError> {
    let options = PackOptions::balanced().spheres(count);
    let packed = with_threads(1, || pack(solid, &options)).unwrap();
    match packed.report.stop {
        StopReason::SphereCount => prop_assert_eq!(packed.packing.spheres().len(), count),
        StopReason::Exhausted | StopReason::Resolution => {
            prop_assert!(packed.packing.spheres().len() < count);
        }
        stop => prop_assert!(false, "{stop}"),
    }
    // The mesh of the solid is the input but for orientation: welding moves no vertex.
    check(packed.packing.spheres(), solid.surface())?;
    for threads in [2, 8] {
        let other = with_threads(threads, || pack(solid, &options)).unwrap();
        prop_assert!(
            packed.packing.to_bytes() == other.packing.to_bytes(),
            "{threads} threads differ from one"
        );
        prop_assert_eq!(&packed.report.quality, &other.report.quality);
    }
    let half = pack(solid, &options.spheres(count.div_ceil(2)).measure_quality(false)).unwrap();
    check_prefix(&half, &packed)
}

proptest! {
    // One case takes a quarter of a second, and each step of shrinking as long.
    #![proptest_config(ProptestConfig { cases: 16, max_shrink_iters: 16, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn packings_of_random_meshes_keep_their_promises(random in random::meshes(), count in 1..80_usize) {
        let solid = Solid::new(&random.mesh).map_err(|e| TestCaseError::fail(format!("{random:?}: {e}")))?;
        check_solid(&solid, count)?;
    }

    #[test]
    fn stops_of_packings_of_random_meshes_are_met(
        random in random::meshes(),
        coverage in 0.05..0.5_f64,
        least in 0.02..0.9_f64,
    ) {
        let solid = Solid::new(&random.mesh).map_err(|e| TestCaseError::fail(format!("{random:?}: {e}")))?;
        let first = pack(&solid, &PackOptions::fast().spheres(1).measure_quality(false)).unwrap();
        let largest = f64::from(first.packing.spheres()[0].radius);
        let options = PackOptions::fast().spheres(150).measure_quality(false);
        let by_all = pack(&solid, &options.clone().coverage(coverage).min_radius(least * largest)).unwrap();
        let spheres = by_all.packing.spheres();
        let filled = |spheres: &[InnerSphere]| -> f64 {
            spheres.iter().map(|s| 4.0 / 3.0 * PI * f64::from(s.radius).powi(3)).sum::<f64>()
                / solid.properties().volume
        };
        prop_assert!((by_all.report.coverage - filled(spheres)).abs() < 1e-9);
        prop_assert!(spheres.iter().all(|s| f64::from(s.radius) >= least * largest));
        prop_assert!(spheres.len() <= 150);
        // All balls but the last are needed for the coverage.
        prop_assert!(filled(&spheres[..spheres.len() - 1]) < coverage);
        match by_all.report.stop {
            StopReason::Coverage => prop_assert!(filled(spheres) >= coverage * (1.0 - 1e-12)),
            StopReason::SphereCount => prop_assert_eq!(spheres.len(), 150),
            StopReason::MinRadius => prop_assert!(filled(spheres) < coverage && spheres.len() < 150),
            stop => prop_assert!(false, "{stop}"),
        }
        // A least radius has a say in the last round, so it is left out here.
        let by_coverage = pack(&solid, &options.clone().coverage(coverage)).unwrap();
        check_prefix(&by_coverage, &pack(&solid, &options).unwrap())?;
    }
}

/// Every asset, one test each, so that they run side by side.
macro_rules! assets {
    ($($name:ident)*) => {$(
        #[test]
        fn $name() {
            let mesh = TriangleMesh::load(common::asset(concat!(stringify!($name), ".obj"))).unwrap();
            check_solid(&Solid::new(&mesh).unwrap(), 250).unwrap();
        }
    )*};
}

mod asset {
    use super::*;

    assets!(bunny femur pelvis pinion_gear spider_gear);
}
