//! Ending the work early: by the caller or by the clock.

use super::{PackError, StopReason};
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Lets the caller end a packing under way, from any thread or from the progress callback.
///
/// Both requests are seen within a fraction of a second while balls are placed and cells are measured, and from then on
/// between the parts of the report. A request stays: use a new
/// signal for the next packing.
///
/// ```
/// use packer::{PackError, PackOptions, Solid, StopSignal, TriangleMesh, pack_interruptible};
/// # use glam::DVec3;
/// # let mesh = TriangleMesh {
/// #     vertices: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
/// #     triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
/// # };
/// let solid = Solid::new(&mesh)?;
/// let signal = StopSignal::new();
/// let packed = std::thread::scope(|scope| {
///     let packing = scope.spawn(|| pack_interruptible(&solid, &PackOptions::fine(), &signal, |_| {}));
///     signal.cancel();
///     packing.join()
/// });
/// assert!(matches!(packed, Ok(Err(PackError::Cancelled))));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct StopSignal {
    request: AtomicU8,
}

const FINISH: u8 = 1;
const CANCEL: u8 = 2;

impl StopSignal {
    /// A signal with nothing requested.
    #[must_use]
    pub const fn new() -> Self {
        Self { request: AtomicU8::new(0) }
    }

    /// Asks for what there is: no further ball is placed, and those placed are returned as a complete packing with
    /// [`StopReason::Caller`].
    pub fn finish(&self) {
        self.request.fetch_max(FINISH, Ordering::Relaxed);
    }

    /// Gives the packing up: the call returns [`PackError::Cancelled`].
    pub fn cancel(&self) {
        self.request.fetch_max(CANCEL, Ordering::Relaxed);
    }

    /// Whether [`Self::cancel`] was called.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.request.load(Ordering::Relaxed) == CANCEL
    }

    fn is_raised(&self) -> bool {
        self.request.load(Ordering::Relaxed) > 0
    }
}

/// Tells long searches when to give up. Once over, it stays over: a search that is cut short anywhere is known to
/// be incomplete afterwards, and nothing it found is placed.
#[derive(Debug)]
pub(super) struct Watch<'a> {
    signal: &'a StopSignal,
    started: Instant,
    limit: Option<Duration>,
    /// When placing has to end, in nanoseconds from the start; it only falls.
    deadline: AtomicU64,
    ended: AtomicBool,
}

impl<'a> Watch<'a> {
    pub(super) fn new(signal: &'a StopSignal, limit: Option<Duration>) -> Self {
        let deadline = AtomicU64::new(limit.map_or(u64::MAX, nanoseconds));
        Self { signal, started: Instant::now(), limit, deadline, ended: AtomicBool::new(false) }
    }

    /// Whether the caller has given the packing up.
    pub(super) fn is_cancelled(&self) -> bool {
        self.signal.is_cancelled()
    }

    /// An error once the caller has given the packing up.
    pub(super) fn go_on(&self) -> Result<(), PackError> {
        if self.is_cancelled() { Err(PackError::Cancelled) } else { Ok(()) }
    }

    /// Whether no further ball is to be placed.
    pub(super) fn is_over(&self) -> bool {
        self.ended.load(Ordering::Relaxed) || self.signal.is_raised() || self.is_late()
    }

    /// Ends the placing: another stop is reached.
    pub(super) fn end(&self) {
        self.ended.store(true, Ordering::Relaxed);
    }

    /// What ended the placing, if the caller or the clock did.
    pub(super) fn reason(&self) -> Option<StopReason> {
        if self.signal.is_raised() {
            Some(StopReason::Caller)
        } else {
            self.is_late().then_some(StopReason::TimeLimit)
        }
    }

    /// Time since the start.
    pub(super) fn elapsed(&self) -> Duration {
        self.started.elapsed()
    }

    /// Whether there is a time limit.
    pub(super) fn has_limit(&self) -> bool {
        self.limit.is_some()
    }

    /// What is left of the time limit, if there is one.
    pub(super) fn left(&self) -> Option<Duration> {
        Some(self.limit?.saturating_sub(self.elapsed()))
    }

    /// Share of the time for placing that is gone; zero without a limit.
    pub(super) fn share(&self) -> f64 {
        let deadline = self.deadline.load(Ordering::Relaxed);
        if deadline == u64::MAX {
            return 0.0;
        }
        (nanoseconds(self.elapsed()) as f64 / deadline.max(1) as f64).min(1.0)
    }

    /// Keeps `time` of the limit for what follows the placing.
    pub(super) fn reserve(&self, time: Duration) {
        if let Some(limit) = self.limit {
            self.deadline.fetch_min(nanoseconds(limit.saturating_sub(time)), Ordering::Relaxed);
        }
    }

    fn is_late(&self) -> bool {
        let deadline = self.deadline.load(Ordering::Relaxed);
        // Without a limit the clock is not read.
        deadline < u64::MAX && nanoseconds(self.elapsed()) >= deadline
    }
}

fn nanoseconds(time: Duration) -> u64 {
    // 584 years fit; the largest number stands for no limit.
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cancelled_signal_stays_cancelled() {
        let signal = StopSignal::new();
        let watch = Watch::new(&signal, None);
        assert!(!watch.is_over() && watch.reason().is_none());
        signal.finish();
        assert!(watch.is_over() && !watch.is_cancelled());
        signal.cancel();
        signal.finish();
        assert!(watch.is_cancelled());
    }

    #[test]
    fn the_deadline_only_falls() {
        let signal = StopSignal::new();
        let watch = Watch::new(&signal, Some(Duration::from_secs(1_000)));
        assert!(!watch.is_over());
        watch.reserve(Duration::from_secs(2_000));
        assert_eq!(watch.reason(), Some(StopReason::TimeLimit));
        watch.reserve(Duration::ZERO);
        assert!(watch.is_over());
        assert!(!Watch::new(&signal, Some(Duration::MAX)).is_over());
    }
}
