//! What is seen at each sample: a depth buffer.

use super::camera::{Camera, FACTOR};
use super::cut::CutPlane;
use super::scene::{Ball, Scene};
use super::{HEIGHT, WIDTH};
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::ops::Range;

/// Columns and rows of samples.
pub(super) const COLUMNS: usize = WIDTH * FACTOR;
pub(super) const ROWS: usize = HEIGHT * FACTOR;
/// Rows that are drawn by one task.
const BAND: usize = 32;
/// Half the width of the line along the section's edge (samples).
const EDGE: f32 = 0.75 * FACTOR as f32;

/// What a line of sight meets first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Seen {
    Nothing,
    /// The round side of a ball.
    Ball(u32),
    /// The face at which the plane cuts a ball.
    Face(u32),
    /// The surface of the solid.
    Surface(u32),
    /// The line at which the plane cuts the surface.
    Edge,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// Depth towards the viewer.
    pub(super) depth: f32,
    pub(super) seen: Seen,
}

/// A shape and the rows of samples that it may cover.
enum Shape {
    Ball(u32),
    Surface(u32),
    Edge([Vec3; 2]),
}

/// Draws all that is behind the plane; samples row by row from the top.
pub(super) fn draw(scene: &Scene, plane: &CutPlane, camera: &Camera) -> Vec<Sample> {
    let bands = bands(scene, plane, camera);
    let mut samples = vec![Sample { depth: f32::NEG_INFINITY, seen: Seen::Nothing }; COLUMNS * ROWS];
    let painter = Painter { scene, plane, camera };
    samples.par_chunks_mut(BAND * COLUMNS).zip(&bands).enumerate().for_each(|(index, (samples, shapes))| {
        let mut band = Band { samples, first_row: index * BAND };
        for shape in shapes {
            match shape {
                Shape::Ball(index) => painter.ball(&mut band, *index),
                Shape::Surface(index) => painter.surface(&mut band, *index),
                Shape::Edge(ends) => painter.edge(&mut band, *ends),
            }
        }
    });
    samples
}

/// The shapes that each band of rows has a part of.
fn bands(scene: &Scene, plane: &CutPlane, camera: &Camera) -> Vec<Vec<Shape>> {
    let mut bands: Vec<Vec<Shape>> = (0..ROWS.div_ceil(BAND)).map(|_| Vec::new()).collect();
    let mut add = |top: f32, bottom: f32, shape: &dyn Fn() -> Shape| {
        let rows = covered(top, bottom, ROWS);
        if !rows.is_empty() {
            bands[rows.start / BAND..=(rows.end - 1) / BAND].iter_mut().for_each(|band| band.push(shape()));
        }
    };
    for (index, ball) in (0_u32..).zip(&scene.balls) {
        if plane.height(ball.center) < ball.radius {
            let (place, reach) = (camera.project(ball.center).0, ball.radius * camera.scale);
            add(place.y - reach, place.y + reach, &|| Shape::Ball(index));
        }
    }
    for (index, triangle) in (0_u32..).zip(&scene.triangles) {
        let rows = triangle.map(|p| camera.project(p).0.y);
        let (top, bottom) = (rows[0].min(rows[1]).min(rows[2]), rows[0].max(rows[1]).max(rows[2]));
        if triangle.iter().any(|p| plane.height(*p) <= 0.0) {
            add(top, bottom, &|| Shape::Surface(index));
        }
        if let Some(ends) = section(triangle, plane) {
            let rows = ends.map(|p| camera.project(p).0.y);
            add(rows[0].min(rows[1]) - EDGE, rows[0].max(rows[1]) + EDGE, &|| Shape::Edge(ends));
        }
    }
    bands
}

/// The segment at which the plane cuts a triangle.
fn section(triangle: &[Vec3; 3], plane: &CutPlane) -> Option<[Vec3; 2]> {
    let [a, b, c] = *triangle;
    let mut ends = [(a, b), (b, c), (c, a)].into_iter().filter_map(|(p, q)| {
        let (over_p, over_q) = (plane.height(p), plane.height(q));
        ((over_p <= 0.0) != (over_q <= 0.0)).then(|| p.lerp(q, over_p / (over_p - over_q)))
    });
    Some([ends.next()?, ends.next()?])
}

/// The samples whose middles lie between `from` and `to`.
fn covered(from: f32, to: f32, count: usize) -> Range<usize> {
    let (first, end) = ((from - 0.5).ceil().max(0.0) as usize, (to + 0.5).floor().max(0.0) as usize);
    first.min(count)..end.min(count)
}

/// Some rows of samples.
struct Band<'a> {
    samples: &'a mut [Sample],
    first_row: usize,
}

impl Band<'_> {
    /// Shows `what` at every sample of a box where it is nearer than what is there already.
    fn paint(&mut self, lower: Vec2, upper: Vec2, what: impl Fn(Vec2) -> Option<Sample>) {
        let rows = self.first_row..self.first_row + self.samples.len() / COLUMNS;
        let wanted = covered(lower.y, upper.y, ROWS);
        let columns = covered(lower.x, upper.x, COLUMNS);
        for row in wanted.start.max(rows.start)..wanted.end.min(rows.end) {
            let line = &mut self.samples[(row - rows.start) * COLUMNS..][..COLUMNS];
            for column in columns.clone() {
                let place = Vec2::new(column as f32 + 0.5, row as f32 + 0.5);
                if let Some(sample) = what(place)
                    && sample.depth > line[column].depth
                {
                    line[column] = sample;
                }
            }
        }
    }
}

struct Painter<'a> {
    scene: &'a Scene,
    plane: &'a CutPlane,
    camera: &'a Camera,
}

impl Painter<'_> {
    fn ball(&self, band: &mut Band, index: u32) {
        let Ball { center, radius } = self.scene.balls[index as usize];
        let (middle, depth) = self.camera.project(center);
        let reach = Vec2::splat(radius * self.camera.scale);
        band.paint(middle - reach, middle + reach, |place| {
            let aside = place.distance_squared(middle) / (self.camera.scale * self.camera.scale);
            let half = radius * radius - aside;
            if half < 0.0 {
                return None;
            }
            let front = depth + half.sqrt();
            if self.plane.height(self.camera.point(place, front)) <= 0.0 {
                return Some(Sample { depth: front, seen: Seen::Ball(index) });
            }
            let cut = self.depth_of_plane(place);
            (cut > depth - half.sqrt()).then_some(Sample { depth: cut, seen: Seen::Face(index) })
        });
    }

    fn surface(&self, band: &mut Band, index: u32) {
        let [(a, depth_a), (b, depth_b), (c, depth_c)] =
            self.scene.triangles[index as usize].map(|p| self.camera.project(p));
        let area = (b - a).perp_dot(c - a);
        if area == 0.0 {
            return;
        }
        band.paint(a.min(b).min(c), a.max(b).max(c), |place| {
            let u = (b - place).perp_dot(c - place) / area;
            let v = (c - place).perp_dot(a - place) / area;
            let w = 1.0 - u - v;
            if u < 0.0 || v < 0.0 || w < 0.0 {
                return None;
            }
            let depth = u * depth_a + v * depth_b + w * depth_c;
            let is_kept = self.plane.height(self.camera.point(place, depth)) <= 0.0;
            is_kept.then_some(Sample { depth, seen: Seen::Surface(index) })
        });
    }

    fn edge(&self, band: &mut Band, ends: [Vec3; 2]) {
        let [(a, depth_a), (b, depth_b)] = ends.map(|p| self.camera.project(p));
        let way = b - a;
        let reach = Vec2::splat(EDGE);
        // Over the faces that it borders, and over the surface that it bounds.
        let lift = EDGE / self.camera.scale;
        band.paint(a.min(b) - reach, a.max(b) + reach, |place| {
            let along = ((place - a).dot(way) / way.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
            let is_near = place.distance_squared(a + along * way) <= EDGE * EDGE;
            let depth = depth_a + along * (depth_b - depth_a) + lift;
            is_near.then_some(Sample { depth, seen: Seen::Edge })
        });
    }

    /// Depth at which a line of sight meets the plane; the camera never looks along it.
    fn depth_of_plane(&self, place: Vec2) -> f32 {
        -self.plane.height(self.camera.point(place, 0.0)) / self.plane.normal.dot(self.camera.back)
    }
}
