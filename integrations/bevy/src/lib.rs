//! Volume contacts in [`bevy_rapier3d`]: inner sphere trees as colliders of Bevy entities.
//!
//! bevy_rapier3d divides a step in three: components go into Rapier's sets (`SyncBackend`), Rapier steps
//! (`StepSimulation`), and poses go back into components (`Writeback`). [`IstPhysicsPlugin`] adds the first and the last
//! part as they are, and puts [`IstPlugin::step_parts`] in the place of the second.
//!
//! What bevy_rapier3d's own step does beside stepping is left out here: `TimestepMode`, physics hooks, contact-force
//! events, quarantine and interpolation. The schedule says how often a step is made, and the context's integration
//! parameters how long it is.

use bevy::prelude::*;
use bevy_rapier3d::plugin::PhysicsSet;
use bevy_rapier3d::plugin::context::{
    RapierContextColliders, RapierContextJoints, RapierContextSimulation, RapierRigidBodySet,
};
use bevy_rapier3d::prelude::{
    Collider, CollisionEvent, NoUserData, RapierConfiguration, RapierPhysicsPlugin, TimestepMode,
};
use bevy_rapier3d::rapier::geometry::CollisionEvent as RapierCollisionEvent;
use bevy_rapier3d::rapier::prelude::{
    ColliderSet, ContactPair, EventHandler, RigidBodySet, SoftBodySet, SoftBodyTearEvent,
};
use rapier_ist::{IstPlugin, IstShape, WorldParts};
use std::sync::{Mutex, PoisonError};

/// Steps Rapier with volume contacts in [`FixedUpdate`], in place of [`RapierPhysicsPlugin`]'s own step.
#[derive(Debug, Default)]
pub struct IstPhysicsPlugin;

impl Plugin for IstPhysicsPlugin {
    fn build(&self, app: &mut App) {
        let dt = app.world().get_resource::<Time<Fixed>>().map_or(1.0 / 64.0, |time| time.timestep().as_secs_f32());
        let rapier = RapierPhysicsPlugin::<NoUserData>::default()
            .with_physics_sets_systems([PhysicsSet::SyncBackend, PhysicsSet::Writeback].into_iter().collect())
            .in_fixed_schedule();
        app.insert_resource(TimestepMode::Fixed { dt, substeps: 1 })
            .init_resource::<VolumeContacts>()
            .add_plugins(rapier)
            .add_systems(FixedUpdate, step.in_set(PhysicsSet::StepSimulation));
    }
}

/// The plugin that steps the world: settings between steps, and the report of the last one.
#[derive(Resource, Debug, Default)]
pub struct VolumeContacts(pub IstPlugin);

/// A Bevy collider of an inner sphere tree.
///
/// The entity's scale scales it where it is positive and the same along all axes; other scales are refused with an error in the
/// log.
#[must_use]
pub fn collider(shape: &IstShape) -> Collider {
    Collider::from(shape.clone().into_shared())
}

/// One step of the length of the fixed time step.
fn step(
    mut contacts: ResMut<VolumeContacts>,
    mut contexts: Query<(
        &mut RapierContextSimulation,
        &mut RapierContextColliders,
        &mut RapierContextJoints,
        &mut RapierRigidBodySet,
        &RapierConfiguration,
    )>,
    time: Res<Time<Fixed>>,
    mut collisions: MessageWriter<CollisionEvent>,
) {
    // What the plugin remembers is of one world.
    let Ok((mut simulation, mut colliders, mut joints, mut bodies, configuration)) = contexts.single_mut() else {
        log::warn!("there is not exactly one Rapier context, and volume contacts need one: no step is made");
        return;
    };
    if !configuration.physics_pipeline_active {
        bodies.propagate_modified_body_positions_to_colliders(&mut colliders);
        return;
    }
    let events = Collisions::default();
    let (simulation, joints, bodies) = (&mut *simulation, &mut *joints, &mut *bodies);
    simulation.integration_parameters.dt = time.timestep().as_secs_f32();
    let world = WorldParts {
        gravity: configuration.gravity,
        integration_parameters: &simulation.integration_parameters,
        physics_pipeline: &mut simulation.pipeline,
        islands: &mut simulation.islands,
        broad_phase: &mut simulation.broad_phase,
        narrow_phase: &mut simulation.narrow_phase,
        bodies: &mut bodies.bodies,
        colliders: &mut colliders.colliders,
        impulse_joints: &mut joints.impulse_joints,
        multibody_joints: &mut joints.multibody_joints,
        soft_bodies: &mut bodies.soft_bodies,
        ccd_solver: &mut simulation.ccd_solver,
    };
    contacts.0.step_parts(world, &(), &events);
    collisions.write_batch(events.0.into_inner().unwrap_or_else(PoisonError::into_inner));
}

/// Rapier's collision events as Bevy's, for `CollidingEntities` and whoever reads them.
#[derive(Default)]
struct Collisions(Mutex<Vec<CollisionEvent>>);

impl EventHandler for Collisions {
    fn handle_collision_event(
        &self,
        _bodies: &RigidBodySet,
        colliders: &ColliderSet,
        event: RapierCollisionEvent,
        _contact_pair: Option<&ContactPair>,
    ) {
        let entity = |handle| colliders.get(handle).map(RapierContextColliders::entity_from_collider);
        let (RapierCollisionEvent::Started(a, b, flags) | RapierCollisionEvent::Stopped(a, b, flags)) = event;
        // A collider that was removed has no entity to name.
        let (Some(a), Some(b)) = (entity(a), entity(b)) else { return };
        let event = match event {
            RapierCollisionEvent::Started(..) => CollisionEvent::Started(a, b, flags),
            RapierCollisionEvent::Stopped(..) => CollisionEvent::Stopped(a, b, flags),
        };
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(event);
    }

    fn handle_contact_force_event(
        &self,
        _dt: f32,
        _bodies: &RigidBodySet,
        _colliders: &ColliderSet,
        _contact_pair: &ContactPair,
        _total_force_magnitude: f32,
    ) {
    }

    fn handle_soft_body_tear_event(&self, _soft_bodies: &SoftBodySet, _event: &SoftBodyTearEvent) {}
}
