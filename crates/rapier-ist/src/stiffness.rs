//! Which stiffness a pair of colliders has.

use rapier3d::dynamics::{RigidBodyHandle, RigidBodySet};
use rapier3d::geometry::{ColliderHandle, ColliderSet};
use rapier3d::math::Real;
use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

/// A pair of colliders that overlap or are about to, as [`crate::IstPlugin::set_pair_stiffness`] sees it.
#[non_exhaustive]
#[derive(Clone, Copy)]
pub struct StiffnessContext<'a> {
    /// All bodies, before the step.
    pub bodies: &'a RigidBodySet,
    /// All colliders, before the step.
    pub colliders: &'a ColliderSet,
    /// The collider with the smaller handle.
    pub collider_a: ColliderHandle,
    /// The other collider.
    pub collider_b: ColliderHandle,
    /// The body of [`Self::collider_a`], if it has one.
    pub body_a: Option<RigidBodyHandle>,
    /// The body of [`Self::collider_b`], if it has one.
    pub body_b: Option<RigidBodyHandle>,
    /// Overlap volume at the poses of the solve, which lie in the step (m³).
    pub volume: Real,
    /// What the pair has without the callback (N/m³).
    pub stiffness: Real,
}

type PairLaw = dyn Fn(&StiffnessContext<'_>) -> Real + Send + Sync;

/// Stiffness of colliders and pairs that differ from the model's.
#[derive(Clone, Default)]
pub(crate) struct StiffnessTable {
    colliders: HashMap<ColliderHandle, f64>,
    law: Option<Arc<PairLaw>>,
}

impl StiffnessTable {
    /// Colliders that have one of their own.
    pub(crate) fn len(&self) -> usize {
        self.colliders.len()
    }

    pub(crate) fn set_collider(&mut self, collider: ColliderHandle, stiffness: Option<Real>) {
        match stiffness {
            Some(stiffness) => self.colliders.insert(collider, valid(stiffness)),
            None => self.colliders.remove(&collider),
        };
    }

    pub(crate) fn collider(&self, collider: ColliderHandle) -> Option<Real> {
        self.colliders.get(&collider).map(|&stiffness| stiffness as Real)
    }

    pub(crate) fn set_law(&mut self, law: Option<Arc<PairLaw>>) {
        self.law = law;
    }

    /// Forgets colliders that are gone.
    pub(crate) fn retain_existing(&mut self, colliders: &ColliderSet) {
        self.colliders.retain(|&handle, _| colliders.contains(handle));
    }

    /// Stiffness (N/m³) of two colliders of their own: that of springs in series, as each gives way by itself.
    /// A collider without one beside a collider with one does not give way.
    pub(crate) fn of_colliders(&self, colliders: [ColliderHandle; 2]) -> Option<f64> {
        match colliders.map(|collider| self.colliders.get(&collider).copied()) {
            [Some(a), Some(b)] => Some(if a + b > 0.0 { a * b / (a + b) } else { 0.0 }),
            [a, b] => a.or(b),
        }
    }

    /// What the user's callback makes of `stiffness`, without one `stiffness` itself.
    pub(crate) fn of_pair<'a>(
        &self,
        stiffness: f64,
        context: impl FnOnce(Real) -> StiffnessContext<'a>,
    ) -> f64 {
        self.law.as_ref().map_or(stiffness, |law| valid(law(&context(stiffness as Real))))
    }
}

impl fmt::Debug for StiffnessTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("StiffnessTable")
            .field("colliders", &self.colliders)
            .field("law", &self.law.is_some())
            .finish()
    }
}

/// A stiffness that the solve can work with: NaN and negative values count as zero, infinity as the largest number.
pub(crate) fn valid(stiffness: Real) -> f64 {
    f64::from(stiffness.clamp(0.0, Real::MAX).max(0.0))
}
