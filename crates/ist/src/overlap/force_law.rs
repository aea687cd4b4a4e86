//! How an overlap turns into a force.

use super::totals::{Totals, WrenchSum};

/// How the force on B follows from the overlap; always for a stiffness of 1 N/m³.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum ForceLaw {
    /// Minus the gradient of the volume: the force of the potential energy V. Conservative, in the direction in
    /// which the volume shrinks fastest, but as large as the contact area and zero for a body wholly inside.
    VolumeGradient,
    /// The stored outward normals weighted by volume: a quadrature of the hydroelastic pressure field ∫∇depth dV
    /// of both solids. As large as the volume, and it pushes a body that is wholly inside.
    OutwardNormals,
    /// As large as the volume, along the gradient where that is significant, along the outward normals where it is
    /// not, with a continuous transition.
    #[default]
    Blended,
}

/// Significance from which on the gradient alone decides.
const SIGNIFICANT: f64 = 0.3;

impl ForceLaw {
    pub(super) fn wrench(self, totals: &Totals) -> WrenchSum {
        match self {
            Self::VolumeGradient => totals.gradient,
            Self::OutwardNormals => outward(totals),
            Self::Blended => blended(totals),
        }
    }
}

/// Both bodies' outward normals, as one body's hydroelastic field would give.
fn outward(totals: &Totals) -> WrenchSum {
    WrenchSum {
        force: totals.normals_a.force - totals.normals_b.force,
        torque: totals.normals_a.torque - totals.normals_b.torque,
    }
}

fn blended(totals: &Totals) -> WrenchSum {
    let outward = outward(totals);
    let length = totals.gradient.force.length();
    let significance = length / totals.area.max(f64::MIN_POSITIVE);
    let weight = gradient_weight(significance);
    let along_gradient = unit(&totals.gradient, totals.volume * weight);
    let along_normals = unit(&outward, totals.volume * (1.0 - weight));
    WrenchSum {
        force: along_gradient.force + along_normals.force,
        torque: along_gradient.torque + along_normals.torque,
    }
}

/// `wrench` scaled so that its force has length `length`.
fn unit(wrench: &WrenchSum, length: f64) -> WrenchSum {
    let factor = length / wrench.force.length().max(f64::MIN_POSITIVE);
    WrenchSum { force: wrench.force * factor, torque: wrench.torque * factor }
}

/// How far the direction is the gradient's, 0 to 1, where `significance` is the length of a sum of area vectors over
/// the sum of their lengths: 1 for a thin contact, 0 for a body wholly inside.
pub(super) fn gradient_weight(significance: f64) -> f64 {
    let x = (significance / SIGNIFICANT).clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}
