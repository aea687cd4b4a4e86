//! Where the second tree stands in the frame of the first.

use super::workspace::Block;
use crate::tree::{Balls, InnerSphereTree, WIDTH};
use fearless_simd::{Simd, f32x8, prelude::*};
use glam::{Mat3, Vec3};
use glamx::Pose3;

/// Similarity that takes B's unscaled frame to A's unscaled frame.
///
/// Trees keep the numbers of their packing whatever their scale; so do queries, and only the result is scaled.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RelativePose {
    /// Rotation of B in A's frame.
    pub(crate) rotation: Mat3,
    /// Rotation times relative scale.
    linear: Mat3,
    pub(crate) translation: Vec3,
    /// Scale of B relative to A.
    pub(crate) scale: f32,
    /// Skins of A and B, in A's unscaled frame.
    pub(crate) skin_a: f32,
    pub(crate) skin_b: f32,
}

impl RelativePose {
    /// From the pose of `b`'s frame in `a`'s frame; `None` where it is not finite or has no rotation.
    pub(crate) fn new(a: &InnerSphereTree, b: &InnerSphereTree, pose: &Pose3) -> Option<Self> {
        let length = pose.rotation.length();
        if !(pose.is_finite() && length > 0.5 && length < 2.0) {
            return None;
        }
        let rotation = Mat3::from_quat(pose.rotation.normalize());
        let scale = b.scale() / a.scale();
        let translation = pose.translation / a.scale();
        let (skin_a, skin_b) = (a.skin() / a.scale(), b.skin() / a.scale());
        Some(Self { rotation, linear: rotation * scale, translation, scale, skin_a, skin_b })
    }

    /// A point of B's unscaled frame in A's.
    pub(super) fn transform_point(&self, p: Vec3) -> Vec3 {
        self.linear * p + self.translation
    }

    /// The block of `level` that begins at ball `first`, in A's frame.
    #[inline(always)]
    pub(crate) fn transform_block<S: Simd>(&self, simd: S, level: &Balls, first: usize) -> Block {
        let load = |array: &[f32]| f32x8::from_slice(simd, &array[first..first + WIDTH]);
        let (x, y, z) = (load(&level.x), load(&level.y), load(&level.z));
        let row = |i: usize| {
            let row = self.linear.row(i);
            x * row.x + y * row.y + z * row.z + self.translation[i]
        };
        let end = level.len().min(first + WIDTH);
        Block {
            x: row(0).to_array(),
            y: row(1).to_array(),
            z: row(2).to_array(),
            radius: (load(&level.radius) * self.scale + self.skin_b).to_array(),
            next: first,
            end,
        }
    }
}
