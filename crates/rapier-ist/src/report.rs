//! What the plugin says about the contacts of a step.

use rapier3d::geometry::ColliderHandle;
use rapier3d::math::Vector;

/// All volume contacts of one step.
#[derive(Clone, Debug, Default)]
pub struct StepReport {
    /// One entry per pair of colliders that overlap, sorted by handles.
    pub contacts: Vec<PairContact>,
    /// Wall time of the overlap queries (s).
    pub query_seconds: f64,
    /// Wall time of the penalty solve (s).
    pub solve_seconds: f64,
    /// Wall time of the whole step, Rapier's part included (s).
    pub step_seconds: f64,
}

/// Contact between two overlapping colliders at the start of a step, world frame.
#[derive(Clone, Copy, Debug)]
pub struct PairContact {
    /// The collider with the smaller handle.
    pub collider_a: ColliderHandle,
    /// The other collider.
    pub collider_b: ColliderHandle,
    /// Overlap volume (m³).
    pub volume: f32,
    /// Penetration depth V/A of the deepest patch (m), with A the patch's cross-section.
    pub depth: f32,
    /// Centroid of the overlap (m).
    pub centroid: Vector,
    /// Mean force on B during the step (N).
    pub force: Vector,
    /// Mean torque on B about [`Self::centroid`] (N·m).
    pub torque: Vector,
    /// Velocity of B relative to A at the centroid before the step (m/s).
    pub relative_velocity: Vector,
}
