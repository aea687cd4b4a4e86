//! An orthographic camera that looks at the cut face at an angle.

use super::cut::CutPlane;
use super::scene::Scene;
use super::{HEIGHT, WIDTH};
use glam::{Vec2, Vec3};

/// Samples per pixel along each side.
pub(super) const FACTOR: usize = 3;
/// How far the view is turned off the plane's normal, sideways and upwards (degrees): a choice. More shows the depth
/// of the half behind the plane, less shows the cut face.
const SIDEWAYS: f32 = 26.0;
const UPWARDS: f32 = 17.0;
/// Free border, and the strip at the bottom that the legend needs (pixels).
const BORDER: f32 = 40.0;
const LEGEND: f32 = 50.0;
/// A section this many times as tall as wide is laid on its side.
const TALL: f32 = 1.3;

pub(super) struct Camera {
    pub(super) right: Vec3,
    pub(super) up: Vec3,
    /// Towards the viewer.
    pub(super) back: Vec3,
    /// Samples per unit of the scene.
    pub(super) scale: f32,
    /// Sample at which the origin is seen.
    middle: Vec2,
}

impl Camera {
    /// The camera that shows what is left of `scene` behind `plane`, as large as the picture allows.
    pub(super) fn on(scene: &Scene, plane: &CutPlane) -> Self {
        let normal = plane.normal;
        let vertical = if normal.y.abs() < 0.8 { Vec3::Y } else { -Vec3::Z };
        let mut up = vertical.reject_from(normal).normalize_or(Vec3::X);
        let mut right = up.cross(normal);
        let size = |axis: Vec3| {
            let (lower, upper) = extent(scene, plane, axis);
            upper - lower
        };
        if size(up) > TALL * size(right) {
            (right, up) = (up, -right);
        }
        let ((sin_a, cos_a), (sin_e, cos_e)) =
            (SIDEWAYS.to_radians().sin_cos(), UPWARDS.to_radians().sin_cos());
        let back = (cos_e * (cos_a * normal + sin_a * right) + sin_e * up).normalize();
        let right = up.cross(back).normalize();
        Self { right, up: back.cross(right), back, scale: 1.0, middle: Vec2::ZERO }.fitted(scene, plane)
    }

    fn fitted(mut self, scene: &Scene, plane: &CutPlane) -> Self {
        let (left, right) = extent(scene, plane, self.right);
        let (bottom, top) = extent(scene, plane, self.up);
        let (width, height) = (WIDTH as f32, HEIGHT as f32);
        let room = Vec2::new(width - 2.0 * BORDER, height - 2.0 * BORDER - LEGEND);
        let scale = (room.x / (right - left)).min(room.y / (top - bottom));
        let factor = FACTOR as f32;
        let free = Vec2::new(width, height - LEGEND);
        self.middle = factor * (0.5 * free + 0.5 * scale * Vec2::new(-(left + right), bottom + top));
        self.scale = factor * scale;
        self
    }

    /// Place on the grid of samples, from its upper left corner, and depth towards the viewer.
    pub(super) fn project(&self, p: Vec3) -> (Vec2, f32) {
        let on_screen = Vec2::new(self.right.dot(p), -self.up.dot(p));
        (self.middle + self.scale * on_screen, self.back.dot(p))
    }

    /// The point of depth `depth` that is seen at a place of the grid.
    pub(super) fn point(&self, place: Vec2, depth: f32) -> Vec3 {
        let offset = (place - self.middle) / self.scale;
        offset.x * self.right - offset.y * self.up + depth * self.back
    }
}

/// Least and greatest coordinate along `axis` of what is left behind the plane.
fn extent(scene: &Scene, plane: &CutPlane, axis: Vec3) -> (f32, f32) {
    let balls = scene
        .balls
        .iter()
        .filter(|ball| plane.height(ball.center) < ball.radius)
        .map(|ball| (axis.dot(ball.center), ball.radius));
    let corners = scene.triangles.iter().flatten().filter(|p| plane.height(**p) <= 0.0);
    let corners = corners.map(|p| (axis.dot(*p), 0.0));
    balls.chain(corners).fold((f32::INFINITY, f32::NEG_INFINITY), |(lower, upper), (middle, radius)| {
        (lower.min(middle - radius), upper.max(middle + radius))
    })
}
