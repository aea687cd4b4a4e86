//! From triangles to a diagnosis and, if they enclose something, to its surface.

use super::bvh::Bvh;
use super::diagnosis::{Diagnosis, Findings, SIZES};
use super::meetings::{self, Meeting};
use super::plane::TrianglePlane;
use super::pseudonormals::{FOLD, Pseudonormals};
use super::shells::{self, Overlaps};
use super::topology::{self, EdgeCensus, NONE, Neighbours};
use super::weld::{self, Repeated, Welding};
use super::{mass, visible};
use crate::TriangleMesh;
use glam::DVec3;
use ist::SolidProperties;
use std::borrow::Cow;

/// The surface of a solid, ready for queries.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    /// What bounds the solid, every triangle facing outwards.
    pub(super) mesh: TriangleMesh,
    /// The closed mesh, where that is another one.
    pub(super) closed: Option<TriangleMesh>,
    pub(super) bvh: Bvh,
    /// The surface as it came, if what lies inside the union could not be cut off everywhere: `mesh` is not closed then.
    pub(super) uncut: Option<Bvh>,
    pub(super) pseudonormals: Pseudonormals,
    pub(super) properties: SolidProperties,
}

/// Most times that the faces at shared edges are turned. Two do for a mesh that is inside out as a whole.
const ROUNDS: usize = 4;

/// Finds everything that there is to say about `mesh`, and its surface if it is a solid.
pub(super) fn examine(mesh: &TriangleMesh) -> (Diagnosis, Option<Surface>) {
    examine_in(ROUNDS, mesh)
}

fn examine_in(rounds: usize, mesh: &TriangleMesh) -> (Diagnosis, Option<Surface>) {
    let mut d = Diagnosis {
        input_vertices: mesh.vertices.len(),
        input_triangles: mesh.triangles.len(),
        ..Diagnosis::default()
    };
    let (mut mesh, welding, census) = clean(&sound(mesh, &mut d));
    d.vertices = mesh.vertices.len();
    d.triangles = mesh.triangles.len();
    d.unused_vertices = welding.unused_vertices;
    d.merged_vertices = welding.merged_vertices;
    d.degenerate_faces = welding.degenerate_faces;
    d.duplicate_faces = welding.duplicate_faces;
    d.paired_faces = welding.paired_faces;
    if mesh.triangles.is_empty() {
        return (d, None);
    }
    let (lower, upper) = mesh.bounds();
    d.bounds = Some((lower, upper));
    d.resolution = 16.0 * lower.abs().max(upper.abs()).max_element() * f64::from(f32::EPSILON);
    let ends = |edge: [u32; 2]| edge.map(|vertex| mesh.vertices[vertex as usize]);
    d.open_edges = census.open.iter().map(|edge| ends(*edge)).collect();
    d.holes = topology::holes(&census.open);
    d.non_manifold_edges = in_space(&mesh, &census.non_manifold);
    d.shared_edges = census.shared.iter().map(|edge| ends(*edge)).collect();
    let mut neighbours = census.neighbours;
    let orientation = topology::orient_consistently(&mut mesh, &mut neighbours);
    d.turned_faces = orientation.turned;
    d.shells = orientation.shells;
    d.one_sided = orientation.one_sided.into_iter().collect();
    if !SIZES.contains(&d.size()) {
        return (d, None);
    }
    find_flat_and_folded(&mesh, &neighbours, &mut d);
    let bvh = bvh_of(&mesh);
    let mut meetings = meetings::find(&mesh, &bvh);
    let overlaps = sort_meetings(&mesh, &meetings, &orientation.shell_of, &mut d);
    if d.refusal().is_some() {
        return (d, None);
    }
    let outward = shells::face_outward(&mut mesh, &mut neighbours, &orientation.shell_of, &overlaps);
    d.cavities = outward.cavities;
    d.reversed_shells = outward.is_reversed.iter().filter(|is_reversed| **is_reversed).count();
    let is_turned = |triangle: u32| outward.is_reversed[orientation.shell_of[triangle as usize] as usize];
    if !census.shared.is_empty() && d.turned_faces + d.reversed_shells > 0 {
        return once_more(&mesh, &census.shared, d, rounds);
    }
    meetings.iter_mut().for_each(|meeting| meeting.turn(is_turned));
    // Triangles that were turned cross rays the other way.
    let bvh = if d.reversed_shells > 0 { bvh_of(&mesh) } else { bvh };
    let surface = finish(Closed { mesh, neighbours, shared: census.shared }, bvh, &meetings, &mut d);
    let is_solid = d.refusal().is_none();
    (d, surface.filter(|_| is_solid))
}

/// Examines faces that were turned. Which ones bound a wedge of material at a shared edge was read from the sides that
/// they told before; told anew, other faces belong together, and so the shells are others.
fn once_more(
    turned: &TriangleMesh,
    shared: &[[u32; 2]],
    first: Diagnosis,
    rounds: usize,
) -> (Diagnosis, Option<Surface>) {
    if rounds <= 1 {
        let has =
            |edge: &[u32; 2]| turned.triangles.iter().filter(|t| edge.iter().all(|v| t.contains(v))).count();
        let edges: Vec<_> = shared.iter().map(|edge| (*edge, has(edge))).collect();
        return (Diagnosis { non_manifold_edges: in_space(turned, &edges), ..first }, None);
    }
    let (again, surface) = examine_in(rounds - 1, turned);
    let d = Diagnosis {
        input_vertices: first.input_vertices,
        input_triangles: first.input_triangles,
        unused_vertices: first.unused_vertices,
        merged_vertices: first.merged_vertices,
        degenerate_faces: first.degenerate_faces,
        duplicate_faces: first.duplicate_faces,
        paired_faces: first.paired_faces,
        turned_faces: first.turned_faces + again.turned_faces,
        reversed_shells: first.reversed_shells + again.reversed_shells,
        ..again
    };
    (d, surface)
}

fn in_space(mesh: &TriangleMesh, edges: &[([u32; 2], usize)]) -> Findings<([DVec3; 2], usize)> {
    edges.iter().map(|(edge, faces)| (edge.map(|vertex| mesh.vertices[vertex as usize]), *faces)).collect()
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

/// Welds. Faces that occur twice are walls between two parts if the surface is closed and manifold without them and is
/// not with one of each; a face written once for each of its sides looks the same, but is needed.
fn clean(mesh: &TriangleMesh) -> (TriangleMesh, Welding, EdgeCensus) {
    let of = |repeated| {
        let (welded, welding) = weld::weld(mesh, repeated);
        let census = topology::edge_census(&welded);
        (welded, welding, census)
    };
    let one_of_each = of(Repeated::KeepOne);
    if one_of_each.1.duplicate_faces == 0 || one_of_each.2.non_manifold.is_empty() {
        return one_of_each;
    }
    let none = of(Repeated::DropPairs);
    let is_better = !none.0.triangles.is_empty() && none.2.open.is_empty() && none.2.non_manifold.is_empty();
    if is_better { none } else { one_of_each }
}

fn bvh_of(mesh: &TriangleMesh) -> Bvh {
    Bvh::new((0..mesh.triangles.len()).map(|triangle| mesh.corners(triangle)))
}

fn find_flat_and_folded(mesh: &TriangleMesh, neighbours: &Neighbours, d: &mut Diagnosis) {
    let normals: Vec<DVec3> = (0..mesh.triangles.len())
        .map(|triangle| {
            let corners = mesh.corners(triangle);
            let plane = TrianglePlane::new(&corners);
            if plane.is_none() {
                d.flat_faces.push((corners[0] + corners[1] + corners[2]) / 3.0);
            }
            plane.map_or(DVec3::ZERO, |plane| plane.normal().normalize_or_zero())
        })
        .collect();
    for (triangle, others) in neighbours.iter().enumerate() {
        for (slot, other) in others.iter().enumerate() {
            let is_first = *other != NONE && triangle < *other as usize;
            if is_first && normals[triangle].dot(normals[*other as usize]) <= FOLD {
                let corners = mesh.corners(triangle);
                d.folds.push(corners[slot].midpoint(corners[(slot + 1) % 3]));
            }
        }
    }
}

/// Enters meetings into the diagnosis; returns the shells that cut each other.
fn sort_meetings(mesh: &TriangleMesh, meetings: &[Meeting], shell_of: &[u32], d: &mut Diagnosis) -> Overlaps {
    let mut overlaps = Overlaps::default();
    for meeting in meetings {
        if meeting.crosses() {
            d.self_intersections.push(meeting.place(mesh));
            let [a, b] = [meeting.first, meeting.second].map(|triangle| shell_of[triangle as usize]);
            if a != b {
                overlaps.insert([a.min(b), a.max(b)]);
            }
        } else if meeting.covers() {
            d.covering_faces.push(meeting.place(mesh));
        }
    }
    d.overlapping_shells = overlaps.len();
    overlaps
}

/// A closed and oriented surface.
struct Closed {
    mesh: TriangleMesh,
    neighbours: Neighbours,
    /// Edges of more than two faces.
    shared: Vec<[u32; 2]>,
}

/// From the whole surface to what bounds its union, if anything does.
fn finish(closed: Closed, bvh: Bvh, meetings: &[Meeting], d: &mut Diagnosis) -> Option<Surface> {
    let Closed { mesh, neighbours, shared } = closed;
    // Several faces are equally near there, and they need not agree.
    let mut is_shared = vec![false; mesh.vertices.len()];
    shared.iter().flatten().for_each(|vertex| is_shared[*vertex as usize] = true);
    let at_shared_edge = |triangle: usize| mesh.triangles[triangle].iter().any(|v| is_shared[*v as usize]);
    let (lower, upper) = mesh.bounds();
    let center = 0.5 * (lower + upper);
    let corners = (0..mesh.triangles.len()).map(|triangle| mesh.corners(triangle));
    let by_shells = mass::properties(corners, center);
    if meetings.is_empty() {
        d.volume = Some(by_shells.volume);
        let pseudonormals = Pseudonormals::new(&mesh, &neighbours, at_shared_edge);
        return Some(Surface { mesh, closed: None, bvh, uncut: None, pseudonormals, properties: by_shells });
    }
    let visible = visible::visible(&mesh, &neighbours, &bvh, meetings);
    let mut is_whole = vec![false; mesh.triangles.len()];
    for (parent, whole) in visible.parents.iter().zip(&visible.is_whole) {
        is_whole[*parent as usize] = *whole;
    }
    let pseudonormals = Pseudonormals::new(&mesh, &neighbours, |t| !is_whole[t] || at_shared_edge(t))
        .of_parts(&visible.parents, &visible.is_whole);
    let properties = mass::properties(visible.enclosing.iter().copied(), center);
    d.hidden_faces = visible.hidden;
    d.cut_faces = visible.cut;
    d.uncut_faces = visible.uncut;
    d.volume = Some(properties.volume);
    d.overlap_volume = by_shells.volume - properties.volume;
    if visible.mesh.triangles.is_empty() {
        return None;
    }
    let uncut = (visible.uncut > 0).then_some(bvh);
    Some(Surface {
        bvh: bvh_of(&visible.mesh),
        mesh: visible.mesh,
        closed: Some(mesh),
        uncut,
        pseudonormals,
        properties,
    })
}
