//! Keeps enough of a time limit for what follows the placing.
//!
//! What the power cells will take is not known before: it depends on the mesh, on the number of balls and on the
//! machine. So they are tried out with few samples as balls are placed.

use super::ball_grid::Ball;
use super::stop_signal::Watch;
use super::{PackOptions, placing, power_cells};
use crate::Solid;
use std::time::Duration;

/// Share of the samples in a trial, and growth of the number of balls between trials. On two assets with 1 to 4,096
/// balls the cells took 4 to 7 times a trial.
const TRIAL: usize = 16;
const GROWTH: usize = 8;
/// The time of the cells grows at most with this power of the samples: boxes that are refined lie along surfaces.
const POWER: f64 = 2.0 / 3.0;
/// Time set aside, in units of what the cells are expected to take: for the cells and for the report.
const RESERVE: f64 = 1.4;

pub(super) struct TimeStop {
    /// Number of balls at the next trial.
    next: usize,
    /// Samples of the last trial and the time that it took (s).
    samples: usize,
    seconds: f64,
}

impl TimeStop {
    pub(super) fn new() -> Self {
        Self { next: 1, samples: 1, seconds: 0.0 }
    }

    /// Sets time aside for the cells of `balls`.
    pub(super) fn reserve(&mut self, solid: &Solid, options: &PackOptions, balls: &[Ball], watch: &Watch) {
        let samples = placing::gap_samples(options, balls.len());
        if balls.len() >= self.next {
            self.next = balls.len() * GROWTH;
            self.samples = samples / TRIAL;
            let started = watch.elapsed();
            power_cells::measure(solid, balls, self.samples, watch);
            self.seconds = (watch.elapsed() - started).as_secs_f64();
        }
        let cells = self.seconds * (samples as f64 / self.samples as f64).powf(POWER);
        watch.reserve(Duration::try_from_secs_f64(RESERVE * cells).unwrap_or(Duration::MAX));
    }

    /// As many of `samples` as the cells have time for, at least those of the last trial. Fewer than asked for where hardly anything
    /// but the trial fitted into the limit: in a tessellated ball the gap is a shell under its facets, and the cells of its one
    /// ball take four times as long as to place it.
    pub(super) fn affordable(&self, samples: usize, left: Duration) -> usize {
        let share = left.as_secs_f64() / self.seconds.max(f64::MIN_POSITIVE);
        // A number too large for an integer becomes the largest one.
        let affordable = self.samples as f64 * share.powf(1.0 / POWER);
        samples.min((affordable as usize).max(self.samples))
    }
}
