//! Overlap volumes and directions against exact mesh booleans.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use glam::Vec3;
use ist::{Overlap, OverlapWorkspace, SpherePacking};
use rapier_ist_tests::{Band, Truth, median, plain};

const BANDS: [Band; 3] = [Band::Shallow, Band::Mid, Band::Deep];

/// Overlaps at all poses of `truth`.
fn overlaps(truth: &Truth, packings: &[SpherePacking; 2]) -> Vec<Overlap> {
    let [a, b] = truth.trees(packings).unwrap();
    let mut workspace = OverlapWorkspace::default();
    truth.poses.iter().map(|pose| a.overlap(&b, &pose.pose(), &mut workspace)).collect()
}

/// Median relative error of the volume in each band.
fn volume_errors(truth: &Truth, overlaps: &[Overlap]) -> [f64; 3] {
    BANDS.map(|band| {
        let in_band =
            truth.poses.iter().zip(overlaps).filter(|(pose, _)| truth.band(pose.volume) == Some(band));
        median(in_band.map(|(pose, overlap)| (f64::from(overlap.volume) / pose.volume - 1.0).abs()).collect())
    })
}

/// Median angle (degrees) between the force and the exact steepest descent of the volume in each band.
fn direction_errors(truth: &Truth, overlaps: &[Overlap]) -> [f64; 3] {
    BANDS.map(|band| {
        let in_band =
            truth.poses.iter().zip(overlaps).filter(|(pose, _)| truth.band(pose.volume) == Some(band));
        let angle = |(pose, overlap): (&rapier_ist_tests::TruePose, &Overlap)| {
            let gradient = Vec3::from_array(pose.volume_gradient.unwrap());
            f64::from(overlap.force.angle_between(-gradient).to_degrees())
        };
        median(in_band.map(angle).collect())
    })
}

fn assert_below(what: &str, figures: [f64; 3], limits: [f64; 3]) {
    println!("{what}: {figures:.4?}, limits {limits:?}");
    for ((band, figure), limit) in BANDS.into_iter().zip(figures).zip(limits) {
        assert!(figure <= limit, "{what} {band:?}: {figure} > {limit}");
    }
}

fn assert_hits(truth: &Truth, overlaps: &[Overlap]) {
    for (index, (pose, overlap)) in truth.poses.iter().zip(overlaps).enumerate() {
        assert!(pose.volume > 0.0 || !overlap.intersects, "pose {index}: false hit");
        assert!(truth.band(pose.volume).is_none() || overlap.intersects, "pose {index}: missed");
    }
}

/// Holds the medians of a pair under limits that are half as large again as what was measured when they were set.
fn check(name: &str, spheres: usize, volume: [f64; 3], direction: [f64; 3]) {
    let truth = Truth::load(name).unwrap();
    let overlaps = overlaps(&truth, &truth.packings(spheres).unwrap());
    let what = |figure: &str| format!("{name}, {spheres} spheres, {figure}");
    assert_below(&what("volume"), volume_errors(&truth, &overlaps), volume);
    assert_below(&what("direction"), direction_errors(&truth, &overlaps), direction);
    assert_hits(&truth, &overlaps);
}

/// No pose of the bones is deep.
const NONE: f64 = f64::INFINITY;

#[test]
fn a_thousand_spheres() {
    check("bunny_bunny", 1_000, [0.041, 0.0030, 0.0030], [3.6, 1.5, 2.0]);
    check("gears", 1_000, [0.014, 0.0045, 0.0020], [4.2, 2.8, 4.6]);
    check("bones", 1_000, [0.015, 0.0060, NONE], [2.3, 3.5, NONE]);
    check("bunny_inside", 1_000, [0.21, 0.048, 0.016], [9.0, 3.6, 11.0]);
}

#[test]
fn three_thousand_spheres() {
    check("bunny_bunny", 3_000, [0.0075, 0.0022, 0.0007], [2.0, 0.8, 1.0]);
    check("gears", 3_000, [0.010, 0.0025, 0.0010], [2.1, 1.5, 2.8]);
    check("bones", 3_000, [0.0085, 0.0036, NONE], [1.6, 3.0, NONE]);
    check("bunny_inside", 3_000, [0.11, 0.030, 0.0065], [7.2, 3.0, 5.5]);
}

#[test]
fn plain_inner_spheres_are_an_order_of_magnitude_off() {
    let truth = Truth::load("bunny_bunny").unwrap();
    let packings = truth.packings(1_000).unwrap();
    let plain = packings.each_ref().map(|packing| plain(packing).unwrap());
    let with_cells = volume_errors(&truth, &overlaps(&truth, &packings));
    let without = volume_errors(&truth, &overlaps(&truth, &plain));
    println!("with power cells {with_cells:.4?}, without {without:.4?}");
    for (cells, plain) in with_cells.into_iter().zip(without) {
        assert!(plain > 20.0 * cells, "{plain} is not twenty times {cells}");
    }
}
