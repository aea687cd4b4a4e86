//! Inner sphere trees: the inside that a triangle mesh lacks.
//!
//! A closed mesh is filled with disjoint spheres (crate `rapier-ist-packer`); this crate stores that
//! [`SpherePacking`], puts a hierarchy over it ([`InnerSphereTree`]) and answers what two overlapping solids
//! do to each other at any relative pose: overlap volume, its centroid and gradient, contact area, force and
//! torque, stiffness, and the contact samples that a solver needs.
//!
//! After R. Weller and G. Zachmann, *A unified approach for physically-based simulations and haptic
//! rendering* (inner sphere trees, Sandbox 2009; RSS 2009), with one departure: every sphere also carries the volume
//! of its *power cell*, and overlap is measured with the ball of that volume instead of the inner ball.
//! The gaps between inner balls are then counted once instead of being lost twice, which makes overlap
//! volumes one to two orders of magnitude more accurate at nearly the same cost (see [`InnerSphere::volume_ball`]).
//!
//! ```
//! use glam::Vec3;
//! use glamx::Pose3;
//! use ist::{InnerSphere, InnerSphereTree, OverlapWorkspace, SolidProperties, SpherePacking};
//!
//! // Two unit balls, each packed with the one sphere that fills it.
//! let ball = InnerSphere::solid_ball(Vec3::ZERO, 1.0, Vec3::X);
//! let packing = SpherePacking::new(vec![ball], SolidProperties::ball(1.0))?;
//! let tree = InnerSphereTree::new(&packing);
//!
//! let mut workspace = OverlapWorkspace::default();
//! let overlap = tree.overlap(&tree, &Pose3::translation(1.5, 0.0, 0.0), &mut workspace);
//! let exact = std::f32::consts::PI * (4.0 + 1.5) * (2.0 - 1.5_f32).powi(2) / 12.0;
//! assert!((overlap.volume - exact).abs() < 1e-5);
//! assert!(overlap.force.x > 0.0, "the force on B points away from A");
//! # Ok::<(), ist::PackingError>(())
//! ```
//!
//! # A tour
//!
//! **From a packing to a tree.** A packing comes from the packer, as a rule in an `.ist` file. Here it is a dumbbell of two balls
//! on the x axis, made by hand.
//!
//! ```
//! use glam::{DMat3, DVec3, Vec3};
//! use ist::{InnerSphere, InnerSphereTree, SolidProperties, SpherePacking};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let ends = [-1.0, 1.0].map(|x| InnerSphere::solid_ball(Vec3::new(x, 0.0, 0.0), 0.5, Vec3::X * x));
//! let ball = SolidProperties::ball(0.5);
//! // By the parallel axis theorem, with both balls 1 m from the common centroid.
//! let across = 2.0 * (ball.unit_inertia.y_axis.y + ball.volume);
//! let inertia = DVec3::new(2.0 * ball.unit_inertia.x_axis.x, across, across);
//! let solid = SolidProperties {
//!     volume: 2.0 * ball.volume,
//!     centroid: DVec3::ZERO,
//!     unit_inertia: DMat3::from_diagonal(inertia),
//! };
//! let packing = SpherePacking::new(ends.to_vec(), solid)?;
//! assert!((packing.coverage() - 1.0).abs() < 1e-6, "balls fill what is made of balls");
//!
//! // The file's bytes and back; `SpherePacking::load` reads a file.
//! let packing = SpherePacking::from_bytes(&packing.to_bytes())?;
//! let dumbbell = InnerSphereTree::new(&packing);
//!
//! // O(1), and the hierarchy is shared.
//! let small = dumbbell.scaled(0.5).ok_or("a scale is positive and finite")?;
//! assert_eq!((dumbbell.len(), small.scale()), (2, 0.5));
//! # Ok(())
//! # }
//! ```
//!
//! **What overlap tells.** Queries take the pose of B in A's frame and memory that is used again. Forces are for a
//! stiffness of 1 N/m³ and act on B; A feels the opposite.
//!
//! ```
//! # use glam::{DMat3, DVec3, Vec3};
//! # use glamx::Pose3;
//! # use ist::*;
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let ends = [-1.0, 1.0].map(|x| InnerSphere::solid_ball(Vec3::new(x, 0.0, 0.0), 0.5, Vec3::X * x));
//! # let ball = SolidProperties::ball(0.5);
//! # let solid = SolidProperties { volume: 2.0 * ball.volume, centroid: DVec3::ZERO, unit_inertia: DMat3::IDENTITY };
//! # let dumbbell = InnerSphereTree::new(&SpherePacking::new(ends.to_vec(), solid)?);
//! let mut workspace = OverlapWorkspace::default();
//! // B lies above A, both ends in both ends of A.
//! let pose = Pose3::translation(0.0, 0.8, 0.0);
//! let overlap = dumbbell.overlap(&dumbbell, &pose, &mut workspace);
//! assert!(overlap.intersects && overlap.pairs == 2);
//! assert!(overlap.force.y > 0.0 && overlap.force.y > 100.0 * overlap.force.x.abs(), "upwards");
//! let lens = ist::lens::Lens::new(0.5, 0.5, 0.8);
//! assert!((f64::from(overlap.volume) - 2.0 * lens.volume).abs() < 1e-5);
//!
//! // Another force law, with the second derivative of the volume.
//! let query = OverlapQuery { law: ForceLaw::VolumeGradient, stiffness: true, ..OverlapQuery::default() };
//! let overlap = dumbbell.overlap_with(&dumbbell, &pose, query, &mut workspace);
//! assert!(overlap.stiffness.is_some());
//!
//! // The two regions apart, each with its force and four points.
//! let mut patches = Vec::new();
//! dumbbell.contact_patches(&dumbbell, &pose, &mut workspace, &mut patches);
//! assert_eq!(patches.len(), 2);
//! # Ok(())
//! # }
//! ```
//!
//! `overlap_cached` is faster for bodies that move little from query to query, [`overlap_batch`] asks for many pairs at once,
//! `overlap_within` ends within a budget of time with bounds for the volume, and [`SignedDistance`] puts any other solid in the
//! place of B.
//!
//! **Where solids are, apart or not.** These queries see the certified inner balls, which lie in the solid.
//!
//! ```
//! # use glam::{DMat3, DVec3, Vec3};
//! # use glamx::Pose3;
//! # use ist::*;
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let ends = [-1.0, 1.0].map(|x| InnerSphere::solid_ball(Vec3::new(x, 0.0, 0.0), 0.5, Vec3::X * x));
//! # let ball = SolidProperties::ball(0.5);
//! # let solid = SolidProperties { volume: 2.0 * ball.volume, centroid: DVec3::ZERO, unit_inertia: DMat3::IDENTITY };
//! # let dumbbell = InnerSphereTree::new(&SpherePacking::new(ends.to_vec(), solid)?);
//! let mut workspace = ProximityWorkspace::default();
//! let apart = Pose3::translation(0.0, 3.0, 0.0);
//! let nearest = dumbbell.distance(&dumbbell, &apart, &mut workspace).ok_or("no pose")?;
//! assert!((nearest.distance - 2.0).abs() < 1e-5);
//!
//! // B falls at 4 m/s, and is there after half a second.
//! let falling = RigidMotion { linear_velocity: -4.0 * Vec3::Y, ..RigidMotion::at_rest(apart) };
//! let motions = [RigidMotion::at_rest(Pose3::IDENTITY), falling];
//! let impact = dumbbell.time_of_impact(&dumbbell, &motions, &ImpactOptions::default(), &mut workspace);
//! assert!(matches!(impact, TimeOfImpact::Hit(impact) if (impact.time - 0.5).abs() < 1e-4));
//!
//! // The shortest way out of an overlap.
//! let way_out = dumbbell.penetration(&dumbbell, &Pose3::translation(0.0, 0.8, 0.0), &mut workspace);
//! assert!((way_out.ok_or("no way")?.translation.y - 0.2).abs() < 1e-3);
//!
//! // Points and rays against one solid.
//! assert!(dumbbell.contains_point(Vec3::X, BallKind::Inner) && !dumbbell.contains_point(Vec3::ZERO, BallKind::Inner));
//! let ray = Ray { origin: Vec3::new(-5.0, 0.0, 0.0), direction: Vec3::X, max_time: 10.0 };
//! let hit = dumbbell.cast_ray(&ray, true, BallKind::Inner).ok_or("missed")?;
//! assert!((hit.time - 3.5).abs() < 1e-5);
//! # Ok(())
//! # }
//! ```
//!
//! Units are SI throughout (m, m², m³, N, N·m). `_a` and `_b` tell which solid something belongs to; the frame is that of A, but
//! for impacts the world.
//!
//! # Features
//! - `std` (default): file access, queries within a budget.
//! - `parallel`: grids and batches on all cores.
//!
//! # Determinism
//! Results have the same bits on any number of threads, on every instruction set that a binary finds at run time, and in
//! binaries for generic x86-64 and for the processor at hand; but not queries with a budget of time.
//!
//! Without `std` the crate needs `alloc`, and queries use the instruction set that it is compiled for instead of the best
//! that the processor has.
#![cfg_attr(not(feature = "std"), no_std)]
#![cfg_attr(docsrs, feature(doc_cfg))]

extern crate alloc;

mod certified;
mod file;
mod grid;
pub mod lens;
mod overlap;
mod packing;
mod patches;
mod proximity;
pub mod reference;
mod rotation;
mod signed_distance;
mod simd_level;
mod solid;
mod sphere;
mod tree;

pub use file::{FileError, Provenance};
pub use grid::SphereGrid;
#[cfg(feature = "std")]
pub use overlap::{Budget, OverlapEstimate, TimeCriticalWorkspace};
pub use overlap::{
    ContactSample, DeepestPair, Engine, ForceLaw, Overlap, OverlapCache, OverlapPair, OverlapQuery,
    OverlapWorkspace, StiffnessMatrix, overlap_batch,
};
pub use packing::{PackingError, SpherePacking};
pub use patches::ContactPatch;
pub use proximity::{
    BallContact, BallKind, DistanceOptions, Impact, ImpactOptions, NearestSphere, Penetration,
    ProximityWorkspace, Ray, RayHit, RigidMotion, Separation, SurfaceSeparation, TimeOfImpact,
};
pub use signed_distance::{SignedDistance, SurfaceDistance};
pub use solid::SolidProperties;
pub use sphere::InnerSphere;
pub use tree::InnerSphereTree;
