//! A small solid wholly inside a large one: deep-penetration recovery.

use super::Model;
use anyhow::Result;
use glamx::Pose3;
use rapier_ist::IstPlugin;
use rapier3d::dynamics::{RigidBodyBuilder, RigidBodyHandle};
use rapier3d::math::Vector;
use rapier3d::pipeline::PhysicsWorld;

/// Two free bodies without gravity.
pub struct Inside {
    /// The Rapier world.
    pub world: PhysicsWorld,
    /// Steps it.
    pub plugin: IstPlugin,
    /// The large body.
    pub large: RigidBodyHandle,
    /// The small one.
    pub small: RigidBodyHandle,
    /// Size of the small one in units of its model's.
    scale: f32,
}

impl Inside {
    /// `small`, `scale` times its size, at `pose` in the frame of `large`.
    ///
    /// # Errors
    /// Where a shape cannot be scaled.
    pub fn new(large: &Model, small: &Model, scale: f32, pose: Pose3, density: f32) -> Result<Self> {
        let mut world = PhysicsWorld { gravity: Vector::ZERO, ..PhysicsWorld::new() };
        let plugin = IstPlugin::install(&mut world);
        let (large, _) = world.insert(RigidBodyBuilder::dynamic(), large.collider(1.0, density)?);
        let (small, _) =
            world.insert(RigidBodyBuilder::dynamic().pose(pose), small.collider(scale, density)?);
        Ok(Self { world, plugin, large, small, scale })
    }

    /// Share of the small mesh's vertices inside the large mesh, given what the scene was made of.
    #[must_use]
    pub fn share_inside(&self, large: &Model, small: &Model) -> f64 {
        let [a, b] = [self.large, self.small].map(|handle| *self.world.bodies[handle].position());
        let pose = a.inv_mul(&b);
        let vertices = &small.solid.mesh().vertices;
        let inside = |v: &&glam::DVec3| large.solid.contains((pose * (v.as_vec3() * self.scale)).as_dvec3());
        vertices.iter().filter(inside).count() as f64 / vertices.len() as f64
    }
}
