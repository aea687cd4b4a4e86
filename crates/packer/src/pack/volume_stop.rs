//! Ends the placing once the asked volume error is met.
//!
//! The error needs the power cells, so it is measured at counts that grow by √2. It falls with every ball but for
//! the noise of the measurement, and every count is a beginning of the same sequence: once it is met, the range
//! between the last two counts is halved.

use super::ball_grid::Ball;
use super::power_cells::PowerCell;
use super::stop_signal::Watch;
use super::{PackOptions, placing, power_cells, quality, record};
use crate::Solid;
use ist::InnerSphere;
use std::f64::consts::SQRT_2;

/// Halvings of the range in which the error is first met; 5 % of the count remain. A choice.
const HALVINGS: u32 = 3;
/// The error as a share of the gaps was 0.33 for a ball in a cube and 0.35 to 0.84 in the assets with 1 to 10,000
/// balls. It is not measured while less than this would be needed.
const LEAST_SHARE: f64 = 0.25;
/// Nor, once it is measured, while that share would have to fall by more than this factor; from 100 to 300 balls it
/// fell to 0.8 of itself at most.
const FALL: f64 = 0.75;
/// It is measured in any case when the count has grown by this factor.
const GROWTH: usize = 4;

pub(super) struct VolumeStop<'a> {
    solid: &'a Solid,
    options: &'a PackOptions,
    watch: &'a Watch<'a>,
    asked: f64,
    /// Counts at which the error was last and will next be looked at.
    previous: usize,
    next: usize,
    /// The error is measured once it can be met with this share of the gaps, or at this count.
    share: f64,
    due: usize,
    /// The cells at the least count that meets the error.
    met: Option<Vec<PowerCell>>,
}

impl<'a> VolumeStop<'a> {
    /// None if no error is asked for.
    pub(super) fn new(solid: &'a Solid, options: &'a PackOptions, watch: &'a Watch<'a>) -> Option<Self> {
        let asked = options.volume_error?;
        let (share, due) = (LEAST_SHARE, usize::MAX);
        Some(Self { solid, options, watch, asked, previous: 0, next: 1, share, due, met: None })
    }

    /// Whether `balls`, which fill `coverage`, are known to meet the error.
    pub(super) fn is_met(&mut self, balls: &[Ball], coverage: f64) -> bool {
        if balls.len() < self.next {
            return false;
        }
        let gaps = 1.0 - coverage;
        if self.share * gaps <= self.asked || balls.len() >= self.due {
            let error = self.measure(balls);
            if error <= self.asked {
                return true;
            }
            self.share = FALL * error / gaps;
            self.due = balls.len().saturating_mul(GROWTH);
        }
        self.previous = self.next;
        // From 1 on: 2, 3, 5, 8, 12, 17 and so on.
        self.next = (self.next as f64 * SQRT_2).ceil() as usize;
        false
    }

    /// Once the error is met: leaves the fewest of `balls` that are found to meet it, and their cells.
    pub(super) fn settle(mut self, balls: &mut Vec<Ball>) -> Option<Vec<PowerCell>> {
        let mut least = self.met.as_ref()?.len();
        let mut too_few = self.previous;
        for _ in 0..HALVINGS {
            let middle = too_few.midpoint(least);
            if middle == too_few || self.watch.reason().is_some() {
                break;
            }
            if self.measure(&balls[..middle]) <= self.asked {
                least = middle;
            } else {
                too_few = middle;
            }
        }
        balls.truncate(least);
        self.met
    }

    /// The error of `balls`, whose cells are kept if it is met.
    fn measure(&mut self, balls: &[Ball]) -> f64 {
        let samples = placing::gap_samples(self.options, balls.len());
        let cells = power_cells::measure(self.solid, balls, samples, self.watch);
        if self.watch.is_cancelled() {
            return f64::INFINITY;
        }
        let spheres: Vec<InnerSphere> =
            balls.iter().zip(&cells).map(|(ball, cell)| record(ball, cell)).collect();
        let error = quality::volume_error(self.solid, &spheres);
        if error <= self.asked {
            self.met = Some(cells);
        }
        error
    }
}
