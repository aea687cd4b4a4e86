//! Grids of samples: what is seen at each place.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// A grid, rows from top to bottom.
pub(super) struct Grid<S> {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) samples: Vec<S>,
}

impl<S: Sample> Grid<S> {
    pub(super) fn new(width: usize, height: usize) -> Self {
        // In parallel, since the first touch of fresh memory is what takes the time.
        let samples = rayon::iter::repeat_n(S::EMPTY, width * height).collect();
        Self { width, height, samples }
    }
}

/// Where in the grid a sample is taken.
///
/// Not in the middle of its cell: in each block of 2 × 2 cells the four places have four columns and four rows of
/// their own (a rotated grid), so that edges along the axes get five shades instead of three.
pub(super) fn place(column: usize, row: usize) -> Vec2 {
    let shift = Vec2::new([0.75, 0.25][row % 2], [0.25, 0.75][column % 2]);
    Vec2::new(column as f32, row as f32) + shift
}

/// What a grid keeps of the nearest thing at a place.
pub(super) trait Sample: Copy + Send + Sync {
    /// Nothing there.
    const EMPTY: Self;
    /// See [`View`](super::camera::View); the nearest wins.
    fn nearness(&self) -> f32;
    fn new(nearness: f32, fragment: impl FnOnce() -> Fragment) -> Self;
}

/// A piece of a thing.
pub(super) struct Fragment {
    pub(super) normal: Vec3,
    pub(super) surface: u32,
    /// Seen from inside.
    pub(super) back: bool,
}

/// The light needs to know only how far it reaches.
impl Sample for f32 {
    const EMPTY: Self = f32::NEG_INFINITY;

    fn nearness(&self) -> f32 {
        *self
    }

    fn new(nearness: f32, _: impl FnOnce() -> Fragment) -> Self {
        nearness
    }
}

/// What the camera sees at a place, in 16 bytes: four million of them make a picture.
#[derive(Clone, Copy)]
pub(super) struct Seen {
    pub(super) nearness: f32,
    /// Components times [`NORMAL_SCALE`].
    normal: [i16; 3],
    pub(super) back: bool,
    pub(super) surface: u32,
}

const NORMAL_SCALE: f32 = 32_000.0;
/// About 3°, less than shows in the shading.
const MAX_BEND: i32 = 1_600;

impl Seen {
    pub(super) const NOTHING: u32 = u32::MAX;
    pub(super) const GROUND: u32 = u32::MAX - 1;

    pub(super) fn normal(&self) -> Vec3 {
        Vec3::from(self.normal.map(|component| f32::from(component) / NORMAL_SCALE))
    }

    /// Whether `other`, next to it, belongs to the same smooth piece of surface.
    pub(super) fn continues_in(&self, other: &Self) -> bool {
        let bent = |k: usize| (i32::from(self.normal[k]) - i32::from(other.normal[k])).abs() > MAX_BEND;
        self.surface == other.surface
            && (self.nearness - other.nearness).abs() <= 0.01 * self.nearness
            && !(0..3).any(bent)
    }
}

impl Sample for Seen {
    const EMPTY: Self = Self { nearness: 0.0, normal: [0; 3], back: false, surface: Self::NOTHING };

    fn nearness(&self) -> f32 {
        self.nearness
    }

    fn new(nearness: f32, fragment: impl FnOnce() -> Fragment) -> Self {
        let Fragment { normal, surface, back } = fragment();
        let normal = normal.to_array().map(|component| (component * NORMAL_SCALE) as i16);
        Self { nearness, normal, back, surface }
    }
}
