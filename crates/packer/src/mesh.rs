//! Indexed triangle meshes.

use crate::MeshError;
use glam::DVec3;

/// A triangle mesh in double precision; counter-clockwise triangles seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    /// Vertex positions (m).
    pub vertices: Vec<DVec3>,
    /// Vertex indices of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl TriangleMesh {
    /// Corner positions of triangle `index`.
    ///
    /// # Panics
    /// If the triangle or one of its vertices does not exist.
    #[must_use]
    pub fn corners(&self, index: usize) -> [DVec3; 3] {
        self.triangles[index].map(|v| self.vertices[v as usize])
    }

    /// Corners of the smallest axis-aligned box around the vertices (m); without vertices (+∞, −∞).
    #[must_use]
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        self.vertices.iter().fold(empty, |(lower, upper), v| (lower.min(*v), upper.max(*v)))
    }

    /// A hash of positions and faces that does not depend on platform or program version (FNV-1a, 64 bits).
    #[must_use]
    pub fn content_hash(&self) -> u64 {
        let positions = self.vertices.iter().flat_map(|v| v.to_array()).map(f64::to_bits);
        let indices = self.triangles.iter().flatten().map(|i| u64::from(*i));
        positions.chain(indices).fold(0xcbf2_9ce4_8422_2325, |hash, word| {
            word.to_le_bytes()
                .iter()
                .fold(hash, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
        })
    }

    /// Refuses what no later stage can work with: no faces, numbers that are not finite, dangling indices.
    pub(crate) fn validate(&self) -> Result<(), MeshError> {
        if self.triangles.is_empty() {
            return Err(MeshError::NoTriangles);
        }
        if let Some((index, position)) = self.vertices.iter().enumerate().find(|(_, v)| !v.is_finite()) {
            return Err(MeshError::VertexNotFinite { index, position: *position });
        }
        let count = self.vertices.len();
        for (triangle, corners) in self.triangles.iter().enumerate() {
            if let Some(vertex) = corners.iter().find(|v| **v as usize >= count) {
                return Err(MeshError::IndexOutOfRange { triangle, vertex: *vertex, count });
            }
        }
        Ok(())
    }
}
