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
//! # Limits
//! The surface must be closed. Every edge must have two faces, or bound wedges of material as where two parts touch.
//! [`diagnose`] tells what is wrong with a mesh. A surface may cut itself and solids may overlap: what they wind around
//! is inside and counts once.
//!
//! # Features
//! - `cli` (default): the program `packer`. Libraries that pack at load time turn it off.
//! - `export`: the module of that name; part of `cli`.
//! - `serde-serialize`: [`PackReport`] and all in it implement serde's `Serialize`; part of `cli`.

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
