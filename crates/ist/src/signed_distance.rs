//! Solids that are given by their signed distance.

use glam::Vec3;

/// The surface of a solid as one point sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceDistance {
    /// Distance to the surface (m), negative inside. A point whose distance is no number meets nothing.
    pub distance: f32,
    /// Unit vector away from the solid.
    pub outward: Vec3,
}

/// A solid that says how far away it is.
///
/// Distances must be 1-Lipschitz, as those of solids are: they change by no more than the way. Closures from points to
/// [`SurfaceDistance`]s are such solids.
pub trait SignedDistance {
    /// The surface as seen from `point`.
    fn distance(&mut self, point: Vec3) -> SurfaceDistance;

    /// The same where the distance is less than `reach` (m). Where it is not, any number from `reach` to the distance will do,
    /// with any outward vector: most points that a tree asks about are clear of the solid, and how far away they are is not
    /// needed.
    fn distance_within(&mut self, point: Vec3, _reach: f32) -> SurfaceDistance {
        self.distance(point)
    }
}

impl<F: FnMut(Vec3) -> SurfaceDistance> SignedDistance for F {
    fn distance(&mut self, point: Vec3) -> SurfaceDistance {
        self(point)
    }
}
