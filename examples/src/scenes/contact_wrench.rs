//! What all volume contacts together did to a body.

use glam::DVec3;
use rapier_ist::IstPlugin;
use rapier3d::dynamics::RigidBodyHandle;
use rapier3d::pipeline::PhysicsWorld;

/// Force (N) and torque about the origin of its frame (N·m) of the contacts on `body` in the last step, world frame.
pub(super) fn contact_wrench(
    world: &PhysicsWorld,
    plugin: &IstPlugin,
    body: RigidBodyHandle,
) -> (DVec3, DVec3) {
    let place = world.bodies[body].translation();
    let (mut force, mut torque) = (DVec3::ZERO, DVec3::ZERO);
    for contact in &plugin.report().contacts {
        for (collider, sign) in [(contact.collider_a, -1.0), (contact.collider_b, 1.0)] {
            if world.colliders[collider].parent() == Some(body) {
                let moment = (contact.centroid - place).cross(contact.force) + contact.torque;
                force += contact.force.as_dvec3() * sign;
                torque += moment.as_dvec3() * sign;
            }
        }
    }
    (force, torque)
}
