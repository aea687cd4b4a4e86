//! Soft shadows of the key light from a map of depths.

use super::buffer::Grid;
use super::camera::{Parallel, View};
use super::raster::draw;
use super::scene::Scene;
use glam::{Vec2, Vec3};
use std::ops::Range;

/// Samples along each side of the map: at 2048 the edges of shadows stay clean in a 720-line picture.
const SIZE: usize = 2048;
/// Radius of the half-shadow at an edge, relative to the radius of the scene.
const SOFTNESS: f32 = 0.012;
/// Look-ups per point; with four points a pixel, 32 levels.
const TAPS: usize = 8;
/// Points per pixel, which share one pattern.
const PHASES: usize = 4;
/// The golden angle (rad), which spreads points evenly over a disc (Vogel 1979).
const GOLDEN_ANGLE: f32 = 2.399_963;

/// What the key light reaches.
pub(super) struct Shadow {
    view: Parallel,
    map: Grid<f32>,
    /// Pattern of the look-ups in samples of the map.
    pattern: [[Vec2; TAPS]; PHASES],
    /// How far points are lifted off their surface before they are looked up (m).
    lift: f32,
}

impl Shadow {
    /// Lights the scene along `direction` (unit).
    pub(super) fn new(scene: &Scene, direction: Vec3) -> Self {
        let (center, radius) = scene.extent();
        let view = Parallel::new(center, radius * 1.01, direction, SIZE);
        let mut map = Grid::new(SIZE, SIZE);
        draw(scene, &view, &mut map);
        let reach = SOFTNESS * radius;
        let pattern = std::array::from_fn(|phase| {
            std::array::from_fn(|tap| {
                let index = (PHASES * tap + phase) as f32;
                let distance = ((index + 0.5) / (PHASES * TAPS) as f32).sqrt() * reach * view.scale();
                Vec2::from_angle(GOLDEN_ANGLE * index) * distance
            })
        });
        Self { pattern, lift: 0.6 * reach, view, map }
    }

    /// Share of the key light that reaches a point with normal `normal`, 0 to 1, from the look-ups of some phases.
    pub(super) fn light(&self, point: Vec3, normal: Vec3, phases: Range<usize>) -> f32 {
        let Some(place) = self.view.project(point + normal * self.lift) else { return 1.0 };
        let (mut lit, mut looked) = (0, 0);
        for pattern in &self.pattern[phases] {
            lit += pattern.iter().filter(|&&offset| self.reaches(place, offset)).count();
            looked += TAPS;
            // Each phase covers the whole disc. One that finds all lit or all dark need not be refined, and most
            // do.
            if lit == 0 || lit == looked {
                break;
            }
        }
        lit as f32 / looked.max(1) as f32
    }

    /// Whether light passes beside a place of the map.
    fn reaches(&self, place: Vec3, offset: Vec2) -> bool {
        let (column, row) = (place.x + offset.x, place.y + offset.y);
        if column < 0.0 || row < 0.0 || column >= SIZE as f32 || row >= SIZE as f32 {
            return true;
        }
        self.map.samples[row as usize * SIZE + column as usize] <= place.z + self.lift
    }
}
