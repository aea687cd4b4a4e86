//! What a recording says about a body once.

use ist::SpherePacking;
use rapier3d::math::Vector;
use std::sync::Arc;

/// A recorded body.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct ReplayBody {
    /// Its name, which is also that of its frame: no other body of the recording has it.
    pub name: String,
    /// Its triangles, if it was described with a mesh.
    pub mesh: Option<ReplayMesh>,
    /// Centres and radii of its inner spheres in its frame (m); none where packings were not recorded.
    pub spheres: Vec<(Vector, f32)>,
    /// Its packing, if packings were recorded.
    pub packing: Option<ReplayPacking>,
}

/// Triangles in the frame of a body.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct ReplayMesh {
    /// Positions of the vertices (m), all finite.
    pub vertices: Vec<Vector>,
    /// Indices of the vertices of each triangle, all of them there.
    pub triangles: Vec<[u32; 3]>,
    /// Red, green, blue and opacity, 0 to 1 each.
    pub color: [f32; 4],
}

/// The packing of a body.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ReplayPacking {
    /// The packing itself; bodies that were described with equal ones share it.
    pub packing: Arc<SpherePacking>,
    /// Size of the body relative to the packing.
    pub scale: f32,
}
