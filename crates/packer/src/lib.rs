//! Fills closed triangle meshes with disjoint inner spheres that carry the volume of their power cell.

mod mesh;

pub use mesh::TriangleMesh;
