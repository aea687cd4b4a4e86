//! Contacts and energies of a recorded step.

use crate::record::messages::{Contact, Metrics, Patch};
use foxglove::messages::Vector3;
use rapier3d::math::Vector;

/// Contact between two overlapping bodies, world frame.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct ReplayContact {
    /// Places of the bodies in [`super::Replay::bodies`]; `None` for one that was not described.
    pub bodies: [Option<usize>; 2],
    /// Overlap volume (m³).
    pub volume: f32,
    /// Penetration depth of the deepest patch (m).
    pub depth: f32,
    /// Centroid of the overlap (m).
    pub centroid: Vector,
    /// Mean force on the second body during the step (N).
    pub force: Vector,
    /// Mean torque on the second body about the centroid (N·m).
    pub torque: Vector,
    /// Velocity of the second body relative to the first at the centroid before the step (m/s).
    pub relative_velocity: Vector,
    /// The parts of the contact that push in about the same direction.
    pub patches: Vec<ReplayPatch>,
}

/// The part of a contact that pushes in about the same direction, world frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct ReplayPatch {
    /// Overlap volume (m³).
    pub volume: f32,
    /// Penetration depth (m).
    pub depth: f32,
    /// Centroid of this part of the overlap (m).
    pub centroid: Vector,
    /// Mean force on the second body during the step (N).
    pub force: Vector,
    /// Mean torque on the second body about the centroid (N·m).
    pub torque: Vector,
    /// Velocity of the second body relative to the first at the centroid before the step (m/s).
    pub relative_velocity: Vector,
}

/// Sums over the world after a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct ReplayMetrics {
    /// Number of the step, counted from 1.
    pub step: u64,
    /// Kinetic energy of the dynamic bodies (J).
    pub kinetic_energy: f64,
    /// Their potential energy in the world's gravity (J), zero at the origin.
    pub potential_energy: f64,
    /// Largest penetration depth of a contact (m).
    pub deepest_overlap: f64,
    /// Overlap volume of all contacts (m³).
    pub overlap_volume: f64,
    /// Number of contacts.
    pub contact_count: u32,
    /// Number of dynamic bodies that are not asleep.
    pub awake_bodies: u32,
    /// Wall times, if they were recorded.
    pub timings: Option<ReplayTimings>,
}

/// Wall times of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct ReplayTimings {
    /// Of the overlap queries (s).
    pub query_seconds: f64,
    /// Of the penalty solve (s).
    pub solve_seconds: f64,
    /// Of the whole step (s).
    pub step_seconds: f64,
}

/// The contact as it was written; `body` finds bodies by name.
pub(super) fn contact(contact: &Contact, body: impl Fn(&str) -> Option<usize>) -> ReplayContact {
    ReplayContact {
        bodies: [body(&contact.body_a), body(&contact.body_b)],
        volume: contact.volume as f32,
        depth: contact.depth as f32,
        centroid: vector(contact.centroid.as_ref()),
        force: vector(contact.force.as_ref()),
        torque: vector(contact.torque.as_ref()),
        relative_velocity: vector(contact.relative_velocity.as_ref()),
        patches: contact.patches.iter().map(patch).collect(),
    }
}

fn patch(patch: &Patch) -> ReplayPatch {
    ReplayPatch {
        volume: patch.volume as f32,
        depth: patch.depth as f32,
        centroid: vector(patch.centroid.as_ref()),
        force: vector(patch.force.as_ref()),
        torque: vector(patch.torque.as_ref()),
        relative_velocity: vector(patch.relative_velocity.as_ref()),
    }
}

pub(super) fn metrics(metrics: &Metrics) -> ReplayMetrics {
    let timings = metrics.timings.as_ref().map(|timings| ReplayTimings {
        query_seconds: timings.query_ms * 1e-3,
        solve_seconds: timings.solve_ms * 1e-3,
        step_seconds: timings.step_ms * 1e-3,
    });
    ReplayMetrics {
        step: metrics.step,
        kinetic_energy: metrics.kinetic_energy,
        potential_energy: metrics.potential_energy,
        deepest_overlap: metrics.deepest_overlap,
        overlap_volume: metrics.overlap_volume,
        contact_count: metrics.contact_count,
        awake_bodies: metrics.awake_bodies,
        timings,
    }
}

/// A vector that is not there is zero: protobuf leaves out what is at its default.
pub(super) fn vector(v: Option<&Vector3>) -> Vector {
    v.map_or(Vector::ZERO, |v| Vector::new(v.x as f32, v.y as f32, v.z as f32))
}
