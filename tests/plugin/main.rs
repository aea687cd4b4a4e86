//! What users of Rapier do with their worlds, with volume contacts in them.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod bad_input;
mod bodies;
mod changes;
mod characters;
mod compounds;
mod debug_render;
mod dominance;
mod filters;
mod force_events;
mod hooks;
mod joints;
mod kinematic;
mod manifold_model;
mod queries;
mod reports;
mod sleeping;
mod snapshot;
mod stepping;
mod stiffness;

use ist::{InnerSphere, SolidProperties, SpherePacking};
use rapier_ist::{ContactModel, IstPlugin, IstShape, Stiffness, VolumePenalty};
use rapier3d::prelude::*;

const RADIUS: f32 = 0.1;
const DENSITY: f32 = 1000.0;

/// A ball of radius 0.1 m that one sphere fills.
fn ball() -> IstShape {
    ball_of(RADIUS)
}

fn ball_of(radius: f32) -> IstShape {
    let sphere = InnerSphere::solid_ball(Vector::ZERO, radius, Vector::Y);
    let solid = SolidProperties::ball(f64::from(radius));
    IstShape::from_packing(&SpherePacking::new(vec![sphere], solid).unwrap())
}

fn ball_collider() -> ColliderBuilder {
    ball().into_collider().density(DENSITY)
}

fn dynamic(position: Vector) -> RigidBodyBuilder {
    RigidBodyBuilder::dynamic().translation(position)
}

/// A world with a fixed ground, y up.
fn grounded() -> (PhysicsWorld, IstPlugin) {
    let mut world = PhysicsWorld::new();
    let plugin = IstPlugin::install(&mut world);
    world.insert(RigidBodyBuilder::fixed(), ColliderBuilder::new(SharedShape::halfspace(Vector::Y)));
    (world, plugin)
}

/// A world without gravity.
fn weightless() -> (PhysicsWorld, IstPlugin) {
    let mut world = PhysicsWorld { gravity: Vector::ZERO, ..PhysicsWorld::new() };
    let plugin = IstPlugin::install(&mut world);
    (world, plugin)
}

fn uniform(stiffness: f32) -> ContactModel {
    ContactModel::VolumePenalty(VolumePenalty {
        stiffness: Stiffness::Uniform(stiffness),
        ..VolumePenalty::default()
    })
}

fn run(plugin: &mut IstPlugin, world: &mut PhysicsWorld, steps: usize) {
    for _ in 0..steps {
        plugin.step(world);
    }
}

fn height(world: &PhysicsWorld, body: RigidBodyHandle) -> f32 {
    world.bodies[body].translation().y
}

/// Everything about a body's motion, bit for bit.
fn bits(world: &PhysicsWorld, body: RigidBodyHandle) -> Vec<u32> {
    let body = &world.bodies[body];
    let pose = body.position();
    let vectors = [pose.translation, body.linvel(), body.angvel()].map(|v| v.to_array());
    let numbers = vectors.into_iter().flatten().chain(pose.rotation.to_array());
    numbers.map(f32::to_bits).collect()
}

fn assert_finite(world: &PhysicsWorld, what: impl std::fmt::Debug) {
    for (_, body) in world.bodies.iter().filter(|(_, body)| body.is_enabled()) {
        let finite = body.position().is_finite() && body.linvel().is_finite() && body.angvel().is_finite();
        assert!(finite, "{what:?}: {:?}", body.position());
    }
}
