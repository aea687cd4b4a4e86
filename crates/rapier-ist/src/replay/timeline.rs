//! Poses and contacts of all steps, one list each.

use super::{ReplayContact, ReplayMetrics};
use rapier3d::math::Pose;
use std::ops::Range;

/// All steps, in the order of the file.
#[derive(Clone, Debug, Default)]
pub(super) struct Timeline {
    steps: Vec<StepRecord>,
    /// Bodies and their poses, step after step, sorted by body within a step.
    poses: Vec<(u32, Pose)>,
    contacts: Vec<ReplayContact>,
}

/// Where a step's part of the lists is.
#[derive(Clone, Debug)]
struct StepRecord {
    /// Since the start (ns).
    time: u64,
    poses: Range<usize>,
    contacts: Range<usize>,
    metrics: Option<ReplayMetrics>,
}

impl Timeline {
    /// Begins a step at `time` (ns). A time that lies before the last one counts as that.
    pub(super) fn begin_step(&mut self, time: u64, mut poses: Vec<(u32, Pose)>) {
        poses.sort_by_key(|(body, _)| *body);
        poses.dedup_by_key(|(body, _)| *body);
        let begin = self.poses.len();
        self.poses.append(&mut poses);
        let contacts = self.contacts.len()..self.contacts.len();
        let time = self.steps.last().map_or(time, |last| last.time.max(time));
        self.steps.push(StepRecord { time, poses: begin..self.poses.len(), contacts, metrics: None });
    }

    /// Adds contacts to the last step if `time` (ns) is its.
    pub(super) fn add_contacts(&mut self, time: u64, contacts: impl Iterator<Item = ReplayContact>) {
        if let Some(step) = self.steps.last_mut().filter(|step| step.time == time) {
            self.contacts.extend(contacts);
            step.contacts.end = self.contacts.len();
        }
    }

    /// Adds figures to the last step if `time` (ns) is its.
    pub(super) fn add_metrics(&mut self, time: u64, metrics: ReplayMetrics) {
        if let Some(step) = self.steps.last_mut().filter(|step| step.time == time) {
            step.metrics = Some(metrics);
        }
    }

    pub(super) fn len(&self) -> usize {
        self.steps.len()
    }

    /// Time of a step (ns).
    pub(super) fn time(&self, step: usize) -> Option<u64> {
        self.steps.get(step).map(|step| step.time)
    }

    pub(super) fn poses(&self, step: usize) -> &[(u32, Pose)] {
        self.steps.get(step).and_then(|step| self.poses.get(step.poses.clone())).unwrap_or_default()
    }

    /// Pose of a body at a step; `None` where it is not in the world. O(log n) in the number of bodies.
    pub(super) fn pose(&self, step: usize, body: usize) -> Option<&Pose> {
        let poses = self.poses(step);
        let place = poses.binary_search_by_key(&body, |(body, _)| *body as usize).ok()?;
        poses.get(place).map(|(_, pose)| pose)
    }

    pub(super) fn contacts(&self, step: usize) -> &[ReplayContact] {
        self.steps.get(step).and_then(|step| self.contacts.get(step.contacts.clone())).unwrap_or_default()
    }

    pub(super) fn metrics(&self, step: usize) -> Option<&ReplayMetrics> {
        self.steps.get(step)?.metrics.as_ref()
    }

    /// Number of steps that are not later than `time` (ns). O(log n).
    pub(super) fn steps_until(&self, time: f64) -> usize {
        self.steps.partition_point(|step| step.time as f64 <= time)
    }
}
