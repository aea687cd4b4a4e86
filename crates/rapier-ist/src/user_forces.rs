//! Contact forces on bodies during Rapier's step.

use crate::WorldParts;
use crate::links::apply_impulses;
use crate::penalty::{RowKind, Screw};
use rapier3d::dynamics::{
    ImpulseJointHandle, JointAxesMask, MultibodyIndex, MultibodyLinkId, RigidBody, RigidBodyHandle,
};
use rapier3d::math::{Real, Vector};

/// What contacts and joints do to one body in a step, about its centre of mass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BodyForce {
    pub(crate) handle: RigidBodyHandle,
    /// Mean force (N) and torque (N·m) of contacts.
    pub(crate) contact: Screw,
    /// The same of joints, and of Rapier's contacts, but for what is in `held`.
    pub(crate) joints: Screw,
    /// What else acts on the body, and what Rapier's step does once more: gravity, the user's own force and torque, springs, the motors of
    /// multibodies.
    pub(crate) held: Screw,
    /// The link of a multibody that the body is.
    pub(crate) link: Option<MultibodyLinkId>,
}

/// What contacts and joints do in a step.
#[derive(Debug, Default)]
pub(crate) struct Pushes {
    pub(crate) bodies: Vec<BodyForce>,
    pub(crate) joints: Vec<JointForce>,
}

/// What a joint has done already to bodies that have their final velocities.
#[derive(Debug)]
pub(crate) struct JointForce {
    pub(crate) handle: ImpulseJointHandle,
    /// Forces on the second body (N, N·m).
    pub(crate) rows: Vec<(RowKind, f64)>,
}

/// Gives links their impulses; returns the multibodies where that could be done.
fn push_links(world: &mut WorldParts<'_>, forces: &[BodyForce]) -> Vec<MultibodyIndex> {
    let dt = f64::from(world.integration_parameters.dt);
    let mut of_multibodies: Vec<(MultibodyIndex, Vec<(usize, Screw)>)> = Vec::new();
    for BodyForce { contact, joints, held, link, .. } in forces {
        let Some(link) = link else { continue };
        let impulse = (link.id, (*contact + *joints + *held) * dt);
        match of_multibodies.iter_mut().find(|(index, _)| *index == link.multibody) {
            Some((_, impulses)) => impulses.push(impulse),
            None => of_multibodies.push((link.multibody, vec![impulse])),
        }
    }
    let push = |(index, impulses): (MultibodyIndex, Vec<(usize, Screw)>)| {
        let multibody = world.multibody_joints.get_multibody_mut_internal(index)?;
        apply_impulses(multibody, world.bodies, &impulses).then_some(index)
    };
    of_multibodies.into_iter().filter_map(push).collect()
}

/// The user's own forces and torques on the bodies that contacts act on, and the motors of their joints.
pub(crate) struct UserForces {
    forces: Vec<(RigidBodyHandle, Vector, Vector)>,
    joints: Vec<(JointForce, JointAxesMask)>,
}

impl UserForces {
    /// Gives every body its final velocity now and holds it against gravity and the user's forces during the step.
    ///
    /// The solve is for a body that moves at its final velocity through the whole step. Rapier moves bodies in
    /// substeps and adds external forces bit by bit, so an impulse alone would lift a resting body before gravity
    /// brings it down again, and a force alone would let an arriving body move on through the contact.
    pub(crate) fn suspend(world: &mut WorldParts<'_>, pushes: Pushes) -> Self {
        let dt = world.integration_parameters.dt;
        let mut before = Vec::with_capacity(pushes.bodies.len());
        let in_one_step = push_links(world, &pushes.bodies);
        for BodyForce { handle, contact, joints, held, link } in pushes.bodies {
            let Some(body) = world.bodies.get_mut(handle) else { continue };
            before.push((handle, body.user_force(), body.user_torque()));
            if let Some(link) = link {
                let force = if in_one_step.contains(&link.multibody) { -held } else { contact };
                body.add_force(force.linear.as_vec3(), false);
                body.add_torque(force.angular.as_vec3(), false);
                continue;
            }
            let impulse = (contact + joints + held) * f64::from(dt);
            body.apply_impulse(impulse.linear.as_vec3(), false);
            body.apply_torque_impulse(impulse.angular.as_vec3(), false);
            body.add_force(-held.linear.as_vec3(), false);
            body.add_torque(-held.angular.as_vec3(), false);
        }
        let joints = pushes.joints.into_iter().filter_map(|joint| {
            let data = &mut world.impulse_joints.get_mut(joint.handle, false)?.data;
            let motors = data.motor_axes;
            // Motors of coupled angular axes are Rapier's alone.
            data.motor_axes &= data.coupled_axes & JointAxesMask::ANG_AXES;
            Some((joint, motors))
        });
        let joints = joints.collect();
        Self { forces: before, joints }
    }

    /// Gives the user's forces and motors back, bit for bit, and tells Rapier's joints what they have done.
    pub(crate) fn restore(self, world: &mut WorldParts<'_>) {
        let parameters = world.integration_parameters;
        let substep = f64::from(parameters.dt) / parameters.num_solver_iterations.max(1) as f64;
        for (JointForce { handle, rows }, motors) in self.joints {
            let Some(joint) = world.impulse_joints.get_mut(handle, false) else { continue };
            joint.data.motor_axes = motors;
            for (row, force) in rows {
                // Rapier's impulses are those of a substep on the first body.
                let impulse = (-force * substep) as Real;
                match row {
                    RowKind::Lock(i) => joint.impulses[i] += impulse,
                    RowKind::Limit(i) => joint.data.limits[i].impulse += impulse,
                    RowKind::Motor(i) => joint.data.motors[i].impulse = impulse,
                }
            }
        }
        for (handle, force, torque) in self.forces {
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
