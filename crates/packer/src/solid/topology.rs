//! Which faces meet at which edge: closedness, orientation, shells.

use super::radial;
use crate::TriangleMesh;
use std::collections::HashMap;

/// For each edge `i` of each triangle the triangle on the other side, or [`NONE`] at edges that have not two.
pub(super) type Neighbours = Vec<[u32; 3]>;
/// No triangle.
pub(super) const NONE: u32 = u32::MAX;

/// A side of a triangle: that from corner `slot` to the next one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Side {
    pub(super) triangle: u32,
    pub(super) slot: usize,
}

/// Edges by how many faces they have.
#[derive(Clone, Debug, Default)]
pub(super) struct EdgeCensus {
    /// Edges of one face, in order of that face.
    pub(super) open: Vec<[u32; 2]>,
    /// Edges of more than two faces that do not bound wedges of material, and their number, in order of the first face.
    pub(super) non_manifold: Vec<([u32; 2], usize)>,
    /// Edges of more than two faces that bound wedges of material, in order of the first face.
    pub(super) shared: Vec<[u32; 2]>,
    pub(super) neighbours: Neighbours,
}

/// Finds the faces at every edge.
pub(super) fn edge_census(mesh: &TriangleMesh) -> EdgeCensus {
    let mut faces: HashMap<[u32; 2], (u32, u32, usize)> =
        HashMap::with_capacity(mesh.triangles.len() * 3 / 2);
    for_each_edge(mesh, |triangle, _, edge| {
        let entry = faces.entry(edge).or_insert((triangle, NONE, 0));
        if entry.2 == 1 {
            entry.1 = triangle;
        }
        entry.2 += 1;
    });
    let mut census =
        EdgeCensus { neighbours: vec![[NONE; 3]; mesh.triangles.len()], ..EdgeCensus::default() };
    let mut crowded: HashMap<[u32; 2], Vec<Side>> = HashMap::new();
    let mut in_order = Vec::new();
    for_each_edge(mesh, |triangle, slot, edge| {
        let Some(&(first, second, count)) = faces.get(&edge) else { return };
        match count {
            1 => census.open.push(edge),
            2 => census.neighbours[triangle as usize][slot] = if first == triangle { second } else { first },
            _ => {
                if first == triangle {
                    in_order.push(edge);
                }
                crowded.entry(edge).or_default().push(Side { triangle, slot });
            }
        }
    });
    for edge in in_order {
        let sides = crowded.remove(&edge).unwrap_or_default();
        match radial::wedges(mesh, edge, &sides) {
            None => census.non_manifold.push((edge, sides.len())),
            Some(wedges) => {
                census.shared.push(edge);
                for [a, b] in wedges {
                    census.neighbours[a.triangle as usize][a.slot] = b.triangle;
                    census.neighbours[b.triangle as usize][b.slot] = a.triangle;
                }
            }
        }
    }
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

/// Connected parts of the surface, each oriented alike.
#[derive(Clone, Debug, Default)]
pub(super) struct Orientation {
    /// The part of every triangle.
    pub(super) shell_of: Vec<u32>,
    /// Number of parts.
    pub(super) shells: usize,
    /// For each one-sided part, a triangle whose neighbours ask for both orientations.
    pub(super) one_sided: Vec<usize>,
}

/// Turns faces until neighbours agree, as far as they can; the first face of a shell keeps its orientation.
pub(super) fn orient_consistently(mesh: &mut TriangleMesh, neighbours: &mut Neighbours) -> Orientation {
    let mut out = Orientation { shell_of: vec![NONE; mesh.triangles.len()], ..Orientation::default() };
    let mut open = Vec::new();
    for seed in 0..mesh.triangles.len() {
        if out.shell_of[seed] != NONE {
            continue;
        }
        let shell = out.shells as u32;
        let mut twist = None;
        out.shell_of[seed] = shell;
        open.push(seed);
        while let Some(index) = open.pop() {
            for slot in 0..3 {
                if neighbours[index][slot] == NONE {
                    continue;
                }
                let other = neighbours[index][slot] as usize;
                let (a, b) = (mesh.triangles[index][slot], mesh.triangles[index][(slot + 1) % 3]);
                // Neighbours agree when they run along their common edge in opposite directions.
                let agrees =
                    (0..3).any(|i| mesh.triangles[other][i] == b && mesh.triangles[other][(i + 1) % 3] == a);
                if out.shell_of[other] == NONE {
                    out.shell_of[other] = shell;
                    if !agrees {
                        turn(mesh, neighbours, other);
                    }
                    open.push(other);
                } else if !agrees {
                    twist = twist.or(Some(other));
                }
            }
        }
        out.one_sided.extend(twist);
        out.shells += 1;
    }
    out
}

/// Faces that are turned against the first one of their shell, and shells whose first face is turned, from triangles as
/// they were before and as they are after.
pub(super) fn turns(before: &[[u32; 3]], after: &[[u32; 3]], shell_of: &[u32]) -> (usize, usize) {
    let is_turned = |triangle: usize| before[triangle] != after[triangle];
    let mut is_reversed: Vec<bool> = Vec::new();
    let mut faces = 0;
    for (triangle, shell) in shell_of.iter().enumerate() {
        // Shells are numbered in the order of their first faces.
        if is_reversed.len() <= *shell as usize {
            is_reversed.push(is_turned(triangle));
        }
        faces += usize::from(is_turned(triangle) != is_reversed[*shell as usize]);
    }
    (faces, is_reversed.into_iter().filter(|is_reversed| *is_reversed).count())
}

/// Loops of open edges: the holes of the surface. Loops that touch in a vertex count as one.
pub(super) fn holes(open: &[[u32; 2]]) -> usize {
    let mut beside: HashMap<u32, Vec<u32>> = HashMap::new();
    for [a, b] in open {
        beside.entry(*a).or_default().push(*b);
        beside.entry(*b).or_default().push(*a);
    }
    let mut holes = 0;
    let mut reached = Vec::new();
    for [start, _] in open {
        holes += usize::from(beside.contains_key(start));
        reached.push(*start);
        while let Some(vertex) = reached.pop() {
            reached.extend(beside.remove(&vertex).into_iter().flatten());
        }
    }
    holes
}

/// Reverses the orientation of one face; its edges change places accordingly.
pub(super) fn turn(mesh: &mut TriangleMesh, neighbours: &mut Neighbours, index: usize) {
    mesh.triangles[index].swap(1, 2);
    neighbours[index].swap(0, 2);
}
