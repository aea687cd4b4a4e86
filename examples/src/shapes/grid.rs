//! A rectangular grid bent into a torus: the topology of rings, tubes and everything with one hole.

use glam::DVec3;
use packer::TriangleMesh;

/// The closed surface through `point(i, j)`, periodic in `i < columns` and in `j < rows`.
///
/// Outside is where the right-hand rule points: the step in `i` times the step in `j`.
pub(super) fn closed_grid(columns: u32, rows: u32, mut point: impl FnMut(u32, u32) -> DVec3) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    for i in 0..columns {
        for j in 0..rows {
            mesh.vertices.push(point(i, j));
        }
    }
    let index = |i: u32, j: u32| (i % columns) * rows + j % rows;
    for i in 0..columns {
        for j in 0..rows {
            push_quad(&mut mesh, [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)]);
        }
    }
    mesh
}

/// Adds a quad, counter-clockwise from outside, split along its shorter diagonal.
pub(super) fn push_quad(mesh: &mut TriangleMesh, [a, b, c, d]: [u32; 4]) {
    let square = |p: u32, q: u32| mesh.vertices[p as usize].distance_squared(mesh.vertices[q as usize]);
    if square(a, c) <= square(b, d) {
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
    } else {
        mesh.triangles.extend([[a, b, d], [b, c, d]]);
    }
}
