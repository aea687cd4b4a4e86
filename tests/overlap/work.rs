//! Net work around closed loops of poses: none under a conservative law.
//!
//! B goes once around and comes back. Over a step by dx of its point at the overlap's centroid and by dθ, the force f and the
//! torque τ about that centroid do the work f·dx + τ·dθ; both are taken in the middle of the step.

use super::{size, trees};
use glam::{DQuat, DVec3};
use glamx::Pose3;
use ist::{ForceLaw, InnerSphereTree, OverlapQuery, OverlapWorkspace};
use std::f64::consts::TAU;

/// A loop of B's poses, with time from 0 to 1.
struct Loop {
    name: &'static str,
    /// Centroid of B against that of A, in sizes of A.
    offset: fn(f64) -> DVec3,
    /// Orientation of B; may end at the negative quaternion it began with.
    turn: fn(f64) -> DQuat,
}

const LOOPS: [Loop; 4] = [
    Loop { name: "translation", offset: round, turn: |_| DQuat::from_rotation_y(0.4) },
    Loop { name: "a full turn", offset: |_| DVec3::new(0.6, 0.2, 0.1), turn: whole_turn },
    Loop { name: "both", offset: round, turn: whole_turn },
    Loop { name: "in and out of contact", offset: |t| round(t) * 3.0, turn: wobble },
];

fn round(t: f64) -> DVec3 {
    let (sin, cos) = (TAU * t).sin_cos();
    DVec3::new(0.3 + 0.5 * cos, 0.6 * sin, 0.4 * (2.0 * TAU * t).sin())
}

fn whole_turn(t: f64) -> DQuat {
    DQuat::from_axis_angle(DVec3::new(0.36, 0.48, 0.8), TAU * t) * DQuat::from_rotation_x(0.7)
}

fn wobble(t: f64) -> DQuat {
    DQuat::from_scaled_axis(DVec3::new((TAU * t).sin(), 0.7 * (TAU * t).cos(), 0.5))
}

/// Sums over a loop (J for 1 N/m³).
struct Work {
    net: f64,
    absolute: f64,
}

impl Loop {
    /// Rotation of B, and place of its centroid, in A's frame.
    fn at(&self, [a, _]: [&InnerSphereTree; 2], t: f64) -> (DQuat, DVec3) {
        ((self.turn)(t), a.solid().centroid + size(a) * (self.offset)(t))
    }

    /// Work from the beginning of the loop to the time `end`.
    fn work(&self, [a, b]: [&InnerSphereTree; 2], law: ForceLaw, end: f64, steps: u32) -> Work {
        let query = OverlapQuery { law, ..OverlapQuery::default() };
        let (mut workspace, mut work) = (OverlapWorkspace::default(), Work { net: 0.0, absolute: 0.0 });
        for step in 0..steps {
            let time = |part: f64| end * (f64::from(step) + part) / f64::from(steps);
            let [begin, middle, after] = [0.0, 0.5, 1.0].map(|part| self.at([a, b], time(part)));
            let (rotation, place) = middle;
            let translation = place - rotation * b.solid().centroid;
            let pose = Pose3::from_parts(translation.as_vec3(), rotation.as_quat());
            let overlap = a.overlap_with(b, &pose, query, &mut workspace);
            let turned = (after.0 * begin.0.inverse()).to_scaled_axis();
            let moved = after.1 - begin.1 + turned.cross(overlap.centroid.as_dvec3() - place);
            let done = overlap.force.as_dvec3().dot(moved) + overlap.torque.as_dvec3().dot(turned);
            work.net += done;
            work.absolute += done.abs();
        }
        work
    }
}

#[test]
fn closed_loops_do_no_net_work() {
    for assets in [["bunny", "bunny"], ["spider_gear", "pinion_gear"]] {
        let [a, b] = trees(assets, 1.0, 300);
        for path in &LOOPS {
            let share = |law, steps| {
                let work = path.work([&a, &b], law, 1.0, steps);
                assert!(work.absolute > 1e-4 * a.solid().volume, "nothing happens on this loop");
                work.net.abs() / work.absolute
            };
            let [coarse, fine] = [200, 2_000].map(|steps| share(ForceLaw::VolumeGradient, steps));
            let others = [ForceLaw::Blended, ForceLaw::OutwardNormals].map(|law| share(law, 2_000));
            println!(
                "{assets:?}, {}: net work over absolute {coarse:.1e} with 200 steps, {fine:.1e} with 2,000; \
                 blended {:.1e}, normals {:.1e}",
                path.name, others[0], others[1]
            );
            // The midpoint rule is of second order, and forces have kinks where spheres begin to touch.
            assert!(fine < 1e-4, "{fine}");
            assert!(fine < 0.1 * coarse || fine < 1e-6, "{coarse} {fine}");
        }
    }
}

/// Work from the start of a loop to anywhere on it is the volume lost: V is the potential energy.
#[test]
fn work_is_the_volume_lost() {
    for assets in [["bunny", "bunny"], ["spider_gear", "pinion_gear"]] {
        let [a, b] = trees(assets, 1.0, 300);
        for path in &LOOPS {
            let volume = |t| {
                let (rotation, place) = path.at([&a, &b], t);
                let translation = place - rotation * b.solid().centroid;
                ist::reference::overlap_at(&a, &b, rotation, translation).volume
            };
            for end in [0.2, 0.45, 0.7] {
                let work = path.work([&a, &b], ForceLaw::VolumeGradient, end, 1_000);
                let lost = volume(0.0) - volume(end);
                let error = (work.net - lost).abs() / work.absolute;
                assert!(error < 1e-3, "{} until {end}: {} {lost}", path.name, work.net);
            }
        }
    }
}
