//! The plain definitions in double precision, O(n·m): what everything else is tested against.

mod proximity;

use crate::InnerSphereTree;
use crate::lens::Lens;
use alloc::vec::Vec;
use core::f64::consts::PI;
use glam::{DMat3, DQuat, DVec3};
use glamx::Pose3;
pub use proximity::{ReferenceDistance, balls, distance};

/// Overlap by brute force over all pairs of spheres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
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
    /// Second derivative of the volume by a translation t (first three rows and columns, m) and a rotation vector ω
    /// (last three, m²/rad and m³/rad²) about [`Self::centroid`]: B is displaced by x ↦ t + exp(ω)x.
    pub stiffness: [[f64; 6]; 6],
    /// Sum of |V''| + |V'/d| over all pairs (m): the scale of rounding errors of the translations in [`Self::stiffness`].
    pub stiffness_scale: f64,
    /// Overlapping pairs of spheres.
    pub pairs: u32,
}

/// Two overlapping volume balls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferencePair {
    /// Positions in the orders of both trees.
    pub spheres: [usize; 2],
    /// The lens of the two balls.
    pub lens: Lens,
    /// Centre of A's ball (m).
    pub center_a: DVec3,
    /// Centre of B's ball in A's frame (m).
    pub center_b: DVec3,
}

impl ReferencePair {
    /// Unit vector from A's centre to B's; zero where they coincide.
    #[must_use]
    pub fn axis(&self) -> DVec3 {
        (self.center_b - self.center_a).normalize_or_zero()
    }
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
    let pairs = pairs_at(a, b, rotation, translation);
    let mut out = ReferenceOverlap { pairs: pairs.len() as u32, ..ReferenceOverlap::default() };
    let (mut moment, mut torque) = (DVec3::ZERO, DVec3::ZERO);
    for pair in &pairs {
        let (lens, axis) = (pair.lens, pair.axis());
        out.volume += lens.volume;
        moment += lens.volume * (pair.center_a + lens.centroid * axis);
        out.area += lens.area;
        out.gradient -= lens.area * axis;
        torque -= lens.area * pair.center_a.cross(axis);
    }
    if out.volume > 0.0 {
        out.centroid = moment / out.volume;
        out.rotation_gradient = torque - out.centroid.cross(out.gradient);
        for pair in &pairs {
            out.add_stiffness(pair);
        }
    }
    out
}

/// All pairs of overlapping volume balls, by position in B's order and then in A's.
#[must_use]
pub fn pairs_at(
    a: &InnerSphereTree,
    b: &InnerSphereTree,
    rotation: DQuat,
    translation: DVec3,
) -> Vec<ReferencePair> {
    let mut pairs = Vec::new();
    for (in_b, (center_b, radius_b)) in b.volume_balls().enumerate() {
        let center_b = rotation * center_b.as_dvec3() + translation;
        for (in_a, (center_a, radius_a)) in a.volume_balls().enumerate() {
            let center_a = center_a.as_dvec3();
            let lens = Lens::new(f64::from(radius_a), f64::from(radius_b), center_a.distance(center_b));
            if lens.volume > 0.0 {
                pairs.push(ReferencePair { spheres: [in_a, in_b], lens, center_a, center_b });
            }
        }
    }
    pairs
}

/// Overlap of `a` with the half-space of all points x with `normal`·x ≤ `offset` (m), in `a`'s frame: the derivatives are
/// by motions of the half-space. Without stiffness; `normal` must be a unit vector.
#[must_use]
pub fn overlap_with_half_space(a: &InnerSphereTree, normal: DVec3, offset: f64) -> ReferenceOverlap {
    let mut out = ReferenceOverlap::default();
    let (mut moment, mut torque) = (DVec3::ZERO, DVec3::ZERO);
    for (center, radius) in a.volume_balls() {
        let (center, r) = (center.as_dvec3(), f64::from(radius));
        // With s the distance of the centre from the plane, the discs at x ∈ [s, r] below the centre have areas π(r² − x²).
        let s = (normal.dot(center) - offset).clamp(-r, r);
        let volume = PI * (2.0 / 3.0 * r * r * r - s * (r * r - s * s / 3.0));
        let area = PI * (r * r - s * s);
        if volume <= 0.0 {
            continue;
        }
        out.pairs += 1;
        out.volume += volume;
        let chord = r * r - s * s;
        moment += volume * center - normal * (0.25 * PI * (chord * chord));
        out.area += area;
        out.gradient += area * normal;
        torque += area * center.cross(normal);
    }
    if out.volume > 0.0 {
        out.centroid = moment / out.volume;
        out.rotation_gradient = torque - out.centroid.cross(out.gradient);
    }
    out
}

impl ReferenceOverlap {
    /// With J = [I, −[r]×] for B's centre at r from the centroid, the pair adds Jᵀ(V'' n nᵀ + V'/d (I − n nᵀ))J and, from
    /// the second order of exp(ω), V'(sym(n rᵀ) − (n·r) I) to the rotations.
    fn add_stiffness(&mut self, pair: &ReferencePair) {
        let (n, d) = (pair.axis(), pair.center_a.distance(pair.center_b));
        let transverse = if d > 0.0 { -pair.lens.area / d } else { 0.0 };
        let r = pair.center_b - self.centroid;
        let outer = |a: DVec3, b: DVec3| DMat3::from_cols(a * b.x, a * b.y, a * b.z);
        let h =
            outer(n, n) * (pair.lens.curvature - transverse) + DMat3::from_diagonal(DVec3::splat(transverse));
        let turn = -DMat3::from_cols(r.cross(DVec3::X), r.cross(DVec3::Y), r.cross(DVec3::Z));
        let mixed = outer(n, r);
        let second = (0.5 * (mixed + mixed.transpose()) - DMat3::from_diagonal(DVec3::splat(n.dot(r))))
            * -pair.lens.area;
        let (coupling, rotation) = (h * turn, turn.transpose() * h * turn + second);
        for i in 0..3 {
            for j in 0..3 {
                self.stiffness[i][j] += h.col(j)[i];
                self.stiffness[i][j + 3] += coupling.col(j)[i];
                self.stiffness[j + 3][i] += coupling.col(j)[i];
                self.stiffness[i + 3][j + 3] += rotation.col(j)[i];
            }
        }
        self.stiffness_scale += pair.lens.curvature.abs() + transverse.abs();
    }
}
