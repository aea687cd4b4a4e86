//! What the packer says about its work.

use super::Quality;
use super::ball_grid::Ball;
use std::fmt;

/// Which of the asked limits ended the packing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde-serialize", derive(serde::Serialize), serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum StopReason {
    /// The asked number of spheres is placed.
    SphereCount,
    /// The asked coverage is reached.
    Coverage,
    /// The asked volume error is met.
    VolumeError,
    /// The time for placing was over.
    TimeLimit,
    /// The caller asked to finish.
    Caller,
    /// No further ball of the asked least radius fits.
    MinRadius,
    /// What is left is not worth a search: the solid is so nearly a ball that all spheres asked for would fill less than
    /// 1e-4 of it after the first. A least radius of 0 asks for these too.
    Exhausted,
    /// No further ball fits that single precision can tell from a point, see [`Diagnosis::resolution`](crate::Diagnosis::resolution).
    Resolution,
}

impl fmt::Display for StopReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::SphereCount => "sphere count",
            Self::Coverage => "coverage",
            Self::VolumeError => "volume error",
            Self::TimeLimit => "time limit",
            Self::Caller => "caller",
            Self::MinRadius => "minimum radius",
            Self::Exhausted => "the rest is negligible",
            Self::Resolution => {
                "single precision resolves no smaller ball here; move the mesh towards the origin"
            }
        })
    }
}

/// Figures of a finished packing.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde-serialize", derive(serde::Serialize))]
#[non_exhaustive]
pub struct PackReport {
    /// Number of spheres.
    pub spheres: usize,
    /// Share of the volume that the balls fill.
    pub coverage: f64,
    /// What ended the packing.
    pub stop: StopReason,
    /// Smallest radius (m).
    pub radius_min: f64,
    /// Median radius (m).
    pub radius_median: f64,
    /// Largest radius (m).
    pub radius_max: f64,
    /// Farthest that a ball sticks out of the mesh (m); zero or less where all are inside.
    pub protrusion: f64,
    /// Deepest overlap of two balls (m); zero or less where they are disjoint.
    pub overlap: f64,
    /// How well the packing represents the solid, unless the options leave that out.
    pub quality: Option<Quality>,
    /// Wall time for placing the balls (s).
    pub place_seconds: f64,
    /// Wall time for measuring the power cells (s).
    pub cells_seconds: f64,
    /// Wall time for normals and residuals (s).
    pub finish_seconds: f64,
    /// Wall time for measuring the quality (s).
    pub quality_seconds: f64,
}

impl PackReport {
    /// Count, coverage and radii of `balls`, at least one, in a solid of `volume`; the rest is left at zero.
    pub(super) fn of_balls(balls: &[Ball], volume: f64, stop: StopReason) -> Self {
        let mut radii: Vec<f64> = balls.iter().map(|ball| ball.radius).collect();
        radii.sort_by(f64::total_cmp);
        Self {
            spheres: balls.len(),
            coverage: balls.iter().map(Ball::volume).sum::<f64>() / volume,
            stop,
            radius_min: radii[0],
            radius_median: radii[radii.len() / 2],
            radius_max: radii[radii.len() - 1],
            protrusion: 0.0,
            overlap: 0.0,
            quality: None,
            place_seconds: 0.0,
            cells_seconds: 0.0,
            finish_seconds: 0.0,
            quality_seconds: 0.0,
        }
    }
}
