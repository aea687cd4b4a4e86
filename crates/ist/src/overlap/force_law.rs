//! How an overlap turns into a force.

use super::totals::{Totals, WrenchSum};
use crate::sphere::{SQUARABLE, cube_root};

/// How the force on B follows from the overlap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum ForceLaw {
    /// Minus the gradient of the volume: the force of an energy of 1 J per m³ of overlap, to be multiplied by a pressure
    /// (N/m²). Conservative, in the direction in which the volume shrinks fastest, but as large as the contact area and
    /// zero for a body wholly inside.
    VolumeGradient,
    /// The stored outward normals weighted by volume: a quadrature of the hydroelastic pressure field ∫∇depth dV
    /// of both solids, for a stiffness of 1 N/m³. Twice the volume where the surfaces face each other, less where their
    /// normals or the places of the overlap differ; it pushes a body that is wholly inside.
    OutwardNormals,
    /// For a stiffness of 1 N/m³: as large as the volume, along the gradient where that is significant, along the outward
    /// normals where it is not, with a continuous transition in which it is smaller where the two differ.
    #[default]
    Blended,
}

/// Length of the volume gradient, in units of V^⅔, from which on it alone decides the direction.
///
/// A convex overlap has 2 to 5. The gradient of a body wholly inside another is zero but for the noise of the
/// sphere representation: at most 0.14 (1,000 spheres) and 0.29 (300 spheres) in 73 poses of a rabbit inside another;
/// the gradient is still right to 2.5–7.5° (medians) in deep overlap, where its length goes down to 0.1.
const SIGNIFICANT: f64 = 0.2;

/// Length of a sum of forces, in units of the length that it is to have, below which they count as opposed to each other
/// and as having no direction: the rounding of sums in f32. Coincident solids have opposed normals.
const OPPOSED: f64 = 1e-6;

impl ForceLaw {
    /// By how much its forces grow where all lengths grow by `scale`: as areas or as volumes.
    pub(super) fn growth(self, scale: f64) -> f64 {
        match self {
            Self::VolumeGradient => scale * scale,
            Self::OutwardNormals | Self::Blended => scale * scale * scale,
        }
    }

    /// Whether the wrench depends on [`Totals::outward`], by the other sums.
    pub(super) fn needs_outward(self, totals: &Totals) -> bool {
        match self {
            Self::VolumeGradient => false,
            Self::OutwardNormals => true,
            Self::Blended => totals.volume > 0.0 && weight(totals) < 1.0,
        }
    }

    pub(super) fn wrench(self, totals: &Totals) -> WrenchSum {
        match self {
            Self::VolumeGradient => totals.gradient,
            Self::OutwardNormals => totals.outward,
            Self::Blended => blended(totals),
        }
    }
}

fn blended(totals: &Totals) -> WrenchSum {
    let weight = weight(totals);
    let along_gradient = scaled(&totals.gradient, totals.volume * weight);
    if weight >= 1.0 {
        return along_gradient;
    }
    let along_normals = scaled(&totals.outward, totals.volume * (1.0 - weight));
    WrenchSum {
        force: along_gradient.force + along_normals.force,
        torque: along_gradient.torque + along_normals.torque,
    }
}

fn weight(totals: &Totals) -> f64 {
    gradient_weight(totals.gradient.force.length(), totals.volume)
}

/// `wrench` scaled so that its force has length `length`.
fn scaled(wrench: &WrenchSum, length: f64) -> WrenchSum {
    let force = wrench.force.length();
    let factor = if force > length * OPPOSED { length / force } else { 0.0 };
    WrenchSum { force: wrench.force * factor, torque: wrench.torque * factor }
}

/// How far the direction is that of a volume gradient of length `gradient` (m²), 0 to 1.
pub(super) fn gradient_weight(gradient: f64, volume: f64) -> f64 {
    let size = cube_root(volume).max(SQUARABLE);
    let x = (gradient / (size * size * SIGNIFICANT)).clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}
