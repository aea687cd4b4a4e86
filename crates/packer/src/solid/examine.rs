//! From triangles to a diagnosis and, if they enclose something, to its surface.

use super::bvh::Bvh;
use super::clean::{self, Cleaned};
use super::diagnosis::{Diagnosis, Findings, SIZES};
use super::mass;
use super::meetings::{self, Meeting};
use super::plane::TrianglePlane;
use super::pseudonormals::{FOLD, Pseudonormals};
use super::shell_pairs::{self, COARSENESSES, Found, ShellPairs, on_plane};
use super::shells;
use super::topology::{self, EdgeCensus, NONE, Neighbours};
use super::visible::{self, Visible};
use crate::TriangleMesh;
use glam::DVec3;
use ist::SolidProperties;

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

/// Most times that a surface with shared edges is turned. Of 230,000 solids of cubes with faces turned at random, corners moved
/// by up to two edges, none needed more than three; of 50,000 with corners in place none more than two.
const ROUNDS: usize = 4;

/// What counts as closed, see [`mass::openness`]: unions of 312 rows of boxes, turned and moved by 1e-17 to 1e-6, had 2e-17 to 2e-10,
/// and those of which a face was missing 2e-4 to 2e-2.
const CLOSED: f64 = 1e-6;

/// Finds everything that there is to say about `mesh`, and its surface if it is a solid.
///
/// Where some parts of a file face inwards and others do not, faces at shared edges may be paired across parts, with a part in
/// another's shell or no end. Then the file's order tells parts, if each agrees with itself. Where all
/// faces look inwards and that has no end, they are turned before they are paired.
pub(super) fn examine(mesh: &TriangleMesh) -> (Diagnosis, Option<Surface>) {
    let cleaned = clean::clean(mesh);
    let has_shared = !cleaned.census.shared.is_empty();
    let in_one = vec![0; cleaned.mesh.triangles.len()];
    let looks_inwards = shells::signed_volumes(&cleaned.mesh, &in_one).first().is_some_and(|v| *v < 0.0);
    let (d, surface) = settle(ROUNDS, cleaned);
    let is_mixed = d.turned_faces > 0 || (1..d.shells).contains(&d.reversed_shells);
    if has_shared
        && (surface.is_none() || is_mixed)
        && let Some((of_parts, in_parts)) = clean::in_parts(mesh).map(|parts| settle(ROUNDS, parts))
        && in_parts.is_some()
        && of_parts.turned_faces == 0
    {
        return (of_parts, in_parts);
    }
    if has_shared && surface.is_none() && looks_inwards {
        let (mut of_turned, surface) = settle(ROUNDS, clean::clean(mesh).turned());
        if surface.is_some() {
            of_turned.reversed_shells = of_turned.shells - of_turned.reversed_shells;
            return (of_turned, surface);
        }
    }
    (d, surface)
}

/// Which faces bound a wedge of material at a shared edge is read from the sides that they face. Once some are turned,
/// other faces belong together and the shells are others: so it is read again until nothing turns.
fn settle(rounds: usize, cleaned: Cleaned) -> (Diagnosis, Option<Surface>) {
    let Cleaned { mut mesh, mut census, diagnosis } = cleaned;
    let before = mesh.triangles.clone();
    let mut round = 1;
    loop {
        let mut d = diagnosis.clone();
        let Some(closed) = close(mesh, census, &before, &mut d) else { return (d, None) };
        if closed.shared.is_empty() || !closed.has_turned {
            let surface = finish(closed, &mut d);
            let is_solid = d.refusal().is_none();
            return (d, surface.filter(|_| is_solid));
        }
        if round == rounds {
            d.non_manifold_edges = unsettled(&closed);
            return (d, None);
        }
        mesh = closed.mesh;
        census = topology::edge_census(&mesh);
        round += 1;
    }
}

/// A closed surface whose shells face outwards.
struct Closed {
    mesh: TriangleMesh,
    neighbours: Neighbours,
    /// Edges of more than two faces.
    shared: Vec<[u32; 2]>,
    bvh: Bvh,
    meetings: Vec<Meeting>,
    /// By which measure they were found, see [`on_plane`].
    coarseness: usize,
    /// Whether a face was turned for it.
    has_turned: bool,
    /// Whether parts of it may lie inside its union.
    has_sheets: bool,
}

/// Turns faces to agree with their neighbours and shells to face outwards; enters what is found on the way. `before` are
/// the triangles as they were read.
fn close(
    mut mesh: TriangleMesh,
    census: EdgeCensus,
    before: &[[u32; 3]],
    d: &mut Diagnosis,
) -> Option<Closed> {
    d.vertices = mesh.vertices.len();
    d.triangles = mesh.triangles.len();
    if mesh.triangles.is_empty() {
        return None;
    }
    let (lower, upper) = mesh.bounds();
    d.bounds = Some((lower, upper));
    d.resolution = 16.0 * lower.abs().max(upper.abs()).max_element() * f64::from(f32::EPSILON);
    let ends = |edge: [u32; 2]| edge.map(|vertex| mesh.vertices[vertex as usize]);
    d.open_edges = census.open.iter().map(|edge| ends(*edge)).collect();
    d.holes = topology::holes(&census.open);
    d.non_manifold_edges = census.non_manifold.iter().map(|(edge, faces)| (ends(*edge), *faces)).collect();
    d.shared_edges = census.shared.iter().map(|edge| ends(*edge)).collect();
    let EdgeCensus { mut neighbours, shared, .. } = census;
    let unturned = mesh.triangles.clone();
    let orientation = topology::orient_consistently(&mut mesh, &mut neighbours);
    d.shells = orientation.shells;
    d.one_sided = orientation.one_sided.iter().copied().collect();
    (d.turned_faces, d.reversed_shells) = topology::turns(before, &mesh.triangles, &orientation.shell_of);
    if !SIZES.contains(&d.size()) {
        return None;
    }
    find_flat_and_folded(&mesh, &neighbours, d);
    let bvh = bvh_of(&mesh);
    let Found { mut meetings, pairs, coarseness } = shell_pairs::find(&mesh, &neighbours, &bvh, &orientation);
    enter_meetings(&mesh, &meetings, &pairs, d);
    if d.refusal().is_some() {
        return None;
    }
    let outward = shells::face_outward(&mut mesh, &mut neighbours, &orientation.shell_of, &pairs);
    d.cavities = outward.cavities;
    (d.turned_faces, d.reversed_shells) = topology::turns(before, &mesh.triangles, &orientation.shell_of);
    let is_turned = |triangle: u32| outward.is_reversed[orientation.shell_of[triangle as usize] as usize];
    meetings.iter_mut().for_each(|meeting| meeting.turn(is_turned));
    // Triangles that were turned cross rays the other way.
    let bvh = if outward.is_reversed.contains(&true) { bvh_of(&mesh) } else { bvh };
    let has_turned = mesh.triangles != unturned;
    let has_sheets = outward.hides_shells || !meetings.iter().all(Meeting::grazes);
    Some(Closed { mesh, neighbours, shared, bvh, meetings, coarseness, has_turned, has_sheets })
}

/// Shared edges whose faces still turned in the last round.
fn unsettled(closed: &Closed) -> Findings<([DVec3; 2], usize)> {
    let Closed { mesh, shared, .. } = closed;
    let faces =
        |edge: &[u32; 2]| mesh.triangles.iter().filter(|t| edge.iter().all(|v| t.contains(v))).count();
    shared.iter().map(|edge| (edge.map(|vertex| mesh.vertices[vertex as usize]), faces(edge))).collect()
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

fn enter_meetings(mesh: &TriangleMesh, meetings: &[Meeting], pairs: &ShellPairs, d: &mut Diagnosis) {
    for meeting in meetings {
        if meeting.crosses() {
            d.self_intersections.push(meeting.place(mesh));
        } else if meeting.covers() {
            d.covering_faces.push(meeting.place(mesh));
        }
    }
    d.overlapping_shells = pairs.count_cut();
}

/// What bounds the union of the surface.
///
/// Some corners of faces that are all but flush may count as on each other's plane and others not, and then one face is taken for
/// covered and the other for bare. The surface has a hole by that, and is looked at more coarsely.
fn union(closed: &Closed) -> Visible {
    let Closed { mesh, neighbours, bvh, meetings, coarseness, .. } = closed;
    let (lower, upper) = mesh.bounds();
    let with_openness = |visible: Visible| {
        let openness = mass::openness(&visible.enclosing, 0.5 * (lower + upper));
        (visible, openness)
    };
    let mut best = with_openness(visible::visible(mesh, neighbours, bvh, meetings));
    for coarseness in coarseness + 1..COARSENESSES {
        if best.0.uncut > 0 || best.1 <= CLOSED {
            break;
        }
        let meetings = meetings::find(mesh, neighbours, bvh, on_plane(mesh, coarseness));
        let next = with_openness(visible::visible(mesh, neighbours, bvh, &meetings));
        if next.1 < best.1 {
            best = next;
        }
    }
    best.0
}

/// From the whole surface to what bounds its union, if anything does.
fn finish(closed: Closed, d: &mut Diagnosis) -> Option<Surface> {
    let visible = closed.has_sheets.then(|| union(&closed));
    let Closed { mesh, neighbours, shared, bvh, .. } = closed;
    // Several faces are equally near there, and they need not agree.
    let mut is_shared = vec![false; mesh.vertices.len()];
    shared.iter().flatten().for_each(|vertex| is_shared[*vertex as usize] = true);
    let at_shared_edge = |triangle: usize| mesh.triangles[triangle].iter().any(|v| is_shared[*v as usize]);
    let (lower, upper) = mesh.bounds();
    let center = 0.5 * (lower + upper);
    let corners = (0..mesh.triangles.len()).map(|triangle| mesh.corners(triangle));
    let by_shells = mass::properties(corners, center);
    let Some(visible) = visible else {
        d.volume = Some(by_shells.volume);
        let pseudonormals = Pseudonormals::new(&mesh, &neighbours, at_shared_edge);
        return Some(Surface { mesh, closed: None, bvh, uncut: None, pseudonormals, properties: by_shells });
    };
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Two tetrahedra with a common edge, both inside out.
    #[test]
    fn a_surface_that_is_not_settled_in_time_is_refused_at_its_shared_edges() {
        let corners = [[0, 0, 0], [0, 0, 1], [2, 1, 0], [2, -1, 0], [-2, 1, 0], [-2, -1, 0]];
        let vertices = corners.map(|corner| DVec3::from_array(corner.map(f64::from))).to_vec();
        let one = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let other = [[0, 5, 1], [0, 1, 4], [0, 4, 5], [1, 5, 4]];
        // Not one after the other, which would tell them apart.
        let triangles = one.into_iter().zip(other).flat_map(<[_; 2]>::from).collect();
        let mesh = TriangleMesh { vertices, triangles };
        let (settled, surface) = examine(&mesh);
        assert!(surface.is_some() && settled.refusal().is_none());
        assert_eq!(settled.shared_edges.count, 1);
        let (unsettled, surface) = settle(1, clean::clean(&mesh));
        assert!(surface.is_none());
        let edge = [DVec3::ZERO, DVec3::Z];
        assert_eq!(unsettled.non_manifold_edges.some, [(edge, 4)]);
    }
}
