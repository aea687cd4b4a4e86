//! From what is seen to light: the stages of a picture.

use super::buffer::{Grid, Sample, Seen};
use super::camera::{Camera, Perspective, View};
use super::occlusion::ambient;
use super::raster::{draw, hit_plane};
use super::scene::{CutPlane, Scene, Section};
use super::shadow::Shadow;
use super::{Image, PictureSize};
use glam::Vec3;
use rayon::prelude::*;

/// Samples per pixel along each side.
const FACTOR: usize = 2;
/// Larger pictures would ask for gigabytes.
const MAX_SIDE: u32 = 8192;

// Light in linear units, white paper in full light at about 1.
const KEY: Vec3 = Vec3::new(0.92, 0.87, 0.80);
const SKY: Vec3 = Vec3::new(0.40, 0.44, 0.50);
const FLOOR: Vec3 = Vec3::new(0.24, 0.22, 0.20);
const SHINE: f32 = 0.10;
const SHINE_EXPONENT: f32 = 40.0;
// Background, sRGB.
const TOP: [f32; 3] = [0.80, 0.84, 0.89];
const BOTTOM: [f32; 3] = [0.96, 0.96, 0.95];

/// Takes the picture.
pub(super) fn render(scene: &Scene, camera: &Camera, size: PictureSize) -> Image {
    let [width, height] = [size.width, size.height].map(|side| side.clamp(1, MAX_SIDE) as usize);
    let view = Perspective::new(*camera, width * FACTOR, height * FACTOR);
    let mut grid: Grid<Seen> = Grid::new(width * FACTOR, height * FACTOR);
    draw(scene, &view, &mut grid);
    complete(scene, &view, &mut grid);
    let towards_light = camera.over_left_shoulder();
    let studio = Studio {
        shadow: Shadow::new(scene, -towards_light),
        ambient: ambient(&grid, &view, FACTOR, scene.extent().1),
        colors: scene.surfaces.iter().map(|surface| linear(surface.color)).collect(),
        background: [linear(TOP), linear(BOTTOM)],
        towards_light,
        view,
        grid,
    };
    let mut pixels = vec![[0; 3]; width * height];
    pixels.par_chunks_mut(width).enumerate().for_each(|(row, pixels)| {
        for (column, pixel) in pixels.iter_mut().enumerate() {
            *pixel = srgb(studio.pixel(column, row));
        }
    });
    Image::new(width as u32, height as u32, pixels)
}

/// Closes the faces of capped meshes and lays the ground.
///
/// Where the nearest thing left of a closed mesh is seen from inside, the line of sight enters its solid through
/// the cut plane.
fn complete(scene: &Scene, view: &Perspective, grid: &mut Grid<Seen>) {
    let width = grid.width;
    let capped = |seen: &Seen| {
        let section = scene.surfaces.get(seen.surface as usize).map(|surface| surface.section);
        seen.back && section == Some(Section::Capped)
    };
    let ground = scene.ground.map(|height| CutPlane { point: Vec3::Y * height, normal: Vec3::Y });
    let place = |seen: &mut Seen, ray: (Vec3, Vec3), plane: &CutPlane, surface: u32| {
        let t = hit_plane(ray, plane).filter(|&t| t > 0.0);
        if let Some(nearness) = t.map(|t| view.nearness(t)).filter(|&n| n > seen.nearness) {
            *seen = Seen::new(nearness, || super::buffer::Fragment {
                normal: plane.normal,
                surface,
                back: false,
            });
        }
    };
    grid.samples.par_chunks_mut(width).enumerate().for_each(|(row, samples)| {
        for (column, seen) in samples.iter_mut().enumerate() {
            let ray = view.ray(column as f32 + 0.5, row as f32 + 0.5);
            if let Some(plane) = scene.cut.as_ref().filter(|_| capped(seen)) {
                let surface = seen.surface;
                place(seen, ray, plane, surface);
            }
            // The ground is seen from above only.
            if let Some(plane) = ground.as_ref().filter(|_| ray.1.y < 0.0) {
                place(seen, ray, plane, Seen::GROUND);
            }
        }
    });
}

/// Everything that decides the colour of a pixel.
struct Studio {
    view: Perspective,
    grid: Grid<Seen>,
    shadow: Shadow,
    ambient: Vec<f32>,
    colors: Vec<Vec3>,
    background: [Vec3; 2],
    towards_light: Vec3,
}

impl Studio {
    /// Mean of the pixel's samples, linear.
    fn pixel(&self, column: usize, row: usize) -> Vec3 {
        let ambient = self.ambient[row * (self.grid.width / FACTOR) + column];
        let mut sum = Vec3::ZERO;
        for phase in 0..FACTOR * FACTOR {
            let (x, y) = (column * FACTOR + phase % FACTOR, row * FACTOR + phase / FACTOR);
            sum += self.sample(x, y, ambient, phase);
        }
        sum / (FACTOR * FACTOR) as f32
    }

    fn sample(&self, column: usize, row: usize, ambient: f32, phase: usize) -> Vec3 {
        let seen = self.grid.samples[row * self.grid.width + column];
        let [top, bottom] = self.background;
        let background = top.lerp(bottom, row as f32 / self.grid.height as f32);
        if seen.surface == Seen::NOTHING {
            return background;
        }
        let (x, y) = (column as f32 + 0.5, row as f32 + 0.5);
        let (point, normal) = (self.view.point(x, y, seen.nearness), seen.normal());
        let facing = normal.dot(self.towards_light);
        let key = if facing > 0.0 { self.shadow.light(point, normal, phase) * facing } else { 0.0 };
        let sky = SKY.lerp(FLOOR, 0.5 - 0.5 * normal.y) * ambient;
        if seen.surface == Seen::GROUND {
            // The ground is the background where light reaches it, so that it has no horizon.
            let full = KEY * facing + SKY;
            return background * (KEY * key + sky) / full;
        }
        let (_, direction) = self.view.ray(x, y);
        let half = (self.towards_light - direction.normalize()).normalize_or_zero();
        let shine = SHINE * normal.dot(half).max(0.0).powf(SHINE_EXPONENT) * key;
        self.colors[seen.surface as usize] * (KEY * key + sky) + KEY * shine
    }
}

fn linear(srgb: [f32; 3]) -> Vec3 {
    Vec3::from(srgb.map(|c| if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }))
}

fn srgb(linear: Vec3) -> [u8; 3] {
    let encode = |c: f32| if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
    linear.to_array().map(|c| (encode(c.clamp(0.0, 1.0)) * 255.0 + 0.5) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_and_back() {
        for value in 0..=255_u8 {
            let channel = f32::from(value) / 255.0;
            assert_eq!(srgb(linear([channel; 3])), [value; 3]);
        }
    }
}
