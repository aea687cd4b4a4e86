//! Spheres as pairs of them are read.

use super::{BallBlock, WIDTH};
use fearless_simd::{Simd, f32x8, prelude::*, u32x8};
use glam::Vec3;

/// One sphere in half a cache line: centre and radius of its volume ball, its outward normal, and the bits of its position in the
/// order of its tree.
///
/// The spheres of eight pairs are anywhere in the tree. From these, loads and transpositions make vectors of their
/// coordinates: a query of two rabbits of 1,000 spheres takes 4 to 7 % less time than from arrays of single numbers, with
/// stiffness 7 to 17 %. Rows of balls apart from rows of normals, which most queries do not read, are no faster, and grids take 3
/// to 6 % longer.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Leaf(pub(crate) [f32; WIDTH]);

impl Leaf {
    /// Far from everything.
    pub(crate) const FAR: Self = Self([BallBlock::FAR.x[0], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);

    pub(super) fn new((center, radius): (Vec3, f32), normal: Vec3, position: usize) -> Self {
        let position = f32::from_bits(position as u32);
        Self([center.x, center.y, center.z, radius, normal.x, normal.y, normal.z, position])
    }

    /// Position in the order of its tree.
    pub(crate) fn position(&self) -> u32 {
        self.0[7].to_bits()
    }

    /// [`Self::position`] in every lane, read once more: two instructions less than from a register.
    #[inline(always)]
    pub(crate) fn positions<S: Simd>(&self, simd: S) -> u32x8<S> {
        f32x8::splat(simd, self.0[7]).bitcast()
    }

    /// Centre of the volume ball.
    pub(crate) fn center(&self) -> Vec3 {
        Vec3::new(self.0[0], self.0[1], self.0[2])
    }

    /// Radius of the volume ball.
    pub(crate) fn radius(&self) -> f32 {
        self.0[3]
    }

    /// Outward normal.
    pub(crate) fn normal(&self) -> Vec3 {
        Vec3::new(self.0[4], self.0[5], self.0[6])
    }
}
