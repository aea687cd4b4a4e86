//! A mesh with everything that a scene makes of it.

use anyhow::{Context, Result};
use packer::{PackOptions, Solid, TriangleMesh, pack};
use rapier_ist::IstShape;
use rapier3d::geometry::{ColliderBuilder, SharedShape};
use rapier3d::math::{Real, Vector};
use rapier3d::parry::transformation::voxelization::FillMode;
use rapier3d::prelude::TriMeshFlags;
use std::path::Path;

/// What stands for a mesh in the simulation: ours, or what Rapier offers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ShapeKind {
    /// An inner sphere tree.
    #[default]
    Ist,
    /// A compound of convex parts by volumetric hierarchical approximate convex decomposition.
    Vhacd,
    /// The hollow triangle mesh.
    Trimesh,
    /// Filled voxels, 32 along the longest side.
    Voxels,
}

/// A solid with longest side 1 m and its centroid at the origin.
#[derive(Clone, Debug)]
pub struct Model {
    /// Name for reports and recordings.
    pub name: String,
    /// The solid itself, exact.
    pub solid: Solid,
    /// Its spheres.
    pub packing: ist::SpherePacking,
    shape: SharedShape,
}

impl Model {
    /// Packs `mesh`, moved to its centroid and scaled to longest side 1, with `spheres` spheres.
    ///
    /// # Errors
    /// Where the mesh encloses no volume or cannot be packed; names the mesh.
    pub fn new(name: impl Into<String>, mesh: TriangleMesh, spheres: usize, kind: ShapeKind) -> Result<Self> {
        let name = name.into();
        let build = || -> Result<_> {
            let solid = Solid::new(&mesh)?;
            let (lower, upper) = solid.bounds();
            let (centroid, scale) = (solid.properties().centroid, 1.0 / (upper - lower).max_element());
            let vertices = solid.mesh().vertices.iter().map(|v| (*v - centroid) * scale).collect();
            let solid = Solid::new(&TriangleMesh { vertices, triangles: solid.mesh().triangles.clone() })?;
            let packing = pack(&solid, &PackOptions::balanced().spheres(spheres).source(&name))?.packing;
            let shape = shape(&solid, &packing, kind)?;
            Ok((solid, packing, shape))
        };
        let (solid, packing, shape) = build().with_context(|| format!("cannot use {name}"))?;
        Ok(Self { name, solid, packing, shape })
    }

    /// Loads a mesh file, as [`Self::new`].
    ///
    /// # Errors
    /// Where the file cannot be read, and as [`Self::new`].
    pub fn load(path: &Path, spheres: usize, kind: ShapeKind) -> Result<Self> {
        let mesh = TriangleMesh::load(path).with_context(|| format!("cannot use {}", path.display()))?;
        let name = path.file_stem().map_or_else(|| "mesh".into(), |stem| stem.to_string_lossy().into_owned());
        Self::new(name, mesh, spheres, kind)
    }

    /// A collider of longest side `size` (m). Whatever stands for the mesh, it weighs what the solid weighs.
    ///
    /// # Errors
    /// Where the shape cannot be scaled.
    pub fn collider(&self, size: Real, density: Real) -> Result<ColliderBuilder> {
        let scaled = self.shape.scale_dyn(Vector::splat(size), 0);
        let shape = scaled.with_context(|| format!("cannot scale {} to {size} m", self.name))?;
        let exact = IstShape::from_packing(&self.packing).scaled(size);
        let mass = exact.with_context(|| format!("{size} m is no size"))?;
        let mass = rapier3d::geometry::Shape::mass_properties(&mass, density);
        Ok(ColliderBuilder::new(SharedShape(shape.into())).mass_properties(mass))
    }
}

/// Vertices and triangles of `solid` in single precision.
#[must_use]
pub fn single_precision(solid: &Solid) -> (Vec<Vector>, Vec<[u32; 3]>) {
    (solid.mesh().vertices.iter().map(|v| v.as_vec3()).collect(), solid.mesh().triangles.clone())
}

fn shape(solid: &Solid, packing: &ist::SpherePacking, kind: ShapeKind) -> Result<SharedShape> {
    let (vertices, triangles) = single_precision(solid);
    Ok(match kind {
        ShapeKind::Ist => IstShape::from_packing(packing).into_shared(),
        ShapeKind::Vhacd => SharedShape::convex_decomposition(&vertices, &triangles),
        ShapeKind::Trimesh => {
            SharedShape::trimesh_with_flags(vertices, triangles, TriMeshFlags::FIX_INTERNAL_EDGES)?
        }
        ShapeKind::Voxels => {
            let fill = FillMode::FloodFill { detect_cavities: false };
            SharedShape::voxelized_mesh(&vertices, &triangles, 1.0 / 32.0, fill)
        }
    })
}
