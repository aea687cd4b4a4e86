//! The sums that an overlap result is made of.

use super::lens_lanes::{CenterLines, Lanes3, LensLanes, PairLanes};
use super::pairs::{PairBuffer, PairSink};
use super::relative_pose::RelativePose;
use super::stiffness::{self, StiffnessLanes, StiffnessSum};
use crate::tree::{Leaf, TreeData, WIDTH};
use fearless_simd::{Simd, f32x8, prelude::*, u32x8};
use glam::{DVec3, Mat3, Vec3};

/// Sum of forces and of their torques about A's origin, in A's frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct WrenchSum {
    pub(super) force: DVec3,
    pub(super) torque: DVec3,
}

/// Sums over all overlapping pairs, in A's unscaled frame.
///
/// A batch is summed in f32 lanes and the batches in f64; the order is fixed, so equal input gives equal bits.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Totals {
    pub(super) pairs: u32,
    pub(super) volume: f64,
    /// Volume times centroid.
    pub(super) moment: DVec3,
    /// Σ A n with the centre-line normals n from A to B: minus the gradient of the volume.
    pub(super) gradient: WrenchSum,
    /// Σ V (n_A − n_B) with the stored outward normals of both spheres, as one body's hydroelastic field would give; zero if it
    /// was not asked for, see [`Extras`].
    pub(super) outward: WrenchSum,
    /// Zero if it was not asked for.
    pub(super) stiffness: StiffnessSum,
    /// Greatest depth of a pair, and a pair that has it, by positions in the trees' orders.
    pub(super) deepest: Deepest,
    /// Whether two certified inner balls meet.
    pub(super) inner_balls_meet: bool,
}

/// A pair and its depth.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Deepest {
    pub(super) depth: f32,
    pub(super) spheres: [u32; 2],
}

/// Sums that not every query needs.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Extras {
    /// [`Totals::outward`], a tenth of the time of a query with it.
    pub(super) outward: bool,
    /// [`Totals::stiffness`], a sixth.
    pub(super) stiffness: bool,
}

/// Adds every pair that overlaps to [`Totals`].
pub(super) struct TotalsSink<'a> {
    a: &'a TreeData,
    b: &'a TreeData,
    /// What the numbers of a pair stand for: the leaves of both trees, or the entries of both grids.
    leaves: [&'a [Leaf]; 2],
    pose: &'a RelativePose,
    extras: Extras,
    pub(super) totals: Totals,
}

impl<'a> TotalsSink<'a> {
    pub(super) fn new((a, b): (&'a TreeData, &'a TreeData), pose: &'a RelativePose, extras: Extras) -> Self {
        Self { a, b, leaves: [&a.leaves, &b.leaves], pose, extras, totals: Totals::default() }
    }

    /// For pairs of entries of their grids.
    pub(super) fn of_entries(self, leaves: [&'a [Leaf]; 2]) -> Self {
        Self { leaves, ..self }
    }

    /// Positions of the spheres of pair `i` in the orders of the trees.
    fn spheres(&self, pairs: &PairBuffer, i: usize) -> [u32; 2] {
        let [a, b] = self.leaves;
        [a[pairs.a[i] as usize].position(), b[pairs.b[i] as usize].position()]
    }

    /// Whether the inner balls of one of the pairs meet. Those of no other pair do: volume balls contain them.
    fn inner_balls_meet(&self, pairs: &PairBuffer) -> bool {
        let ball = |tree: &TreeData, index: u32| {
            let index = index as usize;
            (tree.inner_center[index], tree.inner_radius[index])
        };
        let certified = self.pose.certified_balls(self.a, self.b);
        (0..pairs.len()).any(|i| {
            let [in_a, in_b] = self.spheres(pairs, i);
            let (center_a, radius_a) = ball(self.a, in_a);
            let (center_b, radius_b) = ball(self.b, in_b);
            let reach = radius_a + radius_b * self.pose.scale;
            let seem_to_meet = center_a.distance_squared(self.pose.transform_point(center_b)) < reach * reach;
            seem_to_meet && certified.meet([in_a as usize, in_b as usize])
        })
    }
}

impl PairSink for TotalsSink<'_> {
    #[inline(always)]
    fn take<S: Simd>(&mut self, simd: S, pairs: &PairBuffer) {
        let Extras { outward, stiffness } = self.extras;
        match (outward, stiffness) {
            (false, false) => self.add::<S, false, false>(simd, pairs),
            (false, true) => self.add::<S, false, true>(simd, pairs),
            (true, false) => self.add::<S, true, false>(simd, pairs),
            (true, true) => self.add::<S, true, true>(simd, pairs),
        }
    }
}

impl TotalsSink<'_> {
    #[inline(always)]
    fn add<S: Simd, const OUTWARD: bool, const STIFFNESS: bool>(&mut self, simd: S, pairs: &PairBuffer) {
        let (mut volume, mut moment) = (f32x8::splat(simd, 0.0), Lanes3::zero(simd));
        let mut gradient = WrenchLanes::zero(simd);
        let mut outward = gradient;
        let mut stiffness = StiffnessLanes::zero(simd);
        let origin = Lanes3::splat(simd, stiffness::origin(self.a));
        let mut deepest = (f32x8::splat(simd, 0.0), u32x8::splat(simd, 0));
        let mut overlapping = 0;
        // The centre lines of a block are found while the lenses of the one before it are. Their root and division take 40 cycles,
        // and a block has as many instructions as a processor looks ahead: one after the other, queries take 6 to 16 % longer.
        let last = (pairs.len() - 1) / WIDTH * WIDTH;
        let mut ahead = PairLanes::gather(simd, pairs, 0, self.leaves, self.pose);
        let mut lines_ahead = CenterLines::new(simd, &ahead.0);
        for first in (0..pairs.len()).step_by(WIDTH) {
            let ((balls, [of_a, of_b]), lines) = (ahead, lines_ahead);
            ahead = PairLanes::gather(simd, pairs, last.min(first + WIDTH), self.leaves, self.pose);
            lines_ahead = CenterLines::new(simd, &ahead.0);
            let lens = LensLanes::along(simd, &balls, &lines);
            overlapping += lens.overlapping.to_bitmask().count_ones();
            volume += lens.volume;
            moment = moment.plus(lens.moment);
            gradient.add(lens.axis, lens.area, balls.center_a.scale(lens.area));
            if STIFFNESS {
                stiffness.add(&lens, balls.center_b.minus(origin));
            }
            let deeper = lens.depth.simd_gt(deepest.0);
            deepest.0 = deeper.select(lens.depth, deepest.0);
            deepest.1 = deeper.select(u32x8::splat(simd, first as u32), deepest.1);
            if OUTWARD {
                outward.add(of_a.minus(of_b.rotate(&self.pose.rotation)), lens.volume, lens.moment);
            }
        }
        let meet = self.totals.inner_balls_meet || self.inner_balls_meet(pairs);
        let totals = &mut self.totals;
        totals.pairs += overlapping;
        totals.volume += sum(volume);
        totals.moment += moment.sum();
        gradient.add_to(&mut totals.gradient);
        if STIFFNESS {
            stiffness.add_to(&mut totals.stiffness);
        }
        if OUTWARD {
            outward.add_to(&mut totals.outward);
        }
        totals.inner_balls_meet = meet;
        let (depth, block) = (deepest.0.to_array(), deepest.1.to_array());
        for lane in 0..WIDTH {
            if depth[lane] > self.totals.deepest.depth {
                let spheres = self.spheres(pairs, block[lane] as usize + lane);
                self.totals.deepest = Deepest { depth: depth[lane], spheres };
            }
        }
    }
}

impl Totals {
    /// Adds the sums over other pairs.
    pub(super) fn add(&mut self, other: &Self) {
        self.pairs += other.pairs;
        self.volume += other.volume;
        self.moment += other.moment;
        self.gradient.add(&other.gradient);
        self.outward.add(&other.outward);
        self.stiffness.add(&other.stiffness);
        if other.deepest.depth > self.deepest.depth {
            self.deepest = other.deepest;
        }
        self.inner_balls_meet |= other.inner_balls_meet;
    }
}

impl WrenchSum {
    /// Adds a force that attacks at `point`.
    pub(super) fn add_force(&mut self, force: DVec3, point: DVec3) {
        self.force += force;
        self.torque += point.cross(force);
    }

    fn add(&mut self, other: &Self) {
        self.force += other.force;
        self.torque += other.torque;
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

impl<S: Simd> Lanes3<S> {
    #[inline(always)]
    pub(super) fn zero(simd: S) -> Self {
        let zero = f32x8::splat(simd, 0.0);
        Self { x: zero, y: zero, z: zero }
    }

    #[inline(always)]
    fn splat(simd: S, p: Vec3) -> Self {
        let [x, y, z] = p.to_array().map(|x| f32x8::splat(simd, x));
        Self { x, y, z }
    }

    #[inline(always)]
    pub(super) fn rotate(self, rotation: &Mat3) -> Self {
        let Mat3 { x_axis, y_axis, z_axis } = *rotation;
        Self {
            x: self.x * x_axis.x + self.y * y_axis.x + self.z * z_axis.x,
            y: self.x * x_axis.y + self.y * y_axis.y + self.z * z_axis.y,
            z: self.x * x_axis.z + self.y * y_axis.z + self.z * z_axis.z,
        }
    }

    #[inline(always)]
    pub(super) fn sum(self) -> DVec3 {
        DVec3::new(sum(self.x), sum(self.y), sum(self.z))
    }
}

/// The sum of eight lanes, in the order of the lanes on every processor.
#[inline(always)]
pub(super) fn sum<S: Simd>(lanes: f32x8<S>) -> f64 {
    lanes.to_array().into_iter().map(f64::from).sum()
}
