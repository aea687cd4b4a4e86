//! Overlap of a tree with a solid that is given by its signed distance.
//!
//! Each ball meets the other solid as if that were the half-space behind its nearest surface point, in a spherical
//! [cap](super::cap). Exact for half-spaces and good where the balls are small against the features of the other solid;
//! against parts thinner than a ball the cap is too large.
//!
//! A rigid motion of B with velocity v(x) changes the distance at a ball's centre c by −n·v(q), with q the nearest point of
//! the surface. q = c − dn, and (ω × n)·n = 0, so c does as well as q for the torque, as does any point of the line.

use super::cap::Cap;
use super::flush::Flush;
use super::totals::Totals;
use super::{ContactSample, DeepestPair, ForceLaw, Overlap};
use crate::tree::WIDTH;
use crate::{InnerSphereTree, SignedDistance, SurfaceDistance};
use alloc::vec::Vec;
use glam::Vec3;

/// Nodes that are farther from B than this share of the bounding ball's radius are not asked about more precisely. Not tuned.
const SLACK: f32 = 0.02;

/// Room for eight children on each of the at most eleven levels of 2³¹ spheres.
const MOST_PENDING: usize = 11 * WIDTH;

/// A ball that B cuts.
struct CutBall {
    /// Position in the tree's order.
    index: usize,
    center: Vec3,
    surface: SurfaceDistance,
    cap: Cap,
}

impl InnerSphereTree {
    /// The overlap of this solid (A) with the half-space B of all points x with n·x ≤ `offset` (m), n the unit vector along
    /// `normal`, in A's frame: `normal` points out of B and into the open.
    ///
    /// The sum over all volume balls is exact. As for two solids, [`Overlap::force`] is that on B and as large as the
    /// volume, however deep the solid is; its direction is −`normal`. B counts as one sphere of index 0 in
    /// [`Overlap::pairs`] and [`Overlap::deepest`], and there is no [`Overlap::stiffness`]. [`Overlap::intersects`] is as certain as
    /// single precision: to about 1e-6 of the coordinates of both.
    ///
    /// Takes time in proportion to the spheres in B and allocates nothing. Returns [`Overlap::default`] where nothing
    /// overlaps and where `normal` is far from unit length or a number is not finite.
    #[must_use]
    pub fn overlap_with_half_space(&self, normal: Vec3, offset: f32) -> Overlap {
        let length = normal.length();
        if !(length > 0.5 && length < 2.0 && offset.is_finite()) {
            return Overlap::default();
        }
        let outward = normal / length;
        // Only B says where out is: the way out of A is no way out of a half-space.
        let (totals, deepest) =
            self.cap_totals(|point| SurfaceDistance { distance: outward.dot(point) - offset, outward }, 0.0);
        Overlap { deepest, ..Overlap::from_totals(&totals, ForceLaw::Blended, 1.0) }
    }

    /// The overlap of this solid (A) with a solid B of the given signed distance, both in A's frame, with the force of
    /// [`ForceLaw::Blended`].
    ///
    /// Every volume ball meets the half-space behind its nearest surface point: good where the balls are small against the
    /// features of B, too large against parts of B thinner than a ball. B counts as one sphere of index 0 in
    /// [`Overlap::pairs`] and [`Overlap::deepest`], and there is no [`Overlap::stiffness`]. [`Overlap::intersects`] is as
    /// certain as the distances are.
    ///
    /// `surface` is asked about as many points as B has spheres of A in reach, times
    /// a small constant. Allocates nothing. Returns [`Overlap::default`] where nothing overlaps.
    #[must_use]
    pub fn overlap_with_surface(&self, surface: impl SignedDistance) -> Overlap {
        let (totals, deepest) = self.cap_totals(surface, 1.0);
        Overlap { deepest, ..Overlap::from_totals(&totals, ForceLaw::Blended, 1.0) }
    }

    /// The overlap of this solid (A) with a solid B of the given signed distance, both in A's frame, as one sample
    /// per ball that B cuts, appended to `samples`. Returns a distance (m) of which all balls that B does not cut are certain
    /// to be away from B; infinite where it cuts all.
    pub fn contact_samples_with_surface(
        &self,
        mut surface: impl SignedDistance,
        samples: &mut Vec<ContactSample>,
    ) -> f32 {
        self.for_each_cut_ball(&mut surface, |_, CutBall { center, surface, cap, .. }| {
            samples.push(cap_sample(center, surface.outward, &cap));
        })
    }

    /// As [`Self::contact_samples_with_surface`], but contact begins flush with the surface of A, as in
    /// [`Self::flush_contact_samples`]. Distances are of balls that B does not cut; zero where one is cut and not in contact yet.
    pub fn flush_contact_samples_with_surface(
        &self,
        mut surface: impl SignedDistance,
        samples: &mut Vec<ContactSample>,
    ) -> f32 {
        let mut before = f32::INFINITY;
        let clearance = self.for_each_cut_ball(&mut surface, |_, ball| {
            let (outward, distance) = (ball.surface.outward, ball.surface.distance);
            let radius = self.data().leaves[ball.index].radius() * self.unit() + self.skin();
            let inner_radius = self.data().inner_radius[ball.index] * self.unit() + self.skin();
            let shift = self.data().inner_center[ball.index] * self.unit() - ball.center;
            let inner = inner_radius + self.contact_offset() - distance - shift.dot(outward);
            let radius = f64::from(radius);
            let Some(flush) = Flush::new(radius - f64::from(distance), inner.into(), radius) else {
                before = 0.0;
                return;
            };
            let cap = Cap::new(radius, radius - flush.height);
            // It is as far from B's surface as it was.
            let centroid = cap.centroid - (ball.cap.height - cap.height).max(0.0);
            samples.push(cap_sample(
                ball.center,
                outward,
                &Cap { base: cap.base * flush.slope, centroid, ..cap },
            ));
        });
        clearance.min(before)
    }

    /// Sums over all balls that B cuts, at the tree's scale, and the one that is cut deepest. `share` is the part of A's own
    /// outward normals that counts.
    fn cap_totals(&self, mut surface: impl SignedDistance, share: f64) -> (Totals, Option<DeepestPair>) {
        let (mut totals, mut deepest) = (Totals::default(), None);
        let mut greatest = 0.0;
        self.for_each_cut_ball(&mut surface, |surface, ball| {
            let (outward, cap) = (ball.surface.outward.as_dvec3(), ball.cap);
            let center = ball.center.as_dvec3();
            let point = center - outward * cap.centroid;
            totals.pairs += 1;
            totals.volume += cap.volume;
            totals.moment += cap.volume * point;
            totals.gradient.add_force(outward * -cap.base, center);
            let own = self.data().leaves[ball.index].normal().as_dvec3();
            totals.outward.add_force((own * share - outward) * cap.volume, point);
            if cap.height > greatest {
                greatest = cap.height;
                let spheres = [self.packing_index(ball.index), 0];
                deepest = Some(DeepestPair { spheres, depth: cap.height as f32 });
            }
            totals.inner_balls_meet = totals.inner_balls_meet || self.inner_ball_meets(surface, &ball);
        });
        (totals, deepest)
    }

    /// Whether B cuts the certified ball of a sphere too. Mostly the distance of the volume ball's centre tells.
    fn inner_ball_meets(&self, surface: &mut impl SignedDistance, ball: &CutBall) -> bool {
        let center = self.data().inner_center[ball.index] * self.unit();
        let radius = self.data().inner_radius[ball.index] * self.unit();
        let (shift, distance) = (center.distance(ball.center), ball.surface.distance);
        let is_clear = distance + shift < radius || distance - shift >= radius;
        if is_clear { distance < radius } else { surface.distance_within(center, radius).distance < radius }
    }

    /// Calls `act` with every ball that B cuts, in the tree's order, at the tree's scale. Returns a lower bound of the
    /// distance of all others.
    fn for_each_cut_ball<F: SignedDistance>(
        &self,
        surface: &mut F,
        mut act: impl FnMut(&mut F, CutBall),
    ) -> f32 {
        let mut clearance = f32::INFINITY;
        let data = self.data();
        let slack = SLACK * self.bounding_ball().1;
        let mut pending = [(0, 0, Vec3::ZERO, f32::NEG_INFINITY); MOST_PENDING];
        pending[0].0 = data.height();
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let (level, node, parent, parent_distance) = pending[count];
            let (center, radius) = data.levels[level].get(node);
            let (center, radius) = (center * self.unit(), radius * self.unit() + self.skin());
            // Distances change by no more than the way: most nodes need not be asked about.
            let expected = parent_distance - center.distance(parent) - radius;
            if expected >= 0.0 {
                clearance = clearance.min(expected);
                continue;
            }
            let seen = surface.distance_within(center, radius + slack);
            if seen.distance >= radius {
                clearance = clearance.min(seen.distance - radius);
                continue;
            }
            if level > 0 {
                let end = data.levels[level - 1].len().min((node + 1) * WIDTH);
                for child in (node * WIDTH..end).rev() {
                    pending[count] = (level - 1, child, center, seen.distance);
                    count += 1;
                }
                continue;
            }
            let cap = Cap::new(f64::from(radius), f64::from(seen.distance));
            if cap.volume > 0.0 {
                act(surface, CutBall { index: node, center, surface: seen, cap });
            } else {
                clearance = 0.0;
            }
        }
        clearance
    }
}

/// The sample of a ball at `center`.
fn cap_sample(center: Vec3, outward: Vec3, cap: &Cap) -> ContactSample {
    ContactSample {
        point: center - outward * cap.centroid as f32,
        normal: -outward,
        volume: cap.volume as f32,
        vector_area: outward * -cap.base as f32,
        outward: -outward,
    }
}
