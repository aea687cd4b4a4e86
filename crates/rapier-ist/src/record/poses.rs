//! Poses of all bodies, one `foxglove.FrameTransforms` a step.

use super::convert::{quaternion, timestamp, vector};
use super::{ROOT_FRAME, UpAxis, WORLD_FRAME};
use foxglove::messages::{FrameTransform, FrameTransforms};
use rapier3d::dynamics::{RigidBodyHandle, RigidBodySet};
use rapier3d::math::{Pose, Rotation, Vector};
use std::f32::consts::FRAC_PI_2;

/// A described body.
pub(super) struct TrackedBody {
    pub(super) handle: RigidBodyHandle,
    /// Its frame.
    pub(super) name: String,
    /// Its last finite pose.
    pose: Pose,
    state: State,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    Present,
    /// Its pose is not a number.
    NotFinite,
    Removed,
}

/// What the log should say about a body's pose.
pub(super) enum PoseEvent {
    /// It stopped being a number; the last finite one is kept.
    NotFinite,
    /// The body left the world.
    Removed,
}

impl TrackedBody {
    pub(super) fn new(handle: RigidBodyHandle, name: String) -> Self {
        Self { handle, name, pose: Pose::IDENTITY, state: State::Present }
    }

    pub(super) fn is_removed(&self) -> bool {
        self.state == State::Removed
    }

    /// Takes over the body's pose; returns what is notable about it, once.
    pub(super) fn follow(&mut self, bodies: &RigidBodySet) -> Option<PoseEvent> {
        if self.is_removed() {
            return None;
        }
        let Some(body) = bodies.get(self.handle) else {
            self.state = State::Removed;
            return Some(PoseEvent::Removed);
        };
        let pose = *body.position();
        // A zero quaternion is finite and no rotation.
        if pose.translation.is_finite() && pose.rotation.is_finite() && pose.rotation.length_squared() > 0.5 {
            self.pose = pose;
            self.state = State::Present;
            return None;
        }
        let news = self.state == State::Present;
        self.state = State::NotFinite;
        news.then_some(PoseEvent::NotFinite)
    }
}

/// The transforms of all bodies that are in the world, and the frame that puts the world upright.
pub(super) fn frame_transforms(bodies: &[TrackedBody], up: UpAxis, time: u64) -> FrameTransforms {
    let transform = |parent: &str, child: &str, pose: &Pose| FrameTransform {
        timestamp: Some(timestamp(time)),
        parent_frame_id: parent.to_owned(),
        child_frame_id: child.to_owned(),
        translation: Some(vector(pose.translation)),
        rotation: Some(quaternion(pose.rotation)),
    };
    // Viewers draw z upwards. The axis is said in every message, since they may start to read anywhere.
    let upright = match up {
        UpAxis::Y => Rotation::from_rotation_x(FRAC_PI_2),
        UpAxis::Z => Rotation::IDENTITY,
    };
    let root = transform(ROOT_FRAME, WORLD_FRAME, &Pose::from_parts(Vector::ZERO, upright));
    let present = bodies.iter().filter(|body| !body.is_removed());
    let transforms =
        std::iter::once(root).chain(present.map(|body| transform(WORLD_FRAME, &body.name, &body.pose)));
    FrameTransforms { transforms: transforms.collect() }
}
