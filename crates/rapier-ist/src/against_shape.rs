//! Overlap of an inner sphere tree with one of parry's shapes.

use crate::mesh_surface::MeshSurface;
use ist::{ContactSample, InnerSphereTree, SignedDistance, SurfaceDistance};
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::query::PointQuery;
use rapier3d::parry::shape::{Compound, HalfSpace, Shape};

/// Appends the contact samples of `solid` (A) with `other` (B) at `pose` in A's frame. Returns a distance (m) of which the balls
/// that do not meet `other` are away from it.
///
/// Every ball meets `other` as if that were the half-space behind its nearest surface point: exact for
/// half-spaces, good for solids with features larger than the balls. Shapes without an inside (trimeshes without
/// orientation, heightfields) push only while a ball's centre is on their outer side.
pub(crate) fn contact_samples(
    solid: &InnerSphereTree,
    other: &dyn Shape,
    pose: &Pose,
    samples: &mut Vec<ContactSample>,
) -> Real {
    solid.flush_contact_samples_with_surface(surface_of(other, pose), samples)
}

/// The surface of `shape` at `pose`.
pub(crate) fn surface_of<'a>(shape: &'a dyn Shape, pose: &Pose) -> ShapeSurface<'a> {
    let mesh = shape.as_trimesh().map(MeshSurface::new);
    ShapeSurface { shape, mesh, pose: *pose, inverse: pose.inverse() }
}

/// A shape that is asked about one point after the other.
pub(crate) struct ShapeSurface<'a> {
    shape: &'a dyn Shape,
    mesh: Option<MeshSurface<'a>>,
    pose: Pose,
    inverse: Pose,
}

impl SignedDistance for ShapeSurface<'_> {
    fn distance(&mut self, point: Vector) -> SurfaceDistance {
        self.distance_within(point, Real::INFINITY)
    }

    fn distance_within(&mut self, point: Vector, reach: Real) -> SurfaceDistance {
        let point = self.inverse * point;
        let surface = match &mut self.mesh {
            Some(mesh) => mesh.distance_within(point, reach),
            None => surface_distance(self.shape, point),
        };
        SurfaceDistance { outward: self.pose.rotation * surface.outward, ..surface }
    }
}

/// Signed distance of `shape` at `point`, in its own frame. For many points see [`surface_of`].
pub(crate) fn surface_distance(shape: &dyn Shape, point: Vector) -> SurfaceDistance {
    // parry projects points inside a half-space onto its plane, but reports no distance beyond float range.
    if let Some(half_space) = shape.as_shape::<HalfSpace>() {
        return SurfaceDistance { distance: half_space.normal.dot(point), outward: half_space.normal };
    }
    // parry has no projection of a ball's centre.
    if let Some(ball) = shape.as_ball() {
        let outward = point.try_normalize().unwrap_or(Vector::Y);
        return SurfaceDistance { distance: point.length() - ball.radius, outward };
    }
    // parry projects on the nearest part, which need not be the one that the point is inside of.
    if let Some(compound) = shape.as_compound() {
        return compound_distance(compound, point);
    }
    let projection = shape.project_local_point(point, false);
    let to_point = point - projection.point;
    let sign: Real = if projection.is_inside { -1.0 } else { 1.0 };
    let outward = (to_point * sign).try_normalize().unwrap_or(Vector::Y);
    SurfaceDistance { distance: to_point.length() * sign, outward }
}

/// The least of the parts' distances.
fn compound_distance(compound: &Compound, point: Vector) -> SurfaceDistance {
    let mut nearest = SurfaceDistance { distance: Real::INFINITY, outward: Vector::Y };
    for ((pose, part), bounds) in compound.shapes().iter().zip(compound.aabbs()) {
        let is_far = !bounds.contains_local_point(point)
            && bounds.distance_to_local_point(point, true) >= nearest.distance;
        if is_far {
            continue;
        }
        let seen = surface_distance(part.as_ref(), pose.inverse_transform_point(point));
        if seen.distance < nearest.distance {
            nearest = SurfaceDistance { distance: seen.distance, outward: pose.rotation * seen.outward };
        }
    }
    nearest
}
