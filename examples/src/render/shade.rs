//! From what is seen to light: the stages of a picture.

use super::buffer::{Fragment, Grid, Sample, Seen, place};
use super::camera::{Camera, Perspective, View};
use super::occlusion::ambient;
use super::raster::{draw, hit_plane};
use super::scene::{CutPlane, Scene, Section, WaterBlock};
use super::shadow::Shadow;
use super::{Image, PictureSize};
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Samples per pixel along each side.
const FACTOR: usize = 2;
/// Larger pictures would ask for gigabytes.
const MAX_SIDE: u32 = 8192;

// Light in linear units, white paper in full light at about 1.
const KEY: Vec3 = Vec3::new(1.00, 0.95, 0.87);
const SKY: Vec3 = Vec3::new(0.40, 0.44, 0.50);
const FLOOR: Vec3 = Vec3::new(0.24, 0.22, 0.20);
const SHINE: f32 = 0.16;
const SHINE_EXPONENT: i32 = 40;
const EXPOSURE: f32 = 1.6;
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
        shadow: Shadow::new(scene, -towards_light, camera.right()),
        ambient: ambient(&grid, &view, FACTOR, scene.extent().1),
        colors: scene.surfaces.iter().map(|surface| linear(surface.color)).collect(),
        background: [linear(TOP), linear(BOTTOM)],
        towards_light,
        water: scene.water,
        view,
        grid,
    };
    let encoder = Encoder::new();
    let mut pixels = vec![[0; 3]; width * height];
    pixels.par_chunks_mut(width).enumerate().for_each(|(row, pixels)| {
        for (column, pixel) in pixels.iter_mut().enumerate() {
            *pixel = encoder.encode(studio.pixel(column, row));
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
        seen.back && scene.surfaces.get(seen.surface as usize).is_some_and(|s| s.section == Section::Capped)
    };
    let nearness = |ray, plane| hit_plane(ray, &plane).filter(|&t| t > 0.0).map(|t| view.nearness(t));
    grid.samples.par_chunks_mut(width).enumerate().for_each(|(row, samples)| {
        if let Some(plane) = scene.cut {
            for (column, seen) in samples.iter_mut().enumerate().filter(|(_, seen)| capped(seen)) {
                if let Some(nearness) = nearness(view.ray(place(column, row)), plane) {
                    *seen = flat(nearness, plane.normal, seen.surface);
                }
            }
        }
        // The camera stands upright: rays of one height meet the ground at one depth, and a row has two heights.
        for first in 0..2 {
            let ray = view.ray(place(first, row));
            let below = scene.ground.filter(|&height| ray.1.y < 0.0 && ray.0.y > height);
            let ground = below.map(|height| CutPlane { point: Vec3::Y * height, normal: Vec3::Y });
            if let Some(nearness) = ground.and_then(|plane| nearness(ray, plane)) {
                let ground = flat(nearness, Vec3::Y, Seen::GROUND);
                let beyond =
                    samples.iter_mut().skip(first).step_by(2).filter(|seen| seen.nearness < nearness);
                beyond.for_each(|seen| *seen = ground);
            }
        }
    });
}

fn flat(nearness: f32, normal: Vec3, surface: u32) -> Seen {
    Seen::new(nearness, || Fragment { normal, surface, back: false })
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
    water: Option<WaterBlock>,
}

impl Studio {
    /// Light of a pixel, linear: the mean of its samples, of which those on one smooth thing share their light.
    fn pixel(&self, column: usize, row: usize) -> Vec3 {
        let ambient = self.ambient[row * (self.grid.width / FACTOR) + column];
        let cells = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(x, y)| (column * FACTOR + x, row * FACTOR + y));
        let samples = cells.map(|(x, y)| &self.grid.samples[y * self.grid.width + x]);
        let mut light = [Vec3::ZERO; FACTOR * FACTOR];
        for (index, (&(x, y), seen)) in cells.iter().zip(samples).enumerate() {
            light[index] = match samples[..index].iter().position(|other| other.continues_in(seen)) {
                Some(other) => light[other],
                None => self.light(place(x, y), seen, ambient),
            };
        }
        for ((&(x, y), seen), light) in cells.iter().zip(samples).zip(&mut light) {
            *light = self.through_water(place(x, y), seen, *light);
        }
        light.iter().sum::<Vec3>() / light.len() as f32
    }

    /// What the water leaves of the light from a thing and adds to it.
    fn through_water(&self, place: Vec2, seen: &Seen, light: Vec3) -> Vec3 {
        let Some(water) = self.water else { return light };
        // Nothing has nearness 0 and is infinitely far away.
        let crossing = water.crossing(self.view.ray(place), seen.nearness.recip());
        crossing.map_or(light, |crossing| crossing.tint(light, self.background[0]))
    }

    /// Light from what is seen at a place.
    fn light(&self, place: Vec2, seen: &Seen, ambient: f32) -> Vec3 {
        let [top, bottom] = self.background;
        let background = top.lerp(bottom, place.y / self.grid.height as f32);
        if seen.surface == Seen::NOTHING {
            return background;
        }
        let point = self.view.point(place, seen.nearness);
        let normal = seen.normal();
        let facing = normal.dot(self.towards_light);
        let key = if facing > 0.0 { self.shadow.light(point, normal) * facing } else { 0.0 };
        let sky = SKY.lerp(FLOOR, 0.5 - 0.5 * normal.y) * ambient;
        if seen.surface == Seen::GROUND {
            // The ground is the background where light reaches it, so that it has no horizon.
            return background * (KEY * key + sky) / (KEY * facing + SKY);
        }
        let (_, direction) = self.view.ray(place);
        let half = (self.towards_light - direction.normalize()).normalize_or_zero();
        let shine = SHINE * normal.dot(half).max(0.0).powi(SHINE_EXPONENT) * key;
        expose(self.colors[seen.surface as usize] * (KEY * key + sky) + KEY * shine)
    }
}

/// The response of film: bright light saturates gently, and colours grow a little paler with it.
fn expose(light: Vec3) -> Vec3 {
    let respond = |light: Vec3| Vec3::ONE - (light * -EXPOSURE).exp();
    // Each channel by itself turns orange into yellow; all by the brightest one looks like plastic. Half and half.
    let brightest = light.max_element().max(1e-6);
    let same_hue = light * (respond(Vec3::splat(brightest)).x / brightest);
    same_hue.midpoint(respond(light))
}

fn linear(srgb: [f32; 3]) -> Vec3 {
    Vec3::from(srgb.map(|c| if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }))
}

/// Linear light as 8-bit sRGB, by table: a power for each channel would take as long as the rest of the shading.
struct Encoder(Vec<u8>);

impl Encoder {
    /// Fine enough that every one of the 256 values keeps entries of its own, also the darkest.
    const ENTRIES: usize = 1 << 14;

    fn new() -> Self {
        let encode = |c: f32| if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
        let entry = |index| encode(index as f32 / (Self::ENTRIES - 1) as f32);
        Self((0..Self::ENTRIES).map(|index| (entry(index) * 255.0 + 0.5) as u8).collect())
    }

    fn encode(&self, linear: Vec3) -> [u8; 3] {
        let last = (Self::ENTRIES - 1) as f32;
        linear.to_array().map(|c| self.0[(c.clamp(0.0, 1.0) * last + 0.5) as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_and_back() {
        let encoder = Encoder::new();
        for value in 0..=255_u8 {
            let channel = f32::from(value) / 255.0;
            assert_eq!(encoder.encode(linear([channel; 3])), [value; 3]);
        }
    }
}
