//! Cleaning: coincident vertices become one; faces without area and, unless asked otherwise, faces that occur twice are dropped.

use crate::TriangleMesh;
use glam::DVec3;
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// What [`weld`] did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Welding {
    /// Vertices that no face uses.
    pub(super) unused_vertices: usize,
    /// Vertices that coincided with an earlier one.
    pub(super) merged_vertices: usize,
    /// Faces with two equal corners.
    pub(super) degenerate_faces: usize,
    /// Faces with the same three corners as an earlier one, which was kept.
    pub(super) duplicate_faces: usize,
    /// Faces dropped together with another one of the same three corners.
    pub(super) paired_faces: usize,
}

/// What becomes of faces with the same three corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Repeated {
    /// All are kept.
    KeepAll,
    /// One of them is kept: a face was written twice, or once for each side.
    KeepOne,
    /// Pairs that face opposite ways are dropped: they are a wall between two parts that touch. Of those that face the
    /// same way one is kept.
    DropPairs,
}

/// The mesh with every position once, without degenerate faces and unused vertices.
pub(super) fn weld(mesh: &TriangleMesh, repeated: Repeated) -> (TriangleMesh, Welding) {
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
    // Place of the face with these corners in the result, while it has one.
    let mut place_of: HashMap<[u32; 3], usize> = HashMap::with_capacity(mesh.triangles.len());
    let mut dropped = Vec::new();
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| renumbered[v as usize]);
        let mut sorted = [a, b, c];
        sorted.sort_unstable();
        if a == b || b == c || c == a {
            welding.degenerate_faces += 1;
            continue;
        }
        if repeated == Repeated::KeepAll {
            out.triangles.push([a, b, c]);
            continue;
        }
        match place_of.entry(sorted) {
            Entry::Vacant(entry) => {
                entry.insert(out.triangles.len());
                out.triangles.push([a, b, c]);
            }
            Entry::Occupied(entry)
                if repeated == Repeated::KeepOne || faces_alike(out.triangles[*entry.get()], [a, b, c]) =>
            {
                welding.duplicate_faces += 1;
            }
            Entry::Occupied(entry) => {
                welding.paired_faces += 2;
                dropped.push(entry.remove());
            }
        }
    }
    let mut is_kept = vec![true; out.triangles.len()];
    dropped.into_iter().for_each(|place| is_kept[place] = false);
    let mut kept = is_kept.into_iter();
    out.triangles.retain(|_| kept.next().unwrap_or(true));
    (out, welding)
}

/// Whether two triangles of the same corners face the same way.
fn faces_alike([a, b, c]: [u32; 3], other: [u32; 3]) -> bool {
    [[a, b, c], [b, c, a], [c, a, b]].contains(&other)
}
