//! Recording poses asks for no memory once its buffers have grown.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use rapier_ist::StepReport;
use rapier_ist::record::{BodyDescription, RecordOptions, Recorder};
use rapier3d::prelude::*;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;
use std::io::Cursor;

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

const BODIES: usize = 100;
const STEPS: usize = 500;
/// Steps until every buffer has been used, also that of the compressed bytes.
const WARM_UP: usize = 200;

#[test]
fn poses_are_recorded_without_allocations() {
    let mut world = PhysicsWorld::new();
    for index in 0..BODIES {
        world.insert_body(
            RigidBodyBuilder::dynamic().translation(Vector::X * index as f32).additional_mass(1.0),
        );
    }
    // No chunk ends within the steps that are counted: then the file is written, and that is the mcap crate's.
    let options = RecordOptions::poses().chunk_size(u64::MAX);
    let mut recorder = Recorder::new(Cursor::new(Vec::new()), options).unwrap();
    recorder.add_bodies(&world, |handle, _| Some(BodyDescription::new(handle, "body"))).unwrap();
    let report = StepReport::default();
    for _ in 0..WARM_UP {
        world.step();
        recorder.record(&world, &report).unwrap();
    }
    let region = Region::new(ALLOCATOR);
    for _ in 0..STEPS {
        recorder.record(&world, &report).unwrap();
    }
    let change = region.change();
    assert_eq!(change.allocations, 0, "{change:?}");
    // The chunk and its index grow by doubling.
    assert!(change.reallocations <= 2 * STEPS.ilog2() as usize, "{change:?}");
    assert_eq!(recorder.finish().unwrap().steps, (STEPS + WARM_UP) as u64);
}
