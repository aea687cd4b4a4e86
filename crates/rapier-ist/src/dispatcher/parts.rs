//! The convex parts of parry's shapes.

use rapier3d::math::{Pose, Real};
use rapier3d::parry::bounding_volume::{Aabb, BoundingVolume};
use rapier3d::parry::shape::{Cuboid, Shape, TypedShape};

/// Calls `act` with the convex parts of `shape` whose boxes meet `region` (both in the shape's frame) and with their poses. Parts
/// that are not convex are handed out as well, as they are.
pub(super) fn for_each_part(shape: &dyn Shape, region: &Aabb, act: &mut dyn FnMut(&Pose, &dyn Shape)) {
    if shape.is_convex() {
        act(&Pose::IDENTITY, shape);
        return;
    }
    // Regions reach to infinity where motions do; the shape's own box does not.
    let Some(region) = shape.compute_local_aabb().loosened(Real::EPSILON).intersection(region) else {
        return;
    };
    if let Some(composite) = shape.as_composite_shape() {
        for leaf in composite.bvh().intersect_aabb(&region) {
            composite.map_part_at(leaf, &mut |pose, part, _| act(&pose.copied().unwrap_or_default(), part));
        }
        return;
    }
    match shape.as_typed_shape() {
        TypedShape::HeightField(field) => {
            field.map_elements_in_local_aabb(&region, &mut |_, triangle| act(&Pose::IDENTITY, triangle));
        }
        TypedShape::Voxels(voxels) => {
            let voxel = Cuboid::new(voxels.voxel_size() * 0.5);
            for data in voxels.voxels_intersecting_local_aabb(&region).filter(|data| !data.state.is_empty()) {
                act(&Pose::from_translation(data.center), &voxel);
            }
        }
        _ => act(&Pose::IDENTITY, shape),
    }
}
