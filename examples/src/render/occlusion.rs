//! Ambient occlusion from the depths that the camera sees.
//!
//! After M. McGuire, M. Mara and D. Luebke, *Scalable Ambient Obscurance* (HPG 2012): points around a pixel darken
//! it by how much they rise over its tangent plane, less so the farther away they are. Departures: no depth
//! pyramid, since the scenes are small, and a plain depth-aware box as the filter.

use super::buffer::{Grid, Seen};
use super::camera::Perspective;
use glam::Vec3;
use rayon::prelude::*;
use std::f32::consts::TAU;

/// Look-ups per pixel; a block of 4 × 4 pixels, smoothed together, has sixteen times as many.
const TAPS: usize = 10;
const BLOCK: usize = 4;
/// Turns of the spiral of look-ups: coprime to their number, as the paper asks for.
const TURNS: f32 = 7.0;
/// Radius of the neighbourhood, relative to the radius of the scene.
const REACH: f32 = 0.14;
/// Darkening by a neighbourhood, tuned by eye on rings in a bowl.
const STRENGTH: f32 = 1.5;
/// Neighbours whose depths differ by more than this share lie on different things.
const SAME_DEPTH: f32 = 0.02;

/// Share of the ambient light that reaches each pixel, 0 to 1, row by row. `grid` has `factor` samples a pixel
/// along each side.
pub(super) fn ambient(grid: &Grid<Seen>, view: &Perspective, factor: usize, scene_radius: f32) -> Vec<f32> {
    let (width, height) = (grid.width / factor, grid.height / factor);
    let pixels = Pixels { grid, view, factor, reach: REACH * scene_radius };
    let mut raw = vec![1.0; width * height];
    raw.par_chunks_mut(width.max(1)).enumerate().for_each(|(row, values)| {
        for (column, value) in values.iter_mut().enumerate() {
            *value = pixels.visibility(column, row);
        }
    });
    let mut smooth = vec![1.0; width * height];
    smooth.par_chunks_mut(width.max(1)).enumerate().for_each(|(row, values)| {
        for (column, value) in values.iter_mut().enumerate() {
            *value = pixels.smoothed(&raw, column, row);
        }
    });
    smooth
}

struct Pixels<'a> {
    grid: &'a Grid<Seen>,
    view: &'a Perspective,
    factor: usize,
    reach: f32,
}

impl Pixels<'_> {
    fn seen(&self, column: usize, row: usize) -> &Seen {
        &self.grid.samples[row * self.factor * self.grid.width + column * self.factor]
    }

    fn point(&self, column: usize, row: usize, seen: &Seen) -> Vec3 {
        let middle = |index: usize| (index * self.factor) as f32 + 0.5;
        self.view.point(middle(column), middle(row), seen.nearness)
    }

    fn visibility(&self, column: usize, row: usize) -> f32 {
        let seen = self.seen(column, row);
        if seen.surface == Seen::NOTHING {
            return 1.0;
        }
        let (point, normal) = (self.point(column, row, seen), seen.normal());
        let spread = self.view.samples(self.reach, seen.nearness) / self.factor as f32;
        // Each pixel of a block turns the spiral by another sixteenth.
        let turn = TAU * (((column % BLOCK) * 7 + (row % BLOCK) * 4) % 16) as f32 / 16.0;
        let (width, height) = (self.grid.width / self.factor, self.grid.height / self.factor);
        let mut sum = 0.0;
        for tap in 0..TAPS {
            let share = (tap as f32 + 0.5) / TAPS as f32;
            let (sin, cos) = (turn + share * TURNS * TAU).sin_cos();
            let x = column as f32 + cos * share * spread;
            let y = row as f32 + sin * share * spread;
            if x < 0.0 || y < 0.0 || x >= width as f32 || y >= height as f32 {
                continue;
            }
            let (x, y) = (x as usize, y as usize);
            let other = self.seen(x, y);
            if other.surface != Seen::NOTHING {
                sum += obscurance(self.point(x, y, other) - point, normal, self.reach);
            }
        }
        (1.0 - STRENGTH * sum / TAPS as f32).max(0.0)
    }

    /// Mean over a block of pixels at about the same depth.
    fn smoothed(&self, raw: &[f32], column: usize, row: usize) -> f32 {
        let (width, height) = (self.grid.width / self.factor, self.grid.height / self.factor);
        let own = self.seen(column, row).nearness;
        let (mut sum, mut count) = (0.0, 0.0);
        for y in row.saturating_sub(BLOCK / 2)..(row + BLOCK / 2).min(height) {
            for x in column.saturating_sub(BLOCK / 2)..(column + BLOCK / 2).min(width) {
                if (self.seen(x, y).nearness - own).abs() <= SAME_DEPTH * own {
                    sum += raw[y * width + x];
                    count += 1.0;
                }
            }
        }
        if count > 0.0 { sum / count } else { raw[row * width + column] }
    }
}

/// How much a neighbour at `offset` hides of the sky over a point, 0 to about 1.
fn obscurance(offset: Vec3, normal: Vec3, reach: f32) -> f32 {
    let distance_squared = offset.length_squared();
    let falloff = (1.0 - distance_squared / (reach * reach)).max(0.0);
    // What lies in the tangent plane hides nothing, whatever rounding says.
    let rise = (offset.dot(normal) - 0.01 * reach).max(0.0);
    falloff * rise / (distance_squared.sqrt() + 0.01 * reach)
}
