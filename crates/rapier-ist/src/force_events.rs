//! Contact-force events of the pairs that the penalty pushes apart.
//!
//! Rapier sends these events from the impulses of its own solver, which are zero for such pairs. Its event handlers
//! get a [`ContactPair`], so the patches of the report are written into one: a manifold with one point per patch. As in Rapier's
//! own, the impulse is that along the normal, and friction stands beside it.

use crate::report::key;
use crate::touching::asleep;
use crate::{PairContact, PatchContact, StepReport, WorldParts};
use rapier3d::dynamics::RigidBodyBuilder;
use rapier3d::geometry::{
    Collider, ColliderBuilder, ColliderHandle, ContactManifold, ContactPair, PairContacts,
};
use rapier3d::math::{Real, TangentImpulse, Vector};
use rapier3d::parry::query::TrackedContact;
use rapier3d::parry::shape::PackedFeatureId;
use rapier3d::pipeline::{ActiveEvents, EventHandler, PhysicsWorld};
use rapier3d::utils::OrthonormalBasis;
use std::fmt;

/// Sends the events and remembers which pairs were above their threshold.
#[derive(Clone, Default)]
pub(crate) struct ForceEvents {
    /// Sorted by handles.
    above: Vec<[ColliderHandle; 2]>,
    /// A pair that has been above its threshold before; Rapier lets nobody else make one.
    ongoing: Option<ContactPair>,
}

impl ForceEvents {
    /// Tells `events` of every pair in `report` whose forces exceed the lower threshold of its colliders. Not for a step without
    /// length, of which the report knows nothing.
    pub(crate) fn send(&mut self, world: &WorldParts<'_>, report: &StepReport, events: &dyn EventHandler) {
        let dt = world.integration_parameters.dt;
        let mut above = Vec::new();
        for (index, contact) in report.contacts.iter().enumerate() {
            let Some(threshold) = threshold(world, contact) else { continue };
            let patches = report.patches_of(index);
            let magnitude: Real = patches.iter().map(PatchContact::normal_force).sum();
            if magnitude > threshold {
                let started = !self.was_above(contact);
                let pair = contact_pair(world, contact, patches, self.blank(started));
                events.handle_contact_force_event(dt, world.bodies, world.colliders, &pair, magnitude);
                above.push(contact.colliders());
            }
        }
        // Of sleeping pairs the report says nothing; they go on where they stood.
        self.above.retain(|pair| asleep(world, *pair));
        self.above.append(&mut above);
        self.above.sort_unstable_by_key(|pair| key(*pair));
        self.above.dedup();
    }

    fn was_above(&self, contact: &PairContact) -> bool {
        self.above.binary_search_by_key(&key(contact.colliders()), |pair| key(*pair)).is_ok()
    }

    fn blank(&mut self, started: bool) -> ContactPair {
        if started {
            return ContactPair::default();
        }
        self.ongoing.get_or_insert_with(ongoing_pair).clone()
    }
}

impl fmt::Debug for ForceEvents {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ForceEvents").field("above", &self.above).finish_non_exhaustive()
    }
}

/// The lower threshold (N) of the colliders that ask for events, as in Rapier.
fn threshold(world: &WorldParts<'_>, contact: &PairContact) -> Option<Real> {
    let wanted = |collider: &&Collider| collider.active_events().contains(ActiveEvents::CONTACT_FORCE_EVENTS);
    let colliders = contact.colliders().into_iter().filter_map(|handle| world.colliders.get(handle));
    colliders.filter(wanted).map(Collider::contact_force_event_threshold).reduce(Real::min)
}

/// `blank`, made to tell about `contact`.
fn contact_pair(
    world: &WorldParts<'_>,
    contact: &PairContact,
    patches: &[PatchContact],
    blank: ContactPair,
) -> ContactPair {
    let dt = world.integration_parameters.dt;
    let poses = contact.colliders().map(|handle| world.colliders.get(handle).map(|c| *c.position()));
    let [pose_a, pose_b] = poses.map(Option::unwrap_or_default);
    let manifold = |patch: &PatchContact| {
        let normal = patch.normal;
        let half = normal * (0.5 * patch.depth);
        let point = TrackedContact::new(
            pose_a.inverse_transform_point(patch.centroid + half),
            pose_b.inverse_transform_point(patch.centroid - half),
            PackedFeatureId::UNKNOWN,
            PackedFeatureId::UNKNOWN,
            -patch.depth,
        );
        let mut manifold = ContactManifold::new();
        manifold.local_n1 = pose_a.rotation.inverse() * normal;
        manifold.local_n2 = -(pose_b.rotation.inverse() * normal);
        manifold.data.normal = normal;
        manifold.points.push(point);
        manifold.points[0].data.impulse = patch.normal_force() * dt;
        manifold.points[0].data.tangent_impulse = tangent_impulse(normal, -patch.force * dt);
        manifold
    };
    let mut pair = blank;
    pair.collider1 = contact.collider_a;
    pair.collider2 = contact.collider_b;
    if let PairContacts::Rigid(rigid) = &mut pair.contacts {
        rigid.solver_clusters.clear();
        rigid.manifolds = patches.iter().map(manifold).collect();
    }
    pair
}

/// What of an impulse on the first body is across the normal, along the tangents that Rapier's solver takes: they belong to the
/// direction that pushes the first body.
fn tangent_impulse(normal: Vector, impulse: Vector) -> TangentImpulse<Real> {
    let tangent = (-normal).orthonormal_vector();
    TangentImpulse::new(impulse.dot(tangent), impulse.dot((-normal).cross(tangent)))
}

/// A pair that Rapier has sent a force event for: two balls pressed together for a step.
fn ongoing_pair() -> ContactPair {
    let mut world = PhysicsWorld { gravity: Vector::ZERO, ..PhysicsWorld::new() };
    let ball = || ColliderBuilder::ball(1.0).active_events(ActiveEvents::CONTACT_FORCE_EVENTS);
    let (_, fixed) = world.insert(RigidBodyBuilder::fixed(), ball());
    let pressed = RigidBodyBuilder::dynamic().translation(Vector::Y * 1.9).linvel(-Vector::Y);
    let (_, pressed) = world.insert(pressed, ball());
    world.step();
    world.narrow_phase.contact_pair(fixed, pressed).cloned().unwrap_or_default()
}
