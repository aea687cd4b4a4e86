//! Where equally large balls fit anywhere, they are placed close to each other.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

mod common;

use glam::DVec3;
use packer::{PackOptions, Solid, pack};
use std::f64::consts::PI;

/// How many balls of nearly the largest radius are in the solid.
fn largest_balls(solid: &Solid, share: f64) -> usize {
    let packed = pack(solid, &PackOptions::fast().spheres(400)).unwrap();
    let least = share * packed.report.radius_max;
    packed.packing.spheres().iter().filter(|s| f64::from(s.radius) >= least).count()
}

#[test]
fn a_ring_holds_a_row_of_touching_balls() {
    // Balls of radius r that touch each other on a circle of radius R stand 2·asin(r/R) apart.
    for (minor, sides) in [(0.3_f64, 96), (0.12, 128), (0.07, 160)] {
        let solid = Solid::new(&common::torus(1.0, minor, sides)).unwrap();
        let full = (PI / minor.asin()).floor() as usize;
        let count = largest_balls(&solid, 0.95);
        // A random row would end at three quarters.
        assert!(count + 1 >= full, "{count} of {full} balls of radius {minor}");
    }
}

#[test]
fn a_plate_holds_rows_of_touching_balls() {
    let extent = DVec3::new(12.0, 9.0, 1.0);
    let solid = Solid::new(&common::cuboid(DVec3::ZERO, extent)).unwrap();
    let share = largest_balls(&solid, 0.98) as f64 * 0.25 * PI / (extent.x * extent.y);
    // Discs put down at random cover 0.547 of a plane, hexagons of them 0.907.
    assert!(share > 0.7, "{share}");
}
