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
//! Units are SI throughout (m, m², m³, N, N·m); frames are named by suffix: `_a` for the frame of the first
//! solid, `_b` for the second.
//!
//! # Features
//! - `std` (default): file access, queries within a budget.
//! - `parallel`: grids and batches on all cores.
//!
//! # Determinism
//! Results have the same bits on any number of threads and on every instruction set that a binary finds at run time; but not
//! queries with a budget of time. Binaries that were compiled for other processors may differ.
//!
//! Without `std` the crate needs `alloc`, and queries use the instruction set that it is compiled for instead of the best
//! that the processor has.
#![cfg_attr(not(feature = "std"), no_std)]

extern crate alloc;

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
    OverlapWorkspace, Stiffness, overlap_batch,
};
pub use packing::{PackingError, SpherePacking};
pub use patches::ContactPatch;
pub use proximity::{
    BallContact, BallKind, DistanceOptions, Impact, ImpactOptions, NearestSphere, Penetration,
    ProximityWorkspace, Ray, RayHit, RigidMotion, Separation, SurfaceGap, TimeOfImpact,
};
pub use signed_distance::{SignedDistance, SurfaceDistance};
pub use solid::SolidProperties;
pub use sphere::InnerSphere;
pub use tree::InnerSphereTree;
