//! Fills closed triangle meshes with disjoint inner spheres that carry the volume of their power cell.

mod error;
mod load;
mod mesh;
mod pack;
mod solid;

pub use error::MeshError;
pub use mesh::TriangleMesh;
pub use pack::{PackError, PackOptions, PackReport, Packed, Progress, StopReason, pack, pack_with_progress};
pub use solid::{Diagnosis, Solid, SurfacePoint};
