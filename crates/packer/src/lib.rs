//! Fills closed triangle meshes with disjoint inner spheres that carry the volume of their power cell.
//!
//! ```no_run
//! use packer::{PackOptions, Solid, TriangleMesh, pack};
//!
//! let mesh = TriangleMesh::load("bunny.obj")?;
//! let solid = Solid::new(&mesh)?;
//! let packed = pack(&solid, &PackOptions::balanced())?;
//! println!("{} spheres fill {:.1} %", packed.report.spheres, 100.0 * packed.report.coverage);
//! std::fs::write("bunny.ist", packed.packing.to_bytes())?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! - [`TriangleMesh::load`] reads OBJ, STL, PLY and glTF.
//! - [`Solid::new`] mends what can be mended, refuses what has no inside and says why.
//! - [`pack()`] places the balls. Every ball lies inside the mesh and apart from all others, as exported in
//!   single precision; the cells tile the solid; a larger packing begins with the smaller one; and the
//!   result is the same bit by bit for any number of threads.
//! - [`PackOptions`] says when to stop: count, coverage, least radius, volume error, time. [`pack_interruptible`] can
//!   be ended by another thread.
//! - [`Quality`] has the figures of a finished packing: what the balls leave out, and where.
//! - The module `export` writes packings as CSV, JSON and URDF.
//!
//! # A tour
//!
//! **A mesh** is vertices and triangles, from a file or from anywhere. [`diagnose`] tells all that is wrong with it.
//!
//! ```
//! use glam::DVec3;
//! use packer::{MeshError, Solid, TriangleMesh, diagnose};
//!
//! // A cube of 1 m.
//! let corner = |i: usize| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64);
//! let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
//! let triangles = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
//! let mesh = TriangleMesh { vertices: (0..8).map(corner).collect(), triangles };
//! assert!(diagnose(&mesh).refusal().is_none());
//!
//! let solid = Solid::new(&mesh)?;
//! assert!((solid.properties().volume - 1.0).abs() < 1e-12);
//! assert!((solid.depth(DVec3::splat(0.5)) - 0.5).abs() < 1e-12);
//!
//! // Without its last face it has no inside.
//! let mut open = mesh.clone();
//! open.triangles.truncate(10);
//! let error = Solid::new(&open).unwrap_err();
//! println!("{error}");
//! # Ok::<(), MeshError>(())
//! ```
//!
//! **A packing** begins with a preset and stops. The report tells what came of it.
//!
//! ```
//! # use glam::DVec3;
//! # use packer::{Solid, TriangleMesh};
//! use packer::{PackOptions, StopReason, StopSignal, pack, pack_interruptible};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let corner = |i: usize| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64);
//! # let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
//! # let triangles = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
//! # let solid = Solid::new(&TriangleMesh { vertices: (0..8).map(corner).collect(), triangles })?;
//! let options = PackOptions::fast().spheres(50).source("cube");
//! let packed = pack(&solid, &options)?;
//! assert_eq!(packed.report.stop, StopReason::SphereCount);
//! assert!(packed.report.coverage > 0.6);
//!
//! // A larger packing begins with the smaller one.
//! let larger = pack(&solid, &options.clone().spheres(80))?;
//! for (sphere, same) in packed.packing.spheres().iter().zip(larger.packing.spheres()) {
//!     assert_eq!((sphere.center, sphere.radius), (same.center, same.radius));
//! }
//!
//! // Progress, and a signal by which another thread ends it: `finish` keeps what is there, `cancel` does not.
//! let signal = StopSignal::new();
//! let packed = pack_interruptible(&solid, &options, &signal, |progress| println!("{progress:?}"))?;
//!
//! // The bytes of an `.ist` file, equal for equal input.
//! let bytes = packed.packing.to_bytes();
//! # Ok(())
//! # }
//! ```
//!
//! [`Packed::report`] has a [`Quality`] unless `PackOptions::measure_quality` says no: mean and greatest distance of the surface
//! from the balls, the largest ball that would still fit, mass properties of the balls, the share of the volume that they put in
//! the wrong place.
//!
//! # Limits
//! The surface must be closed. Every edge must have two faces, or bound wedges of material as where two parts touch.
//! [`diagnose`] tells what is wrong with a mesh. A surface may cut itself and solids may overlap: what they wind around
//! is inside and counts once.
//!
//! # Features
//! - `cli` (default): the program `packer`. Libraries that pack at load time turn it off.
//! - `export`: the module of that name; part of `cli`.
//! - `serde-serialize`: [`PackReport`] and all in it implement serde's `Serialize`; part of `cli`.
#![cfg_attr(docsrs, feature(doc_cfg))]

mod error;
#[cfg(feature = "export")]
pub mod export;
mod load;
mod mesh;
mod pack;
mod solid;

pub use error::MeshError;
pub use mesh::TriangleMesh;
pub use pack::{
    LargestGap, MassError, PackError, PackOptions, PackReport, Packed, Progress, Quality, RadiusBin, Stage,
    StopReason, StopSignal, SurfaceGap, pack, pack_interruptible, pack_with_progress, provenance,
};
pub use solid::{Diagnosis, Findings, Solid, SurfacePoint, diagnose};
