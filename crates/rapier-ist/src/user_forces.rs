//! Contact forces on bodies during Rapier's step.

use crate::WorldParts;
use crate::links::apply_impulses;
use crate::penalty::Screw;
use rapier3d::dynamics::{MultibodyIndex, MultibodyLinkId, RigidBody, RigidBodyHandle};
use rapier3d::math::Vector;

/// What the contacts do to one body in a step, about its centre of mass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BodyForce {
    pub(crate) handle: RigidBodyHandle,
    /// Mean contact force (N) and torque (N·m).
    pub(crate) contact: Screw,
    /// What else acts on the body: gravity, the user's own force and torque, joints.
    pub(crate) held: Screw,
    /// The link of a multibody that the body is.
    pub(crate) link: Option<MultibodyLinkId>,
}

/// Gives links their impulses; returns the multibodies where that could be done.
fn push_links(world: &mut WorldParts<'_>, forces: &[BodyForce]) -> Vec<MultibodyIndex> {
    let dt = f64::from(world.integration_parameters.dt);
    let mut of_multibodies: Vec<(MultibodyIndex, Vec<(usize, Screw)>)> = Vec::new();
    for BodyForce { contact, held, link, .. } in forces {
        let Some(link) = link else { continue };
        let impulse = (link.id, (*contact + *held) * dt);
        match of_multibodies.iter_mut().find(|(index, _)| *index == link.multibody) {
            Some((_, impulses)) => impulses.push(impulse),
            None => of_multibodies.push((link.multibody, vec![impulse])),
        }
    }
    let push = |(index, impulses): (MultibodyIndex, Vec<(usize, Screw)>)| {
        let multibody = world.multibody_joints.get_multibody_mut_internal(index)?;
        apply_impulses(multibody, &impulses).then_some(index)
    };
    of_multibodies.into_iter().filter_map(push).collect()
}

/// The user's own forces and torques on the bodies that contacts act on.
pub(crate) struct UserForces(Vec<(RigidBodyHandle, Vector, Vector)>);

impl UserForces {
    /// Gives every body its final velocity now and holds it against gravity, the user's forces and joints during the step.
    ///
    /// The solve is for a body that moves at its final velocity through the whole step. Rapier moves bodies in
    /// substeps and adds external forces bit by bit, so an impulse alone would lift a resting body before gravity
    /// brings it down again, and a force alone would let an arriving body move on through the contact.
    pub(crate) fn suspend(world: &mut WorldParts<'_>, forces: Vec<BodyForce>) -> Self {
        let dt = world.integration_parameters.dt;
        let mut before = Vec::with_capacity(forces.len());
        let in_one_step = push_links(world, &forces);
        for BodyForce { handle, contact, held, link } in forces {
            let Some(body) = world.bodies.get_mut(handle) else { continue };
            before.push((handle, body.user_force(), body.user_torque()));
            if let Some(link) = link {
                let force = if in_one_step.contains(&link.multibody) { -held } else { contact };
                body.add_force(force.linear.as_vec3(), false);
                body.add_torque(force.angular.as_vec3(), false);
                continue;
            }
            let impulse = (contact + held) * f64::from(dt);
            body.apply_impulse(impulse.linear.as_vec3(), false);
            body.apply_torque_impulse(impulse.angular.as_vec3(), false);
            body.add_force(-held.linear.as_vec3(), false);
            body.add_torque(-held.angular.as_vec3(), false);
        }
        Self(before)
    }

    /// Gives the user's forces back, bit for bit.
    pub(crate) fn restore(self, world: &mut WorldParts<'_>) {
        for (handle, force, torque) in self.0 {
            // What Rapier took out of the simulation in this step has lost its forces by that.
            let enabled = |body: &&mut RigidBody| body.is_enabled();
            let Some(body) = world.bodies.get_mut(handle).filter(enabled) else { continue };
            body.reset_forces(false);
            body.reset_torques(false);
            body.add_force(force, false);
            body.add_torque(torque, false);
        }
    }
}
