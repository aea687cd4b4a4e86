//! Balls in struct-of-arrays order, padded so that SIMD code may always load whole blocks.

use super::WIDTH;
use alloc::vec::Vec;
use glam::Vec3;

/// Coordinate of the padding: so far away that no test against it succeeds, and its square is still no NaN.
const FAR: f32 = 1e30;

/// A list of balls as four arrays, each padded to a multiple of [`WIDTH`].
#[derive(Clone, Debug, Default)]
pub(crate) struct Balls {
    pub(crate) x: Vec<f32>,
    pub(crate) y: Vec<f32>,
    pub(crate) z: Vec<f32>,
    pub(crate) radius: Vec<f32>,
    len: usize,
}

impl Balls {
    /// Collects `balls` and pads them.
    pub(crate) fn new(balls: impl Iterator<Item = (Vec3, f32)>) -> Self {
        let mut out = Self::default();
        for (center, radius) in balls {
            out.push(center, radius);
            out.len += 1;
        }
        while out.x.len() % WIDTH != 0 {
            out.push(Vec3::splat(FAR), 0.0);
        }
        out
    }

    fn push(&mut self, center: Vec3, radius: f32) {
        self.x.push(center.x);
        self.y.push(center.y);
        self.z.push(center.z);
        self.radius.push(radius);
    }

    /// Number of balls without the padding.
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// Centre and radius of ball `i`.
    pub(crate) fn get(&self, i: usize) -> (Vec3, f32) {
        (Vec3::new(self.x[i], self.y[i], self.z[i]), self.radius[i])
    }
}
