//! Motion at constant velocities.

use super::BallKind;
use super::placement::exact_ball;
use crate::InnerSphereTree;
use crate::rotation;
use glam::{DMat3, DQuat, DVec3, Vec3};
use glamx::Pose3;

/// The motion of a rigid body at constant linear and angular velocity.
///
/// At time t a point p of the body stands at `C + v t + exp(ω t) (pose(p) − C)`, where C is the place of the local
/// centre at time 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidMotion {
    /// Pose of the body's frame in the world at time 0.
    pub pose: Pose3,
    /// The point that moves in a straight line, in the body's frame (m): its centre of mass, as a rule.
    pub local_center: Vec3,
    /// Velocity of that point (m/s), in the world.
    pub linear_velocity: Vec3,
    /// Angular velocity (rad/s), in the world.
    pub angular_velocity: Vec3,
}

impl RigidMotion {
    /// A body that stays at `pose`.
    #[must_use]
    pub fn at_rest(pose: Pose3) -> Self {
        Self { pose, local_center: Vec3::ZERO, linear_velocity: Vec3::ZERO, angular_velocity: Vec3::ZERO }
    }

    /// The pose at `time` (s).
    #[must_use]
    pub fn pose_at(&self, time: f32) -> Pose3 {
        let Some(mover) = Mover::new(self) else { return self.pose };
        let (rotation, center) = mover.placed_at(f64::from(time));
        let translation = center - rotation * mover.local_center;
        Pose3::from_parts(translation.as_vec3(), rotation.as_quat())
    }
}

/// A motion in f64.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mover {
    rotation: DQuat,
    center: DVec3,
    local_center: DVec3,
    pub(super) velocity: DVec3,
    pub(super) spin: DVec3,
}

impl Mover {
    /// `None` where a number is not finite or the rotation far from unit length.
    pub(super) fn new(motion: &RigidMotion) -> Option<Self> {
        let vectors = [motion.local_center, motion.linear_velocity, motion.angular_velocity];
        let finite = motion.pose.is_finite() && vectors.iter().all(|v| v.is_finite());
        let rotation = rotation::unit_f64(motion.pose.rotation).filter(|_| finite)?;
        let local_center = motion.local_center.as_dvec3();
        Some(Self {
            rotation,
            center: motion.pose.translation.as_dvec3() + rotation * local_center,
            local_center,
            velocity: motion.linear_velocity.as_dvec3(),
            spin: motion.angular_velocity.as_dvec3(),
        })
    }

    /// Rotation, place of the centre and the centre in the body's frame at `time`.
    pub(super) fn frame_at(&self, time: f64) -> (DQuat, DVec3, DVec3) {
        let (rotation, center) = self.placed_at(time);
        (rotation, center, self.local_center)
    }

    /// Rotation and place of the centre at `time`.
    fn placed_at(&self, time: f64) -> (DQuat, DVec3) {
        let rotation = rotation::about(self.spin * time) * self.rotation;
        (rotation, self.center + self.velocity * time)
    }
}

/// A moving tree at one time.
pub(super) struct Snapshot<'a> {
    tree: &'a InnerSphereTree,
    kind: BallKind,
    pub(super) mover: &'a Mover,
    rotation: DMat3,
    center: DVec3,
}

/// A ball of a moving tree at one time.
#[derive(Clone, Copy, Debug)]
pub(super) struct MovingBall {
    pub(super) center: DVec3,
    pub(super) radius: f64,
    /// From the body's centre to the ball's.
    pub(super) arm: DVec3,
}

impl<'a> Snapshot<'a> {
    pub(super) fn new(tree: &'a InnerSphereTree, kind: BallKind, mover: &'a Mover, time: f64) -> Self {
        let (rotation, center) = mover.placed_at(time);
        Self { tree, kind, mover, rotation: DMat3::from_quat(rotation), center }
    }

    /// Ball `node` of `level`.
    pub(super) fn ball(&self, level: usize, node: usize) -> MovingBall {
        let (center, radius) = if level == 0 {
            exact_ball(self.tree, self.kind, node)
        } else {
            let (center, radius) = self.tree.data().levels[level].get(node);
            let scale = f64::from(self.tree.unit());
            let skin = if self.kind == BallKind::Volume { f64::from(self.tree.skin()) } else { 0.0 };
            (center.as_dvec3() * scale, f64::from(radius) * scale + skin)
        };
        let arm = self.rotation * (center - self.mover.local_center);
        MovingBall { center: self.center + arm, radius, arm }
    }

    pub(super) fn normal(&self, leaf: usize) -> DVec3 {
        self.rotation * self.tree.data().leaves[leaf].normal().as_dvec3()
    }
}
