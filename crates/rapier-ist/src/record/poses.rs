//! Poses of all bodies, one `foxglove.FrameTransforms` a step.

use super::convert::{quaternion, timestamp, vector};
use super::{ROOT_FRAME, UpAxis, WORLD_FRAME};
use foxglove::messages::{FrameTransform, FrameTransforms};
use rapier3d::dynamics::{RigidBodyHandle, RigidBodySet};
use rapier3d::math::{Pose, Rotation, Vector};
use std::collections::HashSet;
use std::f32::consts::FRAC_PI_2;

/// The described bodies and the message with their poses, which is filled anew at each step and keeps its memory.
pub(super) struct Poses {
    bodies: Vec<TrackedBody>,
    /// The frame that puts the world upright, then one transform per body that is in the world and has had a pose.
    message: FrameTransforms,
}

/// A described body.
struct TrackedBody {
    handle: RigidBodyHandle,
    /// Its frame.
    name: String,
    state: State,
    /// Whether it has had a pose that is one.
    is_placed: bool,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    Present,
    /// Its pose is not a number.
    NotFinite,
    Removed,
}

/// What the log should say about a body's pose.
#[derive(Clone, Copy)]
pub(super) enum PoseEvent {
    /// It is no number; the last finite one is kept, if there was one.
    NotFinite,
    /// The body left the world.
    Removed,
}

impl Poses {
    pub(super) fn new(up: UpAxis) -> Self {
        // Viewers draw z upwards. The axis is said in every message, since they may start to read anywhere.
        let upright = match up {
            UpAxis::Y => Rotation::from_rotation_x(FRAC_PI_2),
            UpAxis::Z => Rotation::IDENTITY,
        };
        let root = transform(ROOT_FRAME, WORLD_FRAME, &Pose::from_parts(Vector::ZERO, upright));
        Self { bodies: Vec::new(), message: FrameTransforms { transforms: vec![root] } }
    }

    /// Follows one more body.
    pub(super) fn add(&mut self, handle: RigidBodyHandle, name: &str) {
        self.bodies.push(TrackedBody {
            handle,
            name: name.to_owned(),
            state: State::Present,
            is_placed: false,
        });
    }

    /// Number of bodies that have been added.
    pub(super) fn len(&self) -> usize {
        self.bodies.len()
    }

    /// Name of body number `index`.
    pub(super) fn name(&self, index: usize) -> &str {
        self.bodies.get(index).map_or("", |body| &body.name)
    }

    /// Takes over the poses at `time` (ns); tells what is notable about them, once each.
    pub(super) fn follow(&mut self, bodies: &RigidBodySet, time: u64) -> Vec<(PoseEvent, String)> {
        let mut events = Vec::new();
        let transforms = &mut self.message.transforms;
        if let Some(root) = transforms.first_mut() {
            root.timestamp = Some(timestamp(time));
        }
        // The transforms stand in the order of their bodies.
        let mut place = 1;
        for body in self.bodies.iter_mut().filter(|body| body.state != State::Removed) {
            let before = body.state;
            body.state = match bodies.get(body.handle).map(|body| body.position()) {
                Some(pose) if is_rigid(pose) => {
                    if !std::mem::replace(&mut body.is_placed, true) {
                        transforms.insert(place, transform(WORLD_FRAME, &body.name, pose));
                    }
                    transforms[place].translation = Some(vector(pose.translation));
                    transforms[place].rotation = Some(quaternion(pose.rotation));
                    State::Present
                }
                Some(_) => State::NotFinite,
                None => State::Removed,
            };
            if body.is_placed {
                transforms[place].timestamp = Some(timestamp(time));
                place += 1;
            }
            let event = match body.state {
                State::NotFinite if before == State::Present => PoseEvent::NotFinite,
                State::Removed => PoseEvent::Removed,
                _ => continue,
            };
            events.push((event, body.name.clone()));
        }
        let removed = events.iter().filter(|(event, _)| matches!(event, PoseEvent::Removed));
        let gone: HashSet<&String> = removed.map(|(_, name)| name).collect();
        if !gone.is_empty() {
            self.message.transforms.retain(|transform| !gone.contains(&transform.child_frame_id));
        }
        events
    }

    /// The transforms of all bodies that are in the world and have had a pose, as [`Self::follow`] found them.
    pub(super) fn message(&self) -> &FrameTransforms {
        &self.message
    }
}

/// Whether the pose is one. A zero quaternion is finite and no rotation.
fn is_rigid(pose: &Pose) -> bool {
    pose.translation.is_finite() && pose.rotation.is_finite() && pose.rotation.length_squared() > 0.5
}

fn transform(parent: &str, child: &str, pose: &Pose) -> FrameTransform {
    FrameTransform {
        timestamp: None,
        parent_frame_id: parent.to_owned(),
        child_frame_id: child.to_owned(),
        translation: Some(vector(pose.translation)),
        rotation: Some(quaternion(pose.rotation)),
    }
}
