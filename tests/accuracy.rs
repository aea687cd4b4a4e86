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

#[test]
fn two_rabbits_of_a_thousand_spheres() {
    let truth = Truth::load("bunny_bunny").unwrap();
    let packings = truth.packings(1000).unwrap();
    let exact = overlaps(&truth, &packings);
    assert_below("volume", volume_errors(&truth, &exact), [0.06, 0.03, 0.015]);
    assert_below("direction", direction_errors(&truth, &exact), [6.0, 5.0, 6.0]);
    assert_hits(&truth, &exact);
    // The point of the power cells: the plain method is an order of magnitude off.
    let plain = packings.each_ref().map(|packing| plain(packing).unwrap());
    let plain_errors = volume_errors(&truth, &overlaps(&truth, &plain));
    println!("plain inner spheres: {plain_errors:.4?}");
    for (cells, plain) in volume_errors(&truth, &exact).into_iter().zip(plain_errors) {
        assert!(plain > 10.0 * cells, "{plain} is not ten times {cells}");
    }
}

#[test]
fn two_gears_of_a_thousand_spheres() {
    let truth = Truth::load("gears").unwrap();
    let overlaps = overlaps(&truth, &truth.packings(1000).unwrap());
    assert_below("volume", volume_errors(&truth, &overlaps), [0.13, 0.04, 0.015]);
    assert_below("direction", direction_errors(&truth, &overlaps), [6.0, 5.0, 6.0]);
    assert_hits(&truth, &overlaps);
}
