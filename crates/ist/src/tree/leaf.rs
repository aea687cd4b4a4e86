//! Spheres as pairs of them are read.

use super::WIDTH;
use glam::Vec3;

/// One sphere in half a cache line: centre and radius of its volume ball, outward normal, and a number that is not used.
///
/// The spheres of eight pairs are anywhere in the tree. From these, eight loads and a transposition make vectors of their
/// coordinates: a query of two rabbits of 1,000 spheres takes 4 to 7 % less time than from arrays of single numbers, with
/// stiffness 7 to 17 %.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Leaf(pub(crate) [f32; WIDTH]);

impl Leaf {
    pub(super) fn new((center, radius): (Vec3, f32), normal: Vec3) -> Self {
        Self([center.x, center.y, center.z, radius, normal.x, normal.y, normal.z, 0.0])
    }

    /// Outward normal.
    pub(crate) fn normal(&self) -> Vec3 {
        Vec3::new(self.0[4], self.0[5], self.0[6])
    }
}
