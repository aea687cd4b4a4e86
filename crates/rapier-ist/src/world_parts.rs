//! What a step needs of a world.

use rapier3d::dynamics::{
    CCDSolver, ImpulseJointSet, IntegrationParameters, IslandManager, MultibodyJointSet, RigidBodySet,
    SoftBodySet,
};
use rapier3d::geometry::{BroadPhaseBvh, ColliderSet, NarrowPhase};
use rapier3d::math::Vector;
use rapier3d::pipeline::{EventHandler, PhysicsHooks, PhysicsPipeline, PhysicsWorld};

/// The arguments of [`PhysicsPipeline::step`], for those who keep their own sets and no [`PhysicsWorld`].
#[expect(missing_debug_implementations, reason = "Rapier's pipeline has none")]
pub struct WorldParts<'a> {
    /// Gravity (m/s²).
    pub gravity: Vector,
    /// Time step, solver parameters.
    pub integration_parameters: &'a IntegrationParameters,
    /// Runs Rapier's part of the step.
    pub physics_pipeline: &'a mut PhysicsPipeline,
    /// Which bodies are awake.
    pub islands: &'a mut IslandManager,
    /// Pairs of boxes.
    pub broad_phase: &'a mut BroadPhaseBvh,
    /// Contacts; knows inner sphere trees by its query dispatcher.
    pub narrow_phase: &'a mut NarrowPhase,
    /// All bodies.
    pub bodies: &'a mut RigidBodySet,
    /// All colliders.
    pub colliders: &'a mut ColliderSet,
    /// Joints solved by impulses.
    pub impulse_joints: &'a mut ImpulseJointSet,
    /// Joints in reduced coordinates.
    pub multibody_joints: &'a mut MultibodyJointSet,
    /// Soft bodies.
    pub soft_bodies: &'a mut SoftBodySet,
    /// Continuous collision detection.
    pub ccd_solver: &'a mut CCDSolver,
}

impl<'a> From<&'a mut PhysicsWorld> for WorldParts<'a> {
    fn from(world: &'a mut PhysicsWorld) -> Self {
        Self {
            gravity: world.gravity,
            integration_parameters: &world.integration_parameters,
            physics_pipeline: &mut world.physics_pipeline,
            islands: &mut world.islands,
            broad_phase: &mut world.broad_phase,
            narrow_phase: &mut world.narrow_phase,
            bodies: &mut world.bodies,
            colliders: &mut world.colliders,
            impulse_joints: &mut world.impulse_joints,
            multibody_joints: &mut world.multibody_joints,
            soft_bodies: &mut world.soft_bodies,
            ccd_solver: &mut world.ccd_solver,
        }
    }
}

impl WorldParts<'_> {
    /// Rapier's own step.
    pub(crate) fn step(&mut self, hooks: &dyn PhysicsHooks, events: &dyn EventHandler) {
        self.physics_pipeline.step(
            self.gravity,
            self.integration_parameters,
            self.islands,
            self.broad_phase,
            self.narrow_phase,
            self.bodies,
            self.colliders,
            self.impulse_joints,
            self.multibody_joints,
            self.soft_bodies,
            self.ccd_solver,
            hooks,
            events,
        );
    }
}
