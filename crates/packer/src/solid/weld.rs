//! Cleaning: coincident vertices become one; faces without area and faces that occur twice are dropped.

use crate::TriangleMesh;
use glam::DVec3;
use std::collections::{HashMap, HashSet};

/// What [`weld`] did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Welding {
    /// Vertices that no face uses.
    pub(super) unused_vertices: usize,
    /// Vertices that coincided with an earlier one.
    pub(super) merged_vertices: usize,
    /// Faces with two equal corners.
    pub(super) degenerate_faces: usize,
    /// Faces with the same three corners as an earlier one.
    pub(super) duplicate_faces: usize,
}

/// The mesh with every position once, without degenerate and duplicate faces and unused vertices.
pub(super) fn weld(mesh: &TriangleMesh) -> (TriangleMesh, Welding) {
    let mut welding = Welding::default();
    let mut out = TriangleMesh::default();
    let mut index_of: HashMap<[u64; 3], u32> = HashMap::with_capacity(mesh.vertices.len());
    // Adding zero turns -0 into +0, which equals it but has other bits.
    let key = |v: DVec3| (v + DVec3::ZERO).to_array().map(f64::to_bits);
    let mut is_used = vec![false; mesh.vertices.len()];
    mesh.triangles.iter().flatten().for_each(|v| is_used[*v as usize] = true);
    let renumbered: Vec<u32> = mesh
        .vertices
        .iter()
        .zip(&is_used)
        .map(|(v, is_used)| {
            if !is_used {
                welding.unused_vertices += 1;
                return u32::MAX;
            }
            *index_of.entry(key(*v)).or_insert_with(|| {
                out.vertices.push(*v);
                (out.vertices.len() - 1) as u32
            })
        })
        .collect();
    welding.merged_vertices = mesh.vertices.len() - welding.unused_vertices - out.vertices.len();
    let mut seen = HashSet::with_capacity(mesh.triangles.len());
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| renumbered[v as usize]);
        let mut sorted = [a, b, c];
        sorted.sort_unstable();
        if a == b || b == c || c == a {
            welding.degenerate_faces += 1;
        } else if !seen.insert(sorted) {
            welding.duplicate_faces += 1;
        } else {
            out.triangles.push([a, b, c]);
        }
    }
    (out, welding)
}
