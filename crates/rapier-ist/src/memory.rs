//! What the plugin remembers of a pair from step to step.

use crate::penalty::Impact;
use rapier3d::geometry::ColliderHandle;
use std::collections::HashMap;

/// What was found out about a touching pair.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PairMemory {
    /// Sum of the normal forces as last solved (N): where the next solve begins.
    pub(crate) force: f64,
    pub(crate) impact: Impact,
    /// Mean normal velocity as last solved (m/s).
    pub(crate) end: f64,
}

/// All pairs that touch, by their handles.
pub(crate) type Memory = HashMap<[ColliderHandle; 2], PairMemory>;
