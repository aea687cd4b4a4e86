//! A closed mesh as a solid: inside and outside, distances, mass properties.

mod bvh;
mod clean;
mod contact;
mod diagnosis;
mod examine;
mod mass;
mod meetings;
mod parts;
mod plane;
mod pseudonormals;
mod radial;
mod shell_pairs;
mod shells;
mod topology;
mod trapezoids;
mod triangle;
mod visible;
mod weld;

pub use diagnosis::{Diagnosis, Findings};

use crate::{MeshError, TriangleMesh};
use bvh::Nearest;
use examine::{Surface, examine};
use glam::DVec3;
use ist::SolidProperties;

/// The solid that a closed triangle mesh encloses.
///
/// Building one welds coincident vertices, drops degenerate and duplicate faces, refuses what has no inside,
/// and orients every shell so that its normals leave the material. Shells inside others are cavities, unless they touch
/// their inside. Solids that overlap add up to their union; where a surface cuts itself, all is inside that it winds around.
#[derive(Clone, Debug)]
pub struct Solid {
    surface: Surface,
    bounds: (DVec3, DVec3),
    diagnosis: Diagnosis,
}

/// Finds all that is wrong with a mesh, whether it can be packed or not.
///
/// As fast as [`Solid::new`], which does the same and keeps the surface: O(n log n) for n triangles.
#[must_use]
pub fn diagnose(mesh: &TriangleMesh) -> Diagnosis {
    examine(mesh).0
}

/// The surface point nearest to a query point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SurfacePoint {
    /// The point (m).
    pub point: DVec3,
    /// Depth of the query point under the surface (m): positive inside, negative outside.
    pub depth: f64,
    /// Index of the triangle in [`Solid::surface`].
    pub triangle: u32,
}

impl Solid {
    /// The solid enclosed by `mesh`.
    ///
    /// # Errors
    /// [`MeshError`] where the mesh has no triangles, fewer than four that are not degenerate, faces at vertices that do not
    /// exist, numbers that are not finite, open or non-manifold edges, a one-sided surface, encloses no volume, cuts itself a
    /// million times, has a size that single precision cannot hold the volumes of, or is too thin for it at its place.
    pub fn new(mesh: &TriangleMesh) -> Result<Self, MeshError> {
        let (diagnosis, surface) = examine(mesh);
        match (diagnosis.refusal(), surface) {
            (None, Some(surface)) => Ok(Self { bounds: surface.mesh.bounds(), surface, diagnosis }),
            (Some(error), _) => Err(error),
            (None, None) => Err(MeshError::NoTriangles),
        }
    }

    /// The mesh: welded, closed, every shell oriented outwards. It encloses the same solid when it is read again.
    #[must_use]
    pub fn mesh(&self) -> &TriangleMesh {
        self.surface.closed.as_ref().unwrap_or(&self.surface.mesh)
    }

    /// What bounds the solid: [`Self::mesh`], but where that cuts or covers itself only what bounds the union. Triangles
    /// are cut there, and their parts meet without common vertices.
    #[must_use]
    pub fn surface(&self) -> &TriangleMesh {
        &self.surface.mesh
    }

    /// What was found, and mended, in the mesh.
    #[must_use]
    pub fn diagnosis(&self) -> &Diagnosis {
        &self.diagnosis
    }

    /// Exact volume, centroid and inertia; what overlaps counts once.
    #[must_use]
    pub fn properties(&self) -> &SolidProperties {
        &self.surface.properties
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

    /// The surface point nearest to `p`. One that is not finite is its own, of triangle 0, at a depth of −∞.
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
    pub(crate) fn closest_point_within(&self, p: DVec3, bound: f64) -> Option<SurfacePoint> {
        let nearest = self.surface.bvh.nearest(p, bound * bound)?;
        let depth = nearest.distance_squared.sqrt();
        // Far out differences are lost in rounding, or overflow, and their signs are worth nothing.
        let depth = if !self.bounds_hold(p) || self.is_outside(p, &nearest) { -depth } else { depth };
        Some(SurfacePoint { point: nearest.point, depth, triangle: nearest.triangle })
    }

    /// Corner positions of a triangle of [`Self::surface`].
    pub(crate) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.surface.mesh.corners(triangle as usize)
    }

    /// Whether the surface winds around `p`, by the majority of three rays: independent of which surface point is nearest.
    /// Slower than [`Self::contains`], but where much of the surface is about as near, as from the middle of a ball.
    pub(crate) fn winds_around(&self, p: DVec3) -> bool {
        // Directions that no modelled edge or face is aligned with.
        let bvh = self.surface.uncut.as_ref().unwrap_or(&self.surface.bvh);
        let winds = |x, y, z| bvh.winding(p, DVec3::new(x, y, z), &[]) != 0;
        let first = winds(0.531_702, 0.274_161, 0.801_343);
        let second = winds(-0.661_329, 0.722_457, 0.201_711);
        if first == second { first } else { winds(0.172_343, -0.812_929, -0.556_261) }
    }

    fn bounds_hold(&self, p: DVec3) -> bool {
        let (lower, upper) = self.bounds;
        lower.cmple(p).all() && p.cmple(upper).all()
    }

    /// Whether the surface is folded or cuts itself somewhere, so that [`Self::contains`] is worth a second opinion.
    pub(crate) fn has_folds(&self) -> bool {
        self.surface.pseudonormals.has_doubts()
    }

    fn is_outside(&self, p: DVec3, nearest: &Nearest) -> bool {
        if self.surface.pseudonormals.is_doubtful(nearest.triangle, nearest.feature) {
            return !self.winds_around(p);
        }
        (p - nearest.point).dot(self.surface.pseudonormals.at(nearest.triangle, nearest.feature)) > 0.0
    }
}

pub(crate) use triangle::closest_point as closest_point_of_triangle;
