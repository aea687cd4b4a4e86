//! Dynamic non-convex bodies that simply collide: volume-penalty contacts for Rapier.
//!
//! Rapier's triangle meshes are hollow. An [`IstShape`] has an inside: an inner sphere tree (crate
//! `rapier-ist-core`) that tells how much two solids overlap. An [`IstPlugin`] steps the world and pushes overlapping
//! bodies apart with a force in proportion to the volume, found by a linearly implicit solve, which is stable at any
//! stiffness.
//!
//! ```
//! use ist::{InnerSphere, SolidProperties, SpherePacking};
//! use rapier_ist::{IstPlugin, IstShape};
//! use rapier3d::prelude::*;
//!
//! // One sphere is a packing of a ball; the packer makes packings of meshes.
//! let sphere = InnerSphere::solid_ball(Vector::ZERO, 0.1, Vector::Y);
//! let ball = IstShape::from_packing(&SpherePacking::new(vec![sphere], SolidProperties::ball(0.1))?);
//!
//! let mut world = PhysicsWorld::new();
//! let mut plugin = IstPlugin::install(&mut world);
//! world.insert(RigidBodyBuilder::fixed(), ball.clone().into_collider());
//! let falling = RigidBodyBuilder::dynamic().translation(Vector::new(0.0, 0.3, 0.0));
//! let (falling, _) = world.insert(falling, ball.into_collider());
//! for _ in 0..60 {
//!     plugin.step(&mut world);
//! }
//! assert!(world.bodies[falling].translation().y > 0.19, "it lies on the other ball");
//! # Ok::<(), ist::PackingError>(())
//! ```
//!
//! An [`IstShape`] also collides with Rapier's own shapes, in the same solve. Colliders keep their friction, restitution,
//! combine rules, contact skin, groups and sensors; hooks and events go through [`IstPlugin::step_with_events`].
//! [`ContactModel::VolumeManifold`] hands the same overlap to Rapier's own solver instead.
//!
//! # A tour
//!
//! **Shapes** come from packings, see the crate `rapier-ist-packer`: `IstShape::from_file` for files, `IstShape::from_mesh` with the
//! feature `packer`. Cloning and scaling share the tree.
//!
//! **Settings and reports** are the plugin's. All may change between steps.
//!
//! ```
//! use ist::{InnerSphere, SolidProperties, SpherePacking};
//! use rapier_ist::{ContactModel, IstPlugin, IstShape, Stiffness, VolumePenalty};
//! use rapier3d::prelude::*;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let sphere = InnerSphere::solid_ball(Vector::ZERO, 0.1, Vector::Y);
//! let shape = IstShape::from_packing(&SpherePacking::new(vec![sphere], SolidProperties::ball(0.1))?);
//! let large = shape.scaled(2.0).ok_or("a size is positive and finite")?;
//!
//! let mut world = PhysicsWorld::new();
//! let mut plugin = IstPlugin::install(&mut world);
//! plugin.substeps = 2;
//! plugin.model = ContactModel::VolumePenalty(VolumePenalty {
//!     stiffness: Stiffness::Uniform(1e6), // N/m³
//!     ..VolumePenalty::default()
//! });
//!
//! // Rapier's own shapes take part; materials are those of the colliders.
//! let (_, floor) = world.insert(RigidBodyBuilder::fixed(), ColliderBuilder::cuboid(5.0, 0.1, 5.0).friction(0.5));
//! let start = RigidBodyBuilder::dynamic().translation(0.5 * Vector::Y).can_sleep(false);
//! let (body, ball) = world.insert(start, large.into_collider().density(500.0).restitution(0.2));
//! // A soft floor: one stiffness for a collider instead of the model's.
//! plugin.set_collider_stiffness(floor, Some(1e5));
//! for _ in 0..240 {
//!     plugin.step(&mut world);
//! }
//!
//! // What carries the ball: a force in proportion to the overlap volume.
//! let contact = plugin.report().contact(floor, ball).ok_or("it has not landed")?;
//! let weight = 9.81 * world.bodies[body].mass();
//! assert!((contact.force.length() - weight).abs() < 0.02 * weight);
//! assert!((1e5 * contact.volume - weight).abs() < 0.02 * weight);
//! # Ok(())
//! # }
//! ```
//!
//! **Worlds that are kept apart**: [`WorldParts`] stands for a `PhysicsWorld` where the sets are somebody else's, as a game engine's.
//! Hooks and event handlers go through [`IstPlugin::step_with_events`].
//!
//! **Records of a run** are MCAP files: the modules `record` and `replay` (feature `mcap`). The module `snapshot` (feature
//! `serde-serialize`) saves and restores worlds, `debug_render` (feature `debug-render`) draws the spheres.
//!
//! # Features
//! - `mcap`: `record`, trajectories in MCAP files with Foxglove's schemas, and `replay`, which reads them back.
//! - `packer`: `IstShape::from_mesh`.
//! - `debug-render`: as Rapier's feature of that name, and `debug_render`, outlines of the spheres.
//! - `parallel`, `serde-serialize`: as Rapier's features of these names.
//! - `enhanced-determinism`: as Rapier's feature of that name, see below.
//!
//! # Determinism
//! Equal worlds that are stepped equally stay equal bit for bit, on any number of threads: for one binary on one machine, without
//! any feature. Queries are the same for generic x86-64 and the processor at hand, whatever instruction set they find.
//!
//! Steps are meant to be so with `enhanced-determinism`. What differs without it are sine and cosine, which come from the
//! platform, and sums over the components of quaternions, whose order depends on the processor's vectors. Links of multibodies
//! with more than five degrees of freedom are left out: Rapier multiplies their matrices by a library that fuses products and
//! sums where the processor can.
#![cfg_attr(docsrs, feature(doc_cfg))]

mod against_shape;
mod arrival;
mod bodies;
mod candidates;
mod collect;
mod contact_law;
mod containment;
#[cfg(feature = "debug-render")]
pub mod debug_render;
mod dispatcher;
mod drives;
mod force_events;
#[cfg(feature = "packer")]
mod from_mesh;
mod hooks;
mod joint_rows;
mod joints;
mod kinematic;
mod links;
mod lookahead;
mod memory;
mod mesh_surface;
mod mesh_trees;
mod model;
mod modified_contacts;
mod nearest_triangle;
mod penalty;
mod permission;
mod plugin;
mod query;
#[cfg(feature = "mcap")]
pub mod record;
mod remeasure;
mod remembered;
#[cfg(feature = "mcap")]
pub mod replay;
mod report;
mod response;
mod shape;
#[cfg(feature = "serde-serialize")]
pub mod snapshot;
mod solution;
mod stiffness;
mod supports;
mod touching;
mod triangle_tree;
mod user_forces;
mod waking;
mod world_parts;

pub use dispatcher::IstDispatcher;
#[cfg(feature = "packer")]
pub use from_mesh::FromMeshError;
pub use model::{ContactModel, Stiffness, VolumePenalty};
pub use plugin::IstPlugin;
pub use remembered::Remembered;
pub use report::{ContactState, PairContact, PatchContact, StepReport};
pub use shape::IstShape;
pub use stiffness::StiffnessContext;
pub use world_parts::WorldParts;
