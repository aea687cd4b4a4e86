//! The pair of balls of two trees with the least signed distance.

use super::nearest::{Limits, nearest_pair};
use super::placement::{Placement, exact_ball};
use super::projection::BallPair;
use super::side::Side;
use super::{BallKind, ProximityWorkspace};
use crate::InnerSphereTree;
use glam::Vec3;
use glamx::Pose3;

/// Two balls of two trees, nearest to each other or deepest in each other, in A's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct BallContact {
    /// Distance of the balls (m), negative where they meet.
    pub gap: f32,
    /// The point of A's ball that is farthest towards B's centre (m).
    pub point_a: Vec3,
    /// The point of B's ball that is farthest towards A's centre (m).
    pub point_b: Vec3,
    /// Unit vector from the centre of A's ball to that of B's; A's stored normal where they coincide.
    pub normal: Vec3,
    /// Index of A's sphere in its packing.
    pub sphere_a: usize,
    /// Index of B's sphere in its packing.
    pub sphere_b: usize,
}

impl InnerSphereTree {
    /// The balls of this solid (A) and of `other` (B), whose frame stands at `pose` in A's frame, with the least signed
    /// distance below `max_gap` (m): the nearest pair, or the deepest where balls meet.
    ///
    /// `None` where no two are that near, and where [`InnerSphereTree::distance`] is `None`. Takes longer the more pairs meet.
    #[must_use]
    pub fn deepest_contact(
        &self,
        other: &Self,
        pose: &Pose3,
        (balls, max_gap): (BallKind, f32),
        workspace: &mut ProximityWorkspace,
    ) -> Option<BallContact> {
        let placement = Placement::new(self, other, pose)?;
        let sides = [Side::fixed(self, balls), Side::placed(other, balls, self, &placement)];
        let limits = Limits {
            cutoff: max_gap / self.unit(),
            enough: f32::NEG_INFINITY,
            tolerance: 0.0,
            visits: usize::MAX,
        };
        let [a, b] = nearest_pair(sides, limits, workspace)?.pair;
        let fallback = self.data().leaves[a].normal().as_dvec3();
        let pair = BallPair::new(exact_ball(self, balls, a), placement.exact_ball(other, balls, b), fallback);
        Some(BallContact {
            gap: pair.gap as f32,
            point_a: (pair.centers[0] + pair.radii[0] * pair.normal).as_vec3(),
            point_b: (pair.centers[1] - pair.radii[1] * pair.normal).as_vec3(),
            normal: pair.normal.as_vec3(),
            sphere_a: self.packing_index(a),
            sphere_b: other.packing_index(b),
        })
    }
}
