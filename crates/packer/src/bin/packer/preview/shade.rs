//! From what is seen to light.

use super::blur::openness;
use super::camera::{Camera, FACTOR};
use super::cut::CutPlane;
use super::raster::{COLUMNS, Sample, Seen};
use super::scene::Scene;
use super::{HEIGHT, WIDTH};
use glam::{Vec2, Vec3};
use rayon::prelude::*;

// Directions towards the light, in the camera's axes; colours and light are choices, made by eye.
const KEY: Vec3 = Vec3::new(-0.42, 0.64, 0.64);
const KEY_LIGHT: f32 = 0.80;
const SKY_LIGHT: f32 = 0.50;
const SHINE: f32 = 0.22;
/// How far the face of a cut ball is from its colour to white.
const PALE: f32 = 0.22;
const SKIN: [f32; 3] = [0.87, 0.86, 0.845];
const INSIDE: [f32; 3] = [0.62, 0.63, 0.67];
const LINE: [f32; 3] = [0.10, 0.11, 0.14];
const TOP: [f32; 3] = [0.97, 0.975, 0.985];
const BOTTOM: [f32; 3] = [0.87, 0.89, 0.92];

/// Lights every pixel, row by row from the top.
pub(super) fn light(scene: &Scene, plane: &CutPlane, camera: &Camera, samples: &[Sample]) -> Vec<[u8; 3]> {
    let open = openness(samples, camera);
    let studio = Studio { scene, plane, camera, key: KEY.normalize() };
    let mut pixels = vec![[0; 3]; WIDTH * HEIGHT];
    pixels.par_chunks_mut(WIDTH).enumerate().for_each(|(row, pixels)| {
        for (column, pixel) in pixels.iter_mut().enumerate() {
            let open = open[row * WIDTH + column];
            let mut sum = Vec3::ZERO;
            for cell in 0..FACTOR * FACTOR {
                let (x, y) = (column * FACTOR + cell % FACTOR, row * FACTOR + cell / FACTOR);
                sum +=
                    studio.color(Vec2::new(x as f32 + 0.5, y as f32 + 0.5), samples[y * COLUMNS + x], open);
            }
            *pixel = encoded(sum / (FACTOR * FACTOR) as f32);
        }
    });
    pixels
}

/// Colour of a ball by its radius: dark for small ones, bright for large ones, in even steps of the logarithm.
pub(super) fn color_of_radius(radius: f32, (min, max): (f32, f32)) -> Vec3 {
    let share = if max > min { (radius / min).ln() / (max / min).ln() } else { 1.0 };
    color_at(share)
}

/// The colour scale from 0, the smallest radius, to 1, the largest.
pub(super) fn color_at(share: f32) -> Vec3 {
    let color = colorous::PLASMA.eval_continuous(f64::from(share.clamp(0.0, 1.0)));
    linear([color.r, color.g, color.b].map(|c| f32::from(c) / 255.0))
}

struct Studio<'a> {
    scene: &'a Scene,
    plane: &'a CutPlane,
    camera: &'a Camera,
    key: Vec3,
}

impl Studio<'_> {
    fn color(&self, place: Vec2, sample: Sample, open: f32) -> Vec3 {
        let flat = self.plane.normal;
        match sample.seen {
            Seen::Nothing => linear(TOP).lerp(linear(BOTTOM), place.y / (HEIGHT * FACTOR) as f32),
            Seen::Edge => linear(LINE),
            Seen::Ball(index) => {
                let ball = &self.scene.balls[index as usize];
                let normal = (self.camera.point(place, sample.depth) - ball.center) / ball.radius;
                self.lit(color_of_radius(ball.radius, self.scene.radii), normal, open, SHINE)
            }
            Seen::Face(index) => {
                let ball = &self.scene.balls[index as usize];
                let color = color_of_radius(ball.radius, self.scene.radii).lerp(Vec3::ONE, PALE);
                self.lit(color, flat, open, 0.0)
            }
            Seen::Surface(index) => {
                let [a, b, c] = self.scene.triangles[index as usize];
                let normal = (b - a).cross(c - a).normalize_or(flat);
                if normal.dot(self.camera.back) > 0.0 {
                    self.lit(linear(SKIN), normal, open, 0.0)
                } else {
                    self.lit(linear(INSIDE), -normal, open, 0.0)
                }
            }
        }
    }

    /// Light from a thing of a colour: a key light, a sky that is brighter above, a highlight.
    fn lit(&self, color: Vec3, normal: Vec3, open: f32, shine: f32) -> Vec3 {
        let camera = self.camera;
        let n = Vec3::new(camera.right.dot(normal), camera.up.dot(normal), camera.back.dot(normal));
        let key = KEY_LIGHT * n.dot(self.key).max(0.0) * open.sqrt();
        let sky = SKY_LIGHT * (0.7 + 0.3 * n.y) * open;
        let half = (self.key + Vec3::Z).normalize();
        let highlight = shine * n.dot(half).max(0.0).powi(50) * open;
        color * (key + sky) + Vec3::splat(highlight)
    }
}

pub(super) fn linear(srgb: [f32; 3]) -> Vec3 {
    Vec3::from(srgb.map(|c| if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }))
}

pub(super) fn encoded(light: Vec3) -> [u8; 3] {
    light.to_array().map(|c| {
        let c = c.clamp(0.0, 1.0);
        let c = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
        (255.0 * c + 0.5) as u8
    })
}
