//! A solid filled with disjoint spheres.

use crate::file::Provenance;
use crate::{InnerSphere, SolidProperties};
use alloc::vec::Vec;
use glam::Vec3;

/// A solid and the disjoint inner spheres that fill it: what the packer makes and the `.ist` file stores.
///
/// Spheres stand in the order in which the packer placed them, so the first `n` of them are the packing that
/// a request for `n` spheres would have given (with other cell volumes, which belong to the count).
#[derive(Clone, Debug, PartialEq)]
pub struct SpherePacking {
    spheres: Vec<InnerSphere>,
    solid: SolidProperties,
    provenance: Provenance,
}

/// Why a list of spheres is not a packing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PackingError {
    /// There is no sphere.
    #[error("a packing needs at least one sphere")]
    Empty,
    /// 2³¹ spheres or more.
    #[error("{0} spheres are more than a packing can index; pack fewer than 2^31")]
    TooMany(usize),
    /// A sphere has a number that no sphere can have.
    #[error("sphere {index}: {what}")]
    InvalidSphere {
        /// Position in the list.
        index: usize,
        /// What is wrong with it.
        what: &'static str,
    },
    /// The solid's volume is not positive, or one of its figures is not finite.
    #[error("the solid's volume must be positive and its centroid and inertia finite")]
    InvalidSolid,
}

impl SpherePacking {
    /// A packing of `spheres` that fill `solid`.
    ///
    /// # Errors
    /// Refuses an empty list, non-finite numbers, radii or cell volumes that are not positive, and normals
    /// that are not unit vectors. That the spheres are disjoint and inside is the packer's certificate and
    /// is not checked again here: it needs the mesh.
    pub fn new(spheres: Vec<InnerSphere>, solid: SolidProperties) -> Result<Self, PackingError> {
        if spheres.is_empty() {
            return Err(PackingError::Empty);
        }
        if spheres.len() >= 1 << 31 {
            return Err(PackingError::TooMany(spheres.len()));
        }
        for (index, sphere) in spheres.iter().enumerate() {
            if let Some(what) = defect(sphere) {
                return Err(PackingError::InvalidSphere { index, what });
            }
        }
        let finite = solid.centroid.is_finite() && solid.unit_inertia.is_finite();
        if !(solid.volume > 0.0 && solid.volume.is_finite() && finite) {
            return Err(PackingError::InvalidSolid);
        }
        Ok(Self { spheres, solid, provenance: Provenance::default() })
    }

    /// The same packing with a note of where it comes from.
    #[must_use]
    pub fn with_provenance(mut self, provenance: Provenance) -> Self {
        self.provenance = provenance;
        self
    }

    /// The spheres, in the order in which they were placed; never empty.
    #[must_use]
    pub fn spheres(&self) -> &[InnerSphere] {
        &self.spheres
    }

    /// Mass properties of the solid itself.
    #[must_use]
    pub fn solid(&self) -> &SolidProperties {
        &self.solid
    }

    /// Where the packing comes from.
    #[must_use]
    pub fn provenance(&self) -> &Provenance {
        &self.provenance
    }

    /// Share of the solid's volume that the inner balls fill: 0 to 1 where they are disjoint and inside, as the packer makes them,
    /// which [`Self::new`] does not ask.
    #[must_use]
    pub fn coverage(&self) -> f64 {
        let balls: f64 = self
            .spheres
            .iter()
            .map(|s| f64::from(s.radius) * f64::from(s.radius) * f64::from(s.radius))
            .sum();
        balls * 4.0 / 3.0 * core::f64::consts::PI / self.solid.volume
    }

    /// Corners of the smallest axis-aligned box around the volume balls (m).
    #[must_use]
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let empty = (Vec3::splat(f32::INFINITY), Vec3::splat(f32::NEG_INFINITY));
        self.spheres.iter().fold(empty, |(lower, upper), sphere| {
            let (center, radius) = sphere.volume_ball();
            (lower.min(center - radius), upper.max(center + radius))
        })
    }
}

/// What makes `sphere` no sphere, if anything.
fn defect(sphere: &InnerSphere) -> Option<&'static str> {
    let InnerSphere { center, radius, cell_volume, cell_centroid, normal } = *sphere;
    let vectors = [center, cell_centroid, normal];
    if !(vectors.iter().all(|v| v.is_finite()) && radius.is_finite() && cell_volume.is_finite()) {
        Some("a number is not finite")
    } else if radius <= 0.0 {
        Some("the radius is not positive")
    } else if cell_volume <= 0.0 {
        Some("the cell volume is not positive")
    } else if (normal.length_squared() - 1.0).abs() > 1e-3 {
        Some("the normal is not a unit vector")
    } else {
        None
    }
}
