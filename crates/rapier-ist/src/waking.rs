//! Waking bodies that something touches.

use crate::WorldParts;
use crate::query::Contact;
use rapier3d::dynamics::RigidBody;
use rapier3d::geometry::Collider;
use rapier3d::math::Real;

/// Speed (m/s, times `length_unit`) of a contact point from which on it wakes a sleeping body.
const WAKE_SPEED: f64 = 0.05;

/// Wakes sleeping bodies that something moving touches.
pub(crate) fn wake_touched_bodies(world: &mut WorldParts<'_>, contacts: &[Option<Contact>]) {
    let speed = WAKE_SPEED as Real * world.integration_parameters.length_unit;
    for contact in contacts.iter().flatten() {
        let parents =
            contact.candidate.colliders.map(|handle| world.colliders.get(handle).and_then(Collider::parent));
        let body = |i: usize| parents[i].and_then(|handle| world.bodies.get(handle));
        let asleep = |i: usize| body(i).is_some_and(|b| b.is_dynamic() && b.is_sleeping());
        let Some(sleeper) = (0..2).find(|&i| asleep(i)) else { continue };
        let moving = |b: &RigidBody| {
            !b.is_sleeping() && b.velocity_at_point(contact.samples[0].point).length() > speed
        };
        if let (true, Some(handle)) = (body(1 - sleeper).is_some_and(moving), parents[sleeper]) {
            world.islands.wake_up(world.bodies, handle, true);
        }
    }
}
