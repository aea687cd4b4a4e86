//! The lens of eight pairs at once: [`crate::lens`] in f32.

use super::leaf_lanes::LeafLanes;
use super::pairs::PairBuffer;
use super::relative_pose::RelativePose;
use crate::tree::Leaf;
use core::f32::consts::PI;
use fearless_simd::{Simd, f32x8, mask32x8, prelude::*};

/// Three coordinates of eight points.
#[derive(Clone, Copy)]
pub(super) struct Lanes3<S: Simd> {
    pub(super) x: f32x8<S>,
    pub(super) y: f32x8<S>,
    pub(super) z: f32x8<S>,
}

impl<S: Simd> Lanes3<S> {
    #[inline(always)]
    pub(super) fn plus(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }

    #[inline(always)]
    pub(super) fn minus(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }

    #[inline(always)]
    pub(super) fn dot(self, other: Self) -> f32x8<S> {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline(always)]
    pub(super) fn add_scaled(self, factor: f32x8<S>, other: Self) -> Self {
        Self { x: self.x + factor * other.x, y: self.y + factor * other.y, z: self.z + factor * other.z }
    }

    #[inline(always)]
    pub(super) fn scale(self, factor: f32x8<S>) -> Self {
        Self { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }

    #[inline(always)]
    pub(super) fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }
}

/// The balls of eight pairs, in A's frame.
#[derive(Clone, Copy)]
pub(super) struct PairLanes<S: Simd> {
    pub(super) center_a: Lanes3<S>,
    pub(super) center_b: Lanes3<S>,
    pub(super) radius_a: f32x8<S>,
    pub(super) radius_b: f32x8<S>,
    /// Lanes that hold a pair, overlapping or not.
    pub(super) live: mask32x8<S>,
}

impl<S: Simd> PairLanes<S> {
    /// The block of `pairs` that begins at `first`, and the outward normals of A's spheres and of B's, each in the frame of its
    /// solid.
    #[inline(always)]
    pub(super) fn gather(
        simd: S,
        pairs: &PairBuffer,
        first: usize,
        [a, b]: [&[Leaf]; 2],
        pose: &RelativePose,
    ) -> (Self, [Lanes3<S>; 2]) {
        let of_a = LeafLanes::gather(simd, a, pairs.a_at(first));
        let of_b = LeafLanes::gather(simd, b, pairs.b_at(first));
        let (center_b, radius_b) = pose.place_lanes(of_b.center, of_b.radius);
        let radius_a = of_a.radius + pose.skin_a;
        let live = pairs.live(simd, first);
        (Self { center_a: of_a.center, center_b, radius_a, radius_b, live }, [of_a.normal, of_b.normal])
    }
}

/// Eight lenses, in A's frame; all zero in lanes without overlapping balls.
#[derive(Clone, Copy)]
pub(super) struct LensLanes<S: Simd> {
    /// Lanes whose balls overlap, by the test of [`super::lanes`] bit for bit.
    pub(super) overlapping: mask32x8<S>,
    pub(super) volume: f32x8<S>,
    /// Area of the disc inside the intersection circle; zero where one ball contains the other.
    pub(super) area: f32x8<S>,
    /// Unit vector from A's centre to B's; zero for concentric balls.
    pub(super) axis: Lanes3<S>,
    /// First moment of the lens about A's origin, that is volume times centroid.
    pub(super) moment: Lanes3<S>,
    /// Depth of the overlap along the axis, at most the diameter of the smaller ball.
    pub(super) depth: f32x8<S>,
    /// V'/d, with V' = −area the derivative of the volume by the distance d; zero for concentric balls.
    pub(super) transverse: f32x8<S>,
    /// V'' − V'/d; zero for concentric balls.
    pub(super) longitudinal: f32x8<S>,
}

/// Distance of two centres, relative to the sum of the radii, below which balls count as concentric.
const CONCENTRIC: f32 = 1e-6;

/// The lines between the centres of eight pairs.
#[derive(Clone, Copy)]
pub(super) struct CenterLines<S: Simd> {
    overlapping: mask32x8<S>,
    /// Unit vectors from A's centres to B's; zero for concentric balls.
    axis: Lanes3<S>,
    /// Distance of the centres, at least that of concentric balls, and its inverse.
    distance: f32x8<S>,
    inverse: f32x8<S>,
}

impl<S: Simd> CenterLines<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, pairs: &PairLanes<S>) -> Self {
        let PairLanes { center_a, center_b, radius_a, radius_b, live } = *pairs;
        let delta = center_b.minus(center_a);
        let (sum, squared) = (radius_a + radius_b, delta.dot(delta));
        let overlapping = squared.simd_lt(sum * sum) & live;
        // Concentric balls: any small positive distance gives the same clamped heights.
        let distance = squared.sqrt().max(concentric(sum));
        let inverse = f32x8::splat(simd, 1.0) / distance;
        Self { overlapping, axis: delta.scale(inverse), distance, inverse }
    }
}

/// Distance of two centres below which balls with this sum of radii count as concentric.
#[inline(always)]
fn concentric<S: Simd>(sum: f32x8<S>) -> f32x8<S> {
    sum * CONCENTRIC + f32::MIN_POSITIVE
}

impl<S: Simd> LensLanes<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, pairs: &PairLanes<S>) -> Self {
        Self::along(simd, pairs, &CenterLines::new(simd, pairs))
    }

    /// The lenses of `pairs` whose centres `lines` connect.
    #[inline(always)]
    pub(super) fn along(simd: S, pairs: &PairLanes<S>, lines: &CenterLines<S>) -> Self {
        let PairLanes { center_a, radius_a: a, radius_b: b, .. } = *pairs;
        let CenterLines { overlapping, axis, distance: d, inverse } = *lines;
        let (sum, zero) = (a + b, f32x8::splat(simd, 0.0));
        let h = overlapping.select(sum - d, zero);
        let half = h * inverse * 0.5;
        let h_a = (half * (b - a + d)).max(zero).min(a * 2.0);
        let h_b = (half * (a - b + d)).max(zero).min(b * 2.0);
        let (chord_a, chord_b) = (h_a * (a * 2.0 - h_a), h_b * (b * 2.0 - h_b));
        let cap_b = h_b * h_b * (b * 3.0 - h_b) * (PI / 3.0);
        let volume = h_a * h_a * (a * 3.0 - h_a) * (PI / 3.0) + cap_b;
        let along = (chord_a * chord_a - chord_b * chord_b) * (PI / 4.0) + d * cap_b;
        let area = chord_a * PI;
        // The disc is at a − h_a from A's centre and at b − h_b from B's; contained balls have none.
        let disc = chord_a.simd_gt(zero) & d.simd_gt(concentric(sum));
        let transverse = disc.select(zero - area * inverse, zero);
        let second = disc.select((a - h_a) * (b - h_b) * inverse * (2.0 * PI), zero);
        Self {
            overlapping,
            volume,
            area,
            axis,
            moment: center_a.scale(volume).add_scaled(along, axis),
            depth: h.min(a * 2.0).min(b * 2.0),
            transverse,
            longitudinal: second - transverse,
        }
    }
}
