//! From a mesh as it was read to a welded one and its edges.

use super::diagnosis::Diagnosis;
use super::parts;
use super::topology::{self, EdgeCensus};
use super::weld::{self, Repeated, Welding};
use crate::TriangleMesh;
use std::borrow::Cow;

/// A welded mesh, its edges, and what was left out.
pub(super) struct Cleaned {
    pub(super) mesh: TriangleMesh,
    pub(super) census: EdgeCensus,
    pub(super) diagnosis: Diagnosis,
}

impl Cleaned {
    /// With every face turned.
    pub(super) fn turned(self) -> Self {
        let mut mesh = self.mesh;
        mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        Self { census: topology::edge_census(&mesh), mesh, diagnosis: self.diagnosis }
    }
}

/// Leaves out what does not count and welds the rest.
///
/// If the surface is not manifold, parts that follow each other in the file may be. If not, faces that occur twice are walls between
/// two parts if the surface is closed and manifold without them; a face written once for each of its sides looks the same, but is
/// needed.
pub(super) fn clean(mesh: &TriangleMesh) -> Cleaned {
    let (diagnosis, sound) = begin(mesh);
    let of = |repeated| {
        let (welded, welding) = weld::weld(&sound, repeated);
        let census = topology::edge_census(&welded);
        (welded, census, welding)
    };
    let (mut mesh, mut census, mut welding) = of(Repeated::KeepOne);
    if !census.non_manifold.is_empty() {
        if let Some((apart, of_parts)) = parts::apart(&sound) {
            (census, welding) = (topology::edge_census(&apart), of_parts);
            mesh = apart;
        } else if welding.duplicate_faces > 0 {
            let none = of(Repeated::DropPairs);
            if !none.0.triangles.is_empty() && none.1.open.is_empty() && none.1.non_manifold.is_empty() {
                (mesh, census, welding) = none;
            }
        }
    }
    Cleaned { mesh, census, diagnosis: with_welding(diagnosis, welding) }
}

/// The parts that follow each other in the file, each welded for itself, if there are some.
pub(super) fn in_parts(mesh: &TriangleMesh) -> Option<Cleaned> {
    let (diagnosis, sound) = begin(mesh);
    let (mesh, welding) = parts::apart(&sound)?;
    Some(Cleaned { census: topology::edge_census(&mesh), mesh, diagnosis: with_welding(diagnosis, welding) })
}

/// What can be looked at, and a diagnosis that tells what cannot.
fn begin(mesh: &TriangleMesh) -> (Diagnosis, Cow<'_, TriangleMesh>) {
    let mut d = Diagnosis {
        input_vertices: mesh.vertices.len(),
        input_triangles: mesh.triangles.len(),
        ..Diagnosis::default()
    };
    let sound = sound(mesh, &mut d);
    (d, sound)
}

/// Leaves out what nothing can be said about: faces at vertices that do not exist or are not finite.
fn sound<'a>(mesh: &'a TriangleMesh, d: &mut Diagnosis) -> Cow<'a, TriangleMesh> {
    let vertices = mesh.vertices.iter().enumerate();
    d.not_finite = vertices.filter(|(_, v)| !v.is_finite()).map(|(index, v)| (index, *v)).collect();
    let missing =
        |triangle: &[u32; 3]| triangle.iter().find(|v| **v as usize >= mesh.vertices.len()).copied();
    let triangles = mesh.triangles.iter().enumerate();
    d.dangling = triangles.filter_map(|(index, t)| missing(t).map(|vertex| (index, vertex))).collect();
    if d.not_finite.count == 0 && d.dangling.count == 0 {
        return Cow::Borrowed(mesh);
    }
    let is_sound =
        |t: &&[u32; 3]| t.iter().all(|v| mesh.vertices.get(*v as usize).is_some_and(|v| v.is_finite()));
    let triangles = mesh.triangles.iter().filter(is_sound).copied().collect();
    Cow::Owned(TriangleMesh { vertices: mesh.vertices.clone(), triangles })
}

fn with_welding(d: Diagnosis, welding: Welding) -> Diagnosis {
    Diagnosis {
        unused_vertices: welding.unused_vertices,
        merged_vertices: welding.merged_vertices,
        degenerate_faces: welding.degenerate_faces,
        duplicate_faces: welding.duplicate_faces,
        paired_faces: welding.paired_faces,
        ..d
    }
}
