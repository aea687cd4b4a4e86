//! A closed mesh as a solid: inside and outside, distances, mass properties.

mod bvh;
mod mass;
mod pseudonormals;
mod shells;
mod topology;
mod triangle;
mod weld;

use crate::{MeshError, TriangleMesh};
use bvh::{Bvh, Nearest};
use glam::DVec3;
use ist::SolidProperties;
use pseudonormals::Pseudonormals;

/// The solid that a closed triangle mesh encloses.
///
/// Building one welds coincident vertices, drops degenerate and duplicate faces, refuses what has no inside,
/// and orients every shell so that its normals leave the material; shells inside others are cavities.
#[derive(Clone, Debug)]
pub struct Solid {
    mesh: TriangleMesh,
    bvh: Bvh,
    pseudonormals: Pseudonormals,
    properties: SolidProperties,
    bounds: (DVec3, DVec3),
    diagnosis: Diagnosis,
}

/// What was found, and mended, in a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Diagnosis {
    /// Vertices as they came.
    pub input_vertices: usize,
    /// Triangles as they came.
    pub input_triangles: usize,
    /// Vertices after welding.
    pub vertices: usize,
    /// Triangles after cleaning.
    pub triangles: usize,
    /// Vertices that coincided with another one and were merged.
    pub merged_vertices: usize,
    /// Faces dropped because two corners were the same point.
    pub degenerate_faces: usize,
    /// Faces dropped because they occurred twice.
    pub duplicate_faces: usize,
    /// Faces turned to agree with their neighbours.
    pub turned_faces: usize,
    /// Connected parts of the surface.
    pub shells: usize,
    /// Shells that bound cavities.
    pub cavities: usize,
    /// Shells whose normals pointed into the material and were reversed.
    pub reversed_shells: usize,
}

/// The surface point nearest to a query point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The point (m).
    pub point: DVec3,
    /// Depth of the query point under the surface (m): positive inside, negative outside.
    pub depth: f64,
    /// Index of the triangle in [`Solid::mesh`].
    pub triangle: u32,
}

impl Solid {
    /// The solid enclosed by `mesh`.
    ///
    /// # Errors
    /// [`MeshError`] where the mesh has no triangles, numbers that are not finite, open or non-manifold
    /// edges, a one-sided surface, or encloses no volume.
    pub fn new(mesh: &TriangleMesh) -> Result<Self, MeshError> {
        mesh.validate()?;
        let (mut welded, welding) = weld::weld(mesh);
        if welded.triangles.len() < 4 {
            return Err(MeshError::TooFewTriangles { count: welded.triangles.len() });
        }
        let census = topology::edge_census(&welded);
        let ends = |edge: [u32; 2]| edge.map(|v| welded.vertices[v as usize]);
        if let Some((edge, faces)) = census.non_manifold.first() {
            let count = census.non_manifold.len();
            return Err(MeshError::NonManifoldEdges { count, first: ends(*edge), faces: *faces });
        }
        if let Some(edge) = census.open.first() {
            return Err(MeshError::OpenEdges { count: census.open.len(), first: ends(*edge) });
        }
        let mut neighbours = census.neighbours;
        let (shell_of, turned_faces) = topology::orient_consistently(&mut welded, &mut neighbours)?;
        let outward = shells::face_outward(&mut welded, &mut neighbours, &shell_of);

        let (lower, upper) = welded.bounds();
        let corners = || (0..welded.triangles.len()).map(|triangle| welded.corners(triangle));
        let properties = mass::properties(corners(), 0.5 * (lower + upper));
        let size = lower.distance(upper);
        // A sheet of paper, 1 m by 1 m and 0.1 mm thick, has 1e-4 of the cube of its size.
        let is_solid = properties.volume > 1e-12 * size.powi(3);
        if !is_solid {
            return Err(MeshError::ZeroVolume { volume: properties.volume, size });
        }
        let diagnosis = Diagnosis {
            input_vertices: mesh.vertices.len(),
            input_triangles: mesh.triangles.len(),
            vertices: welded.vertices.len(),
            triangles: welded.triangles.len(),
            merged_vertices: welding.merged_vertices,
            degenerate_faces: welding.degenerate_faces,
            duplicate_faces: welding.duplicate_faces,
            turned_faces,
            shells: outward.shells,
            cavities: outward.cavities,
            reversed_shells: outward.reversed,
        };
        let bvh = Bvh::new(corners());
        let pseudonormals = Pseudonormals::new(&welded, &neighbours);
        Ok(Self { bvh, pseudonormals, properties, bounds: (lower, upper), diagnosis, mesh: welded })
    }

    /// The surface: welded, closed, every shell oriented outwards.
    #[must_use]
    pub fn mesh(&self) -> &TriangleMesh {
        &self.mesh
    }

    /// What was found, and mended, in the mesh.
    #[must_use]
    pub fn diagnosis(&self) -> &Diagnosis {
        &self.diagnosis
    }

    /// Exact volume, centroid and inertia.
    #[must_use]
    pub fn properties(&self) -> &SolidProperties {
        &self.properties
    }

    /// Corners of the smallest axis-aligned box around the solid (m).
    #[must_use]
    pub fn bounds(&self) -> (DVec3, DVec3) {
        self.bounds
    }

    /// Diagonal of the bounding box (m): the size against which tolerances are measured.
    #[must_use]
    pub fn size(&self) -> f64 {
        self.bounds.0.distance(self.bounds.1)
    }

    /// Depth of `p` under the surface (m): the distance to the surface, positive inside and negative outside.
    #[must_use]
    pub fn depth(&self, p: DVec3) -> f64 {
        self.closest_point(p).depth
    }

    /// Whether `p` lies inside the solid, its surface included.
    #[must_use]
    pub fn contains(&self, p: DVec3) -> bool {
        self.depth(p) >= 0.0
    }

    /// The surface point nearest to `p`.
    #[must_use]
    pub fn closest_point(&self, p: DVec3) -> SurfacePoint {
        self.closest_point_within(p, f64::INFINITY).unwrap_or(SurfacePoint {
            // Only for a point that is not finite: nothing compares as near.
            point: p,
            depth: f64::NEG_INFINITY,
            triangle: 0,
        })
    }

    /// The surface point nearest to `p`, if there is one closer than `bound` (m); the smaller the bound, the
    /// faster the answer.
    #[must_use]
    pub fn closest_point_within(&self, p: DVec3, bound: f64) -> Option<SurfacePoint> {
        let nearest = self.bvh.nearest(p, bound * bound)?;
        let depth = nearest.distance_squared.sqrt();
        let depth = if self.is_outside(p, &nearest) { -depth } else { depth };
        Some(SurfacePoint { point: nearest.point, depth, triangle: nearest.triangle })
    }

    /// Corner positions of a triangle of [`Self::mesh`].
    pub(crate) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.mesh.corners(triangle as usize)
    }

    /// Whether the surface winds around `p`, by the majority of three rays; slower than
    /// [`Self::contains`], but independent of which surface point is nearest.
    pub(crate) fn winds_around(&self, p: DVec3) -> bool {
        // Directions that no modelled edge or face is aligned with.
        let winds = |x, y, z| self.bvh.winding(p, DVec3::new(x, y, z)) != 0;
        let first = winds(0.531_702, 0.274_161, 0.801_343);
        let second = winds(-0.661_329, 0.722_457, 0.201_711);
        if first == second { first } else { winds(0.172_343, -0.812_929, -0.556_261) }
    }

    /// Whether the surface is folded somewhere, so that [`Self::contains`] is worth a second opinion.
    pub(crate) fn has_folds(&self) -> bool {
        self.pseudonormals.has_folds()
    }

    fn is_outside(&self, p: DVec3, nearest: &Nearest) -> bool {
        if self.pseudonormals.is_doubtful(nearest.triangle, nearest.feature) {
            return !self.winds_around(p);
        }
        (p - nearest.point).dot(self.pseudonormals.at(nearest.triangle, nearest.feature)) > 0.0
    }
}

pub(crate) use triangle::closest_point as closest_point_of_triangle;
