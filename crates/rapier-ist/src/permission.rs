//! Whether Rapier and the user let two colliders touch.

use crate::WorldParts;
use crate::hooks::is_filtered_by_user;
use rapier3d::dynamics::{RigidBody, RigidBodyHandle, RigidBodyType};
use rapier3d::geometry::{Collider, ColliderHandle, SolverFlags};
use rapier3d::pipeline::{ActiveHooks, PairFilterContext, PhysicsHooks};

/// Everything that can forbid a contact in Rapier.
pub(crate) struct Permission<'a> {
    pub(crate) world: &'a WorldParts<'a>,
    pub(crate) hooks: &'a dyn PhysicsHooks,
}

/// A collider with its handle.
type Handled<'a> = (ColliderHandle, &'a Collider);

impl Permission<'_> {
    /// Whether two colliders, the one with the smaller handle first, may push each other.
    pub(crate) fn allows(&self, a: Handled<'_>, b: Handled<'_>) -> bool {
        let (parent_a, parent_b) = (a.1.parent(), b.1.parent());
        if parent_a.is_some() && parent_a == parent_b {
            return false;
        }
        let (body_a, body_b) = (self.body(parent_a), self.body(parent_b));
        let awake =
            |body: Option<&RigidBody>| body.is_some_and(|b| b.is_dynamic_or_kinematic() && !b.is_sleeping());
        let dynamic = |body: Option<&RigidBody>| body.is_some_and(RigidBody::is_dynamic);
        // Rapier hands a body's state on to its colliders during its step; the body itself knows now.
        let disabled = |body: Option<&RigidBody>| body.is_some_and(|body| !body.is_enabled());
        if disabled(body_a) || disabled(body_b) {
            return false;
        }
        let types = [body_a, body_b].map(|body| body.map_or(RigidBodyType::Fixed, RigidBody::body_type));
        let allows = |collider: &Collider| collider.active_collision_types().test(types[0], types[1]);
        (allows(a.1) || allows(b.1))
            && a.1.collision_groups().test(b.1.collision_groups())
            && a.1.solver_groups().test(b.1.solver_groups())
            && (dynamic(body_a) || dynamic(body_b))
            && (awake(body_a) || awake(body_b))
            && !self.joined_without_contacts(parent_a, parent_b)
            && self.user_allows(a, b)
            && self.user_leaves_contacts(a, b)
    }

    fn body(&self, handle: Option<RigidBodyHandle>) -> Option<&RigidBody> {
        self.world.bodies.get(handle?)
    }

    fn joined_without_contacts(&self, a: Option<RigidBodyHandle>, b: Option<RigidBodyHandle>) -> bool {
        let (Some(a), Some(b)) = (a, b) else { return false };
        let impulse =
            self.world.impulse_joints.joints_between(a, b).any(|(_, joint)| !joint.data.contacts_enabled());
        let multibody = self
            .world
            .multibody_joints
            .joint_between(a, b)
            .is_some_and(|(_, _, link)| !link.joint.data.contacts_enabled());
        impulse || multibody
    }

    fn user_allows(&self, a: Handled<'_>, b: Handled<'_>) -> bool {
        if !is_filtered_by_user(a.1) && !is_filtered_by_user(b.1) {
            return true;
        }
        let context = PairFilterContext {
            bodies: self.world.bodies,
            colliders: self.world.colliders,
            collider1: a.0,
            collider2: b.0,
            rigid_body1: a.1.parent(),
            rigid_body2: b.1.parent(),
        };
        let flags = self.hooks.filter_contact_pair(&context);
        flags.is_some_and(|flags| flags.contains(SolverFlags::COMPUTE_RIGID_IMPULSES))
    }

    /// Whether the user's hook has left any contacts of the pair when Rapier last asked it; where the user has no
    /// such hook, yes.
    ///
    /// The hook works on Rapier's manifolds, which are as old as the last detection. A pair that it has not
    /// seen yet is not pushed: a one-way platform would otherwise stop everything once.
    fn user_leaves_contacts(&self, a: Handled<'_>, b: Handled<'_>) -> bool {
        let hooks = a.1.active_hooks() | b.1.active_hooks();
        if !hooks.contains(ActiveHooks::MODIFY_SOLVER_CONTACTS) {
            return true;
        }
        let pair = self.world.narrow_phase.contact_pair(a.0, b.0);
        pair.is_some_and(|pair| pair.solver_manifolds().iter().any(|m| !m.data.solver_contacts.is_empty()))
    }
}
