//! Triangles and balls into a grid of samples, nearest first.
//!
//! Triangles are filled by barycentric coordinates; balls are intersected with the ray of each sample, so that
//! their outlines, depths and normals are exact.

use super::buffer::{Fragment, Grid, Sample, place};
use super::camera::View;
use super::scene::{Ball, CutPlane, PlacedMesh, Scene, Section};
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::ops::Range;

/// Rows that a thread draws at a time: enough bands to share, few enough that each may look at every triangle.
const BAND: usize = 64;

/// How far triangles reach over their edges, in barycentric coordinates: rounding must not tear seams open.
const SEAM: f32 = 1e-5;

/// Draws everything but the ground.
pub(super) fn draw<V: View, S: Sample>(scene: &Scene, view: &V, grid: &mut Grid<S>) {
    let (width, size) = (grid.width, (grid.width, grid.height));
    let meshes: Vec<Vec<Triangle>> =
        scene.meshes.par_iter().map(|placed| project_mesh(scene, view, size, placed)).collect();
    let balls: Vec<ProjectedBall> =
        scene.balls.iter().filter_map(|ball| project_ball(scene, view, size, ball)).collect();
    grid.samples.par_chunks_mut(width.max(1) * BAND).enumerate().for_each(|(index, samples)| {
        let first = index * BAND;
        let rows = first..first + samples.len() / width;
        let mut band = Band { samples, width, rows, view };
        for triangle in meshes.iter().flatten() {
            band.fill_triangle(triangle);
        }
        for ball in &balls {
            band.fill_ball(ball);
        }
    });
}

/// A triangle on the grid.
struct Triangle {
    cells: Cells,
    /// Column, row and nearness of the corners.
    corners: [Vec3; 3],
    /// Weighted normals of the corners, towards the viewer.
    normals: [Vec3; 3],
    /// Weighted distances of the corners beyond the cut plane.
    beyond: [f32; 3],
    surface: u32,
    back: bool,
}

/// A ball with the part of the grid that it can cover.
struct ProjectedBall {
    cells: Cells,
    ball: Ball,
    cut: Option<CutPlane>,
}

fn project_mesh<V: View>(
    scene: &Scene,
    view: &V,
    size: (usize, usize),
    placed: &PlacedMesh,
) -> Vec<Triangle> {
    let PlacedMesh { mesh, pose, surface } = *placed;
    let cut = scene.cut.filter(|_| scene.surfaces[surface as usize].section != Section::Whole);
    let world: Vec<Vec3> = mesh.positions.iter().map(|&p| pose.transform_point(p)).collect();
    let projected: Vec<Option<Vec3>> = world.iter().map(|&p| view.project(p)).collect();
    let mut triangles = Vec::with_capacity(mesh.triangles.len() / 2);
    for (vertices, normals) in mesh.triangles.iter().zip(&mesh.normals) {
        let [Some(a), Some(b), Some(c)] = vertices.map(|i| projected[i as usize]) else { continue };
        // Counter-clockwise from outside is clockwise on the grid, whose rows grow downwards.
        let back = (b - a).truncate().perp_dot((c - a).truncate()) >= 0.0;
        if back && cut.is_none() {
            continue;
        }
        let (lower, upper) = (a.min(b).min(c).truncate(), a.max(b).max(c).truncate());
        let Some(cells) = Cells::new(lower, upper, size) else { continue };
        let corners = [a, b, c];
        let weights = corners.map(|corner| view.weight(corner.z));
        let side = if back { -1.0 } else { 1.0 };
        let normal = |k: usize| pose.rotation * normals[k] * (side * weights[k]);
        let beyond =
            |k: usize| cut.map_or(-1.0, |plane| plane.beyond(world[vertices[k] as usize]) * weights[k]);
        triangles.push(Triangle {
            cells,
            corners,
            normals: [0, 1, 2].map(normal),
            beyond: [0, 1, 2].map(beyond),
            surface,
            back,
        });
    }
    triangles
}

fn project_ball<V: View>(
    scene: &Scene,
    view: &V,
    size: (usize, usize),
    ball: &Ball,
) -> Option<ProjectedBall> {
    let section = scene.surfaces[ball.surface as usize].section;
    let cut = scene.cut.filter(|_| section == Section::Capped);
    let gone = |plane: &CutPlane| match section {
        Section::Whole => false,
        Section::Hollow => plane.beyond(ball.center) > 0.0,
        Section::Capped => plane.beyond(ball.center) > ball.radius,
    };
    if scene.cut.as_ref().is_some_and(gone) {
        return None;
    }
    let [left, right, top, bottom] = view.ball_bounds(ball.center, ball.radius)?;
    let cells = Cells::new(Vec2::new(left, top), Vec2::new(right, bottom), size)?;
    Some(ProjectedBall { cells, ball: *ball, cut })
}

/// Some rows of the grid.
struct Band<'a, S, V> {
    samples: &'a mut [S],
    width: usize,
    rows: Range<usize>,
    view: &'a V,
}

impl<S: Sample, V: View> Band<'_, S, V> {
    fn fill_triangle(&mut self, triangle: &Triangle) {
        let rows = triangle.cells.rows_in(&self.rows);
        let [a, b, c] = triangle.corners;
        let (ab, ac) = ((b - a).truncate(), (c - a).truncate());
        let area = ab.perp_dot(ac);
        if rows.is_empty() || area == 0.0 {
            return;
        }
        // Barycentric coordinates of b and c: linear functions on the grid.
        let v_slope = Vec2::new(ac.y, -ac.x) / area;
        let w_slope = Vec2::new(-ab.y, ab.x) / area;
        for row in rows {
            let start = (row - self.rows.start) * self.width;
            for column in triangle.cells.columns.clone() {
                let offset = place(column, row) - a.truncate();
                let (v, w) = (offset.dot(v_slope), offset.dot(w_slope));
                let u = 1.0 - v - w;
                if u < -SEAM || v < -SEAM || w < -SEAM {
                    continue;
                }
                let nearness = a.z * u + b.z * v + c.z * w;
                let sample = &mut self.samples[start + column];
                let [beyond_a, beyond_b, beyond_c] = triangle.beyond;
                if nearness <= sample.nearness() || beyond_a * u + beyond_b * v + beyond_c * w > 0.0 {
                    continue;
                }
                *sample = S::new(nearness, || {
                    let [na, nb, nc] = triangle.normals;
                    let normal = (na * u + nb * v + nc * w).normalize_or_zero();
                    Fragment { normal, surface: triangle.surface, back: triangle.back }
                });
            }
        }
    }

    fn fill_ball(&mut self, projected: &ProjectedBall) {
        for row in projected.cells.rows_in(&self.rows) {
            let start = (row - self.rows.start) * self.width;
            for column in projected.cells.columns.clone() {
                let ray = self.view.ray(place(column, row));
                let Some((t, normal)) = hit_ball(ray, projected) else { continue };
                let nearness = self.view.nearness(t);
                let sample = &mut self.samples[start + column];
                if nearness > sample.nearness() {
                    let surface = projected.ball.surface;
                    *sample = S::new(nearness, || Fragment { normal, surface, back: false });
                }
            }
        }
    }
}

/// Where a ray meets a ball, cut as the ball asks for, and the unit normal there.
fn hit_ball((origin, direction): (Vec3, Vec3), projected: &ProjectedBall) -> Option<(f32, Vec3)> {
    let Ball { center, radius, .. } = projected.ball;
    let to_center = center - origin;
    let length_squared = direction.length_squared();
    let middle = to_center.dot(direction) / length_squared;
    // From the foot of the perpendicular: the textbook b² − ac loses small balls far away to cancellation.
    let half_chord_squared =
        (radius * radius - (to_center - direction * middle).length_squared()) / length_squared;
    if half_chord_squared < 0.0 {
        return None;
    }
    let half_chord = half_chord_squared.sqrt();
    let t = middle - half_chord;
    let normal = (direction * t - to_center) / radius;
    match projected.cut {
        Some(plane) if plane.beyond(origin + direction * t) > 0.0 => {
            let t = hit_plane((origin, direction), &plane)?;
            (t > middle - half_chord && t < middle + half_chord).then_some((t, plane.normal))
        }
        _ => Some((t, normal)),
    }
}

/// Where a ray meets the cut plane.
pub(super) fn hit_plane((origin, direction): (Vec3, Vec3), plane: &CutPlane) -> Option<f32> {
    let approach = direction.dot(plane.normal);
    (approach != 0.0).then(|| -plane.beyond(origin) / approach)
}

/// Cells of the grid that something can touch.
#[derive(Clone)]
struct Cells {
    columns: Range<usize>,
    rows: Range<usize>,
}

impl Cells {
    /// The cells between two corners; `None` off the grid, and for corners that are not numbers.
    fn new(lower: Vec2, upper: Vec2, (width, height): (usize, usize)) -> Option<Self> {
        let inside = upper.x >= 0.0 && upper.y >= 0.0 && lower.x < width as f32 && lower.y < height as f32;
        // Conversion to an integer cuts off the fraction and turns what is negative into zero.
        let span = |low: f32, high: f32, count: usize| low as usize..(high as usize + 1).min(count);
        let cells = Self { columns: span(lower.x, upper.x, width), rows: span(lower.y, upper.y, height) };
        inside.then_some(cells)
    }

    /// The rows that lie in `band`.
    fn rows_in(&self, band: &Range<usize>) -> Range<usize> {
        self.rows.start.max(band.start)..self.rows.end.min(band.end)
    }
}
