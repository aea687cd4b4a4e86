//! Mass properties of the solid that a packing fills.

use core::f64::consts::PI;
use glam::{DMat3, DVec3};

/// Volume, centroid and inertia of the solid enclosed by a mesh, for unit density.
///
/// The packer computes them exactly from the triangles, so that a body weighs what its mesh weighs,
/// however few spheres fill it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidProperties {
    /// Enclosed volume (m³), positive.
    pub volume: f64,
    /// Centroid of the volume (m), in the frame of the mesh.
    pub centroid: DVec3,
    /// Inertia tensor about the centroid for density 1 kg/m³ (kg·m²), in the axes of the mesh.
    pub unit_inertia: DMat3,
}

impl SolidProperties {
    /// A ball of radius `radius` (m) about the origin.
    #[must_use]
    pub fn ball(radius: f64) -> Self {
        let volume = 4.0 / 3.0 * PI * radius * radius * radius;
        Self {
            volume,
            centroid: DVec3::ZERO,
            unit_inertia: DMat3::from_diagonal(DVec3::splat(0.4 * volume * radius * radius)),
        }
    }

    /// The same solid, `scale` times as large.
    #[must_use]
    pub fn scaled(&self, scale: f64) -> Self {
        let square = scale * scale;
        Self {
            volume: self.volume * (scale * square),
            centroid: self.centroid * scale,
            unit_inertia: self.unit_inertia * (scale * (square * square)),
        }
    }
}
