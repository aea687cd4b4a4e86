//! What a step needs of a world.

use rapier3d::dynamics::{
    CCDSolver, ImpulseJointSet, IntegrationParameters, IslandManager, MultibodyJointSet, RigidBodySet,
    SoftBodySet,
};
use rapier3d::geometry::{BroadPhaseBvh, ColliderSet, NarrowPhase};
use rapier3d::math::Vector;
use rapier3d::pipeline::{EventHandler, PhysicsHooks, PhysicsPipeline, PhysicsWorld};

/// The arguments of [`PhysicsPipeline::step`], for those who keep their own sets and no [`PhysicsWorld`].
///
/// ```
/// use ist::{InnerSphere, SolidProperties, SpherePacking};
/// use rapier_ist::{IstPlugin, IstShape, WorldParts};
/// use rapier3d::prelude::*;
///
/// let mut bodies = RigidBodySet::new();
/// let mut colliders = ColliderSet::new();
/// let (mut islands, mut broad_phase) = (IslandManager::new(), BroadPhaseBvh::new());
/// let (mut impulse_joints, mut multibody_joints) = (ImpulseJointSet::new(), MultibodyJointSet::new());
/// let (mut soft_bodies, mut ccd_solver) = (SoftBodySet::new(), CCDSolver::new());
/// let (mut physics_pipeline, mut narrow_phase) = (PhysicsPipeline::new(), NarrowPhase::new());
/// let integration_parameters = IntegrationParameters::default();
///
/// let sphere = InnerSphere::solid_ball(Vector::ZERO, 0.1, Vector::Y);
/// let ball = IstShape::from_packing(&SpherePacking::new(vec![sphere], SolidProperties::ball(0.1))?);
/// colliders.insert(ColliderBuilder::new(SharedShape::halfspace(Vector::Y)));
/// let body = bodies.insert(RigidBodyBuilder::dynamic().translation(Vector::Y * 0.3));
/// colliders.insert_with_parent(ball.into_collider(), body, &mut bodies);
///
/// let mut plugin = IstPlugin::for_narrow_phase(&mut narrow_phase);
/// for _ in 0..60 {
///     let world = WorldParts {
///         gravity: Vector::new(0.0, -9.81, 0.0),
///         integration_parameters: &integration_parameters,
///         physics_pipeline: &mut physics_pipeline,
///         islands: &mut islands,
///         broad_phase: &mut broad_phase,
///         narrow_phase: &mut narrow_phase,
///         bodies: &mut bodies,
///         colliders: &mut colliders,
///         impulse_joints: &mut impulse_joints,
///         multibody_joints: &mut multibody_joints,
///         soft_bodies: &mut soft_bodies,
///         ccd_solver: &mut ccd_solver,
///     };
///     plugin.step_parts(world, &(), &());
/// }
/// assert!((bodies[body].translation().y - 0.1).abs() < 0.01, "it lies on the ground");
/// # Ok::<(), ist::PackingError>(())
/// ```
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
    /// The same world with other parameters.
    pub(crate) fn with_parameters<'b>(
        &'b mut self,
        integration_parameters: &'b IntegrationParameters,
    ) -> WorldParts<'b> {
        WorldParts {
            gravity: self.gravity,
            integration_parameters,
            physics_pipeline: self.physics_pipeline,
            islands: self.islands,
            broad_phase: self.broad_phase,
            narrow_phase: self.narrow_phase,
            bodies: self.bodies,
            colliders: self.colliders,
            impulse_joints: self.impulse_joints,
            multibody_joints: self.multibody_joints,
            soft_bodies: self.soft_bodies,
            ccd_solver: self.ccd_solver,
        }
    }

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
