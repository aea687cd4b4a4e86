//! When a time-critical query has to stop.

use core::time::Duration;

/// How much work a query may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Budget {
    /// So many visits of pairs of nodes; a visit tests the children of one against those of the other, some dozens of
    /// nanoseconds. The same input gives the same result on every machine.
    Visits(u32),
    /// So much wall time, of the call as a whole. The query ends after about nine tenths of it, leaving out what it has begun:
    /// the rest is for a processor whose caches are cold. Needs a platform with a clock.
    Time(Duration),
}

/// The clock is read again after as much work as this part of the time that is left would take: rarely far from the end, often
/// near it. A reading takes 25 ns.
const APPROACH: u64 = 4;

/// Part of the time that is left for what follows the last reading: the work up to where the next would have been, 0.1 to
/// 1 µs, and sums over what is still open. Most queries end within nine tenths of their time.
pub(super) const RESERVE: u32 = 10;

/// Keeps a budget.
#[derive(Debug)]
pub(super) struct Meter {
    /// Visits that are left.
    left: u32,
    visits: u32,
    /// Units of work done, and at which the clock is read next: not before the first [`Self::spend`], as there must be a part to
    /// estimate.
    work: u64,
    next_reading: u64,
    clock: Clock,
    /// When to end (ns), by the clock.
    end: u64,
}

/// What tells the time.
#[derive(Debug)]
enum Clock {
    /// Time has no limit; there are platforms without a clock.
    None,
    /// Since the query began.
    Wall(std::time::Instant),
    /// Tests: a nanosecond per unit of work.
    #[cfg(test)]
    Work,
}

impl Meter {
    /// Units of work of estimating the lenses of eight pairs of nodes; testing eight pairs of balls is one.
    pub(super) const LENS: u32 = 8;

    /// Starts the clock, if the budget has one.
    pub(super) fn new(budget: Budget) -> Self {
        let (left, clock, end) = match budget {
            Budget::Visits(most) => (most, Clock::None, u64::MAX),
            Budget::Time(most) => {
                (u32::MAX, Clock::Wall(std::time::Instant::now()), nanoseconds(most - most / RESERVE))
            }
        };
        Self { left, visits: 0, work: 0, next_reading: u64::MAX, clock, end }
    }

    /// For tests: time is what [`Self::work`] counts.
    #[cfg(test)]
    pub(super) fn of_work(budget: Duration) -> Self {
        Self { clock: Clock::Work, ..Self::new(Budget::Time(budget)) }
    }

    /// Units of work done.
    #[cfg(test)]
    pub(super) fn done(&self) -> u64 {
        self.work
    }

    /// Visits made.
    pub(super) fn visits(&self) -> u32 {
        self.visits
    }

    /// Whether `count` more visits fit; if so, they are counted as made.
    #[inline]
    pub(super) fn spend(&mut self, count: u32) -> bool {
        let fits = count <= self.left && !self.is_late();
        if fits {
            self.visits += count;
            self.left -= count;
        }
        fits
    }

    /// Counts `units` of work. Whether the time is over: then the caller stops, and leaves out what it has begun.
    #[inline]
    pub(super) fn work(&mut self, units: usize) -> bool {
        self.work += units as u64;
        self.work >= self.next_reading && self.is_late()
    }

    /// Reads the clock. A call, for the vectors of a caller to stay where they are while the clock is not read.
    #[cold]
    #[inline(never)]
    fn is_late(&mut self) -> bool {
        let elapsed = match &self.clock {
            Clock::None => return false,
            Clock::Wall(start) => nanoseconds(start.elapsed()),
            #[cfg(test)]
            Clock::Work => self.work,
        };
        let Some(left) = self.end.checked_sub(elapsed) else { return true };
        // At the pace so far.
        let units = u128::from(left / APPROACH) * u128::from(self.work) / u128::from(elapsed.max(1));
        let units = u64::try_from(units).unwrap_or(u64::MAX).max(u64::from(Self::LENS));
        self.next_reading = self.work.saturating_add(units);
        left == 0
    }
}

/// As many as a number of 64 bits holds: 584 years.
fn nanoseconds(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}
