//! Soft shadows of the key light from a map of depths.

use super::buffer::Grid;
use super::camera::{Parallel, View};
use super::raster::draw;
use super::scene::Scene;
use glam::{Vec2, Vec3};

/// Samples along each side of the map: at 2048 the edges of shadows stay clean in a 720-line picture.
const SIZE: usize = 2048;
/// Radius of the half-shadow at an edge, relative to the radius of the scene.
const SOFTNESS: f32 = 0.012;
/// Look-ups per point: levels of the half-shadow.
const TAPS: usize = 24;
/// Look-ups that come first: where they agree, the others are left out.
const PROBES: usize = 8;
/// Order of the look-ups, coprime to their number: the probes spread over the whole disc. Probing the rim alone
/// makes speckles of lit spots that are smaller than the disc.
const STRIDE: usize = 7;
/// The golden angle (rad), which spreads points evenly over a disc (Vogel 1979).
const GOLDEN_ANGLE: f32 = 2.399_963;

/// What the key light reaches.
pub(super) struct Shadow {
    view: Parallel,
    map: Grid<f32>,
    /// Pattern of the look-ups in samples of the map.
    pattern: [Vec2; TAPS],
    /// How far points are lifted off their surface before they are looked up (m).
    lift: f32,
}

impl Shadow {
    /// Lights the scene along `direction` (unit).
    ///
    /// The map's rows follow `across`, the rows of the picture: neighbouring pixels then look up neighbouring
    /// places, which saves a third of the shading.
    pub(super) fn new(scene: &Scene, direction: Vec3, across: Vec3) -> Self {
        let (center, radius) = scene.extent();
        let view = Parallel::new((center, radius * 1.01), direction, across, SIZE);
        let mut map = Grid::new(SIZE, SIZE);
        draw(scene, &view, &mut map);
        let reach = SOFTNESS * radius;
        let pattern = std::array::from_fn(|tap| {
            let index = ((TAPS - 1 + STRIDE * tap) % TAPS) as f32;
            let distance = ((index + 0.5) / TAPS as f32).sqrt() * reach * view.scale();
            Vec2::from_angle(GOLDEN_ANGLE * index) * distance
        });
        Self { pattern, lift: 0.6 * reach, view, map }
    }

    /// Share of the key light that reaches a point with normal `normal`, 0 to 1.
    pub(super) fn light(&self, point: Vec3, normal: Vec3) -> f32 {
        let Some(place) = self.view.project(point + normal * self.lift) else { return 1.0 };
        let lit = |taps: &[Vec2]| taps.iter().filter(|&&offset| self.reaches(place, offset)).count();
        let (probes, others) = self.pattern.split_at(PROBES);
        match lit(probes) {
            0 => 0.0,
            PROBES => 1.0,
            some => (some + lit(others)) as f32 / TAPS as f32,
        }
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
