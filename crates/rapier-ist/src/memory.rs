//! What the plugin remembers of a pair from step to step.

use crate::penalty::{Impact, Screw};
use rapier3d::geometry::ColliderHandle;
use rapier3d::glamx::DVec3;
use std::collections::HashMap;

/// What was found out about a touching pair.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PairMemory {
    /// Sum of the normal forces as last solved (N): where the next solve begins.
    pub(crate) force: f64,
    /// What the pair has carried of late (N), see [`PairContacts::memory`](crate::penalty::PairContacts::memory).
    pub(crate) carried: f64,
    /// How the contact began, before the step.
    pub(crate) impact: Impact,
    /// The point (m, world frame) that impulses are about.
    pub(crate) origin: DVec3,
    /// The impulse that has stopped the bodies since, this step's included as last solved.
    pub(crate) impulse: Screw,
    /// The impulse of the rebound that was found in this step.
    pub(crate) rebound: Option<Screw>,
    /// Mean normal velocity as last solved (m/s).
    pub(crate) end: f64,
}

impl Default for PairMemory {
    /// Of a pair that did not touch.
    fn default() -> Self {
        Self {
            force: 0.0,
            carried: 0.0,
            impact: Impact::default(),
            origin: DVec3::ZERO,
            impulse: Screw::ZERO,
            rebound: None,
            end: f64::NEG_INFINITY,
        }
    }
}

impl PairMemory {
    /// The same with impulses about `origin` (m, world frame): a contact that is measured anew has its centroid elsewhere.
    pub(crate) fn about(self, origin: DVec3) -> Self {
        let moved = |impulse: Screw| impulse.wrench_from(self.origin - origin);
        Self {
            origin,
            impulse: moved(self.impulse),
            rebound: self.rebound.map(moved),
            impact: Impact { impulse: moved(self.impact.impulse), ..self.impact },
            ..self
        }
    }

    /// What is known of the pair at the beginning of the next step.
    pub(crate) fn next(self) -> Self {
        Self { impulse: self.impact.impulse, rebound: None, end: f64::NEG_INFINITY, ..self }
    }
}

/// All pairs that touch, by their handles.
pub(crate) type Memory = HashMap<[ColliderHandle; 2], PairMemory>;
