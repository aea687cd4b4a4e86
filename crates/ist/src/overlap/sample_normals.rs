//! The normals of eight contact samples at once.

use super::leaf_lanes::LeafLanes;
use super::lens_lanes::Lanes3;
use super::samples::{Lens, Lenses, SIGNIFICANT, Sum};
use crate::tree::{Leaf, WIDTH};
use fearless_simd::{Simd, f32x8, mask32x8, prelude::*};
use glam::{Mat3, Vec3};

/// Unit vectors of eight samples, by coordinate.
#[derive(Clone, Copy, Debug)]
pub(super) struct SampleNormals {
    normal: [[f32; WIDTH]; 3],
    outward: [[f32; WIDTH]; 3],
}

impl SampleNormals {
    /// Those of up to eight of `all` lenses between `leaves` of A and of B, which has `rotation` in A's frame. Behind them the last
    /// one is repeated.
    #[inline(always)]
    pub(super) fn new<S: Simd>(
        simd: S,
        lenses: &[Lens],
        all: &Lenses,
        leaves: [&[Leaf]; 2],
        rotation: &Mat3,
    ) -> Self {
        let mut spheres = [[0; WIDTH]; 2];
        let (mut gradient, mut axis, mut area) = ([[0.0; WIDTH]; 3], [[0.0; WIDTH]; 3], [0.0; WIDTH]);
        for lane in 0..WIDTH {
            let lens = &lenses[lane.min(lenses.len() - 1)];
            let Sum { gradient: seen, area: whole } = all.around(lens);
            (spheres[0][lane], spheres[1][lane]) = lens.spheres.into();
            (gradient[0][lane], gradient[1][lane], gradient[2][lane]) = seen.into();
            (axis[0][lane], axis[1][lane], axis[2][lane]) = lens.axis.into();
            area[lane] = whole;
        }
        let gradient = Lanes3::load(simd, gradient);
        let area = f32x8::load_array(simd, area).max(f32::MIN_POSITIVE);
        let weight = smooth_step(gradient.length() / (area * SIGNIFICANT));
        let of_a = LeafLanes::gather(simd, leaves[0], &spheres[0]).normal;
        let of_b = LeafLanes::gather(simd, leaves[1], &spheres[1]).normal.rotate(rotation);
        let zero = Lanes3::zero(simd);
        let outward = zero.replaced(of_a.minus(of_b).unit());
        let steepest = zero.replaced(direction(gradient));
        let blend = steepest.scale(weight).add_scaled(f32x8::splat(simd, 1.0) - weight, outward);
        let up = Lanes3 { y: f32x8::splat(simd, 1.0), ..zero };
        let normal = up.replaced(direction(Lanes3::load(simd, axis))).replaced(direction(blend));
        Self { normal: normal.to_arrays(), outward: outward.to_arrays() }
    }

    /// Unit vector along which B is pushed out of A.
    pub(super) fn normal(&self, lane: usize) -> Vec3 {
        Vec3::from(self.normal.map(|lanes| lanes[lane]))
    }

    /// Unit vector out of A by the stored normals, or zero.
    pub(super) fn outward(&self, lane: usize) -> Vec3 {
        Vec3::from(self.outward.map(|lanes| lanes[lane]))
    }
}

/// [`samples::direction`](super::samples::direction), and where there is one.
#[inline(always)]
fn direction<S: Simd>(v: Lanes3<S>) -> (Lanes3<S>, mask32x8<S>) {
    let longest = v.x.abs().max(v.y.abs().max(v.z.abs()));
    Lanes3 { x: v.x / longest, y: v.y / longest, z: v.z / longest }.unit()
}

#[inline(always)]
fn smooth_step<S: Simd>(x: f32x8<S>) -> f32x8<S> {
    let x = x.max(0.0).min(1.0);
    x * x * (3.0 - x * 2.0)
}

impl<S: Simd> Lanes3<S> {
    #[inline(always)]
    fn load(simd: S, [x, y, z]: [[f32; WIDTH]; 3]) -> Self {
        Self { x: f32x8::load_array(simd, x), y: f32x8::load_array(simd, y), z: f32x8::load_array(simd, z) }
    }

    #[inline(always)]
    fn to_arrays(self) -> [[f32; WIDTH]; 3] {
        [self.x.to_array(), self.y.to_array(), self.z.to_array()]
    }

    #[inline(always)]
    fn length(self) -> f32x8<S> {
        self.dot(self).sqrt()
    }

    /// Unit vectors along these, and where there are any.
    #[inline(always)]
    fn unit(self) -> (Self, mask32x8<S>) {
        let inverse = 1.0 / self.length();
        (self.scale(inverse), inverse.simd_gt(0.0) & inverse.simd_lt(f32::INFINITY))
    }

    /// The other vectors where the mask is set, else these.
    #[inline(always)]
    fn replaced(self, (other, mask): (Self, mask32x8<S>)) -> Self {
        Self {
            x: mask.select(other.x, self.x),
            y: mask.select(other.y, self.y),
            z: mask.select(other.z, self.z),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::OverlapWorkspace;
    use crate::overlap::relative_pose::RelativePose;
    use crate::overlap::samples;
    use crate::overlap::tests::{random_pose, tree};
    use crate::tree::TreeData;
    use crate::tree::tests::random_packing;
    use alloc::vec::Vec;
    use glamx::Pose3;
    use proptest::prelude::*;

    /// Normal and stored normals of one sample.
    fn one(lens: &Lens, all: &Lenses, [a, b]: [&TreeData; 2], rotation: &Mat3) -> [Vec3; 2] {
        let Sum { gradient, area } = all.around(lens);
        let share = gradient.length() / (area.max(f32::MIN_POSITIVE) * SIGNIFICANT);
        let share = share.clamp(0.0, 1.0);
        let weight = share * share * (3.0 - 2.0 * share);
        let [in_a, in_b] = lens.spheres.map(|sphere| sphere as usize);
        let outward = (a.leaves[in_a].normal() - *rotation * b.leaves[in_b].normal()).normalize_or_zero();
        let blend = weight * samples::direction(gradient).unwrap_or(Vec3::ZERO) + (1.0 - weight) * outward;
        [samples::direction(blend).or(samples::direction(lens.axis)).unwrap_or(Vec3::Y), outward]
    }

    proptest! {
        /// Bit for bit, also of solids that coincide, where axes and differences of normals vanish.
        #[test]
        fn eight_at_once_are_as_one_by_one(
            a in random_packing(60), b in random_packing(60), pose in random_pose(0.7), coincide in prop::bool::ANY,
        ) {
            let (a, b) = (tree(&a), tree(if coincide { &a } else { &b }));
            let pose = if coincide { Pose3::IDENTITY } else { pose };
            let (mut workspace, mut samples) = (OverlapWorkspace::default(), Vec::new());
            a.contact_samples(&b, &pose, &mut workspace, &mut samples);
            let (all, relative) = (&workspace.lenses, RelativePose::new(&a, &b, &pose).unwrap());
            prop_assert_eq!(samples.len(), all.lenses.len());
            for (lens, sample) in all.lenses.iter().zip(&samples) {
                let expected = one(lens, all, [a.data(), b.data()], &relative.rotation);
                prop_assert_eq!([sample.normal, sample.outward], expected);
            }
        }
    }
}
