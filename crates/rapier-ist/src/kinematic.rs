//! Position-based kinematic bodies in substeps.

use rapier3d::dynamics::{RigidBody, RigidBodyHandle, RigidBodySet, RigidBodyType};
use rapier3d::math::{Pose, Real, Vector};

/// Where position-based kinematic bodies have to be at the end of the whole step.
///
/// Rapier takes such a body to its next position within one of its steps. In `n` substeps it has to go an `n`-th of the
/// way in each, on the path that the plugin predicts for it: its centre of mass on a straight line, turning about a
/// fixed axis.
pub(crate) struct KinematicTargets(Vec<Target>);

struct Target {
    body: RigidBodyHandle,
    center: Vector,
    from: Pose,
    to: Pose,
}

impl KinematicTargets {
    pub(crate) fn new(bodies: &RigidBodySet) -> Self {
        let targets = bodies.iter().filter(|(_, body)| {
            let is_target = body.next_position().is_finite() && body.position() != body.next_position();
            body.is_enabled() && body.body_type() == RigidBodyType::KinematicPositionBased && is_target
        });
        let target = |(handle, body): (RigidBodyHandle, &RigidBody)| Target {
            body: handle,
            center: body.local_center_of_mass(),
            from: *body.position(),
            to: *body.next_position(),
        };
        Self(targets.map(target).collect())
    }

    /// Sets the next positions to where the bodies have to be after `share` of the step, from 0 to 1.
    pub(crate) fn aim(&self, bodies: &mut RigidBodySet, share: Real) {
        for target in &self.0 {
            if let Some(body) = bodies.get_mut(target.body) {
                body.set_next_kinematic_position(target.at(share));
            }
        }
    }
}

impl Target {
    fn at(&self, share: Real) -> Pose {
        if share >= 1.0 {
            return self.to;
        }
        let rotation = self.from.rotation.slerp(self.to.rotation, share);
        let center = (self.from * self.center).lerp(self.to * self.center, share);
        Pose::from_parts(center - rotation * self.center, rotation)
    }
}
