//! Keeps enough of a time limit for what follows the placing.
//!
//! What the power cells will take is not known before: it depends on the mesh, on the number of balls and on the
//! machine. So they are tried out with few samples as balls are placed.

use super::ball_grid::Ball;
use super::stop_signal::Watch;
use super::{PackOptions, placing, power_cells};
use crate::Solid;
use std::time::Duration;

/// Share of the samples in a trial, and growth of the number of balls between trials; together 7 % of the time of
/// the cells. A choice.
const TRIAL: usize = 16;
const GROWTH: usize = 8;
/// Time set aside, in units of what the cells are expected to take: for the cells, for the report, and for the
/// error of the expectation.
const RESERVE: f64 = 1.6;

pub(super) struct TimeStop {
    /// Number of balls at the next trial.
    next: usize,
    seconds_per_sample: f64,
}

impl TimeStop {
    pub(super) fn new() -> Self {
        Self { next: 1, seconds_per_sample: 0.0 }
    }

    /// Sets time aside for the cells of `balls`.
    pub(super) fn reserve(&mut self, solid: &Solid, options: &PackOptions, balls: &[Ball], watch: &Watch) {
        let samples = placing::gap_samples(options, balls.len());
        if balls.len() >= self.next {
            self.next = balls.len() * GROWTH;
            let started = watch.elapsed();
            let trial = (samples / TRIAL).max(1);
            power_cells::volumes(solid, balls, trial, watch);
            self.seconds_per_sample = (watch.elapsed() - started).as_secs_f64() / trial as f64;
        }
        let seconds = RESERVE * self.seconds_per_sample * samples as f64;
        watch.reserve(Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX));
    }
}
