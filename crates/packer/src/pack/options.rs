//! What to pack and when to stop.

use super::PackError;
use std::fmt;
use std::time::Duration;

/// When a packing is done, and how finely its power cells are measured.
///
/// Start from a preset and change what matters; the first stop that is reached ends the packing, and
/// [`PackReport::stop`](crate::PackReport::stop) names it. Whatever ends it, the packing is the beginning of one and
/// the same sequence of balls, but for the last of those with a [`Self::min_radius`].
///
/// ```
/// use packer::PackOptions;
/// use std::time::Duration;
///
/// let options = PackOptions::balanced().spheres(2_000).coverage(0.8).time_limit(Duration::from_secs(10));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PackOptions {
    /// Most spheres to place.
    pub spheres: usize,
    /// Stop once the balls fill this share of the solid, in (0, 1].
    pub coverage: Option<f64>,
    /// Place no ball of a radius below this (m). Balls up to a ninth larger may be others than those of a packing
    /// without it; all before them are the same. With 0 m, a solid that is nearly a ball gets more than
    /// one: [`StopReason::Exhausted`](crate::StopReason::Exhausted).
    pub min_radius: Option<f64>,
    /// Stop once the volume balls put no more than this share of the volume in the wrong place, in (0, 1):
    /// [`Quality::volume_error`](crate::Quality::volume_error).
    pub volume_error: Option<f64>,
    /// Stop early enough that the whole call, with power cells and report, takes about this long.
    pub time_limit: Option<Duration>,
    /// Sample points in the gaps between the balls that measure the power cells, for each sphere; at least 200,000 in all.
    pub samples_per_sphere: usize,
    /// Whether the report has a [`Quality`](crate::Quality); without it small packings are ready sooner. The
    /// packing does not depend on it.
    pub measure_quality: bool,
    /// Name of the mesh, for the provenance of the packing.
    pub source: String,
}

impl PackOptions {
    /// 300 spheres: a body among many, or a first look. On the five assets they fill 56 to 77 % and the volume error
    /// is 9 to 17 %.
    #[must_use]
    pub fn fast() -> Self {
        Self {
            spheres: 300,
            coverage: None,
            min_radius: None,
            volume_error: None,
            time_limit: None,
            samples_per_sphere: 64,
            measure_quality: true,
            source: String::new(),
        }
    }

    /// 1,000 spheres: overlap volumes to a few per cent; the default. On the five assets they fill 66 to 82 % and
    /// the volume error is 7 to 12 %.
    #[must_use]
    pub fn balanced() -> Self {
        Self { spheres: 1_000, ..Self::fast() }
    }

    /// 5,000 spheres: for thin or large bodies and for reference. On the five assets they fill 75 to 87 % and the
    /// volume error is 5 to 9 %.
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

    /// Stops once the volume balls put no more than `share` of the volume in the wrong place, in (0, 1): the bound
    /// of the error of an overlap volume that [`Quality::volume_error`](crate::Quality::volume_error) is.
    ///
    /// It is measured at some of the counts that grow by √2, as it takes power cells, and then the range between
    /// the last two counts is halved three times: about 5 % more balls than necessary may be placed. The search took
    /// three to five times the time of asking for the count that it ended with (two assets, 22 to 1,378 balls).
    #[must_use]
    pub fn volume_error(mut self, share: f64) -> Self {
        self.volume_error = Some(share);
        self
    }

    /// Stops placing early enough that the whole call takes about `limit`.
    ///
    /// Power cells are tried out with few samples on the way, and time for all of them is set aside. The balls are
    /// those that a request for the same count gives; their number depends on the machine. Calls with limits of 1 to
    /// 10 s took 80 to 96 % of them on two assets and a busy machine. The search for the first ball and the cells of
    /// so few take a few tenths of a second each, 0.5 and 3 s in a sheet a hundred thousand times as wide as thick, and 1 and
    /// 2 s in a ball of 100,000 triangles: a shorter limit is overrun by so much, or ends in [`PackError::NothingInTime`].
    #[must_use]
    pub fn time_limit(mut self, limit: Duration) -> Self {
        self.time_limit = Some(limit);
        self
    }

    /// Sets whether the report has a [`Quality`](crate::Quality).
    #[must_use]
    pub fn measure_quality(mut self, measure: bool) -> Self {
        self.measure_quality = measure;
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
        if let Some(error) = self.volume_error
            && !(error > 0.0 && error < 1.0)
        {
            return Err(PackError::VolumeErrorOutOfRange { error });
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

/// The options as one line, as it stands in a packing's provenance: all that the packing depends on but the mesh.
/// Equal lines mean equal packings, unless a time limit is among them.
impl fmt::Display for PackOptions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "spheres={}", self.spheres)?;
        if let Some(coverage) = self.coverage {
            write!(f, " coverage={coverage}")?;
        }
        if let Some(radius) = self.min_radius {
            write!(f, " min_radius={radius}")?;
        }
        if let Some(error) = self.volume_error {
            write!(f, " volume_error={error}")?;
        }
        if let Some(limit) = self.time_limit {
            // Debug prints all digits, with their unit.
            write!(f, " time_limit={limit:?}")?;
        }
        write!(f, " samples_per_sphere={}", self.samples_per_sphere)
    }
}
