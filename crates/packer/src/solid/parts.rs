//! Parts of a file that have edges in common.
//!
//! Where solids overlap or touch along an edge, the edge has four faces, and positions alone do not tell which two are
//! one part's. The order of the faces does: files hold one part after another, whatever their format, and a run of faces
//! is a part when each of its edges has got all its faces.

use super::topology;
use super::weld::{self, Repeated, Welding};
use crate::TriangleMesh;
use std::collections::{HashMap, HashSet};
use std::ops::Range;

/// Fewest faces of a closed surface. Two of the same three corners close each other too, but enclose nothing.
const FEWEST: usize = 4;

/// The mesh with vertices of its own for every part, each welded for itself. None unless it is made of parts that are
/// closed and manifold, of which there is more than one. O(n) for n faces.
pub(super) fn apart(mesh: &TriangleMesh) -> Option<(TriangleMesh, Welding)> {
    // Vertices that coincide are one here, but faces keep their order and number.
    let (welded, mut total) = weld::weld(mesh, Repeated::KeepAll);
    let runs = closed_runs(&welded.triangles)?;
    if runs.len() < 2 {
        return None;
    }
    let mut out = TriangleMesh::default();
    for run in runs {
        let (part, welding) = weld::weld(&part_of(&welded, run), Repeated::KeepOne);
        let census = topology::edge_census(&part);
        if !census.open.is_empty() || !census.non_manifold.is_empty() {
            return None;
        }
        total.duplicate_faces += welding.duplicate_faces;
        let base = out.vertices.len() as u32;
        out.vertices.extend(part.vertices);
        out.triangles.extend(part.triangles.iter().map(|triangle| triangle.map(|vertex| vertex + base)));
    }
    Some((out, total))
}

/// Some faces of the mesh, with the vertices that they use.
fn part_of(mesh: &TriangleMesh, faces: Range<usize>) -> TriangleMesh {
    let mut part = TriangleMesh::default();
    let mut index_of: HashMap<u32, u32> = HashMap::new();
    for triangle in &mesh.triangles[faces] {
        part.triangles.push(triangle.map(|vertex| {
            *index_of.entry(vertex).or_insert_with(|| {
                part.vertices.push(mesh.vertices[vertex as usize]);
                (part.vertices.len() - 1) as u32
            })
        }));
    }
    part
}

/// Runs of faces without open edges, as short as they can be. None if the last one has some.
fn closed_runs(triangles: &[[u32; 3]]) -> Option<Vec<Range<usize>>> {
    // Edges that have an odd number of faces in the present run.
    let mut open: HashSet<[u32; 2]> = HashSet::new();
    let mut runs = Vec::new();
    let mut first = 0;
    for (index, triangle) in triangles.iter().enumerate() {
        for slot in 0..3 {
            let (a, b) = (triangle[slot], triangle[(slot + 1) % 3]);
            let edge = [a.min(b), a.max(b)];
            if !open.remove(&edge) {
                open.insert(edge);
            }
        }
        if open.is_empty() && index + 1 - first >= FEWEST {
            runs.push(first..index + 1);
            first = index + 1;
        }
    }
    (first == triangles.len()).then_some(runs)
}
