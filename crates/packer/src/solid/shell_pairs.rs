//! Which shells of a surface meet, and how.

use super::bvh::Bvh;
use super::meetings::{self, Meeting};
use super::shells;
use super::topology::Orientation;
use crate::TriangleMesh;
use glam::DVec3;
use std::collections::HashSet;

/// A corner nearer to a plane than this share of the size of the mesh lies on it; the next one counts where with the one before the
/// union is not closed. Rotating a mesh moves its corners by 1e-16 of their coordinates: faces that were flush remain so, even ten
/// thousand sizes from the origin.
pub(super) const ON_PLANE: [f64; 3] = [1e-11, 1e-9, 1e-7];

/// Where a surface meets itself.
pub(super) struct Found {
    pub(super) meetings: Vec<Meeting>,
    pub(super) pairs: ShellPairs,
    /// Place in [`ON_PLANE`] of what they were found with.
    pub(super) coarseness: usize,
}

/// Finds where the surface meets itself, as finely as shells can be told apart: copies of a part that differ by more than
/// rounding but by less than anyone can want are all but flush everywhere, and nothing else tells that they overlap.
pub(super) fn find(mesh: &TriangleMesh, bvh: &Bvh, orientation: &Orientation) -> Found {
    let is_inverted: Vec<bool> =
        shells::signed_volumes(mesh, &orientation.shell_of).into_iter().map(|volume| volume < 0.0).collect();
    let find = |coarseness: usize| {
        let meetings = meetings::find(mesh, bvh, ON_PLANE[coarseness]);
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
    let coarse = find(ON_PLANE.len() - 1);
    if coarse.pairs.has_more_flush_than(&fine.pairs) { coarse } else { fine }
}

fn area_vector(mesh: &TriangleMesh, triangle: usize) -> DVec3 {
    let [a, b, c] = mesh.corners(triangle);
    (b - a).cross(c - a)
}

/// Pairs of shells that meet, the smaller number first.
#[derive(Clone, Debug, Default)]
pub(super) struct ShellPairs {
    cut: HashSet<[u32; 2]>,
    flush: HashSet<[u32; 2]>,
}

impl ShellPairs {
    /// Whether two shells cut each other.
    pub(super) fn cut(&self, a: usize, b: usize) -> bool {
        self.cut.contains(&ordered([a as u32, b as u32]))
    }

    /// Whether faces of two shells cover each other that would face the same way if both bounded material.
    pub(super) fn are_flush(&self, a: usize, b: usize) -> bool {
        self.flush.contains(&ordered([a as u32, b as u32]))
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
