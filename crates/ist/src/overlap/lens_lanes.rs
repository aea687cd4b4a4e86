//! The lens of eight pairs at once: [`crate::lens`] in f32.

use super::pairs::{BallLanes, PairBuffer};
use crate::tree::WIDTH;
use core::f32::consts::PI;
use fearless_simd::{Simd, f32x8, prelude::*};

/// Three coordinates of eight points.
#[derive(Clone, Copy)]
pub(crate) struct Lanes3<S: Simd> {
    pub(crate) x: f32x8<S>,
    pub(crate) y: f32x8<S>,
    pub(crate) z: f32x8<S>,
}

impl<S: Simd> Lanes3<S> {
    #[inline(always)]
    pub(crate) fn plus(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }

    #[inline(always)]
    pub(crate) fn add_scaled(self, factor: f32x8<S>, other: Self) -> Self {
        Self { x: self.x + factor * other.x, y: self.y + factor * other.y, z: self.z + factor * other.z }
    }

    #[inline(always)]
    pub(crate) fn scale(self, factor: f32x8<S>) -> Self {
        Self { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }

    #[inline(always)]
    pub(crate) fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }
}

/// Eight lenses, in A's frame.
#[derive(Clone, Copy)]
pub(crate) struct LensLanes<S: Simd> {
    pub(crate) volume: f32x8<S>,
    /// Area of the disc inside the intersection circle; zero where one ball contains the other.
    pub(crate) area: f32x8<S>,
    /// Unit vector from A's centre to B's; zero for concentric balls.
    pub(crate) axis: Lanes3<S>,
    /// First moment of the lens about A's origin, that is volume times centroid.
    pub(crate) moment: Lanes3<S>,
    pub(crate) center_a: Lanes3<S>,
}

impl<S: Simd> LensLanes<S> {
    /// The lenses of the block of pairs that begins at `first`.
    #[inline(always)]
    pub(crate) fn new(simd: S, pairs: &PairBuffer, first: usize) -> Self {
        let load = |array: &[f32]| f32x8::from_slice(simd, &array[first..first + WIDTH]);
        let center = |side: &BallLanes| Lanes3 { x: load(&side.x), y: load(&side.y), z: load(&side.z) };
        let (ca, cb) = (center(&pairs.a), center(&pairs.b));
        let (a, b) = (load(&pairs.a.radius), load(&pairs.b.radius));
        let delta = Lanes3 { x: cb.x - ca.x, y: cb.y - ca.y, z: cb.z - ca.z };
        let d = (delta.x * delta.x + delta.y * delta.y + delta.z * delta.z).sqrt();
        // Concentric balls: any small distance gives the same clamped heights, if it is taken everywhere. A fixed one
        // would overflow for large balls.
        let d = d.max((a + b) * 1e-7).max(f32::MIN_POSITIVE);
        let inverse = f32x8::splat(simd, 1.0) / d;
        let axis = delta.scale(inverse);
        let h = a + b - d;
        let zero = f32x8::splat(simd, 0.0);
        let half = h * inverse * 0.5;
        let h_a = (half * (b - a + d)).max(zero).min(a * 2.0);
        let h_b = (half * (a - b + d)).max(zero).min(b * 2.0);
        let (chord_a, chord_b) = (h_a * (a * 2.0 - h_a), h_b * (b * 2.0 - h_b));
        let cap_b = h_b * h_b * (b * 3.0 - h_b) * (PI / 3.0);
        let volume = h_a * h_a * (a * 3.0 - h_a) * (PI / 3.0) + cap_b;
        let along = (chord_a * chord_a - chord_b * chord_b) * (PI / 4.0) + d * cap_b;
        Self {
            volume,
            area: chord_a * PI,
            axis,
            moment: ca.scale(volume).add_scaled(along, axis),
            center_a: ca,
        }
    }
}
