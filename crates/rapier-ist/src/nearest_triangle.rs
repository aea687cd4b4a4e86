//! Which of many triangles is nearest to a point.

use rapier3d::glamx::Vec4;
use rapier3d::math::{Real, Vector};
use rapier3d::parry::query::PointQueryWithLocation;
use rapier3d::parry::shape::{Triangle, TrianglePointLocation};

/// Room for rounding, as a share.
pub(crate) const ROUNDING: Real = 1e-5;

/// The nearest of the triangles seen so far, in whatever order: of equally near ones that of the least index, so that
/// results do not depend on how the search goes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NearestTriangle {
    point: Vector,
    /// Squared distance of the nearest (m²), and at first that of the reach.
    square: Real,
    found: Option<Found>,
}

/// The point of a triangle that is nearest to another point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Found {
    pub(crate) triangle: u32,
    pub(crate) nearest: Vector,
    pub(crate) location: TrianglePointLocation,
}

impl NearestTriangle {
    /// Of those nearer to `point` than `reach` (m).
    pub(crate) fn new(point: Vector, reach: Real) -> Self {
        Self { point, square: reach * reach, found: None }
    }

    pub(crate) fn point(&self) -> Vector {
        self.point
    }

    pub(crate) fn found(&self) -> Option<Found> {
        self.found
    }

    /// Squared distance (m²) that boxes must be nearer than to matter.
    pub(crate) fn square(&self) -> Real {
        self.square
    }

    /// In which of the boxes at these squared distances (m²) the nearest triangle may lie: one bit each, from the lowest.
    pub(crate) fn may_hold_nearest(&self, squares: Vec4) -> u32 {
        // No mask leaves this function: its type depends on the target and on whether glam has SIMD.
        (squares * (1.0 - ROUNDING)).cmplt(Vec4::splat(self.square)).bitmask()
    }

    pub(crate) fn see(&mut self, index: u32, triangle: &Triangle) {
        if self.is_plane_beyond(triangle) {
            return;
        }
        let (projection, location) = triangle.project_local_point_and_get_location(self.point, false);
        let square = projection.point.distance_squared(self.point);
        let is_first = self.found.is_none_or(|found| index < found.triangle);
        if square < self.square || (square == self.square && is_first && self.found.is_some()) {
            self.square = square;
            self.found = Some(Found { triangle: index, nearest: projection.point, location });
        }
    }

    /// Whether the plane of a triangle is certain to be farther than the nearest: most need no projection.
    ///
    /// Of a sliver the normal is uncertain: it is the difference of products of the sides. With the error e of the normal n the
    /// distance is at least `(|n·p| − e |p|) / (|n| + e)`, and `(|n| + e)² ≤ 1.01 n² + 101 e²`. Sums of components stand for
    /// lengths, as roots take longer than the rest.
    fn is_plane_beyond(&self, triangle: &Triangle) -> bool {
        let (ab, ac, ap) = (triangle.b - triangle.a, triangle.c - triangle.a, self.point - triangle.a);
        let sum = |v: Vector| v.abs().element_sum();
        let normal = ab.cross(ac);
        let error = 1e-6 * sum(ab) * sum(ac);
        let height = normal.dot(ap).abs() - error * sum(ap);
        height > 0.0
            && height * height > self.square * (1.01 * normal.length_squared() + 101.0 * error * error)
    }
}
