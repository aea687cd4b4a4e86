//! Why no packing was made.

use ist::PackingError;
use std::time::Duration;

/// Why no packing was made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PackError {
    /// Zero spheres were asked for.
    #[error("zero spheres asked for; ask for at least one")]
    NoSpheresAsked,
    /// The asked coverage is no share.
    #[error("coverage {coverage} asked for; it is a share of the volume, above 0 and at most 1")]
    CoverageOutOfRange {
        /// What was asked.
        coverage: f64,
    },
    /// The asked volume error is no share.
    #[error("volume error {error} asked for; it is a share of the volume, above 0 and below 1")]
    VolumeErrorOutOfRange {
        /// What was asked.
        error: f64,
    },
    /// The asked least radius is no length.
    #[error("minimum radius {radius} asked for; it is a length (m), zero or more and finite")]
    InvalidMinRadius {
        /// What was asked.
        radius: f64,
    },
    /// Not one ball was placed.
    #[error(
        "no ball of radius {smallest:e} m or more fits; ask for a smaller minimum radius, or move the mesh towards the origin if it lies far away: single precision must resolve it there"
    )]
    NothingFits {
        /// Least radius asked for, or representable (m).
        smallest: f64,
    },
    /// The time was over before one ball was placed.
    #[error("no ball was placed within {limit:?}; allow more time")]
    NothingInTime {
        /// The time limit.
        limit: Duration,
    },
    /// The caller gave the packing up, or asked to finish before one ball was placed.
    #[error("the packing was cancelled")]
    Cancelled,
    /// The packing could not be stored.
    #[error(transparent)]
    Packing(#[from] PackingError),
}
