//! Where the second tree stands in the frame of the first.

use super::lens_lanes::Lanes3;
use crate::InnerSphereTree;
use crate::certified::{CertifiedBalls, CertifiedPlacement};
use crate::rotation;
use crate::tree::{BallBlock, TreeData};
use fearless_simd::{Simd, f32x8, prelude::*};
use glam::{Mat3, Vec3};
use glamx::Pose3;

/// Similarity that takes B's unscaled frame to A's unscaled frame.
///
/// Trees keep the numbers of their packing, in units of its size, whatever their scale; so do queries, and only the result is
/// scaled.
#[derive(Clone, Copy, Debug)]
pub(super) struct RelativePose {
    /// Rotation of B in A's frame.
    pub(super) rotation: Mat3,
    /// Rotation times relative scale.
    linear: Mat3,
    pub(super) translation: Vec3,
    /// Scale of B relative to A.
    pub(super) scale: f32,
    /// Skins of A and B, in A's unscaled frame.
    pub(super) skin_a: f32,
    pub(super) skin_b: f32,
    /// The same in double precision.
    certified: CertifiedPlacement,
}

/// Units of B relative to A's, at least and at most: the padding of B, 1e30 of them from its origin, must not come near A, and
/// squares of its lengths must have room in f32.
const SMALLEST: f32 = 1e-12;
const LARGEST: f32 = 1e16;
/// Longest translations in A's unscaled frame; such solids are apart.
const FARTHEST: f32 = 1e17;
/// Thickest skins in A's unscaled frame: fourth powers of the radii still have room in f32.
const THICKEST: f32 = 5e8;
/// What rounding does to the distance of two balls, and to the heights of the caps of their lens, relative to the largest
/// coordinate. Three products and three sums move a centre of B by at most 4 · 2⁻²⁴, differences, root and caps add 6 · 2⁻²⁴; in
/// all 6e-7.
const ROUNDING: f32 = 1e-6;

impl RelativePose {
    /// From the pose of `b`'s frame in `a`'s frame; `None` where it is not finite or has no rotation, and where sizes differ
    /// by more than f32 bears.
    pub(super) fn new(a: &InnerSphereTree, b: &InnerSphereTree, pose: &Pose3) -> Option<Self> {
        let unit = rotation::unit(pose.rotation).filter(|_| pose.is_finite())?;
        let rotation = Mat3::from_quat(unit);
        let scale = b.unit() / a.unit();
        let translation = pose.translation / a.unit();
        let (skin_a, skin_b) = (a.skin() / a.unit(), b.skin() / a.unit());
        let resolved = scale > SMALLEST && scale < LARGEST && skin_a < THICKEST && skin_b < THICKEST;
        if !(resolved && translation.abs().max_element() < FARTHEST) {
            return None;
        }
        let certified = CertifiedPlacement::new(a, b, pose);
        Some(Self { rotation, linear: rotation * scale, translation, scale, skin_a, skin_b, certified })
    }

    /// The same with every ball of B larger by `margin`, in A's unscaled frame.
    pub(super) fn with_margin(&self, margin: f32) -> Self {
        Self { skin_b: self.skin_b + margin, ..*self }
    }

    /// How far rounding moves a centre of B at most, in A's unscaled frame.
    pub(super) fn rounding(&self, (a, b): (&TreeData, &TreeData)) -> f32 {
        let reach = |tree: &TreeData| {
            let (center, radius) = tree.root().get(0);
            center.length() + radius
        };
        let skins = self.skin_a + self.skin_b;
        ROUNDING * (reach(a) + reach(b) * self.scale + self.translation.length() + skins)
    }

    /// By how much the balls of B's nodes are enlarged, so that they meet a ball of A where a sphere below them is found to:
    /// once for the rounding of the node, once for that of the sphere. Nodes are enlarged when they are made, but by a share
    /// of their own coordinates: next to a large A that is nothing.
    pub(super) fn enlargement(&self, trees: (&TreeData, &TreeData)) -> f32 {
        2.0 * self.rounding(trees)
    }

    /// The inner balls of both.
    pub(super) fn certified_balls<'a>(&self, a: &'a TreeData, b: &'a TreeData) -> CertifiedBalls<'a> {
        CertifiedBalls::new([a, b], self.certified)
    }

    /// A point of B's unscaled frame in A's.
    pub(super) fn transform_point(&self, p: Vec3) -> Vec3 {
        self.linear * p + self.translation
    }

    /// `block` of B in A's frame.
    #[inline(always)]
    pub(super) fn place<S: Simd>(&self, simd: S, block: &BallBlock) -> BallBlock {
        let x = f32x8::load_array(simd, block.x);
        let y = f32x8::load_array(simd, block.y);
        let z = f32x8::load_array(simd, block.z);
        let radius = f32x8::load_array(simd, block.radius);
        let (center, radius) = self.place_lanes(Lanes3 { x, y, z }, radius);
        BallBlock {
            x: center.x.to_array(),
            y: center.y.to_array(),
            z: center.z.to_array(),
            radius: radius.to_array(),
        }
    }

    /// Eight balls of B in A's frame.
    #[inline(always)]
    pub(super) fn place_lanes<S: Simd>(
        &self,
        Lanes3 { x, y, z }: Lanes3<S>,
        radius: f32x8<S>,
    ) -> (Lanes3<S>, f32x8<S>) {
        let (m, t) = (&self.linear, self.translation);
        let center = Lanes3 {
            x: x * m.x_axis.x + y * m.y_axis.x + z * m.z_axis.x + t.x,
            y: x * m.x_axis.y + y * m.y_axis.y + z * m.z_axis.y + t.y,
            z: x * m.x_axis.z + y * m.y_axis.z + z * m.z_axis.z + t.z,
        };
        (center, radius * self.scale + self.skin_b)
    }
}
