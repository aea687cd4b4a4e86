//! Distance of two trees.

use super::nearest::{Limits, nearest_pair};
use super::placement::{Placement, exact_ball};
use super::projection::BallPair;
use super::side::Side;
use super::{BallKind, ProximityWorkspace};
use crate::InnerSphereTree;
use glam::Vec3;
use glamx::Pose3;

/// How far apart two trees are, in A's frame.
///
/// # What is certified
/// With [`BallKind::Inner`] the balls lie inside the solids: the *solids* are at most [`Self::distance`] apart.
/// [`Self::lower_bound`] holds for the *balls*: no ball of A is nearer to a ball of B. It does not bound the distance
/// of the solids, as neither kind of balls covers its solid. Whoever knows how far the surface of either solid
/// reaches from its nearest ball, h_a and h_b, has the bound `lower_bound − h_a − h_b` for the solids.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Separation {
    /// Distance (m) of the nearest pair of balls that was found; 0 where two balls meet.
    pub distance: f32,
    /// No two balls are nearer than this (m), rounding allowed for; at least 0.
    pub lower_bound: f32,
    /// Point of A's ball nearest to B's ball (m). Where they meet, a point that both share.
    pub point_a: Vec3,
    /// Point of B's ball nearest to A's ball (m). Where they meet, the same as [`Self::point_a`].
    pub point_b: Vec3,
    /// Unit vector from the centre of A's ball to that of B's.
    pub normal: Vec3,
    /// Index of A's sphere in its packing.
    pub sphere_a: usize,
    /// Index of B's sphere in its packing.
    pub sphere_b: usize,
}

/// What a distance query looks at and when it may stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DistanceOptions {
    /// The balls of both trees; inner balls by default.
    pub balls: BallKind,
    /// Pairs at this distance (m) or farther are of no interest; infinite by default.
    pub max_distance: f32,
    /// By how much (m) the distance may be larger than the smallest, but for rounding; 0 by default. For bodies of
    /// 10,000 spheres, a hundredth of their radius saves 5 % of the time, a tenth saves 60 to 85 %.
    pub tolerance: f32,
    /// Pairs of tree nodes that may be looked at after the first way down; unlimited by default. Bounded, pairs are visited best
    /// first, at about 0.05 µs each.
    pub max_visits: usize,
}

impl Default for DistanceOptions {
    fn default() -> Self {
        Self { balls: BallKind::Inner, max_distance: f32::INFINITY, tolerance: 0.0, max_visits: usize::MAX }
    }
}

impl InnerSphereTree {
    /// Distance of the inner balls of this solid (A) and of `other` (B), whose frame stands at `pose` in A's frame.
    ///
    /// The pair is the nearest one up to the rounding of centres to f32, 2e-6 of their coordinates; its distance is
    /// computed in f64. Where balls meet, the distance is 0 and the pair is one that meets, not the deepest.
    /// `None` where the pose is not finite, its quaternion far from unit length, or a coordinate
    /// beyond 10¹⁸ times A's size.
    ///
    /// The time grows with the number of nearly nearest pairs: most for parallel faces, least for corners and contacts.
    ///
    /// ```
    /// # use glam::Vec3;
    /// # use glamx::Pose3;
    /// # use ist::{InnerSphere, InnerSphereTree, ProximityWorkspace, SolidProperties, SpherePacking};
    /// # let ball = InnerSphere::solid_ball(Vec3::ZERO, 1.0, Vec3::X);
    /// # let tree = InnerSphereTree::new(&SpherePacking::new(vec![ball], SolidProperties::ball(1.0))?);
    /// let mut workspace = ProximityWorkspace::default();
    /// let nearest = tree.distance(&tree, &Pose3::translation(5.0, 0.0, 0.0), &mut workspace);
    /// assert_eq!(nearest.map(|nearest| (nearest.distance, nearest.point_a)), Some((3.0, Vec3::X)));
    /// # Ok::<(), ist::PackingError>(())
    /// ```
    #[must_use]
    pub fn distance(
        &self,
        other: &Self,
        pose: &Pose3,
        workspace: &mut ProximityWorkspace,
    ) -> Option<Separation> {
        self.distance_with(other, pose, &DistanceOptions::default(), workspace)
    }

    /// As [`Self::distance`], with `options`.
    ///
    /// `None` also where no two balls are nearer than [`DistanceOptions::max_distance`]. A query that runs out of visits
    /// returns what it has: the distances of the balls then lie between `lower_bound` and `distance`, however far
    /// apart these are. NaN in `options` stands for the default.
    #[must_use]
    pub fn distance_with(
        &self,
        other: &Self,
        pose: &Pose3,
        options: &DistanceOptions,
        workspace: &mut ProximityWorkspace,
    ) -> Option<Separation> {
        let placement = Placement::new(self, other, pose)?;
        let kind = options.balls;
        let limits = Limits {
            cutoff: f32::INFINITY.min(options.max_distance) / self.unit(),
            enough: 0.0,
            tolerance: options.tolerance.max(0.0) / self.unit(),
            visits: options.max_visits,
        };
        let sides = [Side::fixed(self, kind), Side::placed(other, kind, self, &placement)];
        let found = nearest_pair(sides, limits, workspace)?;
        let [a, b] = found.pair;
        let fallback = self.data().leaves[a].normal().as_dvec3();
        let pair = BallPair::new(exact_ball(self, kind, a), placement.exact_ball(other, kind, b), fallback);
        let [point_a, point_b] = pair.witnesses().map(|point| point.as_vec3());
        let distance = pair.gap.max(0.0) as f32;
        Some(Separation {
            distance,
            lower_bound: ((found.lower - placement.rounding) * self.unit()).clamp(0.0, distance),
            point_a,
            point_b,
            normal: pair.normal.as_vec3(),
            sphere_a: self.packing_index(a),
            sphere_b: other.packing_index(b),
        })
    }
}
