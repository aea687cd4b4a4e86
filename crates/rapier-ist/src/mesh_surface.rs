//! Signed distances of points from a triangle mesh.
//!
//! The same as parry's projection gives, but the search begins with the triangle that was nearest to the point before, as the balls
//! of a tree come in an order in which neighbours follow each other, and leaves out what only the sign needs.

use ist::SurfaceDistance;
use rapier3d::math::{Real, Vector};
use rapier3d::parry::partitioning::BvhNode;
use rapier3d::parry::query::PointQueryWithLocation;
use rapier3d::parry::shape::{TriMesh, TriMeshPseudoNormals, TrianglePointLocation};
use std::cell::Cell;

/// A triangle mesh that is asked about one point after the other.
pub(crate) struct MeshSurface<'a> {
    mesh: &'a TriMesh,
    /// Of meshes with an inside.
    pseudo_normals: Option<&'a TriMeshPseudoNormals>,
    /// The triangle nearest to the last point.
    last: Cell<u32>,
}

/// The point of a triangle nearest to another point, and on which part of the triangle it is.
type Nearest = (Vector, TrianglePointLocation);

impl<'a> MeshSurface<'a> {
    pub(crate) fn new(mesh: &'a TriMesh) -> Self {
        Self { mesh, pseudo_normals: mesh.pseudo_normals_if_oriented(), last: Cell::new(0) }
    }

    /// Distance of `point`, in the mesh's frame; never negative where the mesh is not oriented.
    pub(crate) fn distance(&self, point: Vector) -> SurfaceDistance {
        let known = (self.last.get(), self.nearest_on(self.last.get(), point));
        let (triangle, (_, (nearest, location))) = self
            .mesh
            .bvh()
            .find_best(
                known.1.0,
                |node: &BvhNode, _| squared_distance(node, point),
                |triangle, _| Some(self.nearest_on(triangle, point)),
            )
            .unwrap_or(known);
        self.last.set(triangle);
        let away = point - nearest;
        let normal = self.pseudo_normal(triangle, location);
        let sign = if normal.is_some_and(|normal| away.dot(normal) <= 0.0) { -1.0 } else { 1.0 };
        let outward = (away * sign).try_normalize().or_else(|| normal?.try_normalize());
        SurfaceDistance { distance: away.length() * sign, outward: outward.unwrap_or(Vector::Y) }
    }

    /// The nearest point of one triangle, after its squared distance.
    fn nearest_on(&self, triangle: u32, point: Vector) -> (Real, Nearest) {
        let triangle = self.mesh.triangle(triangle);
        let (projection, location) = triangle.project_local_point_and_get_location(point, false);
        (projection.point.distance_squared(point), (projection.point, location))
    }

    /// A vector that points out of the mesh, to tell the side of points whose nearest one is there: J. A. Bærentzen and
    /// H. Aanæs, *Signed distance computation using the angle weighted pseudonormal* (2005).
    fn pseudo_normal(&self, triangle: u32, location: TrianglePointLocation) -> Option<Vector> {
        let normals = self.pseudo_normals?;
        let index = triangle as usize;
        match location {
            TrianglePointLocation::OnVertex(corner) => {
                let vertex = *self.mesh.indices().get(index)?.get(corner as usize)?;
                normals.vertices_pseudo_normal.get(vertex as usize).copied()
            }
            TrianglePointLocation::OnEdge(edge, _) => {
                normals.edges_pseudo_normal.get(index)?.get(edge as usize).copied()
            }
            TrianglePointLocation::OnFace(..) | TrianglePointLocation::OnSolid => {
                Some(self.mesh.triangle(triangle).scaled_normal())
            }
        }
    }
}

fn squared_distance(node: &BvhNode, point: Vector) -> Real {
    let bounds = node.aabb();
    (bounds.mins - point).max(point - bounds.maxs).max(Vector::ZERO).length_squared()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rapier3d::parry::query::PointQuery;
    use rapier3d::parry::shape::{Ball, Cuboid, Cylinder, TriMeshFlags};

    /// Meshes with faces, edges and corners of all kinds.
    fn meshes(flags: TriMeshFlags) -> Vec<TriMesh> {
        let parts = [
            Ball::new(1.0).to_trimesh(12, 8),
            Cuboid::new(Vector::new(1.0, 0.1, 0.4)).to_trimesh(),
            Cylinder::new(0.2, 1.0).to_trimesh(17),
        ];
        parts.into_iter().map(|(v, t)| TriMesh::with_flags(v, t, flags).unwrap()).collect()
    }

    proptest! {
        #[test]
        fn points_are_as_far_as_parry_says(
            points in prop::collection::vec(prop::array::uniform3(-1.5_f32..1.5), 20), oriented in prop::bool::ANY,
        ) {
            let flags = if oriented { TriMeshFlags::ORIENTED } else { TriMeshFlags::empty() };
            for mesh in meshes(flags) {
                let surface = MeshSurface::new(&mesh);
                for point in points.iter().map(|p| Vector::from_array(*p)) {
                    let seen = surface.distance(point);
                    let expected = mesh.project_local_point(point, false);
                    let distance = expected.point.distance(point);
                    prop_assert!((seen.distance.abs() - distance).abs() <= 1e-6, "{} {distance}", seen.distance);
                    prop_assert!(distance < 1e-6 || (seen.distance < 0.0) == expected.is_inside);
                    let on_surface = point - seen.outward * seen.distance;
                    prop_assert!(mesh.project_local_point(on_surface, false).point.distance(on_surface) < 1e-6);
                }
            }
        }
    }

    #[test]
    fn a_point_on_the_surface_knows_the_way_out() {
        for mesh in meshes(TriMeshFlags::ORIENTED) {
            let surface = MeshSurface::new(&mesh);
            for vertex in mesh.vertices() {
                let seen = surface.distance(*vertex);
                assert!(seen.distance.abs() < 1e-6 && seen.outward.dot(*vertex) > 0.0, "{seen:?}");
            }
        }
    }

    #[test]
    fn points_that_are_no_numbers_have_no_distance() {
        for mesh in meshes(TriMeshFlags::ORIENTED) {
            let surface = MeshSurface::new(&mesh);
            assert!(surface.distance(Vector::NAN).distance.is_nan());
            assert!(surface.distance(Vector::X * 3.0).distance > 1.9);
        }
    }
}
