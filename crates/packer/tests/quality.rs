//! The figures of the quality report, against closed forms and against measurements by brute force.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

mod common;

use glam::{DVec3, Vec3};
use packer::{PackOptions, Packed, Quality, Solid, TriangleMesh, pack};
use proptest::prelude::*;
use std::f64::consts::PI;

fn packed(solid: &Solid, spheres: usize) -> (Packed, Quality) {
    let packed = pack(solid, &PackOptions::balanced().spheres(spheres)).unwrap();
    let quality = packed.report.quality.clone().unwrap();
    (packed, quality)
}

fn unit_cube() -> Solid {
    Solid::new(&common::cuboid(DVec3::ZERO, DVec3::ONE)).unwrap()
}

#[test]
fn one_ball_in_a_cube_has_the_figures_of_closed_forms() {
    let (_, q) = packed(&unit_cube(), 1);
    let near = |name: &str, value: f64, exact: f64, tolerance: f64| {
        assert!((value - exact).abs() <= tolerance, "{name} is {value}, not {exact}");
    };
    near("coverage", q.coverage, PI / 6.0, 1e-3);
    near("volume ratio", q.volume_ratio, 1.0, 1e-6);
    // The ball of the cube's volume sticks out by six caps of height ρ − 1/2.
    let rho = (0.75 / PI).cbrt();
    let cap = rho - 0.5;
    near("volume error", q.volume_error, 2.0 * PI * cap * cap * (3.0 * rho - cap), 3e-3);
    // Distance of the points of a face from the ball about the centre; the mean of √(1/4 + x² + y²) by midpoints.
    let n = 400;
    let at = |i: i32| (f64::from(i) + 0.5) / f64::from(n) - 0.5;
    let roots = (0..n * n).map(|k| (0.25 + at(k / n).powi(2) + at(k % n).powi(2)).sqrt());
    // Four standard errors of 10,000 random points.
    near("mean gap", q.surface_gap.mean, roots.sum::<f64>() / f64::from(n * n) - 0.5, 3e-3);
    near("largest surface gap", q.surface_gap.max, 0.75_f64.sqrt() - 0.5, 0.01);
    assert!(q.surface_gap.p95 < q.surface_gap.max && q.surface_gap.p95 > q.surface_gap.mean);
    let corner = (q.surface_gap.farthest - 0.5).abs();
    assert!(corner.min_element() > 0.47, "{}", q.surface_gap.farthest);
    let gap = q.largest_gap.unwrap();
    near("largest gap", gap.radius, 0.5 * (3.0_f64.sqrt() - 1.0) / (3.0_f64.sqrt() + 1.0), 1e-3);
    near("centroid", q.inner_mass.centroid, 0.0, 1e-3);
    // 2/5·(1/2)² and 2/5·ρ² against 1/6.
    near("inertia of the inner ball", q.inner_mass.inertia, 0.4, 2e-3);
    near("inertia of the volume ball", q.volume_mass.inertia, 1.0 - 2.4 * rho * rho, 2e-3);
    assert_eq!((q.radii.len(), q.radii[0].count), (1, 1));
}

#[test]
fn the_report_can_be_made_again_from_the_file() {
    let solid = Solid::new(&TriangleMesh::load(common::asset("bunny.obj")).unwrap()).unwrap();
    let (packed, quality) = packed(&solid, 300);
    let read = ist::SpherePacking::from_bytes(&packed.packing.to_bytes()).unwrap();
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(pool.install(|| Quality::measure(&solid, &read)), quality);
    }
    let without = pack(&solid, &PackOptions::fast().measure_quality(false)).unwrap();
    assert!(without.report.quality.is_none());
    assert!(without.packing.spheres() == packed.packing.spheres());
}

#[test]
fn figures_agree_with_brute_force_on_every_asset() {
    for name in ["bunny", "femur", "pelvis", "pinion_gear", "spider_gear"] {
        let solid = Solid::new(&TriangleMesh::load(common::asset(&format!("{name}.obj"))).unwrap()).unwrap();
        let (packed, q) = packed(&solid, 200);
        let spheres = packed.packing.spheres();
        let distance = |p: DVec3, ball: fn(&ist::InnerSphere) -> (Vec3, f32)| {
            let gap = |(center, radius): (Vec3, f32)| center.as_dvec3().distance(p) - f64::from(radius);
            spheres.iter().map(|s| gap(ball(s))).fold(f64::INFINITY, f64::min)
        };
        // Points of the box by an additive recurrence (M. Roberts, 2018).
        let (lower, upper) = solid.bounds();
        let points = (0..30_000).map(|i| {
            let share = (f64::from(i) * DVec3::new(0.819_172_5, 0.671_043_6, 0.549_700_5)).fract();
            lower + share * (upper - lower)
        });
        let (mut inside, mut missed) = (0.0, 0.0);
        for p in points.filter(|p| solid.contains(*p)) {
            inside += 1.0;
            missed += f64::from(u8::from(distance(p, ist::InnerSphere::volume_ball) > 0.0));
        }
        let error = missed / inside;
        // Four standard errors of the measurement here.
        let tolerance = 4.0 * (error * (1.0 - error) / inside).sqrt();
        assert!((q.volume_error - error).abs() < tolerance, "{name}: {} is {error}", q.volume_error);
        assert!(q.volume_error <= 1.0 - q.coverage, "{name}");

        let gap = q.largest_gap.unwrap();
        assert!(solid.depth(gap.center) >= gap.radius * (1.0 - 1e-9), "{name}");
        assert!(distance(gap.center, |s| (s.center, s.radius)) >= gap.radius * (1.0 - 1e-9), "{name}");
        // The next ball of the sequence fits into some gap.
        let next = pack(&solid, &PackOptions::fast().spheres(201)).unwrap();
        let next = f64::from(next.packing.spheres()[200].radius);
        assert!(gap.radius > 0.95 * next, "{name}: {} but {next} fits", gap.radius);

        let max = distance(q.surface_gap.farthest, |s| (s.center, s.radius));
        assert!((max - q.surface_gap.max).abs() < 1e-9 * solid.size(), "{name}");
        assert!(solid.depth(q.surface_gap.farthest).abs() < 1e-9 * solid.size(), "{name}");
        let count: usize = q.radii.iter().map(|bin| bin.count).sum();
        let share: f64 = q.radii.iter().map(|bin| bin.volume_share).sum();
        assert!(count == 200 && (share - q.coverage).abs() < 1e-9, "{name}");
        assert!((q.coverage - packed.packing.coverage()).abs() < 1e-9, "{name}");
        assert!(q.volume_mass.inertia < q.inner_mass.inertia, "{name}");
    }
}

#[test]
fn more_spheres_represent_a_solid_better() {
    let solid = Solid::new(&common::torus(1.0, 0.3, 48)).unwrap();
    let mut before: Option<Quality> = None;
    for spheres in [30, 300, 3_000] {
        let (_, q) = packed(&solid, spheres);
        if let Some(p) = before {
            assert!(q.coverage > p.coverage && q.volume_error < p.volume_error);
            assert!(q.surface_gap.mean < p.surface_gap.mean && q.surface_gap.p95 < p.surface_gap.p95);
            assert!(q.largest_gap.unwrap().radius < p.largest_gap.unwrap().radius);
        }
        before = Some(q);
    }
}

#[test]
fn a_thin_part_without_a_ball_is_found() {
    // A cube and beside it a rod, for which 100 balls are too few.
    let cube = common::cuboid(DVec3::ZERO, DVec3::ONE);
    let rod = common::cuboid(DVec3::new(2.0, 0.49, 0.49), DVec3::new(4.0, 0.51, 0.51));
    let solid = Solid::new(&common::join(&cube, &rod)).unwrap();
    let (_, q) = packed(&solid, 100);
    assert!(q.surface_gap.farthest.x > 3.9, "{:?}", q.surface_gap);
    assert!(q.surface_gap.max > 2.9, "{:?}", q.surface_gap);
}

#[test]
fn plates_needles_and_distant_solids_have_finite_figures() {
    let needle = common::cuboid(DVec3::ZERO, DVec3::new(1.0, 1e-4, 1e-4));
    let plate = common::cuboid(DVec3::splat(-1.0), DVec3::new(1.0, 1.0, -0.99));
    let distant = common::cuboid(DVec3::new(999.0, -500.0, 20.0), DVec3::new(1000.0, -499.0, 21.5));
    for (name, mesh) in [("needle", needle), ("plate", plate), ("distant", distant)] {
        for spheres in [1, 40] {
            let (_, q) = packed(&Solid::new(&mesh).unwrap(), spheres);
            let figures = [
                q.coverage,
                q.volume_ratio,
                q.volume_error,
                q.surface_gap.mean,
                q.surface_gap.p95,
                q.surface_gap.max,
                q.inner_mass.centroid,
                q.inner_mass.inertia,
                q.volume_mass.centroid,
                q.volume_mass.inertia,
            ];
            assert!(figures.iter().all(|x| x.is_finite() && *x >= 0.0), "{name}: {q:?}");
            assert!(q.gap_samples > 1_000 && q.largest_gap.is_some(), "{name}: {q:?}");
            assert!(q.volume_error <= 1.0 - q.coverage, "{name}: {q:?}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 8, max_shrink_iters: 8, failure_persistence: None, ..ProptestConfig::default() })]

    /// The theorem in the documentation of the volume error: no half-space sees more of it.
    #[test]
    fn the_volume_error_bounds_the_error_of_the_overlap_with_any_half_space(
        size in prop::array::uniform3(0.2..3.0_f64),
        spheres in 1..60_usize,
        cut in 0.0..1.0_f64,
        axis in 0..3_usize,
    ) {
        let size = DVec3::from_array(size);
        let solid = Solid::new(&common::cuboid(DVec3::ZERO, size)).unwrap();
        let (packed, q) = packed(&solid, spheres);
        let plane = cut * size[axis];
        // Volume of each volume ball below the plane: a cap of height h has πh²(3ρ − h)/3.
        let below: f64 = packed.packing.spheres().iter().map(|s| {
            let (center, rho) = s.volume_ball();
            let rho = f64::from(rho);
            let h = (plane - f64::from(center[axis]) + rho).clamp(0.0, 2.0 * rho);
            PI * h * h * (3.0 * rho - h) / 3.0
        }).sum();
        let volume = solid.properties().volume;
        let error = (below / volume - cut).abs();
        // A tenth for the noise of the measured bound.
        prop_assert!(error <= 1.1 * q.volume_error, "{error} with a bound of {}", q.volume_error);
    }
}

#[cfg(feature = "serde-serialize")]
#[test]
fn the_report_becomes_json() {
    let (packed, quality) = packed(&unit_cube(), 9);
    let json = serde_json::to_value(&packed.report).unwrap();
    assert_eq!(json["spheres"], 9);
    assert_eq!(json["stop"], "sphere_count");
    assert_eq!(json["quality"]["volume_error"], quality.volume_error);
    assert_eq!(json["quality"]["largest_gap"]["center"].as_array().map(Vec::len), Some(3));
    assert_eq!(json["quality"]["radii"][0]["count"], 1);
}
