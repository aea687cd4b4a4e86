//! Edges that several parts of a solid have in common, such as two cubes that touch along an edge.
//!
//! Around such an edge material and space alternate. If the faces agree in their orientation, each face of the file
//! tells on which side its material is, and the two faces that bound a wedge of it belong together: the radial edge
//! structure of K. Weiler (1986).

use super::topology::Side;
use crate::TriangleMesh;
use glam::DVec3;
use std::f64::consts::TAU;

/// Faces at a smaller angle to each other (rad) lie upon each other. A choice: far above rounding.
const SAME: f64 = 1e-9;

/// Pairs the faces around `edge` that bound a wedge of material, if their orientations allow it.
pub(super) fn wedges(mesh: &TriangleMesh, edge: [u32; 2], faces: &[Side]) -> Option<Vec<[Side; 2]>> {
    let [from, to] = edge.map(|vertex| mesh.vertices[vertex as usize]);
    let axis = (to - from).normalize_or_zero();
    let across = |face: &Side| -> DVec3 {
        let triangle = mesh.triangles[face.triangle as usize];
        let opposite = mesh.vertices[triangle[(face.slot + 2) % 3] as usize] - from;
        opposite - axis * opposite.dot(axis)
    };
    let zero = across(faces.first()?);
    // Steps of the angle around the edge, and whether material lies below it: seen along the edge, a face that runs
    // with it has its normal a quarter turn ahead.
    let mut around: Vec<(u64, bool, Side)> = faces
        .iter()
        .map(|face| {
            let across = across(face);
            let angle = libm::atan2(zero.cross(across).dot(axis), zero.dot(across)).rem_euclid(TAU);
            let step = (angle / SAME).round() as u64 % (TAU / SAME).round() as u64;
            let runs_along = mesh.triangles[face.triangle as usize][face.slot] == edge[0];
            (step, !runs_along, *face)
        })
        .collect();
    // Where two wedges touch face to face, the one below ends before the one above begins.
    around.sort_by_key(|(step, begins, face)| (*step, *begins, face.triangle));
    if !around[0].1 {
        around.rotate_left(1);
    }
    let pairs =
        around.chunks_exact(2).map(|pair| (pair[0].1 && !pair[1].1).then_some([pair[0].2, pair[1].2]));
    if faces.len().is_multiple_of(2) { pairs.collect() } else { None }
}
