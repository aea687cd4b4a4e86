//! What to pack and when to stop.

use super::PackError;
use std::fmt;

/// When a packing is done, and how finely its power cells are measured.
///
/// Start from a preset and change what matters; the first stop that is reached ends the packing.
///
/// ```
/// use packer::PackOptions;
///
/// let options = PackOptions::balanced().spheres(2_000).coverage(0.8);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PackOptions {
    /// Most spheres to place.
    pub spheres: usize,
    /// Stop once the balls fill this share of the solid, in (0, 1].
    pub coverage: Option<f64>,
    /// Place no ball of a radius below this (m).
    pub min_radius: Option<f64>,
    /// Sample points in the gaps between the balls that measure the power cells.
    pub samples_per_sphere: usize,
    /// Name of the mesh, for the provenance of the packing.
    pub source: String,
}

impl PackOptions {
    /// 300 spheres: a body among many, or a first look.
    #[must_use]
    pub fn fast() -> Self {
        Self { spheres: 300, coverage: None, min_radius: None, samples_per_sphere: 64, source: String::new() }
    }

    /// 1,000 spheres: overlap volumes to a few per cent; the default.
    #[must_use]
    pub fn balanced() -> Self {
        Self { spheres: 1_000, ..Self::fast() }
    }

    /// 5,000 spheres: for thin or large bodies and for reference.
    #[must_use]
    pub fn fine() -> Self {
        Self { spheres: 5_000, ..Self::fast() }
    }

    /// Sets the largest number of spheres.
    #[must_use]
    pub fn spheres(mut self, spheres: usize) -> Self {
        self.spheres = spheres;
        self
    }

    /// Stops once the balls fill `share` of the volume, in (0, 1].
    #[must_use]
    pub fn coverage(mut self, share: f64) -> Self {
        self.coverage = Some(share);
        self
    }

    /// Places no ball of a radius below `radius` (m).
    #[must_use]
    pub fn min_radius(mut self, radius: f64) -> Self {
        self.min_radius = Some(radius);
        self
    }

    /// Names the mesh in the provenance of the packing.
    #[must_use]
    pub fn source(mut self, name: impl Into<String>) -> Self {
        self.source = name.into();
        self
    }

    /// Refuses options that no packing meets; [`crate::pack`] asks this too.
    ///
    /// # Errors
    /// [`PackError`] names the option that is out of range.
    pub fn validate(&self) -> Result<(), PackError> {
        if self.spheres == 0 {
            return Err(PackError::NoSpheresAsked);
        }
        if let Some(coverage) = self.coverage
            && !(coverage > 0.0 && coverage <= 1.0)
        {
            return Err(PackError::CoverageOutOfRange { coverage });
        }
        if let Some(radius) = self.min_radius
            && !(radius >= 0.0 && radius.is_finite())
        {
            return Err(PackError::InvalidMinRadius { radius });
        }
        Ok(())
    }
}

impl Default for PackOptions {
    fn default() -> Self {
        Self::balanced()
    }
}

/// The options as one line, as it stands in a packing's provenance.
impl fmt::Display for PackOptions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "spheres={}", self.spheres)?;
        if let Some(coverage) = self.coverage {
            write!(f, " coverage={coverage}")?;
        }
        if let Some(radius) = self.min_radius {
            write!(f, " min_radius={radius}")?;
        }
        write!(f, " samples_per_sphere={}", self.samples_per_sphere)
    }
}
