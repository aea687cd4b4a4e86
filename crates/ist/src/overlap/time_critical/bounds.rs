//! Bounds and expected values for a node of B and the nodes of A that it meets.
//!
//! Let m_a(x) and m_b(x) be the numbers of volume balls below nodes a and b that cover the point x. The sum of the
//! lens volumes of all pairs of spheres is ∫ m_a m_b dx. With V the sum of the volumes of the balls below a node, that
//! is ∫ m dx, and M a bound of m, it is at most
//!
//! `min(M_b V_a, M_a V_b, M_a M_b L)`, L the volume of the lens of the two nodes' balls,
//!
//! and over all nodes of A together at most D V_b, D a bound of the number of balls of the whole of A over one point.
//! If one node is a single ball that contains the other node's ball, it is exactly V of that.
//! Spheres spread evenly over their node's ball, of volume B, would overlap in V_a/B_a · V_b/B_b · L: that is what is
//! expected, within the bounds.

use super::super::lanes::live_lanes;
use super::super::lens_lanes::{Lanes3, LensLanes, PairLanes};
use super::super::workspace::Candidates;
use super::budget::Meter;
use super::frontier::Frontier;
use super::query::{NodeFigures, Query, leaves_below};
use super::row::{Expected, Part, Row, Wrench};
use crate::tree::WIDTH;
use core::f32::consts::PI;
use core::ops::Range;
use fearless_simd::{Simd, f32x8, mask32x8, prelude::*};
use glam::Vec3;

/// Nodes of A per row at most: the work of opening one must be bounded. Most rows have 10 to 30.
pub(super) const ROW: usize = 32;

/// Makes rows of a node of B and the nodes of A that it meets.
pub(super) struct RowMaker<'q> {
    query: &'q Query<'q>,
    frontier: &'q mut Frontier,
    pub(super) meter: &'q mut Meter,
    level_a: usize,
    level_b: usize,
}

impl<'q> RowMaker<'q> {
    /// For nodes of `level_a` and `level_b`, not both leaves.
    pub(super) fn new(
        query: &'q Query<'q>,
        frontier: &'q mut Frontier,
        meter: &'q mut Meter,
        (level_a, level_b): (usize, usize),
    ) -> Self {
        Self { query, frontier, meter, level_a, level_b }
    }

    /// Adds `node` of B, whose ball stands at `ball` (centre and radius) in A's frame, with the nodes of A in `near`, which is
    /// padded up to whole blocks. Whether there was time for it.
    #[inline(always)]
    pub(super) fn add<S: Simd>(
        &mut self,
        simd: S,
        near: &Candidates,
        (node, ball): (usize, [f32; 4]),
    ) -> bool {
        let figures = self.query.b.figures(self.level_b, node);
        for first in (0..near.len).step_by(ROW) {
            let range = first..near.len.min(first + ROW);
            let Some(part) = self.part(simd, (near, range.clone()), ball, &figures) else { return false };
            let row = Row {
                ball,
                node: node as u32,
                level_a: self.level_a as u8,
                level_b: self.level_b as u8,
                largest: near.radius[range.clone()].iter().copied().fold(0.0, f32::max),
                part,
                ..Row::default()
            };
            self.frontier.push(row, &near.index[range]);
        }
        true
    }

    /// What is known about B's node with the nodes `range` of `near`, which begin a block; `None` if there is no time.
    #[inline(always)]
    fn part<S: Simd>(
        &mut self,
        simd: S,
        (near, range): (&Candidates, Range<usize>),
        [x, y, z, radius_b]: [f32; 4],
        b: &NodeFigures,
    ) -> Option<Part> {
        let query = self.query;
        let center_b =
            Lanes3 { x: f32x8::splat(simd, x), y: f32x8::splat(simd, y), z: f32x8::splat(simd, z) };
        let volume_b = f32x8::splat(simd, b.volume);
        let fill_b = b.volume / ball_volume(radius_b).max(f32::MIN_POSITIVE);
        let multiple_b = b.depth.min(leaves_below(self.level_b));
        let zero = f32x8::splat(simd, 0.0);
        let (mut lower, mut upper, mut depth, mut volume) = (zero, zero, zero, zero);
        let nothing = Lanes3::zero(simd);
        let (mut moment, mut force, mut torque) = (nothing, nothing, nothing);
        let (mut outward, mut outward_torque) = (nothing, nothing);
        let [x, y, z] = (query.pose.rotation * b.normal).to_array();
        let normal_b =
            Lanes3 { x: f32x8::splat(simd, x), y: f32x8::splat(simd, y), z: f32x8::splat(simd, z) };
        for first in range.clone().step_by(WIDTH) {
            if self.meter.work(Meter::LENS as usize) {
                return None;
            }
            let pairs = PairLanes {
                center_a: Lanes3 {
                    x: load(simd, &near.x, first),
                    y: load(simd, &near.y, first),
                    z: load(simd, &near.z, first),
                },
                center_b,
                radius_a: load(simd, &near.radius, first),
                radius_b: f32x8::splat(simd, radius_b),
                live: live_lanes(simd, range.end, first),
            };
            let lens = LensLanes::new(simd, &pairs);
            let a = FigureLanes::new(simd, query, self.level_a, &near.index[first..first + WIDTH]);
            let radius_a = pairs.radius_a;
            let multiple_a = a.depth.min(leaves_below(self.level_a));
            let overlapping = lens.volume.simd_gt(0.0);
            let lens_bound = lens.volume * multiple_a * multiple_b;
            let bound = (a.volume * multiple_b).min(multiple_a * b.volume).min(lens_bound);
            upper += overlapping.select(bound, zero);
            depth = depth.max(a.depth);
            let ball_a = (radius_a * radius_a * radius_a * (4.0 / 3.0 * PI)).max(f32::MIN_POSITIVE);
            let density = overlapping.select(a.volume / ball_a * fill_b, zero);
            let expected = lens.volume * density;
            volume += expected;
            let expected_moment = lens.moment.scale(density);
            moment = moment.plus(expected_moment);
            let area = lens.area * density;
            force = force.add_scaled(area, lens.axis);
            torque = torque.plus(pairs.center_a.scale(area).cross(lens.axis));
            let normal = a.normal.minus(normal_b);
            outward = outward.add_scaled(expected, normal);
            outward_torque = outward_torque.plus(expected_moment.cross(normal));
            if self.level_a == 0 || self.level_b == 0 {
                let [in_a, in_b] = containment(&pairs, query.rounding);
                if self.level_a == 0 {
                    lower += (in_a & overlapping).select(volume_b, zero);
                }
                if self.level_b == 0 {
                    lower += (in_b & overlapping).select(a.volume, zero);
                }
            }
        }
        let most = depth.to_array().into_iter().fold(0.0, f32::max) * b.volume;
        let upper = sum(upper).min(most);
        let moment = sum3(moment);
        let volume = sum(volume);
        let expected = Expected {
            volume,
            moment,
            gradient: Wrench { force: sum3(force), torque: sum3(torque) },
            outward: Wrench { force: sum3(outward), torque: sum3(outward_torque) },
        };
        let lower = sum(lower).min(upper);
        let within = volume.min(b.volume).clamp(lower, upper);
        Some(Part { lower, upper, expected: expected.with_volume(within) })
    }
}

/// Lanes in which A's ball contains B's, and in which B's contains A's, whatever was rounded. B's radius may have been
/// enlarged.
#[inline(always)]
fn containment<S: Simd>(pairs: &PairLanes<S>, rounding: f32) -> [mask32x8<S>; 2] {
    let delta = pairs.center_b.minus(pairs.center_a);
    let distance = delta.dot(delta).sqrt() + 3.0 * rounding;
    let (a, b) = (pairs.radius_a, pairs.radius_b);
    [(distance + b).simd_lt(a), (distance + a).simd_lt(b)]
}

/// [`NodeFigures`] of eight nodes of A.
struct FigureLanes<S: Simd> {
    volume: f32x8<S>,
    depth: f32x8<S>,
    normal: Lanes3<S>,
}

impl<S: Simd> FigureLanes<S> {
    #[inline(always)]
    fn new(simd: S, query: &Query, level: usize, nodes: &[u32]) -> Self {
        let mut figures = [NodeFigures::default(); WIDTH];
        for (figures, node) in figures.iter_mut().zip(nodes) {
            *figures = query.a.figures(level, *node as usize);
        }
        let lane = |i: usize| &figures[i];
        Self {
            volume: f32x8::from_fn(simd, |i| lane(i).volume),
            depth: f32x8::from_fn(simd, |i| lane(i).depth),
            normal: Lanes3 {
                x: f32x8::from_fn(simd, |i| lane(i).normal.x),
                y: f32x8::from_fn(simd, |i| lane(i).normal.y),
                z: f32x8::from_fn(simd, |i| lane(i).normal.z),
            },
        }
    }
}

/// Eight numbers of `array` from `first` on.
#[inline(always)]
fn load<S: Simd>(simd: S, array: &[f32], first: usize) -> f32x8<S> {
    f32x8::from_slice(simd, &array[first..first + WIDTH])
}

fn ball_volume(radius: f32) -> f32 {
    4.0 / 3.0 * PI * radius * radius * radius
}

/// In the order of the lanes on every processor.
#[inline(always)]
fn sum<S: Simd>(lanes: f32x8<S>) -> f32 {
    lanes.to_array().into_iter().sum()
}

#[inline(always)]
fn sum3<S: Simd>(lanes: Lanes3<S>) -> Vec3 {
    Vec3::new(sum(lanes.x), sum(lanes.y), sum(lanes.z))
}
