//! Where equally large balls fit anywhere, they are placed close to each other.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests fail by panicking")]

mod common;

use glam::{DQuat, DVec3, EulerRot};
use packer::{PackOptions, Solid, TriangleMesh, pack};
use std::f64::consts::PI;
use std::time::Duration;

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

/// The search went through all places of a plate before it placed the first ball: a minute for this one, and a hundred
/// times as long for one a tenth as thick.
#[test]
fn issue_a_thin_plate_does_not_keep_its_first_balls_waiting() {
    for thickness in [1e-3, 1e-4, 3e-5] {
        let plate = common::cuboid(DVec3::ZERO, DVec3::new(1.0, 1.0, thickness));
        // Oblique: the box around it is no thinner than it is wide.
        let turn = DQuat::from_euler(EulerRot::XYZ, 0.5, 0.4, 0.3);
        let vertices = plate.vertices.iter().map(|v| turn * *v).collect();
        let solid = Solid::new(&TriangleMesh { vertices, ..plate }).unwrap();
        let (done, receiver) = std::sync::mpsc::channel();
        let thread = std::thread::spawn(move || {
            let _ = done.send(pack(&solid, &PackOptions::fast().spheres(50)).map(|packed| packed.packing));
        });
        let packing = receiver.recv_timeout(Duration::from_secs(60)).expect("the plate hangs").unwrap();
        thread.join().unwrap();
        assert_eq!(packing.spheres().len(), 50);
        let radius = f64::from(packing.spheres()[0].radius);
        assert!((2.0 * radius / thickness - 1.0).abs() < 1e-2, "{radius} in a plate of {thickness}");
    }
}
