//! Keeping Rapier's own solver off the pairs that the penalty pushes apart.

use crate::{IstShape, WorldParts};
use rapier3d::geometry::{Collider, SolverFlags};
use rapier3d::pipeline::{ActiveHooks, ContactModificationContext, PairFilterContext, PhysicsHooks};

/// Marks colliders whose contact filter the plugin switched on, not the user. Rapier does not use this bit. It is part
/// of the collider, so it is saved with it, and a user who sets hooks of their own takes it away.
const BY_PLUGIN: ActiveHooks = ActiveHooks::from_bits_retain(1 << 31);

/// Marks manifolds that Rapier's solver must leave alone and that a hook of the user looks at: they are measured in full, those
/// without any flag are not. Rapier does not use this bit.
const LOOKED_AT: SolverFlags = SolverFlags::from_bits_retain(1 << 31);

/// Passes every call on to the user's hooks, then takes the forces off pairs that involve an [`IstShape`].
///
/// Rapier still detects those pairs and sends their collision events.
pub(crate) struct PenaltyHooks<'a> {
    pub(crate) user: &'a dyn PhysicsHooks,
}

impl PhysicsHooks for PenaltyHooks<'_> {
    fn filter_contact_pair(&self, context: &PairFilterContext) -> Option<SolverFlags> {
        let colliders = [context.collider1, context.collider2].map(|handle| context.colliders.get(handle));
        let colliders = || colliders.into_iter().flatten();
        let flags = if colliders().any(is_filtered_by_user) {
            self.user.filter_contact_pair(context)?
        } else {
            SolverFlags::default()
        };
        let is_looked_at =
            colliders().any(|c| c.active_hooks().contains(ActiveHooks::MODIFY_SOLVER_CONTACTS));
        Some(match (colliders().any(is_solid), is_looked_at) {
            (true, true) => LOOKED_AT,
            (true, false) => SolverFlags::empty(),
            (false, _) => flags,
        })
    }

    fn filter_intersection_pair(&self, context: &PairFilterContext) -> bool {
        self.user.filter_intersection_pair(context)
    }

    fn modify_solver_contacts(&self, context: &mut ContactModificationContext) {
        self.user.modify_solver_contacts(context);
    }
}

/// Whether the collider's shape is an inner sphere tree.
pub(crate) fn is_solid(collider: &Collider) -> bool {
    collider.shape().as_shape::<IstShape>().is_some()
}

/// Whether the user wants to be asked about the contacts of this collider.
pub(crate) fn is_filtered_by_user(collider: &Collider) -> bool {
    let hooks = collider.active_hooks();
    hooks.contains(ActiveHooks::FILTER_CONTACT_PAIRS) && !hooks.contains(BY_PLUGIN)
}

/// Rapier asks its hooks about a pair only where a collider wants that.
pub(crate) fn switch_filters_on(world: &mut WorldParts<'_>) {
    let without = |collider: &Collider| {
        is_solid(collider) && !collider.active_hooks().contains(ActiveHooks::FILTER_CONTACT_PAIRS)
    };
    change(world, without, |hooks| hooks | ActiveHooks::FILTER_CONTACT_PAIRS | BY_PLUGIN);
}

/// Takes back what [`switch_filters_on`] did.
pub(crate) fn switch_filters_off(world: &mut WorldParts<'_>) {
    let marked = |collider: &Collider| collider.active_hooks().contains(BY_PLUGIN);
    change(world, marked, |hooks| hooks.difference(ActiveHooks::FILTER_CONTACT_PAIRS | BY_PLUGIN));
}

fn change(
    world: &mut WorldParts<'_>,
    which: impl Fn(&Collider) -> bool,
    change: impl Fn(ActiveHooks) -> ActiveHooks,
) {
    // Only what changes is borrowed mutably: Rapier looks again at every collider that was.
    let handles: Vec<_> =
        world.colliders.iter().filter(|(_, c)| which(c)).map(|(handle, _)| handle).collect();
    for handle in handles {
        if let Some(collider) = world.colliders.get_mut(handle) {
            collider.set_active_hooks(change(collider.active_hooks()));
        }
    }
}
