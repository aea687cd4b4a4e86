//! How far a packing has come.

use super::PackOptions;
use std::fmt;

/// What the packer is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde-serialize", derive(serde::Serialize), serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Stage {
    /// Looks for the places of the largest balls.
    Seeds,
    /// Places balls.
    Placing,
    /// Measures the power cells.
    Cells,
    /// Checks every ball and measures the quality.
    Report,
    /// All is done.
    Finished,
}

impl Stage {
    /// Share of the work done when the stage begins: rounded from the times of the assets at 1,000 to 10,000
    /// spheres.
    fn begin(self) -> f64 {
        match self {
            Self::Seeds => 0.0,
            Self::Placing => 0.05,
            Self::Cells => 0.7,
            Self::Report => 0.95,
            Self::Finished => 1.0,
        }
    }
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Seeds => "seeds",
            Self::Placing => "placing",
            Self::Cells => "power cells",
            Self::Report => "report",
            Self::Finished => "finished",
        })
    }
}

/// How far the work has come.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde-serialize", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Progress {
    /// What is being done.
    pub stage: Stage,
    /// Balls placed.
    pub spheres: usize,
    /// Share of the volume that they fill.
    pub coverage: f64,
    /// Estimated share of the whole work that is done, from 0 to 1: it never falls, and it is exactly 1 in
    /// [`Stage::Finished`] and only there.
    pub fraction: f64,
}

/// Tells the caller, and sees to it that the fraction never falls.
pub(super) struct Reporter<'a> {
    callback: &'a mut dyn FnMut(Progress),
    latest: Progress,
}

impl<'a> Reporter<'a> {
    pub(super) fn new(callback: &'a mut dyn FnMut(Progress)) -> Self {
        let latest = Progress { stage: Stage::Seeds, spheres: 0, coverage: 0.0, fraction: 0.0 };
        Self { callback, latest }
    }

    /// A new stage, with the figures of the balls as they are.
    pub(super) fn begin(&mut self, stage: Stage) {
        self.latest.stage = stage;
        self.latest.fraction = self.latest.fraction.max(stage.begin());
        (self.callback)(self.latest);
    }

    /// `spheres` balls fill `coverage`, and this `share` of the placing is done, 0 to 1.
    pub(super) fn placed(&mut self, spheres: usize, coverage: f64, share: f64) {
        let (from, to) = (Stage::Placing.begin(), Stage::Cells.begin());
        let fraction = (from + share * (to - from)).clamp(self.latest.fraction, to);
        self.latest = Progress { stage: Stage::Placing, spheres, coverage, fraction };
        (self.callback)(self.latest);
    }

    /// The balls that were kept in the end.
    pub(super) fn kept(&mut self, spheres: usize, coverage: f64) {
        (self.latest.spheres, self.latest.coverage) = (spheres, coverage);
    }
}

/// Dimension of a random Apollonian packing of balls: balls above radius `r` number about `r^-D` and leave a gap of
/// about `r^(3 − D)` (M. Borkovec, W. de Paris and R. Peikert, *The fractal dimension of the Apollonian sphere
/// packing*, 1994).
const DIMENSION: f64 = 2.474;

/// Share of the placing that is done by the nearest of the stops of `options`, when `spheres` balls fill `coverage`
/// and the last has `radius`; 0 to 1.
pub(super) fn share_placed(options: &PackOptions, spheres: usize, coverage: f64, radius: f64) -> f64 {
    let by_count = spheres as f64 / options.spheres as f64;
    // The time goes as the number of balls.
    let by_gap = |gap: f64| (gap / (1.0 - coverage)).powf(DIMENSION / (3.0 - DIMENSION));
    let by_coverage = options.coverage.map_or(0.0, |asked| by_gap(1.0 - asked));
    let by_radius = options.min_radius.map_or(0.0, |asked| (asked / radius).powf(DIMENSION));
    let nearest = by_count.max(by_coverage).max(by_radius);
    if nearest.is_finite() { nearest.clamp(0.0, 1.0) } else { 1.0 }
}
