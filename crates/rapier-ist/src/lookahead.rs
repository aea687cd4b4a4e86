//! Where colliders will be at the end of the step if nothing stops them.
//!
//! The implicit step needs the contact forces at the end of the step. Overlap is therefore measured at the predicted
//! poses, not at the present ones: a body that arrives during the step is stopped where it touches, instead of
//! being found deep inside one step too late.

use crate::penalty::{Screw, way_to_next_position};
use ist::RigidMotion;
use rapier3d::dynamics::{RigidBody, RigidBodyType};
use rapier3d::glamx::DVec3;
use rapier3d::math::{Pose, Real, Rotation};
use std::ops::Sub;

/// A small rigid displacement about a body's centre of mass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Displacement {
    /// Centre of mass before (m), world frame.
    center: DVec3,
    /// Translation of the centre of mass (m) and rotation vector (rad).
    screw: Screw,
}

impl Displacement {
    /// What `body` does in `dt` seconds at its present velocity.
    ///
    /// Without gravity and other forces: a body at rest is then measured where it lies, and the force on it is
    /// not a linearisation but exact.
    pub(crate) fn of(body: &RigidBody, dt: Real) -> Self {
        let center = body.center_of_mass().as_dvec3();
        let screw = match body.body_type() {
            _ if body.is_sleeping() || body.is_fixed() => Screw::ZERO,
            RigidBodyType::KinematicPositionBased => way_to_next_position(body),
            _ => {
                Screw { linear: body.linvel().as_dvec3(), angular: body.angvel().as_dvec3() } * f64::from(dt)
            }
        };
        Self { center, screw: if screw.is_finite() { screw } else { Screw::ZERO } }
    }

    /// About the centre of mass `center`.
    pub(crate) fn new(center: DVec3, screw: Screw) -> Self {
        Self { center, screw }
    }

    /// The first `share` of the displacement, 0 to 1.
    pub(crate) fn part(&self, share: f64) -> Self {
        Self { center: self.center, screw: self.screw * share }
    }

    /// To half-way between the end of this and that of another of the same body.
    pub(crate) fn half_way_from(&self, other: &Self) -> Self {
        Self { center: self.center, screw: (self.screw + other.screw) * 0.5 }
    }

    /// No point within `radius` of the centre of mass moves farther than this relative to one that moves with
    /// `other` (m), but for terms of second order.
    pub(crate) fn reach(&self, other: &Self, radius: Real) -> f64 {
        let turn = self.screw.angular - other.screw.angular;
        (self.screw.linear - other.at(self.center)).length() + turn.length() * f64::from(radius)
    }

    /// `pose` after the displacement.
    pub(crate) fn apply(&self, pose: &Pose) -> Pose {
        let turn = Rotation::from_scaled_axis(self.screw.angular.as_vec3());
        let center = self.center.as_vec3();
        let moved = center + self.screw.linear.as_vec3() + turn * (pose.translation - center);
        Pose::from_parts(moved, (turn * pose.rotation).normalize())
    }

    /// The displacement as a motion of `pose` that takes a time of 1.
    pub(crate) fn motion(&self, pose: &Pose) -> RigidMotion {
        RigidMotion {
            pose: *pose,
            local_center: pose.inverse_transform_point(self.center.as_vec3()),
            linear_velocity: self.screw.linear.as_vec3(),
            angular_velocity: self.screw.angular.as_vec3(),
        }
    }

    /// Way of the centre of mass (m).
    pub(crate) fn translation(&self) -> DVec3 {
        self.screw.linear
    }

    /// Rotation vector (rad).
    pub(crate) fn rotation(&self) -> DVec3 {
        self.screw.angular
    }

    /// Way of the point of the body that is at `point` before (m), to first order.
    pub(crate) fn at(&self, point: DVec3) -> DVec3 {
        self.screw.twist_at(point - self.center).linear
    }
}

/// The displacement that leads from the end of the other to the end of this one, to first order.
impl Sub for Displacement {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { center: self.center, screw: self.screw - other.screw }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn displacement() -> impl Strategy<Value = Displacement> {
        let vector = || prop::array::uniform3(-1.0_f64..1.0).prop_map(DVec3::from_array);
        (vector(), vector(), vector())
            .prop_map(|(center, linear, angular)| Displacement::new(center, Screw { linear, angular }))
    }

    proptest! {
        #[test]
        fn no_point_moves_farther_than_its_reach(
            a in displacement(), b in displacement(), radius in 0.0_f32..2.0, to in prop::array::uniform3(-1.0_f64..1.0),
        ) {
            let point = a.center + DVec3::from_array(to).clamp_length_max(1.0) * f64::from(radius);
            let way = (a.at(point) - b.at(point)).length();
            prop_assert!(way <= a.reach(&b, radius) * (1.0 + 1e-12), "{way}");
        }
    }

    /// What lies in a drum that turns was taken for fast.
    #[test]
    fn what_moves_as_one_does_not_move() {
        let table = Displacement::new(DVec3::ZERO, Screw { linear: DVec3::X, angular: DVec3::Y });
        let center = DVec3::new(3.0, 0.5, -1.0);
        let load = Displacement::new(center, Screw { linear: table.at(center), ..table.screw });
        assert_eq!(load.reach(&table, 2.0), 0.0);
    }
}
