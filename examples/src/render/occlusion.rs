//! Ambient occlusion from the depths that the camera sees.
//!
//! After M. McGuire, M. Mara and D. Luebke, *Scalable Ambient Obscurance* (HPG 2012): points around a pixel darken
//! it by how much they rise over its tangent plane, less so the farther away they are. Departures: no depth
//! pyramid, since the scenes are small, and a plain depth-aware box as the filter.

use super::buffer::{Grid, Seen, place};
use super::camera::Perspective;
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::f32::consts::TAU;

/// Look-ups per known pixel; a block of 4 × 4 of them, smoothed together, has sixteen times as many.
const TAPS: usize = 10;
const BLOCK: usize = 4;
/// Occlusion varies slowly: every second pixel of every second row is looked at, the others take the mean around.
const SPARSE: usize = 2;
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
    let pixels = Pixels::new(grid, view, factor, REACH * scene_radius);
    let (columns, rows) = (pixels.width.div_ceil(SPARSE), pixels.height.div_ceil(SPARSE));
    let raw = fill(columns, rows, |column, row| pixels.visibility(column * SPARSE, row * SPARSE));
    fill(pixels.width, pixels.height, |column, row| pixels.smoothed(&raw, column, row))
}

/// A value for every place of a grid, row by row.
fn fill(width: usize, height: usize, value: impl Fn(usize, usize) -> f32 + Sync) -> Vec<f32> {
    let mut values = vec![0.0; width * height];
    values.par_chunks_mut(width.max(1)).enumerate().for_each(|(row, values)| {
        values.iter_mut().enumerate().for_each(|(column, slot)| *slot = value(column, row));
    });
    values
}

struct Pixels<'a> {
    grid: &'a Grid<Seen>,
    view: &'a Perspective,
    factor: usize,
    width: usize,
    height: usize,
    reach: f32,
    /// Nearness of each pixel, apart from what else is known of it so that it stays in the cache.
    nearness: Vec<f32>,
    /// Look-ups of each pixel of a block, on the unit disc.
    spirals: Vec<[Vec2; TAPS]>,
}

impl<'a> Pixels<'a> {
    fn new(grid: &'a Grid<Seen>, view: &'a Perspective, factor: usize, reach: f32) -> Self {
        // Each pixel of a block turns the spiral by another sixteenth.
        let spiral = |index: usize| {
            let turn = TAU * ((index * 7) % (BLOCK * BLOCK)) as f32 / (BLOCK * BLOCK) as f32;
            std::array::from_fn(|tap| {
                let share = (tap as f32 + 0.5) / TAPS as f32;
                Vec2::from_angle(turn + share * TURNS * TAU) * share
            })
        };
        let (width, height) = (grid.width / factor, grid.height / factor);
        let mut pixels = Self {
            grid,
            view,
            factor,
            width,
            height,
            reach,
            nearness: Vec::new(),
            spirals: (0..BLOCK * BLOCK).map(spiral).collect(),
        };
        pixels.nearness = fill(width, height, |column, row| pixels.seen(column, row).nearness);
        pixels
    }

    fn seen(&self, column: usize, row: usize) -> &Seen {
        &self.grid.samples[row * self.factor * self.grid.width + column * self.factor]
    }

    /// The point that a pixel shows, if any.
    fn point(&self, column: usize, row: usize) -> Option<Vec3> {
        let nearness = self.nearness[row * self.width + column];
        let place = place(column * self.factor, row * self.factor);
        (nearness > 0.0).then(|| self.view.point(place, nearness))
    }

    fn visibility(&self, column: usize, row: usize) -> f32 {
        let Some(point) = self.point(column, row) else { return 1.0 };
        let seen = self.seen(column, row);
        let normal = seen.normal();
        let spread = self.view.samples(self.reach, seen.nearness) / self.factor as f32;
        let mut sum = 0.0;
        for offset in &self.spirals[column / SPARSE % BLOCK + row / SPARSE % BLOCK * BLOCK] {
            let (x, y) = (column as f32 + offset.x * spread, row as f32 + offset.y * spread);
            if x < 0.0 || y < 0.0 || x >= self.width as f32 || y >= self.height as f32 {
                continue;
            }
            if let Some(other) = self.point(x as usize, y as usize) {
                sum += obscurance(other - point, normal, self.reach);
            }
        }
        (1.0 - STRENGTH * sum / TAPS as f32).max(0.0)
    }

    /// Mean over the block of known pixels around this one that lie at about the same depth.
    fn smoothed(&self, raw: &[f32], column: usize, row: usize) -> f32 {
        let own = self.nearness[row * self.width + column];
        if own <= 0.0 {
            return 1.0;
        }
        let (columns, rows) = (self.width.div_ceil(SPARSE), self.height.div_ceil(SPARSE));
        let around = |middle: usize, count: usize| {
            let first = (middle / SPARSE + 1).saturating_sub(BLOCK / 2);
            first..(first + BLOCK).min(count)
        };
        let (mut sum, mut count) = (0.0, 0.0);
        for y in around(row, rows) {
            for x in around(column, columns) {
                let nearness = self.nearness[y * SPARSE * self.width + x * SPARSE];
                if (nearness - own).abs() <= SAME_DEPTH * own {
                    sum += raw[y * columns + x];
                    count += 1.0;
                }
            }
        }
        // A thing too thin to hold a known pixel gets a value of its own.
        if count > 0.0 { sum / count } else { self.visibility(column, row) }
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
