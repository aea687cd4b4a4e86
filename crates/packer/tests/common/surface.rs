//! Distances from and windings of a mesh in double precision, triangle by triangle: code that shares nothing with the packer.

use glam::DVec3;
use packer::TriangleMesh;
use std::f64::consts::PI;

/// Distance (m) of `p` from the nearest triangle of `mesh`.
pub(crate) fn distance(mesh: &TriangleMesh, p: DVec3) -> f64 {
    (0..mesh.triangles.len()).map(|i| distance_to_triangle(mesh.corners(i), p)).fold(f64::INFINITY, f64::min)
}

/// Distance (m) of `p` from a triangle: that from its plane above its face, and else that from its nearest side.
fn distance_to_triangle([a, b, c]: [DVec3; 3], p: DVec3) -> f64 {
    let side = |from: DVec3, to: DVec3| {
        let along = to - from;
        let share = ((p - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        p.distance(if share.is_finite() { from + along * share } else { from })
    };
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let above = |from: DVec3, to: DVec3| normal.dot((to - from).cross(p - from)) > 0.0;
    let sides = side(a, b).min(side(b, c)).min(side(c, a));
    if above(a, b) && above(b, c) && above(c, a) { sides.min(normal.dot(p - a).abs()) } else { sides }
}

/// How often `mesh` winds around `p`: the sum of the solid angles of all triangles by 4π (A. van Oosterom and J. Strackee,
/// *The solid angle of a plane triangle*, 1983).
pub(crate) fn winding_number(mesh: &TriangleMesh, p: DVec3) -> f64 {
    let angle = |triangle: usize| {
        let [a, b, c] = mesh.corners(triangle).map(|corner| corner - p);
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        2.0 * a.dot(b.cross(c)).atan2(la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb)
    };
    (0..mesh.triangles.len()).map(angle).sum::<f64>() / (4.0 * PI)
}

/// Volume (m³) that `mesh` encloses, what overlaps counted twice.
pub(crate) fn volume(mesh: &TriangleMesh) -> f64 {
    let (lower, upper) = mesh.bounds();
    let center = 0.5 * (lower + upper);
    let tetrahedron = |triangle: usize| {
        let [a, b, c] = mesh.corners(triangle).map(|corner| corner - center);
        a.dot(b.cross(c)) / 6.0
    };
    (0..mesh.triangles.len()).map(tetrahedron).sum()
}
