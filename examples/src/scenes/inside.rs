//! A small solid wholly inside a large one: deep-penetration recovery.

use super::Model;
use anyhow::Result;
use glamx::Pose3;
use rapier_ist::IstPlugin;
use rapier3d::dynamics::{RigidBodyBuilder, RigidBodyHandle};
use rapier3d::geometry::{Group, InteractionGroups, InteractionTestMode};
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
    pair: Pair,
}

/// A small body in a large one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    /// The large body.
    pub(super) large: RigidBodyHandle,
    /// The small one.
    pub(super) small: RigidBodyHandle,
    /// Size of the small one in units of its model's.
    pub(super) scale: f32,
}

/// Where a pair stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct PairPlace {
    /// Of the large body in the world (m).
    pub(super) translation: Vector,
    /// Of the small body in the large one's frame.
    pub(super) pose: Pose3,
    /// Size of the small body in units of its model's.
    pub(super) scale: f32,
    /// Bodies of different groups do not meet; 0 to 31.
    pub(super) group: u32,
}

impl Inside {
    /// `small`, `scale` times its size, at `pose` in the frame of `large`.
    ///
    /// # Errors
    /// Where a shape cannot be scaled.
    pub fn new(large: &Model, small: &Model, scale: f32, pose: Pose3, density: f32) -> Result<Self> {
        let mut world = weightless_world();
        let plugin = IstPlugin::install(&mut world);
        let place = PairPlace { translation: Vector::ZERO, pose, scale, group: 0 };
        let pair = Pair::insert(&mut world, [large, small], &place, density)?;
        Ok(Self { world, plugin, large: pair.large, small: pair.small, pair })
    }

    /// Share of the small mesh's vertices inside the large mesh, given what the scene was made of.
    #[must_use]
    pub fn share_inside(&self, large: &Model, small: &Model) -> f64 {
        self.pair.share_inside(&self.world, [large, small])
    }
}

/// A world without gravity.
#[must_use]
pub(super) fn weightless_world() -> PhysicsWorld {
    PhysicsWorld { gravity: Vector::ZERO, ..PhysicsWorld::new() }
}

impl Pair {
    /// Adds the large and the small body.
    ///
    /// # Errors
    /// Where a shape cannot be scaled.
    pub(super) fn insert(
        world: &mut PhysicsWorld,
        [large, small]: [&Model; 2],
        place: &PairPlace,
        density: f32,
    ) -> Result<Self> {
        let group = Group::from_bits_truncate(1 << place.group.min(31));
        let groups = InteractionGroups::new(group, group, InteractionTestMode::And);
        let base = Pose3::from_translation(place.translation);
        let body = |pose| RigidBodyBuilder::dynamic().pose(pose);
        let (large, _) = world.insert(body(base), large.collider(1.0, density)?.collision_groups(groups));
        let (small, _) = world
            .insert(body(base * place.pose), small.collider(place.scale, density)?.collision_groups(groups));
        Ok(Self { large, small, scale: place.scale })
    }

    /// Share of the small mesh's vertices inside the large mesh.
    #[must_use]
    pub(super) fn share_inside(&self, world: &PhysicsWorld, [large, small]: [&Model; 2]) -> f64 {
        let [a, b] = [self.large, self.small].map(|handle| *world.bodies[handle].position());
        let pose = a.inv_mul(&b);
        let vertices = &small.solid.mesh().vertices;
        let inside = |v: &&glam::DVec3| large.solid.contains((pose * (v.as_vec3() * self.scale)).as_dvec3());
        vertices.iter().filter(inside).count() as f64 / vertices.len() as f64
    }
}
