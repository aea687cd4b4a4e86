//! A hand of three fingers that motors close.

use glam::{Quat, Vec3};
use rapier3d::dynamics::{
    GenericJointBuilder, ImpulseJointHandle, JointAxesMask, JointAxis, MotorModel, RigidBodyBuilder,
    RigidBodyHandle,
};
use rapier3d::geometry::ColliderBuilder;
use rapier3d::math::{Pose, Real};
use rapier3d::pipeline::PhysicsWorld;

/// Stiffness and damping of the motors (N/m, N·s/m): a finger of 50 g comes to rest within a tenth of a second.
const MOTOR: [Real; 2] = [2000.0, 20.0];

/// A kinematic palm and three fingers, which motors of limited force move towards the palm's y axis and away from it.
#[derive(Clone, Debug)]
pub struct Hand {
    /// Where it goes is where it is told to.
    pub palm: RigidBodyHandle,
    /// The x axes of their frames lead away from the palm's axis.
    pub fingers: [RigidBodyHandle; 3],
    joints: [ImpulseJointHandle; 3],
}

impl Hand {
    /// A hand at `place` with fingers of shape `finger`, at the given distance from its axis (m). The first finger is at the
    /// angle `turned` (rad) from the x axis about the y axis; `force` is the most that a motor gives (N).
    pub fn new(
        world: &mut PhysicsWorld,
        place: Vec3,
        finger: &ColliderBuilder,
        [distance, turned]: [Real; 2],
        force: Real,
    ) -> Self {
        let palm = world.insert_body(RigidBodyBuilder::kinematic_position_based().translation(place));
        let joined = [0.0, 1.0, 2.0].map(|i| {
            let frame = Quat::from_rotation_y(turned + i * std::f32::consts::TAU / 3.0);
            let pose = Pose::from_parts(place + frame * Vec3::X * distance, frame);
            let body = RigidBodyBuilder::dynamic().pose(pose).can_sleep(false);
            let (body, _) = world.insert(body, finger.clone());
            let joint = GenericJointBuilder::new(JointAxesMask::LOCKED_PRISMATIC_AXES)
                .local_frame1(Pose::from_parts(Vec3::ZERO, frame))
                .motor_model(JointAxis::LinX, MotorModel::ForceBased)
                .motor_position(JointAxis::LinX, distance, MOTOR[0], MOTOR[1])
                .motor_max_force(JointAxis::LinX, force)
                .build();
            (body, world.insert_impulse_joint(palm, body, joint))
        });
        Self { palm, fingers: joined.map(|(body, _)| body), joints: joined.map(|(_, joint)| joint) }
    }

    /// Where the motors shall bring the fingers: `distance` from the palm's axis (m).
    pub fn spread(&self, world: &mut PhysicsWorld, distance: Real) {
        for joint in self.joints {
            if let Some(joint) = world.impulse_joints.get_mut(joint, true) {
                joint.data.set_motor_position(JointAxis::LinX, distance, MOTOR[0], MOTOR[1]);
            }
        }
    }

    /// Where the palm shall be at the end of the next step.
    pub fn move_to(&self, world: &mut PhysicsWorld, place: Vec3) {
        world.bodies[self.palm].set_next_kinematic_translation(place);
    }
}
