//! Energies and overlaps of the whole world.

use super::messages::{Metrics, Timings};
use crate::StepReport;
use rapier3d::dynamics::RigidBody;
use rapier3d::pipeline::PhysicsWorld;

/// Sums over the world after step `step`; bodies and contacts that are not finite are left out.
pub(super) fn metrics(world: &PhysicsWorld, report: &StepReport, step: u64) -> Metrics {
    let dynamic = || world.bodies.iter().map(|(_, body)| body).filter(|body| body.is_dynamic());
    let sum =
        |energy: &dyn Fn(&RigidBody) -> f64| -> f64 { dynamic().map(energy).filter(|e| e.is_finite()).sum() };
    let contacts = || super::contacts::finite_contacts(report).map(|(_, contact)| contact);
    Metrics {
        step,
        kinetic_energy: sum(&|body| body.kinetic_energy().into()),
        potential_energy: sum(&|body| potential_energy(world, body)),
        deepest_overlap: contacts().map(|contact| f64::from(contact.depth)).fold(0.0, f64::max),
        overlap_volume: contacts().map(|contact| f64::from(contact.volume)).sum(),
        contact_count: contacts().count() as u32,
        awake_bodies: dynamic().filter(|body| !body.is_sleeping()).count() as u32,
        timings: None,
    }
}

/// Potential energy in the world's gravity (J), zero at the origin.
fn potential_energy(world: &PhysicsWorld, body: &RigidBody) -> f64 {
    let gravity = (world.gravity * body.gravity_scale()).as_dvec3();
    -f64::from(body.mass()) * gravity.dot(body.center_of_mass().as_dvec3())
}

/// The wall times of a step.
pub(super) fn timings(report: &StepReport) -> Timings {
    let milliseconds = |seconds: f64| if seconds.is_finite() { seconds * 1e3 } else { 0.0 };
    Timings {
        query_ms: milliseconds(report.query_seconds),
        solve_ms: milliseconds(report.solve_seconds),
        step_ms: milliseconds(report.step_seconds),
    }
}
