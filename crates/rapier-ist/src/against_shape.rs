//! Overlap of an inner sphere tree with one of parry's shapes.

use ist::{ContactSample, InnerSphereTree, SurfaceDistance};
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::shape::{HalfSpace, Shape};

/// Appends the contact samples of `solid` (A) with `other` (B) at `pose` in A's frame.
///
/// Every ball meets `other` as if that were the half-space behind its nearest surface point: exact for
/// half-spaces, good for solids with features larger than the balls. Shapes without an inside (trimeshes without
/// orientation, heightfields) push only while a ball's centre is on their outer side.
pub(crate) fn contact_samples(
    solid: &InnerSphereTree,
    other: &dyn Shape,
    pose: &Pose,
    samples: &mut Vec<ContactSample>,
) {
    let inverse = pose.inverse();
    solid.contact_samples_with(
        |point| {
            let surface = surface_distance(other, inverse * point);
            SurfaceDistance { outward: pose.rotation * surface.outward, ..surface }
        },
        samples,
    );
}

/// Signed distance of `shape` at `point`, in its own frame.
fn surface_distance(shape: &dyn Shape, point: Vector) -> SurfaceDistance {
    // parry projects points inside a half-space onto its plane, but reports no distance beyond float range.
    if let Some(half_space) = shape.as_shape::<HalfSpace>() {
        return SurfaceDistance { distance: half_space.normal.dot(point), outward: half_space.normal };
    }
    let projection = shape.project_local_point(point, false);
    let to_point = point - projection.point;
    let sign: Real = if projection.is_inside { -1.0 } else { 1.0 };
    let outward = (to_point * sign).try_normalize().unwrap_or(Vector::Y);
    SurfaceDistance { distance: to_point.length() * sign, outward }
}
