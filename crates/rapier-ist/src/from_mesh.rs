//! Packing meshes at load time (feature `packer`).

use crate::IstShape;
use packer::{MeshError, PackError, PackOptions, Solid, TriangleMesh};
use rapier3d::math::Vector;

/// Why a mesh is no shape.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FromMeshError {
    /// The triangles enclose no solid.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The solid could not be packed.
    #[error(transparent)]
    Pack(#[from] PackError),
}

impl IstShape {
    /// The solid inside a closed triangle mesh (vertices in metres), packed now with `spheres` spheres: a third of a
    /// second for a thousand. Games pack ahead of time and use [`Self::from_file`].
    ///
    /// # Errors
    /// Where the mesh is open or otherwise encloses no solid, or `spheres` is zero; the error names the place.
    pub fn from_mesh(
        vertices: &[Vector],
        triangles: &[[u32; 3]],
        spheres: usize,
    ) -> Result<Self, FromMeshError> {
        let vertices = vertices.iter().map(|v| v.as_dvec3()).collect();
        let solid = Solid::new(&TriangleMesh { vertices, triangles: triangles.to_vec() })?;
        Ok(Self::from_packing(&packer::pack(&solid, &PackOptions::balanced().spheres(spheres))?.packing))
    }
}
