//! Which faces meet at which edge: closedness, orientation, shells.

use crate::{MeshError, TriangleMesh};
use std::collections::HashMap;

/// For each edge `i` of each triangle the triangle on the other side; only closed manifolds have one.
pub(super) type Neighbours = Vec<[u32; 3]>;

/// Edges by how many faces they have.
#[derive(Clone, Debug, Default)]
pub(super) struct EdgeCensus {
    /// Edges of one face, in order of that face.
    pub(super) open: Vec<[u32; 2]>,
    /// Edges of more than two faces and their number, in order of the first face.
    pub(super) non_manifold: Vec<([u32; 2], usize)>,
    pub(super) neighbours: Neighbours,
}

/// Finds the faces at every edge.
pub(super) fn edge_census(mesh: &TriangleMesh) -> EdgeCensus {
    let mut faces: HashMap<[u32; 2], (u32, u32, usize)> =
        HashMap::with_capacity(mesh.triangles.len() * 3 / 2);
    for_each_edge(mesh, |triangle, _, edge| {
        let entry = faces.entry(edge).or_insert((triangle, u32::MAX, 0));
        if entry.2 == 1 {
            entry.1 = triangle;
        }
        entry.2 += 1;
    });
    let mut census =
        EdgeCensus { neighbours: vec![[u32::MAX; 3]; mesh.triangles.len()], ..EdgeCensus::default() };
    for_each_edge(mesh, |triangle, slot, edge| {
        let Some(&(first, second, count)) = faces.get(&edge) else { return };
        match count {
            1 => census.open.push(edge),
            2 => census.neighbours[triangle as usize][slot] = if first == triangle { second } else { first },
            _ if first == triangle => census.non_manifold.push((edge, count)),
            _ => {}
        }
    });
    census
}

fn for_each_edge(mesh: &TriangleMesh, mut visit: impl FnMut(u32, usize, [u32; 2])) {
    for (index, triangle) in mesh.triangles.iter().enumerate() {
        for slot in 0..3 {
            let (a, b) = (triangle[slot], triangle[(slot + 1) % 3]);
            visit(index as u32, slot, [a.min(b), a.max(b)]);
        }
    }
}

/// Turns faces until neighbours agree. Returns the shell of every triangle and how many faces were turned;
/// the first face of a shell keeps its orientation.
pub(super) fn orient_consistently(
    mesh: &mut TriangleMesh,
    neighbours: &mut Neighbours,
) -> Result<(Vec<u32>, usize), MeshError> {
    const UNSEEN: u32 = u32::MAX;
    let mut shell = vec![UNSEEN; mesh.triangles.len()];
    let (mut shells, mut turned) = (0, 0);
    let mut open = Vec::new();
    for seed in 0..mesh.triangles.len() {
        if shell[seed] != UNSEEN {
            continue;
        }
        shell[seed] = shells;
        open.push(seed);
        while let Some(index) = open.pop() {
            for slot in 0..3 {
                let other = neighbours[index][slot] as usize;
                let (a, b) = (mesh.triangles[index][slot], mesh.triangles[index][(slot + 1) % 3]);
                // Neighbours agree when they run along their common edge in opposite directions.
                let agrees =
                    (0..3).any(|i| mesh.triangles[other][i] == b && mesh.triangles[other][(i + 1) % 3] == a);
                if shell[other] == UNSEEN {
                    shell[other] = shells;
                    if !agrees {
                        turn(mesh, neighbours, other);
                        turned += 1;
                    }
                    open.push(other);
                } else if !agrees {
                    return Err(MeshError::NotOrientable { triangle: other });
                }
            }
        }
        shells += 1;
    }
    Ok((shell, turned))
}

/// Reverses the orientation of one face; its edges change places accordingly.
pub(super) fn turn(mesh: &mut TriangleMesh, neighbours: &mut Neighbours, index: usize) {
    mesh.triangles[index].swap(1, 2);
    neighbours[index].swap(0, 2);
}
