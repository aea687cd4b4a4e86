//! Keeping Rapier's own solver off the pairs that the penalty pushes apart.

use crate::IstShape;
use rapier3d::geometry::{ColliderHandle, SolverFlags};
use rapier3d::pipeline::{ActiveHooks, ContactModificationContext, PairFilterContext, PhysicsHooks};
use std::collections::HashSet;

/// Passes every call on to the user's hooks, then takes the forces off pairs that involve an [`IstShape`].
///
/// Rapier still detects those pairs and sends their collision events.
pub(crate) struct PenaltyHooks<'a> {
    pub(crate) user: &'a dyn PhysicsHooks,
    /// Colliders whose contact filter was switched on by the plugin and not by the user.
    pub(crate) switched_on: &'a HashSet<ColliderHandle>,
}

impl PhysicsHooks for PenaltyHooks<'_> {
    fn filter_contact_pair(&self, context: &PairFilterContext) -> Option<SolverFlags> {
        let handles = [context.collider1, context.collider2];
        let wanted_by_user = handles.into_iter().any(|handle| {
            let hooks = context.colliders.get(handle).map_or(ActiveHooks::empty(), |c| c.active_hooks());
            hooks.contains(ActiveHooks::FILTER_CONTACT_PAIRS) && !self.switched_on.contains(&handle)
        });
        let flags =
            if wanted_by_user { self.user.filter_contact_pair(context)? } else { SolverFlags::default() };
        let solid = |handle| {
            context.colliders.get(handle).is_some_and(|c| c.shape().as_shape::<IstShape>().is_some())
        };
        if handles.into_iter().any(solid) { Some(SolverFlags::empty()) } else { Some(flags) }
    }

    fn filter_intersection_pair(&self, context: &PairFilterContext) -> bool {
        self.user.filter_intersection_pair(context)
    }

    fn modify_solver_contacts(&self, context: &mut ContactModificationContext) {
        self.user.modify_solver_contacts(context);
    }
}
