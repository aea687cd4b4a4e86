//! Meshes, spheres and poses out of Foxglove's messages.

use super::ReplayMesh;
use super::contact::vector;
use crate::record::{ROOT_FRAME, UpAxis, WORLD_FRAME};
use foxglove::messages::{FrameTransform, PointCloud, SceneEntity, TriangleListPrimitive};
use rapier3d::math::{Pose, Rotation, Vector};

/// The triangles of an entity, without those that name missing vertices or are not finite; `None` where none is
/// left.
pub(super) fn mesh(entity: &SceneEntity) -> Option<ReplayMesh> {
    let mut mesh = ReplayMesh::default();
    for list in &entity.triangles {
        add_triangles(&mut mesh, list);
    }
    (!mesh.triangles.is_empty()).then_some(mesh)
}

fn add_triangles(mesh: &mut ReplayMesh, list: &TriangleListPrimitive) {
    let first = mesh.vertices.len() as u32;
    mesh.vertices.extend(list.points.iter().map(|p| Vector::new(p.x as f32, p.y as f32, p.z as f32)));
    let finite = |index: u32| mesh.vertices.get(index as usize).is_some_and(|vertex| vertex.is_finite());
    // Without indices, each three points are a triangle.
    let in_order: Vec<u32> = (0..list.points.len() as u32).collect();
    let indices = if list.indices.is_empty() { &in_order } else { &list.indices };
    let (triangles, _) = indices.as_chunks::<3>();
    let triangles: Vec<[u32; 3]> = triangles
        .iter()
        .map(|triangle| triangle.map(|index| index.saturating_add(first)))
        .filter(|triangle| triangle.iter().all(|&index| finite(index)))
        .collect();
    mesh.triangles.extend(triangles);
    // Vertices of broken triangles stay, so that indices hold, but as something that can be drawn.
    for vertex in mesh.vertices.iter_mut().filter(|vertex| !vertex.is_finite()) {
        *vertex = Vector::ZERO;
    }
    if let Some(color) = &list.color {
        mesh.color = [color.r, color.g, color.b, color.a].map(|channel| (channel as f32).clamp(0.0, 1.0));
    }
}

/// Centres and radii out of a cloud with the fields x, y, z and radius as floats, as the recorder writes it; nothing
/// out of another one.
pub(super) fn spheres(cloud: &PointCloud) -> Vec<(Vector, f32)> {
    let names: Vec<&str> = cloud.fields.iter().map(|field| field.name.as_str()).collect();
    if names != ["x", "y", "z", "radius"] || cloud.point_stride != 16 {
        return Vec::new();
    }
    let (numbers, _) = cloud.data.as_chunks::<4>();
    let numbers: Vec<f32> = numbers.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
    let (points, _) = numbers.as_chunks::<4>();
    let spheres = points.iter().map(|[x, y, z, radius]| (Vector::new(*x, *y, *z), *radius));
    spheres.filter(|(center, radius)| center.is_finite() && radius.is_finite()).collect()
}

/// What a transform is about.
pub(super) enum Transform<'a> {
    /// The world stands upright in the frame that viewers start from.
    Up(UpAxis),
    /// A body has a pose.
    Body(&'a str, Pose),
    /// Nothing that a recorder writes.
    Other,
}

pub(super) fn transform(transform: &FrameTransform) -> Transform<'_> {
    let translation = vector(transform.translation.as_ref());
    let q = transform.rotation.unwrap_or_default();
    let rotation = Rotation::from_xyzw(q.x as f32, q.y as f32, q.z as f32, q.w as f32);
    let turned = rotation.length_squared();
    if !translation.is_finite() || !turned.is_finite() || turned < 0.5 {
        return Transform::Other;
    }
    let rotation = rotation.normalize();
    match (transform.parent_frame_id.as_str(), transform.child_frame_id.as_str()) {
        (ROOT_FRAME, WORLD_FRAME) => {
            let up = rotation * Vector::Y;
            Transform::Up(if up.z > 0.5 { UpAxis::Y } else { UpAxis::Z })
        }
        (WORLD_FRAME, name) => Transform::Body(name, Pose::from_parts(translation, rotation)),
        _ => Transform::Other,
    }
}
