//! Signed distances of points from a triangle mesh.
//!
//! The same as parry's projection gives, sooner for the balls of a tree: they come in an order in which neighbours follow each
//! other, and of most it is enough to know that they are clear of the mesh.

use crate::mesh_trees::tree_of;
use crate::nearest_triangle::{Found, NearestTriangle, ROUNDING};
use crate::triangle_tree::TriangleTree;
use ist::{SignedDistance, SurfaceDistance};
use rapier3d::math::{Real, Vector};
use rapier3d::parry::partitioning::BvhNode;
use rapier3d::parry::shape::{TriMesh, TriMeshPseudoNormals, TrianglePointLocation};
use std::cell::Cell;
use std::sync::Arc;

/// A triangle mesh that is asked about one point after the other.
pub(crate) struct MeshSurface<'a> {
    mesh: &'a TriMesh,
    /// Faster than parry's, where there is one.
    tree: Option<Arc<TriangleTree>>,
    /// Of meshes with an inside.
    pseudo_normals: Option<&'a TriMeshPseudoNormals>,
    /// A point of the mesh, the nearest to one of the last points.
    near: Vector,
    /// The last points outside of the mesh, each with a distance within which there is no triangle.
    clear: [(Vector, Real); REMEMBERED],
    /// Where the next of them is put.
    next: usize,
}

/// Number of balls clear of the mesh that are kept: of the clear balls of the pile of gears 32 % meet none of one and have to be
/// measured, 9 % none of eight.
const REMEMBERED: usize = 8;

impl<'a> MeshSurface<'a> {
    pub(crate) fn new(mesh: &'a TriMesh) -> Self {
        let near = mesh.vertices().first().copied().unwrap_or(Vector::NAN);
        let pseudo_normals = mesh.pseudo_normals_if_oriented();
        Self {
            mesh,
            tree: tree_of(mesh),
            pseudo_normals,
            near,
            clear: [(Vector::ZERO, Real::NEG_INFINITY); REMEMBERED],
            next: 0,
        }
    }

    /// The triangle nearest to `point` among those nearer than `reach`, with its point.
    fn nearest(&self, point: Vector, reach: Real) -> Option<Found> {
        let mut search = NearestTriangle::new(point, reach);
        if let Some(tree) = &self.tree {
            tree.search(&mut search);
            return search.found();
        }
        let search = Cell::new(search);
        self.mesh.bvh().find_best(
            search.get().square(),
            |node: &BvhNode, _| squared_distance(node, point) * (1.0 - ROUNDING),
            |triangle, _| {
                let mut seen = search.get();
                seen.see(triangle, &self.mesh.triangle(triangle));
                search.set(seen);
                Some(seen.square())
            },
        );
        search.get().found()
    }

    /// Whether a ball about `point` that holds no triangle lies outside of the mesh: it meets another that does. So the space beyond
    /// the border of an open mesh is outside on both sides, although the pseudo-normals of the border give it an inside.
    fn is_clear(&self, point: Vector, radius: Real) -> bool {
        let meets = |&(center, clearance): &(Vector, Real)| {
            center.distance(point) < (1.0 - ROUNDING) * (clearance + radius)
        };
        self.pseudo_normals.is_none() || self.clear.iter().any(meets)
    }

    fn remember_clear(&mut self, point: Vector, radius: Real) {
        self.clear[self.next] = (point, radius);
        self.next = (self.next + 1) % REMEMBERED;
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

impl SignedDistance for MeshSurface<'_> {
    /// Distance of `point`, in the mesh's frame; never negative where the mesh is not oriented.
    fn distance(&mut self, point: Vector) -> SurfaceDistance {
        self.distance_within(point, Real::INFINITY)
    }

    fn distance_within(&mut self, point: Vector, reach: Real) -> SurfaceDistance {
        // Not less than the distance of the mesh, however small that is.
        let most = self.near.distance(point) * (1.0 + ROUNDING) + Real::MIN_POSITIVE.sqrt();
        let mut found = self.nearest(point, most.min(reach.max(0.0)));
        if found.is_none() && reach < most {
            if self.is_clear(point, reach) {
                self.remember_clear(point, reach);
                return SurfaceDistance { distance: reach, outward: Vector::Y };
            }
            found = self.nearest(point, most);
        }
        let Some(Found { triangle, nearest, location }) =
            found.or_else(|| self.nearest(point, Real::INFINITY))
        else {
            return SurfaceDistance { distance: Real::NAN, outward: Vector::Y };
        };
        self.near = nearest;
        let away = point - nearest;
        let normal = self.pseudo_normal(triangle, location);
        let sign = if normal.is_some_and(|normal| away.dot(normal) <= 0.0) { -1.0 } else { 1.0 };
        let distance = away.length() * sign;
        if distance > 0.0 {
            self.remember_clear(point, distance);
        }
        let outward = (away * sign).try_normalize().or_else(|| normal?.try_normalize());
        SurfaceDistance { distance, outward: outward.unwrap_or(Vector::Y) }
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

    /// Meshes with faces, edges and corners of all kinds, slivers, and few and many triangles.
    fn meshes(flags: TriMeshFlags) -> Vec<TriMesh> {
        let (needles, triangles) = Cylinder::new(0.2, 1.0).to_trimesh(40);
        let needles = needles.into_iter().map(|v| v * Vector::new(1e-3, 1.2, 0.3)).collect();
        let parts = [
            Ball::new(1.0).to_trimesh(12, 8),
            Ball::new(0.8).to_trimesh(40, 30),
            Cuboid::new(Vector::new(1.0, 0.1, 0.4)).to_trimesh(),
            Cylinder::new(0.2, 1.0).to_trimesh(17),
            (needles, triangles),
            (vec![Vector::X, Vector::Y, Vector::Z], vec![[0, 1, 2]]),
        ];
        parts.into_iter().map(|(v, t)| TriMesh::with_flags(v, t, flags).unwrap()).collect()
    }

    /// Without a tree and with one.
    fn surfaces(mesh: &TriMesh) -> [MeshSurface<'_>; 2] {
        let tree = TriangleTree::new(mesh).map(Arc::new);
        [MeshSurface::new(mesh), MeshSurface { tree, ..MeshSurface::new(mesh) }]
    }

    fn points() -> impl Strategy<Value = Vec<Vector>> {
        prop::collection::vec(prop::array::uniform3(-1.5_f32..1.5).prop_map(Vector::from), 20)
    }

    proptest! {
        #[test]
        fn points_are_as_far_as_parry_says(points in points(), oriented in prop::bool::ANY) {
            let flags = if oriented { TriMeshFlags::ORIENTED } else { TriMeshFlags::empty() };
            for mesh in meshes(flags) {
                for mut surface in surfaces(&mesh) {
                    for point in points.iter().copied() {
                        let seen = surface.distance(point);
                        let expected = mesh.project_local_point(point, false);
                        let distance = expected.point.distance(point);
                        prop_assert!((seen.distance.abs() - distance).abs() <= 1e-6, "{} {distance}", seen.distance);
                        if mesh.num_triangles() > 1 {
                            prop_assert!(distance < 1e-6 || (seen.distance < 0.0) == expected.is_inside);
                        }
                        let on_surface = point - seen.outward * seen.distance;
                        prop_assert!(mesh.project_local_point(on_surface, false).point.distance(on_surface) < 1e-6);
                    }
                }
            }
        }

        /// Bit for bit: whether and when a mesh gets its tree changes nothing.
        #[test]
        fn distances_do_not_depend_on_the_search(
            points in points(), reaches in prop::collection::vec(-0.5_f32..1.0, 20), oriented in prop::bool::ANY,
        ) {
            let flags = if oriented { TriMeshFlags::ORIENTED } else { TriMeshFlags::empty() };
            for mesh in meshes(flags) {
                let [mut plain, mut fast] = surfaces(&mesh);
                for (point, reach) in points.iter().zip(&reaches) {
                    let [exact, again] = surfaces(&mesh).map(|mut surface| surface.distance(*point));
                    prop_assert_eq!(exact, again);
                    let seen = plain.distance_within(*point, *reach);
                    prop_assert_eq!(seen, fast.distance_within(*point, *reach));
                    if exact.distance < *reach && mesh.num_triangles() > 1 {
                        prop_assert_eq!(seen, exact);
                    } else if mesh.num_triangles() > 1 {
                        prop_assert!(seen.distance >= *reach && seen.distance <= exact.distance);
                    }
                }
            }
        }
    }

    #[test]
    fn a_point_on_the_surface_knows_the_way_out() {
        for mesh in meshes(TriMeshFlags::ORIENTED).iter().filter(|mesh| mesh.num_triangles() > 1) {
            for mut surface in surfaces(mesh) {
                for vertex in mesh.vertices() {
                    let seen = surface.distance(*vertex);
                    assert!(seen.distance.abs() < 1e-6 && seen.outward.dot(*vertex) > 0.0, "{seen:?}");
                }
            }
        }
    }

    #[test]
    fn points_that_are_no_numbers_have_no_distance() {
        for mesh in meshes(TriMeshFlags::ORIENTED) {
            for mut surface in surfaces(&mesh) {
                assert!(surface.distance(Vector::NAN).distance.is_nan());
                assert!(surface.distance_within(Vector::NAN, 1.0).distance.is_nan());
                assert!(surface.distance(Vector::X * 3.0).distance.abs() > 1.9);
            }
        }
    }
}
