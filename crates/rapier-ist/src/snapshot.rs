//! Saving and restoring worlds (feature `serde-serialize`).
//!
//! Rapier cannot serialise custom shapes: a world with an [`IstShape`] fails to. So every such collider is saved with a
//! ball in its place, and gets its solid back after loading. What tells which solid that is, is the user's choice:
//! the collider's handle, which a snapshot keeps, or its `user_data`.
//!
//! ```no_run
//! use rapier_ist::{IstPlugin, IstShape, snapshot};
//! use rapier3d::prelude::*;
//!
//! # fn bytes(_: &PhysicsWorld) -> Vec<u8> { Vec::new() }
//! # fn world(_: &[u8]) -> PhysicsWorld { PhysicsWorld::new() }
//! # fn example(mut world_before: PhysicsWorld, shapes: Vec<IstShape>) {
//! // `bytes` and `world` stand for a format of serde's. Colliders keep an index into `shapes` in their user data.
//! let saved = snapshot::save(&mut world_before, bytes);
//! let mut restored = world(&saved);
//! snapshot::restore(&mut restored.colliders, |_, collider| shapes.get(collider.user_data as usize).cloned());
//! let mut plugin = IstPlugin::install(&mut restored);
//! plugin.step(&mut restored);
//! # }
//! ```
//!
//! With a clone of the plugin the restored world moves on as the saved one, bit for bit, as long as nothing sleeps: to Rapier the
//! colliders have a new shape, and it wakes their bodies. A new plugin, as one that is loaded by another process, knows nothing of
//! contacts under way and begins its solves without a guess: contacts at rest hold, but four cubes in a heap ended 4 to 44 mm from where
//! they would have, and up to 0.65 m where they rebound. Under [`ContactModel::VolumeManifold`](crate::ContactModel::VolumeManifold) it also
//! measures contacts anew that it would have recycled; without `contact_recycling` that makes no difference either. Of
//! a plugin that is not cloned, copy `model`, `substeps` and stiffnesses of colliders and pairs.
//!
//! Compounds that hold an [`IstShape`] are replaced as a whole; give them back as a [`SharedShape`].

use crate::IstShape;
use rapier3d::geometry::{Collider, ColliderHandle, ColliderSet, Shape, SharedShape};
use rapier3d::pipeline::PhysicsWorld;

/// Calls `write` on `world` with a ball in place of every [`IstShape`] and every compound that holds one, and leaves the world as it was.
pub fn save<T>(world: &mut PhysicsWorld, write: impl FnOnce(&PhysicsWorld) -> T) -> T {
    let stand_ins = stand_ins(&world.colliders);
    let colliders = std::mem::replace(&mut world.colliders, stand_ins);
    let written = write(world);
    world.colliders = colliders;
    written
}

/// A copy of `colliders` that Rapier can serialise: each [`IstShape`], and each compound that holds one, is replaced by its
/// bounding ball.
///
/// For who keeps Rapier's sets without a [`PhysicsWorld`], which [`save`] takes.
#[must_use]
pub fn stand_ins(colliders: &ColliderSet) -> ColliderSet {
    let mut copy = colliders.clone();
    for (handle, collider) in colliders.iter() {
        let shape = collider.shape();
        let radius = match shape.as_shape::<IstShape>() {
            Some(solid) => solid.tree().bounding_ball().1,
            None if holds_a_solid(shape) => shape.compute_local_bounding_sphere().radius(),
            None => continue,
        };
        if let Some(collider) = copy.get_mut(handle) {
            collider.set_shape(SharedShape::ball(radius));
        }
    }
    copy
}

fn holds_a_solid(shape: &dyn Shape) -> bool {
    let Some(compound) = shape.as_compound() else { return false };
    compound.shapes().iter().any(|(_, part)| part.as_shape::<IstShape>().is_some() || holds_a_solid(&**part))
}

/// Gives the colliders that `shape` knows their solids back. Call it before the first step after loading.
pub fn restore<S: Into<SharedShape>>(
    colliders: &mut ColliderSet,
    mut shape: impl FnMut(ColliderHandle, &Collider) -> Option<S>,
) {
    let known: Vec<_> =
        colliders.iter().filter_map(|(handle, c)| Some((handle, shape(handle, c)?))).collect();
    for (handle, shape) in known {
        if let Some(collider) = colliders.get_mut(handle) {
            collider.set_shape(shape.into());
        }
    }
}
