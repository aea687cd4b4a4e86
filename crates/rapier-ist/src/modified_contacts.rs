//! What the user's contact-modification hook made of a pair.
//!
//! Rapier asks the hook about its own manifolds, at its last detection: changes are felt a step later.

use crate::WorldParts;
use rapier3d::geometry::ColliderHandle;
use rapier3d::glamx::DVec3;
use rapier3d::math::{Real, Vector};
use rapier3d::pipeline::ActiveHooks;

/// Coefficients of a pair after the hook.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModifiedContacts {
    pub(crate) friction: Real,
    pub(crate) restitution: Real,
    /// Wanted velocity (m/s) of the second collider relative to the first, world frame.
    pub(crate) tangent_velocity: DVec3,
}

impl ModifiedContacts {
    /// `None` where no collider of the pair wants the hook, or Rapier has not found the pair yet.
    pub(crate) fn of(world: &WorldParts<'_>, [a, b]: [ColliderHandle; 2]) -> Option<Self> {
        let hooks = [a, b].map(|handle| world.colliders.get(handle).map(|c| c.active_hooks()));
        if !hooks.into_iter().flatten().any(|hooks| hooks.contains(ActiveHooks::MODIFY_SOLVER_CONTACTS)) {
            return None;
        }
        let pair = world.narrow_phase.contact_pair(a, b)?;
        // A pair has one law of friction here: that of the first manifold, and the mean of its contacts.
        let manifold = pair.solver_manifolds().iter().find(|m| !m.data.solver_contacts.is_empty())?;
        let contacts = &manifold.data.solver_contacts;
        let mean = contacts.iter().map(|c| c.tangent_velocity).sum::<Vector>() / contacts.len() as Real;
        let mean = if mean.is_finite() { mean.as_dvec3() } else { DVec3::ZERO };
        Some(Self {
            friction: manifold.data.friction,
            restitution: manifold.data.restitution,
            tangent_velocity: if pair.collider1 == a { mean } else { -mean },
        })
    }
}
