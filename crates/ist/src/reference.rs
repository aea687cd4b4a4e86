//! The plain definitions in double precision, O(n·m): what everything else is tested against.

use crate::InnerSphereTree;
use crate::lens::Lens;
use glam::{DQuat, DVec3};
use glamx::Pose3;

/// Overlap by brute force over all pairs of spheres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReferenceOverlap {
    /// Penetration volume (m³).
    pub volume: f64,
    /// Centroid of the penetration volume (m); zero where nothing overlaps.
    pub centroid: DVec3,
    /// Sum of the areas that the intersection circles bound (m²).
    pub area: f64,
    /// Derivative of the volume by a translation of B (m²).
    pub gradient: DVec3,
    /// Derivative of the volume by a rotation of B about [`Self::centroid`] (m³/rad).
    pub rotation_gradient: DVec3,
    /// Overlapping pairs of spheres.
    pub pairs: u32,
}

/// Overlap of `a` and `b`, whose frame stands at `pose` in `a`'s frame, with volume balls.
#[must_use]
pub fn overlap(a: &InnerSphereTree, b: &InnerSphereTree, pose: &Pose3) -> ReferenceOverlap {
    overlap_at(a, b, pose.rotation.as_dquat().normalize(), pose.translation.as_dvec3())
}

/// As [`overlap`], with a pose in double precision, for finite differences.
#[must_use]
pub fn overlap_at(
    a: &InnerSphereTree,
    b: &InnerSphereTree,
    rotation: DQuat,
    translation: DVec3,
) -> ReferenceOverlap {
    let mut out = ReferenceOverlap::default();
    let (mut moment, mut torque) = (DVec3::ZERO, DVec3::ZERO);
    for (center_b, radius_b) in b.volume_balls() {
        let center_b = rotation * center_b.as_dvec3() + translation;
        for (center_a, radius_a) in a.volume_balls() {
            let center_a = center_a.as_dvec3();
            let delta = center_b - center_a;
            let lens = Lens::new(f64::from(radius_a), f64::from(radius_b), delta.length());
            if lens.volume <= 0.0 {
                continue;
            }
            let normal = delta.normalize_or_zero();
            out.pairs += 1;
            out.volume += lens.volume;
            moment += lens.volume * (center_a + lens.centroid * normal);
            out.area += lens.area;
            out.gradient -= lens.area * normal;
            torque -= lens.area * center_a.cross(normal);
        }
    }
    if out.volume > 0.0 {
        out.centroid = moment / out.volume;
        out.rotation_gradient = torque - out.centroid.cross(out.gradient);
    }
    out
}

mod proximity;
pub use proximity::{ReferenceDistance, distance};
