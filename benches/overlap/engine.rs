//! What is compared.

use glam::Vec3;
use glamx::Pose3;

/// A way to ask how two solids overlap; the answer of the last query is kept, as a caller would keep it.
pub(crate) trait Engine {
    /// Name in reports.
    fn name(&self) -> &str;

    /// Seconds that it took to prepare both solids from their meshes.
    fn build_seconds(&self) -> f64;

    /// Forgets the poses so far: the next one has nothing to do with them.
    fn jump(&mut self) {}

    /// Asks about B at `pose` in A's frame: this is what is timed.
    fn query(&mut self, pose: &Pose3);

    /// What the last query found.
    fn answer(&self) -> Answer;
}

/// What all engines can be compared by.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Answer {
    /// Overlap volume (m³), from engines that know it.
    pub(crate) volume: Option<f64>,
    /// Direction in which B is pushed, of any length; zero where nothing touches.
    pub(crate) push: Vec3,
    /// Overlapping pairs of spheres, from engines that look for them.
    pub(crate) pairs: Option<u32>,
}
