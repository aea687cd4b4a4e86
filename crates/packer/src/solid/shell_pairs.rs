//! Which shells of a surface meet, and how.

use super::bvh::Bvh;
use super::meetings::{self, Meeting};
use super::shells;
use super::topology::{Neighbours, Orientation};
use super::triangle::closest_point;
use crate::TriangleMesh;
use glam::DVec3;
use std::collections::HashSet;

/// How many measures there are of what lies on a plane, see [`on_plane`].
pub(super) const COARSENESSES: usize = 3;

/// A corner nearer to a plane than this (m) lies on it; the next coarser measure counts where with the one before the
/// union is not closed. Rotating a mesh moves its corners by 1e-16 of their coordinates: faces that were flush remain so,
/// even ten thousand sizes from the origin. The coarsest one is at least what writing both corner and plane in single
/// precision moves them by, half a unit in the last place along each axis.
pub(super) fn on_plane(mesh: &TriangleMesh, coarseness: usize) -> f64 {
    let (lower, upper) = mesh.bounds();
    let share = [1e-11, 1e-9, 1e-7][coarseness];
    let rounding = 3.0_f64.sqrt() * f64::from(f32::EPSILON) * lower.abs().max(upper.abs()).max_element();
    let least = if coarseness + 1 == COARSENESSES { rounding } else { 0.0 };
    least.max(share * lower.distance(upper))
}

/// Where a surface meets itself.
pub(super) struct Found {
    pub(super) meetings: Vec<Meeting>,
    pub(super) pairs: ShellPairs,
    /// By which measure, see [`on_plane`].
    pub(super) coarseness: usize,
}

/// Finds where the surface meets itself, as finely as shells can be told apart: copies of a part that differ by more than
/// rounding but by less than anyone can want are all but flush everywhere, and nothing else tells that they overlap. Which
/// shells touch is always told by the coarsest measure.
pub(super) fn find(
    mesh: &TriangleMesh,
    neighbours: &Neighbours,
    bvh: &Bvh,
    orientation: &Orientation,
) -> Found {
    let is_inverted: Vec<bool> =
        shells::signed_volumes(mesh, &orientation.shell_of).into_iter().map(|volume| volume < 0.0).collect();
    let find = |coarseness: usize| {
        let meetings = meetings::find(mesh, neighbours, bvh, on_plane(mesh, coarseness));
        let mut pairs = ShellPairs::default();
        for meeting in &meetings {
            let triangles = [meeting.first, meeting.second].map(|triangle| triangle as usize);
            let shells = triangles.map(|triangle| orientation.shell_of[triangle]);
            if shells[0] == shells[1] {
                continue;
            }
            let pair = ordered(shells);
            if meeting.crosses() {
                pairs.cut.insert(pair);
            } else if meeting.covers() {
                let [a, b] = triangles.map(|triangle| area_vector(mesh, triangle));
                let face_alike =
                    (a.dot(b) > 0.0) != (is_inverted[shells[0] as usize] != is_inverted[shells[1] as usize]);
                if face_alike {
                    pairs.flush.insert(pair);
                }
            }
        }
        Found { meetings, pairs, coarseness }
    };
    let fine = find(0);
    if orientation.shells < 2 {
        return fine;
    }
    let coarse = find(COARSENESSES - 1);
    let mut found = if coarse.pairs.has_more_flush_than(&fine.pairs) { coarse } else { fine };
    found.pairs.touching = touching(mesh, bvh, &orientation.shell_of);
    found
}

/// Pairs of shells of which a corner of the one lies on the other, by the coarsest measure. O(n log n) for n triangles.
fn touching(mesh: &TriangleMesh, bvh: &Bvh, shell_of: &[u32]) -> HashSet<[u32; 2]> {
    let near = on_plane(mesh, COARSENESSES - 1);
    // Of which shell a corner was asked last: shells may have corners in common.
    let mut asked_for: Vec<Option<u32>> = vec![None; mesh.vertices.len()];
    let mut touching = HashSet::new();
    for (triangle, shell) in mesh.triangles.iter().zip(shell_of) {
        for vertex in triangle.map(|vertex| vertex as usize) {
            if asked_for[vertex].replace(*shell) == Some(*shell) {
                continue;
            }
            let corner = mesh.vertices[vertex];
            bvh.for_each_near(&[corner; 3], near, |other, corners| {
                let other = shell_of[other as usize];
                if other != *shell && closest_point(corners, corner).0.distance(corner) <= near {
                    touching.insert(ordered([*shell, other]));
                }
            });
        }
    }
    touching
}

fn area_vector(mesh: &TriangleMesh, triangle: usize) -> DVec3 {
    let [a, b, c] = mesh.corners(triangle);
    (b - a).cross(c - a)
}

/// Pairs of shells that meet, the smaller number first.
#[derive(Clone, Debug, Default)]
pub(super) struct ShellPairs {
    cut: HashSet<[u32; 2]>,
    /// Faces of the two cover each other, and would face the same way if both bounded material.
    flush: HashSet<[u32; 2]>,
    /// A corner of the one lies on the other.
    touching: HashSet<[u32; 2]>,
}

impl ShellPairs {
    /// Whether two shells cut each other.
    pub(super) fn cut(&self, a: usize, b: usize) -> bool {
        self.cut.contains(&ordered([a as u32, b as u32]))
    }

    /// Whether a corner of the one shell lies on the other.
    pub(super) fn touch(&self, a: usize, b: usize) -> bool {
        self.touching.contains(&ordered([a as u32, b as u32]))
    }

    /// Number of pairs that cut each other.
    pub(super) fn count_cut(&self) -> usize {
        self.cut.len()
    }

    /// Whether shells are flush that do not meet in `other`.
    fn has_more_flush_than(&self, other: &Self) -> bool {
        self.flush.iter().any(|pair| !other.cut.contains(pair) && !other.flush.contains(pair))
    }
}

fn ordered([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}
