//! Intersection, distance, contact and closest points.

use super::pair::{Other, Pair};
use super::workspace::with_workspace;
use crate::against_shape::surface_of;
use ist::{BallKind, SignedDistance};
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::query::{ClosestPoints, Contact, Unsupported};
use rapier3d::parry::shape::Shape;

/// The deepest or nearest places of two shapes, in the first one's frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gap {
    /// Signed distance (m).
    pub(super) gap: Real,
    pub(super) points: [Vector; 2],
    /// From the first shape to the second.
    pub(super) normal: Vector,
}

impl Pair<'_> {
    /// Whether they meet; touching counts.
    pub(super) fn intersects(&self, pos12: &Pose) -> bool {
        let pose = self.pose(pos12);
        match self.other {
            Other::Tree(other) => {
                with_workspace(|workspace| self.tree.intersects(other, &pose, &mut workspace.proximity))
            }
            Other::Shape(shape) => {
                pose.is_finite() && self.tree.meets_surface(BallKind::Inner, surface_of(shape, &pose))
            }
        }
    }

    /// The pair of balls, or the ball and the point of the surface, with the least signed distance below `max_gap`.
    pub(super) fn gap(&self, pos12: &Pose, balls: BallKind, max_gap: Real) -> Option<Gap> {
        let pose = self.pose(pos12);
        if !pose.is_finite() {
            return None;
        }
        let gap = match self.other {
            Other::Tree(other) => {
                let limits = (balls, max_gap);
                let contact = with_workspace(|workspace| {
                    self.tree.deepest_contact(other, &pose, limits, &mut workspace.proximity)
                })?;
                Gap { gap: contact.gap, points: [contact.point_a, contact.point_b], normal: contact.normal }
            }
            Other::Shape(shape) => {
                let found = self.tree.nearest_to_surface(balls, max_gap, surface_of(shape, &pose))?;
                let points = [found.point_on_ball(), found.point_on_surface()];
                Gap { gap: found.gap, points, normal: -found.surface.outward }
            }
        };
        Some(self.in_first_frame(gap, pos12))
    }

    /// The distance of a point of the tree from the surface of the other shape. `last` has the point on each shape, in its frame.
    /// `None` where both are trees.
    pub(super) fn gap_at(&self, pos12: &Pose, last: [Vector; 2]) -> Option<Gap> {
        let pose = self.pose(pos12);
        let (Other::Shape(shape), true) = (self.other, pose.is_finite()) else { return None };
        let point = last[usize::from(self.is_swapped)];
        let surface = surface_of(shape, &pose).distance(point);
        let points = [point, point - surface.distance * surface.outward];
        let gap = Gap { gap: surface.distance, points, normal: -surface.outward };
        Some(self.in_first_frame(gap, pos12))
    }

    /// A gap in the frame of the first shape instead of the tree's.
    fn in_first_frame(&self, gap: Gap, pos12: &Pose) -> Gap {
        if !self.is_swapped {
            return gap;
        }
        let points = [gap.points[1], gap.points[0]].map(|point| *pos12 * point);
        Gap { gap: gap.gap, points, normal: -(pos12.rotation * gap.normal) }
    }
}

/// 0 where shapes meet; the largest number where the pose is not finite.
pub(super) fn distance(pos12: &Pose, g1: &dyn Shape, g2: &dyn Shape) -> Result<Real, Unsupported> {
    let pair = Pair::new(g1, g2)?;
    if pair.intersects(pos12) {
        return Ok(0.0);
    }
    Ok(pair.gap(pos12, BallKind::Inner, Real::INFINITY).map_or(Real::MAX, |gap| gap.gap.max(0.0)))
}

/// The deepest place, or the nearest within `prediction`.
pub(super) fn contact(
    pos12: &Pose,
    g1: &dyn Shape,
    g2: &dyn Shape,
    prediction: Real,
) -> Result<Option<Contact>, Unsupported> {
    let gap = Pair::new(g1, g2)?.gap(pos12, BallKind::Inner, prediction);
    Ok(gap.map(|Gap { gap, points, normal }| {
        let point2 = pos12.inverse_transform_point(points[1]);
        Contact::new(points[0], point2, normal, -(pos12.rotation.inverse() * normal), gap)
    }))
}

/// The nearest places within `margin`.
pub(super) fn closest_points(
    pos12: &Pose,
    g1: &dyn Shape,
    g2: &dyn Shape,
    margin: Real,
) -> Result<ClosestPoints, Unsupported> {
    let pair = Pair::new(g1, g2)?;
    if pair.intersects(pos12) {
        return Ok(ClosestPoints::Intersecting);
    }
    let gap = pair.gap(pos12, BallKind::Inner, margin.next_up());
    Ok(gap.map_or(ClosestPoints::Disjoint, |gap| {
        ClosestPoints::WithinMargin(gap.points[0], pos12.inverse_transform_point(gap.points[1]))
    }))
}
