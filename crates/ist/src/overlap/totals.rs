//! The sums that an overlap result is made of.

use super::lens_lanes::{Lanes3, LensLanes};
use super::pairs::PairBuffer;
use super::relative_pose::RelativePose;
use super::traversal::PairSink;
use crate::tree::{TreeData, WIDTH};
use fearless_simd::{Simd, f32x8, prelude::*};
use glam::{DVec3, Mat3, Vec3};

/// Sum of forces and of their torques about A's origin, in A's frame.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct WrenchSum {
    pub(crate) force: DVec3,
    pub(crate) torque: DVec3,
}

/// Sums over all overlapping pairs, in A's unscaled frame.
///
/// A batch is summed in f32 lanes and the batches in f64; the order is fixed, so equal input gives equal bits.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Totals {
    pub(crate) pairs: u32,
    pub(crate) volume: f64,
    /// Volume times centroid.
    pub(crate) moment: DVec3,
    /// Σ A n with the centre-line normals n from A to B: minus the gradient of the volume.
    pub(crate) gradient: WrenchSum,
    /// Σ V n with the stored outward normals of A's spheres.
    pub(crate) normals_a: WrenchSum,
    /// Σ V n with the stored outward normals of B's spheres.
    pub(crate) normals_b: WrenchSum,
    /// Whether two certified inner balls meet.
    pub(super) inner_balls_meet: bool,
}

/// Adds every pair to [`Totals`].
pub(crate) struct TotalsSink<'a> {
    a: &'a TreeData,
    b: &'a TreeData,
    pose: &'a RelativePose,
    pub(crate) totals: Totals,
}

impl<'a> TotalsSink<'a> {
    pub(crate) fn new((a, b): (&'a TreeData, &'a TreeData), pose: &'a RelativePose) -> Self {
        Self { a, b, pose, totals: Totals::default() }
    }

    /// Whether the inner balls of one of the pairs meet. Those of no other pair do: volume balls contain them.
    fn inner_balls_meet(&self, pairs: &PairBuffer) -> bool {
        let ball = |tree: &TreeData, index: u32| {
            let index = index as usize;
            (tree.inner_center[index], tree.inner_radius[index])
        };
        (0..pairs.len()).any(|i| {
            let (center_a, radius_a) = ball(self.a, pairs.a.index[i]);
            let (center_b, radius_b) = ball(self.b, pairs.b.index[i]);
            let reach = radius_a + radius_b * self.pose.scale;
            center_a.distance_squared(self.pose.transform_point(center_b)) < reach * reach
        })
    }
}

impl PairSink for TotalsSink<'_> {
    #[inline(always)]
    fn take<S: Simd>(&mut self, simd: S, pairs: &PairBuffer) {
        let (mut volume, mut moment) = (f32x8::splat(simd, 0.0), Lanes3::zero(simd));
        let mut gradient = WrenchLanes::zero(simd);
        let (mut normals_a, mut normals_b) = (gradient, gradient);
        for first in (0..pairs.len()).step_by(WIDTH) {
            let lens = LensLanes::new(simd, pairs, first);
            volume += lens.volume;
            moment = moment.plus(lens.moment);
            gradient.add(lens.axis, lens.area, lens.center_a.scale(lens.area));
            let of_a = gather(simd, &self.a.normals, &pairs.a.index[first..first + WIDTH]);
            normals_a.add(of_a, lens.volume, lens.moment);
            let of_b = gather(simd, &self.b.normals, &pairs.b.index[first..first + WIDTH]);
            normals_b.add(of_b.rotate(&self.pose.rotation), lens.volume, lens.moment);
        }
        let meet = self.totals.inner_balls_meet || self.inner_balls_meet(pairs);
        let totals = &mut self.totals;
        totals.pairs += pairs.len() as u32;
        totals.volume += sum(volume);
        totals.moment += moment.sum();
        gradient.add_to(&mut totals.gradient);
        normals_a.add_to(&mut totals.normals_a);
        normals_b.add_to(&mut totals.normals_b);
        totals.inner_balls_meet = meet;
    }
}

/// Eight partial sums of a [`WrenchSum`].
#[derive(Clone, Copy)]
struct WrenchLanes<S: Simd> {
    force: Lanes3<S>,
    torque: Lanes3<S>,
}

impl<S: Simd> WrenchLanes<S> {
    #[inline(always)]
    fn zero(simd: S) -> Self {
        Self { force: Lanes3::zero(simd), torque: Lanes3::zero(simd) }
    }

    /// Adds the force `weight` · `direction`; `weighted_point` is `weight` times its point of attack.
    #[inline(always)]
    fn add(&mut self, direction: Lanes3<S>, weight: f32x8<S>, weighted_point: Lanes3<S>) {
        self.force = self.force.add_scaled(weight, direction);
        self.torque = self.torque.plus(weighted_point.cross(direction));
    }

    #[inline(always)]
    fn add_to(self, sum: &mut WrenchSum) {
        sum.force += self.force.sum();
        sum.torque += self.torque.sum();
    }
}

/// Eight vectors of `normals`.
#[inline(always)]
fn gather<S: Simd>(simd: S, normals: &[Vec3], index: &[u32]) -> Lanes3<S> {
    let lanes = |axis: usize| f32x8::from_fn(simd, |lane| normals[index[lane] as usize][axis]);
    Lanes3 { x: lanes(0), y: lanes(1), z: lanes(2) }
}

impl<S: Simd> Lanes3<S> {
    #[inline(always)]
    fn zero(simd: S) -> Self {
        let zero = f32x8::splat(simd, 0.0);
        Self { x: zero, y: zero, z: zero }
    }

    #[inline(always)]
    fn rotate(self, rotation: &Mat3) -> Self {
        let row = |i: usize| {
            let row = rotation.row(i);
            self.x * row.x + self.y * row.y + self.z * row.z
        };
        Self { x: row(0), y: row(1), z: row(2) }
    }

    #[inline(always)]
    fn sum(self) -> DVec3 {
        DVec3::new(sum(self.x), sum(self.y), sum(self.z))
    }
}

/// The sum of eight lanes, in the order of the lanes on every processor.
#[inline(always)]
fn sum<S: Simd>(lanes: f32x8<S>) -> f64 {
    lanes.to_array().into_iter().map(f64::from).sum()
}
