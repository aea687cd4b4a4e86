//! Places balls until a stop is reached.

use super::ball_grid::Ball;
use super::power_cells::PowerCell;
use super::progress::{Reporter, share_placed};
use super::rounds::{self, Smallest};
use super::stop_signal::Watch;
use super::time_stop::TimeStop;
use super::volume_stop::VolumeStop;
use super::{PackError, PackOptions, StopReason};
use crate::Solid;
use std::f64::consts::PI;

/// Gap samples of the smallest packings, whose cells are to be as exact as those of larger ones.
const FEWEST_SAMPLES: usize = 200_000;
/// Share of the volume that is not worth a search by all balls that were asked for together. A tessellated ball is
/// filled to 99.9 % by one ball; the next ones lie in the dust under its facets, and looking for ten of them took
/// minutes.
const NEGLIGIBLE: f64 = 1e-4;
/// Balls placed between two reports of progress.
const BALLS_PER_PROGRESS: usize = 64;

/// Balls placed, and why no more.
#[derive(Debug)]
pub(super) struct Placed {
    /// In the order of placing; at least one.
    pub(super) balls: Vec<Ball>,
    pub(super) stop: StopReason,
    /// Their power cells, where the stop needed them.
    pub(super) cells: Option<Vec<PowerCell>>,
    /// Number of gap samples for the cells otherwise.
    pub(super) gap_samples: usize,
}

/// Number of gap samples for the cells of `spheres` balls.
pub(super) fn gap_samples(options: &PackOptions, spheres: usize) -> usize {
    options.samples_per_sphere.saturating_mul(spheres).max(FEWEST_SAMPLES)
}

/// Places balls until a stop of `options` or the watch ends it.
pub(super) fn place(
    solid: &Solid,
    options: &PackOptions,
    watch: &Watch,
    reporter: &mut Reporter,
) -> Result<Placed, PackError> {
    let asked = options.min_radius.unwrap_or(0.0);
    let smallest = asked.max(solid.diagnosis().resolution);
    let negligible = negligible_radius(solid, options);
    let mut stops = Stops {
        solid,
        options,
        watch,
        reporter,
        balls: Vec::new(),
        filled: 0.0,
        time: watch.has_limit().then(TimeStop::new),
        volume: VolumeStop::new(solid, options, watch),
        stop: None,
    };
    let grid = rounds::place(solid, Smallest { radius: smallest, negligible }, watch, |ball| stops.add(ball));
    let Stops { mut balls, volume, stop, time, .. } = stops;
    debug_assert!(balls == grid.balls(), "what was wanted is what was placed");
    let cells = match stop {
        Some(StopReason::VolumeError) => volume.and_then(|volume| volume.settle(&mut balls)),
        _ => None,
    };
    if watch.is_cancelled() {
        return Err(PackError::Cancelled);
    }
    let nothing_left = if smallest <= asked {
        StopReason::MinRadius
    } else if smallest < negligible {
        StopReason::Exhausted
    } else {
        StopReason::Resolution
    };
    let stop = stop.or_else(|| watch.reason()).unwrap_or(nothing_left);
    if balls.is_empty() {
        return Err(match (stop, options.time_limit) {
            (StopReason::Caller, _) => PackError::Cancelled,
            (StopReason::TimeLimit, Some(limit)) => PackError::NothingInTime { limit },
            _ => PackError::NothingFits { smallest },
        });
    }
    let asked = gap_samples(options, balls.len());
    let gap_samples = time.zip(watch.left()).map_or(asked, |(time, left)| time.affordable(asked, left));
    Ok(Placed { balls, stop, cells, gap_samples })
}

/// Radius (m) under which all balls asked for together fill less than [`NEGLIGIBLE`]; 0 where the caller chose a
/// smallest radius. It falls with the count, so that a larger packing still begins with the smaller one.
fn negligible_radius(solid: &Solid, options: &PackOptions) -> f64 {
    if options.min_radius.is_some() {
        return 0.0;
    }
    let volume = NEGLIGIBLE * solid.properties().volume / options.spheres as f64;
    libm::cbrt(volume / (4.0 / 3.0 * PI))
}

/// Balls placed so far, and what may end the placing.
struct Stops<'a, 'r> {
    solid: &'a Solid,
    options: &'a PackOptions,
    watch: &'a Watch<'a>,
    reporter: &'a mut Reporter<'r>,
    balls: Vec<Ball>,
    /// Volume of the balls (m³).
    filled: f64,
    time: Option<TimeStop>,
    volume: Option<VolumeStop<'a>>,
    stop: Option<StopReason>,
}

impl Stops<'_, '_> {
    /// Adds the next ball unless a stop is reached. Stops are looked at once a ball is added: the search for the
    /// next one may be long or find none.
    fn add(&mut self, ball: &Ball) -> bool {
        if self.watch.is_over() {
            return false;
        }
        self.balls.push(*ball);
        self.filled += ball.volume();
        self.stop = self.reached();
        if self.stop.is_some() {
            self.watch.end();
        }
        let count = self.balls.len();
        if count == 1 || count.is_multiple_of(BALLS_PER_PROGRESS) {
            let coverage = self.coverage();
            let share = share_placed(self.options, count, coverage, ball.radius).max(self.watch.share());
            self.reporter.placed(count, coverage, share);
        }
        true
    }

    /// The stop that is reached, if one is.
    fn reached(&mut self) -> Option<StopReason> {
        let coverage = self.coverage();
        if self.balls.len() >= self.options.spheres {
            return Some(StopReason::SphereCount);
        }
        if self.options.coverage.is_some_and(|asked| coverage >= asked) {
            return Some(StopReason::Coverage);
        }
        if self.volume.as_mut().is_some_and(|volume| volume.is_met(&self.balls, coverage)) {
            return Some(StopReason::VolumeError);
        }
        if let Some(time) = &mut self.time {
            time.reserve(self.solid, self.options, &self.balls, self.watch);
        }
        self.watch.reason()
    }

    fn coverage(&self) -> f64 {
        self.filled / self.solid.properties().volume
    }
}
