//! The replay that users see.

use super::builder::Builder;
use super::container::{begins_as_mcap, walk};
use super::interpolate::interpolate;
use super::timeline::Timeline;
use super::{ReplayBody, ReplayContact, ReplayEnd, ReplayError, ReplayMetrics};
use crate::record::UpAxis;
use rapier3d::math::{Pose, Real};
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

/// A recording, read back.
#[derive(Clone, Debug)]
pub struct Replay {
    pub(super) bodies: Vec<ReplayBody>,
    pub(super) body_indices: HashMap<String, usize>,
    pub(super) timeline: Timeline,
    pub(super) metadata: BTreeMap<String, BTreeMap<String, String>>,
    pub(super) log: Vec<LogLine>,
    pub(super) up: UpAxis,
    pub(super) defects: Vec<String>,
    pub(super) end: ReplayEnd,
}

/// A line of the recording's log.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LogLine {
    /// Since the start (s).
    pub time: f64,
    /// Whether it tells of something that went wrong.
    pub is_error: bool,
    /// What it says.
    pub message: String,
}

/// One recorded step.
#[derive(Clone, Copy, Debug)]
pub struct ReplayStep<'a> {
    replay: &'a Replay,
    index: usize,
}

impl Replay {
    /// Reads the recording at `path`.
    ///
    /// # Errors
    /// [`ReplayError`] with the path, where it cannot be read or is no MCAP file. A file that is cut off or damaged is
    /// no error: see [`Self::end`].
    pub fn open(path: impl AsRef<Path>) -> Result<Self, ReplayError> {
        let path = path.as_ref();
        let bytes = std::fs::read(path).map_err(|source| ReplayError::Read { path: path.into(), source })?;
        Self::read(&bytes, &path.display().to_string())
    }

    /// Reads a recording from memory.
    ///
    /// # Errors
    /// [`ReplayError::NotMcap`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ReplayError> {
        Self::read(bytes, "the given data")
    }

    fn read(bytes: &[u8], origin: &str) -> Result<Self, ReplayError> {
        if !begins_as_mcap(bytes) {
            return Err(ReplayError::NotMcap { origin: origin.to_owned() });
        }
        let mut builder = Builder::default();
        let end = walk(bytes, |record| builder.add(record));
        Ok(builder.finish(end))
    }

    /// The bodies, in the order in which the file first names them.
    #[must_use]
    pub fn bodies(&self) -> &[ReplayBody] {
        &self.bodies
    }

    /// Place of the body called `name` in [`Self::bodies`]. O(1).
    #[must_use]
    pub fn body_index(&self, name: &str) -> Option<usize> {
        self.body_indices.get(name).copied()
    }

    /// Number of recorded steps; the poses before the first step count as one.
    #[must_use]
    pub fn step_count(&self) -> usize {
        self.timeline.len()
    }

    /// The recorded steps, in order.
    pub fn steps(&self) -> impl DoubleEndedIterator<Item = ReplayStep<'_>> + ExactSizeIterator {
        (0..self.step_count()).map(|index| ReplayStep { replay: self, index })
    }

    /// Step number `index`, counted from 0.
    #[must_use]
    pub fn step(&self, index: usize) -> Option<ReplayStep<'_>> {
        (index < self.step_count()).then_some(ReplayStep { replay: self, index })
    }

    /// Time of the last step (s); 0 without steps.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.steps().next_back().map_or(0.0, |step| step.time())
    }

    /// Pose of body number `body` at `time` (s), between two steps interpolated, before the first step as there and after
    /// the last as there. `None` for a body that is not there at that time, and for a time that is not a number.
    ///
    /// Between a step that has the body and one that has not, it stays where it was. O(log n) in the numbers of steps and
    /// of bodies.
    #[must_use]
    pub fn pose_at(&self, body: usize, time: f64) -> Option<Pose> {
        if time.is_nan() {
            return None;
        }
        let nanoseconds = in_nanoseconds(time);
        let later = self.timeline.steps_until(nanoseconds);
        let earlier = later.saturating_sub(1);
        let from = self.timeline.pose(earlier, body)?;
        let (Some(to), Some(from_time), Some(to_time)) =
            (self.timeline.pose(later, body), self.timeline.time(earlier), self.timeline.time(later))
        else {
            return Some(*from);
        };
        let (from_time, to_time) = (from_time as f64, to_time as f64);
        if to_time <= from_time {
            return Some(*from);
        }
        let share = ((nanoseconds - from_time) / (to_time - from_time)).clamp(0.0, 1.0);
        Some(if share == 0.0 { *from } else { interpolate(from, to, share as Real) })
    }

    /// The last step that is not later than `time` (s); the first one for earlier times, `None` without steps and for a
    /// time that is not a number.
    #[must_use]
    pub fn step_at(&self, time: f64) -> Option<ReplayStep<'_>> {
        let until = self.timeline.steps_until(in_nanoseconds(time));
        if time.is_nan() { None } else { self.step(until.saturating_sub(1)) }
    }

    /// The metadata records of the file by name: `recording` with versions and what
    /// [`RecordOptions::metadata`](crate::record::RecordOptions::metadata) was given, `simulation` with time step and
    /// gravity.
    #[must_use]
    pub fn metadata(&self) -> &BTreeMap<String, BTreeMap<String, String>> {
        &self.metadata
    }

    /// The value of `key` in the first metadata record that has it.
    #[must_use]
    pub fn parameter(&self, key: &str) -> Option<&str> {
        self.metadata.values().find_map(|record| record.get(key)).map(String::as_str)
    }

    /// The lines of the log, in order.
    #[must_use]
    pub fn log(&self) -> &[LogLine] {
        &self.log
    }

    /// The direction that is up.
    #[must_use]
    pub fn up(&self) -> UpAxis {
        self.up
    }

    /// What was left out because it could not be understood, message by message; empty for what a recorder wrote.
    #[must_use]
    pub fn defects(&self) -> &[String] {
        &self.defects
    }

    /// How far the recording goes.
    #[must_use]
    pub fn end(&self) -> &ReplayEnd {
        &self.end
    }
}

/// Seconds in nanoseconds; whole ones where rounding cannot tell them apart, so that the time of a step is that of the step: for
/// 26 days.
///
/// A whole number of nanoseconds is rounded twice on its way to seconds and back.
fn in_nanoseconds(time: f64) -> f64 {
    let product = time * 1e9;
    let whole = product.round();
    if (product - whole).abs() <= f64::EPSILON * whole.abs() { whole } else { product }
}

impl<'a> ReplayStep<'a> {
    /// Its place among the recorded steps, from 0.
    #[must_use]
    pub fn index(&self) -> usize {
        self.index
    }

    /// Time since the start of the recording (s).
    #[must_use]
    pub fn time(&self) -> f64 {
        self.nanoseconds() as f64 / 1e9
    }

    /// Time since the start of the recording (ns).
    #[must_use]
    pub fn nanoseconds(&self) -> u64 {
        self.replay.timeline.time(self.index).unwrap_or(0)
    }

    /// Pose of body number `body`; `None` where it is not in the world. O(log n).
    #[must_use]
    pub fn pose(&self, body: usize) -> Option<Pose> {
        self.replay.timeline.pose(self.index, body).copied()
    }

    /// All bodies that are in the world, by their places in [`Replay::bodies`], with their poses.
    pub fn poses(&self) -> impl ExactSizeIterator<Item = (usize, Pose)> + use<'a> {
        self.replay.timeline.poses(self.index).iter().map(|(body, pose)| (*body as usize, *pose))
    }

    /// The contacts; none where contacts were not recorded.
    #[must_use]
    pub fn contacts(&self) -> &'a [ReplayContact] {
        self.replay.timeline.contacts(self.index)
    }

    /// Energies and overlaps of the world; `None` where contacts were not recorded, and before the first step.
    #[must_use]
    pub fn metrics(&self) -> Option<&'a ReplayMetrics> {
        self.replay.timeline.metrics(self.index)
    }
}

#[cfg(test)]
mod tests {
    use super::in_nanoseconds;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(100_000))]

        /// A step was not found by its own time: the one before it was.
        #[test]
        fn issue_seconds_of_whole_nanoseconds_are_those(
            bits in 0_u32..51, number in 0_u64..1 << 51, share in 0.01_f64..0.99,
        ) {
            let whole = (number >> bits) as f64;
            prop_assert_eq!(in_nanoseconds(whole / 1e9), whole);
            // And what lies between two of them stays there.
            let between = in_nanoseconds((whole.min(1e9) + share) / 1e9);
            prop_assert!(whole.min(1e9) < between && between < whole.min(1e9) + 1.0);
        }
    }
}
