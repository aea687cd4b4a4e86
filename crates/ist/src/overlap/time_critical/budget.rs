//! When a time-critical query has to stop.

/// How much work a query may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Budget {
    /// So many visits of pairs of nodes; a visit tests the children of one against those of the other, some dozens of
    /// nanoseconds. The same input gives the same result on every machine.
    Visits(u32),
    /// So much wall time, of the call as a whole. The clock is read before each step of about a microsecond, and a
    /// step that would probably end too late is not begun. Needs a platform with a clock.
    Time(core::time::Duration),
}

/// Keeps a budget.
#[derive(Debug)]
pub(super) struct Meter {
    budget: Budget,
    visits: u32,
    clock: Clock,
}

impl Meter {
    /// Starts the clock, if the budget has one.
    pub(super) fn new(budget: Budget) -> Self {
        Self { budget, visits: 0, clock: Clock::new(budget) }
    }

    /// Visits made.
    pub(super) fn visits(&self) -> u32 {
        self.visits
    }

    /// Whether `count` more visits fit; if so, they are counted as made.
    #[inline]
    pub(super) fn spend(&mut self, count: u32) -> bool {
        let fits = match self.budget {
            Budget::Visits(most) => count <= most - self.visits,
            Budget::Time(most) => self.clock.has_time_for(count, self.visits, most),
        };
        if fits {
            self.visits += count;
        }
        fits
    }
}

/// The time that a query has taken.
#[derive(Debug)]
struct Clock {
    start: Option<std::time::Instant>,
    /// Nanoseconds at the last reading.
    elapsed: u64,
    /// Visits at the last reading.
    visits: u32,
}

impl Clock {
    /// Reads the clock only where time is limited: there are platforms without one.
    fn new(budget: Budget) -> Self {
        let start = matches!(budget, Budget::Time(_)).then(std::time::Instant::now);
        Self { start, elapsed: 0, visits: 0 }
    }

    /// Whether `count` visits more would end before `most`, at the pace of the last step. Of what interrupted that step
    /// a part only is expected to come again: its pace counts up to four times the mean.
    #[inline]
    fn has_time_for(&mut self, count: u32, visits: u32, most: core::time::Duration) -> bool {
        let elapsed = self.start.map_or(0, |start| nanoseconds(start.elapsed()));
        let pace = |nanoseconds: u64, visits: u32| nanoseconds as f32 / visits.max(1) as f32;
        let mean = pace(elapsed, visits);
        let last = pace(elapsed - self.elapsed, visits - self.visits);
        let expected = count as f32 * last.clamp(mean, 4.0 * mean);
        (self.elapsed, self.visits) = (elapsed, visits);
        elapsed.saturating_add(expected as u64) <= nanoseconds(most)
    }
}

/// As many as a number of 64 bits holds: 584 years.
fn nanoseconds(duration: core::time::Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}
