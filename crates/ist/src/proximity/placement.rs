//! Where the second tree stands in the frame of the first, and how far rounding moves it.

use super::BallKind;
use crate::InnerSphereTree;
use crate::rotation;
use fearless_simd::{Simd, f32x8};
use glam::{DMat3, DVec3, Mat3, Vec3};
use glamx::Pose3;

/// Error of a gap between two balls in f32, relative to the sum of the largest coordinates that enter it.
///
/// Matrix and products move a coordinate by up to 7 roundings of 2⁻²⁴, in three coordinates of a centre at most √3 times
/// as far out as its largest coordinate: 21. Translation, difference, length and radii add 6: 27 · 2⁻²⁴ = 1.6e-6.
const ROUNDING: f32 = 2e-6;

/// Coordinates beyond this (in the unscaled frame of A) would overflow when they are squared.
const LARGEST: f32 = 1e18;

/// Similarity that takes B's unscaled frame to A's unscaled frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    /// Rotation times relative scale.
    linear: Mat3,
    translation: Vec3,
    /// Scale of B relative to A.
    scale: f32,
    /// Bound of the error of a gap computed in f32, in A's unscaled frame.
    pub(super) rounding: f32,
    /// Rotation and translation (m) of B's frame in A's frame.
    exact: (DMat3, DVec3),
}

impl Placement {
    /// From the pose of `b`'s frame in `a`'s frame; `None` where it is not finite, has no rotation or is farther
    /// away than f32 can tell.
    pub(super) fn new(a: &InnerSphereTree, b: &InnerSphereTree, pose: &Pose3) -> Option<Self> {
        Self::shifted(a, b, pose, DVec3::ZERO)
    }

    /// As [`Self::new`] after a further translation of B by `shift` (m, A's frame).
    pub(super) fn shifted(
        a: &InnerSphereTree,
        b: &InnerSphereTree,
        pose: &Pose3,
        shift: DVec3,
    ) -> Option<Self> {
        let exact = rotation::unit_f64(pose.rotation).filter(|_| pose.is_finite())?;
        // The same f32 operations as in the overlap, so that both see the same pairs meet.
        let rotation = Mat3::from_quat(rotation::unit(pose.rotation)?);
        let scale = b.unit() / a.unit();
        let exact_translation = pose.translation.as_dvec3() + shift;
        let translation = exact_translation.as_vec3() / a.unit();
        let reach = |tree: &InnerSphereTree| {
            let (center, radius) = tree.bounding_ball();
            (center.abs().max_element() + radius) / a.unit()
        };
        let largest = reach(a) + reach(b) + translation.abs().max_element();
        let usable = largest < LARGEST && scale > 0.0 && scale.is_finite();
        usable.then(|| Self {
            linear: rotation * scale,
            translation,
            scale,
            rounding: ROUNDING * largest,
            exact: (DMat3::from_quat(exact), exact_translation),
        })
    }

    /// A ball of B's unscaled frame in A's.
    #[inline(always)]
    pub(super) fn transform_ball(&self, (center, radius): (Vec3, f32)) -> (Vec3, f32) {
        (self.linear * center + self.translation, radius * self.scale)
    }

    /// Eight of them.
    #[inline(always)]
    pub(super) fn transform_lanes<S: Simd>(&self, [x, y, z, radius]: [f32x8<S>; 4]) -> [f32x8<S>; 4] {
        let (m, t) = (&self.linear, self.translation);
        [
            x * m.x_axis.x + y * m.y_axis.x + z * m.z_axis.x + t.x,
            x * m.x_axis.y + y * m.y_axis.y + z * m.z_axis.y + t.y,
            x * m.x_axis.z + y * m.y_axis.z + z * m.z_axis.z + t.z,
            radius * self.scale,
        ]
    }

    /// Ball `i` of B's tree in A's frame (m), without the rounding of the search.
    pub(super) fn exact_ball(&self, b: &InnerSphereTree, kind: BallKind, i: usize) -> (DVec3, f64) {
        let (center, radius) = exact_ball(b, kind, i);
        (self.exact.0 * center + self.exact.1, radius)
    }
}

/// Centre and radius (m) of ball `i` of `tree` in its frame.
pub(super) fn exact_ball(tree: &InnerSphereTree, kind: BallKind, i: usize) -> (DVec3, f64) {
    let data = tree.data();
    let ((center, radius), skin) = match kind {
        BallKind::Inner => ((data.inner_center[i], data.inner_radius[i]), 0.0),
        BallKind::Volume => (data.levels[0].get(i), tree.skin()),
    };
    let scale = f64::from(tree.unit());
    (center.as_dvec3() * scale, f64::from(radius) * scale + f64::from(skin))
}
