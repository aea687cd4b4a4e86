//! Ends the placing once the asked volume error is met.
//!
//! The error needs the power cells, so it is measured at counts that grow by √2. It falls with every ball but for
//! the noise of the measurement, and every count is a beginning of the same sequence: once it is met, the range
//! between the last two counts is halved.

use super::ball_grid::Ball;
use super::stop_signal::Watch;
use super::{PackOptions, placing, power_cells, quality, record};
use crate::Solid;
use ist::InnerSphere;
use std::f64::consts::SQRT_2;

/// Halvings of the range in which the error is first met; 5 % of the count remain. A choice.
const HALVINGS: u32 = 3;
/// The error is not measured while it can hardly be met. It was 0.33 of the gaps' share for a ball in a cube and 0.35
/// to 0.84 of it in the assets with 1 to 10,000 balls.
const LEAST_SHARE_OF_GAPS: f64 = 0.25;

pub(super) struct VolumeStop<'a> {
    solid: &'a Solid,
    options: &'a PackOptions,
    watch: &'a Watch<'a>,
    asked: f64,
    /// Counts at which the error was last and will next be looked at.
    previous: usize,
    next: usize,
    /// Volumes of the cells at the least count that meets the error.
    met: Option<Vec<f64>>,
}

impl<'a> VolumeStop<'a> {
    /// None if no error is asked for.
    pub(super) fn new(solid: &'a Solid, options: &'a PackOptions, watch: &'a Watch<'a>) -> Option<Self> {
        let asked = options.volume_error?;
        Some(Self { solid, options, watch, asked, previous: 0, next: 1, met: None })
    }

    /// Whether `balls`, which fill `coverage`, are known to meet the error.
    pub(super) fn is_met(&mut self, balls: &[Ball], coverage: f64) -> bool {
        if balls.len() < self.next {
            return false;
        }
        let is_possible = LEAST_SHARE_OF_GAPS * (1.0 - coverage) <= self.asked;
        if is_possible && self.measure(balls) {
            return true;
        }
        self.previous = self.next;
        // From 1 on: 2, 3, 5, 8, 12, 17 and so on.
        self.next = (self.next as f64 * SQRT_2).ceil() as usize;
        false
    }

    /// Once the error is met: leaves the fewest of `balls` that are found to meet it, and their cells.
    pub(super) fn settle(mut self, balls: &mut Vec<Ball>) -> Option<Vec<f64>> {
        let mut least = self.met.as_ref()?.len();
        let mut too_few = self.previous;
        for _ in 0..HALVINGS {
            let middle = too_few.midpoint(least);
            if middle == too_few || self.watch.reason().is_some() {
                break;
            }
            if self.measure(&balls[..middle]) {
                least = middle;
            } else {
                too_few = middle;
            }
        }
        balls.truncate(least);
        self.met
    }

    /// Measures the error of `balls` and keeps their cells if it is met.
    fn measure(&mut self, balls: &[Ball]) -> bool {
        let samples = placing::gap_samples(self.options, balls.len());
        let volumes = power_cells::volumes(self.solid, balls, samples, self.watch);
        if self.watch.is_cancelled() {
            return false;
        }
        let spheres: Vec<InnerSphere> =
            balls.iter().zip(&volumes).map(|(ball, volume)| record(ball, *volume)).collect();
        let is_met = quality::volume_error(self.solid, &spheres) <= self.asked;
        if is_met {
            self.met = Some(volumes);
        }
        is_met
    }
}
