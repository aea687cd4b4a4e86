//! Which way the shells of a closed surface face.
//!
//! Shells are taken from the largest to the smallest. One that lies wholly in empty space bounds material, one that lies
//! wholly in material bounds a cavity: where copies of a hollow part coincide, each has its own. A shell that cuts another
//! does not lie inside it: the two overlap, and their union is the solid. Neither does one bound a cavity that touches the
//! inside of what is around it: there would be a wall of no thickness. Orientation in the file is
//! not asked: it is wrong too often.

use super::shell_pairs::ShellPairs;
use super::topology::{Neighbours, turn};
use crate::TriangleMesh;
use glam::DVec3;
use std::f64::consts::PI;

/// One connected part of the surface.
struct Shell {
    lower: DVec3,
    upper: DVec3,
    triangles: Vec<u32>,
}

/// Points of a shell that are asked whether they lie inside another one.
const PROBES: usize = 8;

/// What [`face_outward`] found.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Outward {
    /// Shells that bound a cavity.
    pub(super) cavities: usize,
    /// For each shell whether its orientation was reversed.
    pub(super) is_reversed: Vec<bool>,
    /// Whether a shell has material on both of its sides: it bounds nothing of the union.
    pub(super) hides_shells: bool,
}

/// Orients every shell so that its normals leave the material. `shell_of` tells each triangle's shell. For s shells
/// of n triangles whose boxes overlap, O(s·n).
pub(super) fn face_outward(
    mesh: &mut TriangleMesh,
    neighbours: &mut Neighbours,
    shell_of: &[u32],
    pairs: &ShellPairs,
) -> Outward {
    let shells = collect(mesh, shell_of);
    let volumes = signed_volumes(mesh, shell_of);
    let mut from_largest: Vec<usize> = (0..shells.len()).collect();
    from_largest.sort_by(|a, b| volumes[*b].abs().total_cmp(&volumes[*a].abs()).then(a.cmp(b)));
    let mut is_cavity = vec![false; shells.len()];
    let mut hides_shells = false;
    for index in from_largest {
        let around = (0..shells.len())
            .filter(|other| *other != index && !pairs.cut(index, *other))
            .filter(|other| encloses(mesh, &shells[*other], &shells[index]));
        // How often the others wind around this one, and whether it touches one that bounds material.
        let (mut winding, mut touches) = (0, false);
        for other in around {
            winding += if is_cavity[other] { -1 } else { 1 };
            touches |= !is_cavity[other] && pairs.touch(index, other);
        }
        is_cavity[index] = winding > 0 && !touches;
        hides_shells |= winding != i32::from(is_cavity[index]);
    }
    let is_reversed: Vec<bool> =
        volumes.iter().zip(&is_cavity).map(|(volume, is_cavity)| (*volume < 0.0) != *is_cavity).collect();
    for (shell, _) in shells.iter().zip(&is_reversed).filter(|(_, is_reversed)| **is_reversed) {
        shell.triangles.iter().for_each(|triangle| turn(mesh, neighbours, *triangle as usize));
    }
    let cavities = is_cavity.iter().filter(|is_cavity| **is_cavity).count();
    Outward { cavities, is_reversed, hides_shells }
}

fn collect(mesh: &TriangleMesh, shell_of: &[u32]) -> Vec<Shell> {
    let mut shells: Vec<Shell> = Vec::new();
    for (triangle, shell) in shell_of.iter().enumerate() {
        let [a, b, c] = mesh.corners(triangle);
        if shells.len() <= *shell as usize {
            shells.push(Shell { lower: a, upper: a, triangles: Vec::new() });
        }
        let shell = &mut shells[*shell as usize];
        shell.lower = shell.lower.min(a).min(b).min(c);
        shell.upper = shell.upper.max(a).max(b).max(c);
        shell.triangles.push(triangle as u32);
    }
    shells
}

/// Whether `inner`, which does not cut `outer`, lies inside it, whichever way they face. Where the two touch, a point
/// is on the border of `outer` and tells nothing, so several are asked.
fn encloses(mesh: &TriangleMesh, outer: &Shell, inner: &Shell) -> bool {
    if inner.lower.cmplt(outer.lower).any() || inner.upper.cmpgt(outer.upper).any() {
        return false;
    }
    let step = inner.triangles.len().div_ceil(PROBES);
    let windings = inner.triangles.iter().step_by(step).map(|triangle| {
        let [a, b, c] = mesh.corners(*triangle as usize);
        winding_number(mesh, outer, (a + b + c) / 3.0).abs()
    });
    let (mut inside, mut outside) = (0, 0);
    for winding in windings {
        inside += usize::from(winding > 0.75);
        outside += usize::from(winding < 0.25);
    }
    inside > outside
}

/// How often `shell` winds around `point`; half numbers on its faces.
///
/// The solid angle of a triangle is that of A. van Oosterom and J. Strackee, *The solid angle of a plane
/// triangle* (1983): `tan(Ω/2) = a·(b×c) / (abc + (a·b)c + (b·c)a + (c·a)b)`.
fn winding_number(mesh: &TriangleMesh, shell: &Shell, point: DVec3) -> f64 {
    let angle = |triangle: &u32| {
        let [a, b, c] = mesh.corners(*triangle as usize).map(|corner| corner - point);
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        2.0 * libm::atan2(a.dot(b.cross(c)), below)
    };
    shell.triangles.iter().map(angle).sum::<f64>() / (4.0 * PI)
}

/// Volumes of the shells (m³), negative where they face inwards.
pub(super) fn signed_volumes(mesh: &TriangleMesh, shell_of: &[u32]) -> Vec<f64> {
    let volume = |shell: Shell| {
        let origin = 0.5 * (shell.lower + shell.upper);
        let tetrahedron = |triangle: &u32| {
            let [a, b, c] = mesh.corners(*triangle as usize).map(|corner| corner - origin);
            a.dot(b.cross(c)) / 6.0
        };
        shell.triangles.iter().map(tetrahedron).sum()
    };
    collect(mesh, shell_of).into_iter().map(volume).collect()
}
