//! What ends a packing, and that it really does.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

mod common;

use glam::DVec3;
use packer::{
    PackError, PackOptions, Packed, Solid, Stage, StopReason, StopSignal, TriangleMesh, pack,
    pack_interruptible, pack_with_progress,
};
use std::time::{Duration, Instant};

fn gear() -> Solid {
    Solid::new(&TriangleMesh::load(common::asset("pinion_gear.obj")).unwrap()).unwrap()
}

fn torus() -> Solid {
    Solid::new(&common::torus(1.0, 0.4, 40)).unwrap()
}

/// Options that do not end by themselves in the time of a test.
fn endless() -> PackOptions {
    PackOptions::fine().spheres(10_000_000)
}

/// The packing is the one that a request for its count gives, cell volumes included.
fn assert_same_as_by_count(packed: &Packed, solid: &Solid) {
    let spheres = packed.packing.spheres();
    let options = PackOptions::balanced().spheres(spheres.len()).measure_quality(false);
    assert!(spheres == pack(solid, &options).unwrap().packing.spheres());
    assert_eq!(packed.report.spheres, spheres.len());
}

#[test]
fn the_volume_error_is_met_with_few_more_balls_than_needed() {
    for (name, solid, asked) in [("torus", torus(), 0.12), ("gear", gear(), 0.14)] {
        let packed = pack(&solid, &endless().volume_error(asked)).unwrap();
        assert_eq!(packed.report.stop, StopReason::VolumeError, "{name}");
        let error = packed.report.quality.as_ref().unwrap().volume_error;
        assert!(error <= asked, "{name}: {error}");
        assert_same_as_by_count(&packed, &solid);
        let fewer = PackOptions::balanced().spheres(packed.report.spheres * 4 / 5);
        let error = pack(&solid, &fewer).unwrap().report.quality.unwrap().volume_error;
        assert!(error > asked, "{name}: {error} already with {}", fewer.spheres);
    }
}

#[test]
fn an_easy_volume_error_takes_one_ball_and_another_stop_may_come_first() {
    let solid = Solid::new(&common::cuboid(glam::DVec3::ZERO, glam::DVec3::ONE)).unwrap();
    let packed = pack(&solid, &endless().volume_error(0.9)).unwrap();
    assert_eq!((packed.report.stop, packed.report.spheres), (StopReason::VolumeError, 1));
    let packed = pack(&solid, &endless().volume_error(1e-3).spheres(50)).unwrap();
    assert_eq!((packed.report.stop, packed.report.spheres), (StopReason::SphereCount, 50));
}

#[test]
fn no_ball_of_the_least_radius_is_left_out() {
    for (name, solid, share) in [("torus", torus(), 0.015), ("gear", gear(), 0.015)] {
        let radius = share * solid.size();
        let packed = pack(&solid, &endless().min_radius(radius)).unwrap();
        assert_eq!(packed.report.stop, StopReason::MinRadius, "{name}");
        assert!(packed.packing.spheres().iter().all(|s| f64::from(s.radius) >= radius), "{name}");
        let gap = packed.report.quality.unwrap().largest_gap.unwrap();
        assert!(gap.radius < radius * 1.01, "{name}: {gap:?} after {radius}");
    }
}

/// The stops were looked at before the next ball, and where there was none, "minimum radius" was reported.
#[test]
fn issue_a_stop_that_the_last_ball_meets_is_the_one_reported() {
    // The insphere fills π/6 of a cube, and the next ball has a radius of 0.134.
    let solid = Solid::new(&common::cuboid(glam::DVec3::ZERO, glam::DVec3::ONE)).unwrap();
    let options = endless().min_radius(0.4);
    let stop = |options: PackOptions| pack(&solid, &options).unwrap().report.stop;
    assert_eq!(stop(options.clone()), StopReason::MinRadius);
    assert_eq!(stop(options.clone().coverage(0.5)), StopReason::Coverage);
    assert_eq!(stop(options.clone().volume_error(0.5)), StopReason::VolumeError);
    assert_eq!(stop(options.spheres(1)), StopReason::SphereCount);
}

#[test]
fn a_time_limit_ends_in_a_complete_packing() {
    let solid = gear();
    let limit = Duration::from_secs(2);
    let packed = pack(&solid, &endless().time_limit(limit)).unwrap();
    assert_eq!(packed.report.stop, StopReason::TimeLimit);
    assert!(packed.report.quality.is_some() && packed.report.protrusion <= 0.0);
    assert_same_as_by_count(&packed, &solid);
    // Time that is not used up ends nothing.
    let packed = pack(&solid, &PackOptions::fast().time_limit(Duration::MAX)).unwrap();
    assert_eq!((packed.report.stop, packed.report.spheres), (StopReason::SphereCount, 300));
}

/// Half of a cube was left empty and called negligible.
#[test]
fn issue_a_stop_by_single_precision_says_so() {
    let far = common::cuboid(DVec3::splat(1e5), DVec3::splat(1e5) + 1.0);
    let packed = pack(&Solid::new(&far).unwrap(), &PackOptions::balanced()).unwrap();
    assert_eq!(packed.report.stop, StopReason::Resolution);
    assert!(packed.report.coverage < 0.7 && packed.report.stop.to_string().contains("single precision"));
    // A least radius that is asked for is another matter.
    let packed = pack(&Solid::new(&far).unwrap(), &PackOptions::balanced().min_radius(0.3)).unwrap();
    assert_eq!(packed.report.stop, StopReason::MinRadius);
}

#[test]
fn issue_dust_under_the_facets_of_a_ball_is_not_searched_for() {
    // One ball fills 99.6 %. Looking for the next ones went through minutes and gigabytes.
    let ball = Solid::new(&common::bumpy_sphere(40, 1.0, 0.0, 0)).unwrap();
    let packed = pack(&ball, &PackOptions::balanced().spheres(10)).unwrap();
    assert_eq!(packed.report.stop, StopReason::Exhausted);
    assert!(packed.report.coverage > 0.99, "{}", packed.report.coverage);
    assert_eq!(packed.report.stop.to_string(), "the rest is negligible");
    // In a plate and in the fins of a ball all is small, and none of it dust.
    let plate = common::cuboid(DVec3::ZERO, DVec3::new(1.0, 1.0, 1e-3));
    let fin = common::cuboid(DVec3::new(2.0, 0.0, 0.0), DVec3::new(6.0, 1.0, 0.01));
    let winged = common::join(&common::bumpy_sphere(24, 1.0, 0.0, 0), &fin);
    for mesh in [plate, winged] {
        let packed = pack(&Solid::new(&mesh).unwrap(), &PackOptions::fast()).unwrap();
        assert_eq!(packed.packing.spheres().len(), 300);
    }
}

#[test]
fn no_time_is_an_error() {
    for limit in [Duration::ZERO, Duration::from_nanos(1)] {
        let error = pack(&torus(), &endless().time_limit(limit)).unwrap_err();
        assert_eq!(error, PackError::NothingInTime { limit });
    }
}

#[test]
fn a_finished_packing_is_the_one_of_its_count() {
    let solid = gear();
    let signal = StopSignal::new();
    let packed = pack_interruptible(&solid, &endless(), &signal, |progress| {
        if progress.spheres >= 500 {
            signal.finish();
        }
    })
    .unwrap();
    assert_eq!(packed.report.stop, StopReason::Caller);
    assert!(packed.report.spheres >= 500);
    assert_same_as_by_count(&packed, &solid);
}

#[test]
fn finishing_before_the_first_ball_gives_nothing() {
    let signal = StopSignal::new();
    signal.finish();
    assert_eq!(pack_interruptible(&torus(), &endless(), &signal, |_| {}).unwrap_err(), PackError::Cancelled);
}

#[test]
fn every_stage_can_be_cancelled() {
    let solid = torus();
    for stage in [Stage::Seeds, Stage::Placing, Stage::Cells, Stage::Report] {
        let signal = StopSignal::new();
        let result = pack_interruptible(&solid, &PackOptions::balanced(), &signal, |progress| {
            if progress.stage == stage {
                signal.cancel();
            }
            assert!(progress.stage <= stage, "{} came after cancelling in {stage}", progress.stage);
        });
        assert_eq!(result.unwrap_err(), PackError::Cancelled, "{stage}");
    }
}

/// Guards against hangs only: uncancelled, each of these would take minutes.
const SOON: Duration = Duration::from_secs(20);

#[test]
fn cancelling_from_another_thread_cuts_long_searches_and_power_cells_short() {
    let solid = gear();
    // So many gap samples that the cells of few balls take long; or a search without end.
    let mut long_cells = PackOptions::fast().spheres(100);
    long_cells.samples_per_sphere = 10_000_000;
    for options in [long_cells, endless(), endless().volume_error(1e-3), endless().time_limit(100 * SOON)] {
        let signal = StopSignal::new();
        let (error, took) = std::thread::scope(|scope| {
            let packing = scope.spawn(|| pack_interruptible(&solid, &options, &signal, |_| {}).unwrap_err());
            std::thread::sleep(Duration::from_millis(600));
            signal.cancel();
            let cancelled = Instant::now();
            (packing.join().unwrap(), cancelled.elapsed())
        });
        assert_eq!(error, PackError::Cancelled);
        assert!(took < SOON, "{options}: {took:?}");
    }
}

/// Every place of a thin plate is as good as any other, and the search for the first ball goes through all of them.
#[test]
fn a_time_limit_is_kept_where_the_first_search_is_long() {
    let plate = common::cuboid(glam::DVec3::ZERO, glam::DVec3::new(2.0, 2.0, 1e-4));
    let solid = Solid::new(&plate).unwrap();
    let limit = Duration::from_secs(1);
    let started = Instant::now();
    match pack(&solid, &endless().time_limit(limit)) {
        Ok(packed) => assert_eq!(packed.report.stop, StopReason::TimeLimit),
        Err(error) => assert_eq!(error, PackError::NothingInTime { limit }),
    }
    assert!(started.elapsed() < SOON, "{:?}", started.elapsed());
}

#[test]
fn progress_never_falls_and_ends_at_one() {
    let solid = torus();
    for options in [
        PackOptions::fast(),
        endless().coverage(0.7),
        endless().min_radius(0.03),
        endless().volume_error(0.12),
        endless().coverage(0.75).min_radius(0.05).spheres(2_000),
        // Long enough for a first ball on a machine with much else to do.
        endless().time_limit(Duration::from_secs(5)),
        PackOptions::fast().spheres(1).measure_quality(false),
    ] {
        let mut seen = Vec::new();
        let packed = pack_with_progress(&solid, &options, |progress| seen.push(progress)).unwrap();
        for pair in seen.windows(2) {
            assert!(pair[0].fraction <= pair[1].fraction, "{options}: {pair:?}");
            assert!(pair[0].stage <= pair[1].stage, "{options}: {pair:?}");
        }
        let (first, last) = (seen.first().unwrap(), seen.last().unwrap());
        assert_eq!((first.stage, first.fraction, first.spheres), (Stage::Seeds, 0.0, 0), "{options}");
        assert_eq!((last.stage, last.fraction), (Stage::Finished, 1.0), "{options}");
        assert_eq!((last.spheres, last.coverage), (packed.report.spheres, packed.report.coverage));
        assert!(seen[..seen.len() - 1].iter().all(|p| (0.0..1.0).contains(&p.fraction)), "{options}");
        for stage in [Stage::Placing, Stage::Cells, Stage::Report] {
            assert!(seen.iter().any(|p| p.stage == stage), "{options}: no {stage}");
        }
    }
}

#[test]
fn the_provenance_has_what_the_packing_depends_on_and_nothing_else() {
    let base = PackOptions::balanced();
    let same = [
        base.clone().measure_quality(false),
        // The source stands in a line of its own.
        base.clone().source("bunny.obj"),
    ];
    for options in same {
        assert_eq!(options.to_string(), base.to_string());
    }
    let mut finer = base.clone();
    finer.samples_per_sphere += 1;
    let different = [
        base.clone(),
        base.clone().spheres(1_001),
        base.clone().coverage(0.8),
        base.clone().coverage(f64::from_bits(0.8_f64.to_bits() + 1)),
        base.clone().min_radius(0.8),
        base.clone().volume_error(0.8),
        base.clone().time_limit(Duration::from_secs(8)),
        base.clone().time_limit(Duration::from_nanos(8_000_000_001)),
        finer,
    ];
    let lines: Vec<String> = different.iter().map(PackOptions::to_string).collect();
    for (i, line) in lines.iter().enumerate() {
        assert!(!lines[..i].contains(line), "{line} stands for two different requests");
    }
    let solid = torus();
    let options = PackOptions::fast().spheres(10).coverage(0.9).source("ring.obj");
    let packed = pack_with_progress(&solid, &options, |_| {}).unwrap();
    let provenance = packed.packing.provenance();
    assert_eq!(provenance.options, options.to_string());
    assert!(provenance.source.starts_with("ring.obj "), "{}", provenance.source);
}
