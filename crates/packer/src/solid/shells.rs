//! Which way the shells of a closed surface face.
//!
//! A shell that lies inside an even number of others bounds material from outside, one that lies inside an
//! odd number bounds a cavity. Orientation in the file is not asked: it is wrong too often.

use super::topology::{Neighbours, turn};
use crate::TriangleMesh;
use glam::DVec3;
use std::f64::consts::PI;

/// One connected part of the surface.
struct Shell {
    lower: DVec3,
    upper: DVec3,
    triangles: Vec<u32>,
    /// A point of the shell: the centroid of its first face.
    point: DVec3,
}

/// What [`face_outward`] found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Outward {
    /// Connected parts of the surface.
    pub(super) shells: usize,
    /// Shells that bound a cavity.
    pub(super) cavities: usize,
    /// Shells whose orientation was reversed.
    pub(super) reversed: usize,
}

/// Orients every shell so that its normals leave the material. `shell_of` tells each triangle's shell.
pub(super) fn face_outward(
    mesh: &mut TriangleMesh,
    neighbours: &mut Neighbours,
    shell_of: &[u32],
) -> Outward {
    let shells = collect(mesh, shell_of);
    let mut outward = Outward { shells: shells.len(), ..Outward::default() };
    for (index, shell) in shells.iter().enumerate() {
        let others = shells.iter().enumerate().filter(|(other, _)| *other != index);
        let depth = others.filter(|(_, other)| encloses(mesh, other, shell.point)).count();
        let is_cavity = depth % 2 == 1;
        outward.cavities += usize::from(is_cavity);
        if (signed_volume(mesh, shell) < 0.0) != is_cavity {
            shell.triangles.iter().for_each(|triangle| turn(mesh, neighbours, *triangle as usize));
            outward.reversed += 1;
        }
    }
    outward
}

fn collect(mesh: &TriangleMesh, shell_of: &[u32]) -> Vec<Shell> {
    let mut shells: Vec<Shell> = Vec::new();
    for (triangle, shell) in shell_of.iter().enumerate() {
        let [a, b, c] = mesh.corners(triangle);
        if shells.len() <= *shell as usize {
            let point = (a + b + c) / 3.0;
            shells.push(Shell { lower: a, upper: a, triangles: Vec::new(), point });
        }
        let shell = &mut shells[*shell as usize];
        shell.lower = shell.lower.min(a).min(b).min(c);
        shell.upper = shell.upper.max(a).max(b).max(c);
        shell.triangles.push(triangle as u32);
    }
    shells
}

/// Whether `point` lies inside `shell`, whichever way the shell faces: its winding number is not zero.
///
/// The solid angle of a triangle is that of A. van Oosterom and J. Strackee, *The solid angle of a plane
/// triangle* (1983): `tan(Ω/2) = a·(b×c) / (abc + (a·b)c + (b·c)a + (c·a)b)`.
fn encloses(mesh: &TriangleMesh, shell: &Shell, point: DVec3) -> bool {
    if point.cmplt(shell.lower).any() || point.cmpgt(shell.upper).any() {
        return false;
    }
    let angle: f64 = shell
        .triangles
        .iter()
        .map(|triangle| {
            let [a, b, c] = mesh.corners(*triangle as usize).map(|corner| corner - point);
            let (la, lb, lc) = (a.length(), b.length(), c.length());
            let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
            2.0 * a.dot(b.cross(c)).atan2(below)
        })
        .sum();
    angle.abs() > 2.0 * PI
}

fn signed_volume(mesh: &TriangleMesh, shell: &Shell) -> f64 {
    let origin = 0.5 * (shell.lower + shell.upper);
    let tetrahedron = |triangle: &u32| {
        let [a, b, c] = mesh.corners(*triangle as usize).map(|corner| corner - origin);
        a.dot(b.cross(c))
    };
    shell.triangles.iter().map(tetrahedron).sum()
}
