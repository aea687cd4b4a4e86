//! How far motors and the user's forces may move bodies in a step beyond their present velocities.

use crate::WorldParts;
use crate::joint_rows::joint_forces;
use crate::joints::{Joint, can_move, joints_at};
use crate::penalty::SolverBody;
use rapier3d::dynamics::{RigidBody, RigidBodyHandle};
use rapier3d::glamx::DVec3;
use rapier3d::math::Real;
use rapier3d::parry::bounding_volume::Aabb;
use std::collections::HashMap;

/// A translation (m) and a rotation (rad) of any direction, about a point.
#[derive(Clone, Copy, Debug, Default)]
struct Drive {
    center: DVec3,
    translation: f64,
    rotation: f64,
}

/// Of all bodies that something drives.
///
/// Each joint by itself: what a motor does to bodies that hang on those that it drives is left out.
pub(crate) struct Drives(HashMap<RigidBodyHandle, Vec<Drive>>);

impl Drives {
    pub(crate) fn new(world: &WorldParts<'_>) -> Self {
        let mut drives = Self(HashMap::new());
        let dt = f64::from(world.integration_parameters.dt);
        for (handle, body) in world.bodies.iter().filter(|(_, body)| can_move(body)) {
            let acceleration = (body.user_force() * body.mass_properties().effective_inv_mass).length();
            if acceleration > 0.0 {
                let translation = f64::from(acceleration) * dt * dt;
                drives.add(handle, Drive { translation, ..Drive::default() });
            }
            for (_, joint) in joints_at(world, handle).filter(|(_, joint)| !joint.data.motor_axes.is_empty())
            {
                motors(world, &joint).into_iter().for_each(|drive| drives.add(handle, drive));
            }
        }
        drives
    }

    fn add(&mut self, body: RigidBodyHandle, drive: Drive) {
        self.0.entry(body).or_default().push(drive);
    }

    /// How far a point of `body` within `bounds` may be moved (m).
    pub(crate) fn way(&self, body: RigidBodyHandle, bounds: &Aabb) -> Real {
        let way = |drive: &Drive| {
            let center = drive.center.as_vec3();
            let farthest = (center - bounds.mins).abs().max((bounds.maxs - center).abs()).length();
            drive.translation as Real + drive.rotation as Real * farthest
        };
        self.0.get(&body).map_or(0.0, |drives| drives.iter().map(way).sum())
    }
}

/// What the motors of a joint do to its bodies.
fn motors(world: &WorldParts<'_>, joint: &Joint<'_>) -> Option<Drive> {
    let parameters = world.integration_parameters;
    let dt = f64::from(parameters.dt);
    let [a, b] = joint.bodies.map(|body| world.bodies.get(body));
    let state = |body: &RigidBody| SolverBody::new(body, can_move(body), world.gravity, parameters.dt);
    let states = [&state(a?), &state(b?)];
    let forces = joint_forces(states, [a?.position(), b?.position()], joint, parameters)?;
    let [translation, rotation] = forces.drives(states, dt).map(|change| change * dt);
    Some(Drive { center: forces.anchors[1], translation, rotation })
}
