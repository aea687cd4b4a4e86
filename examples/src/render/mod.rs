//! A small software renderer for pictures without a screen.
//!
//! Triangles and exact spheres in a z-buffer, a key light with soft shadows, ambient occlusion, a ground that
//! fades into the background, a cut plane to look into bodies, and clear water. The camera frames the scene by itself.
//!
//! ```no_run
//! use glamx::Pose3;
//! use glam::Vec3;
//! use rapier_ist_examples::render::{Mesh, PictureSize, Scene, Surface};
//! use rapier_ist_examples::{palette, shapes};
//!
//! # fn main() -> Result<(), rapier_ist_examples::render::ImageError> {
//! let ring = Mesh::new(&shapes::ring(0.5, 0.15, [96, 48]));
//! let mut scene = Scene::new();
//! scene.add_mesh(&ring, Pose3::IDENTITY, Surface::new(palette::color(0)));
//! scene.set_ground(-0.15);
//! let camera = scene.framed_from(Vec3::new(1.0, 0.8, 2.0), PictureSize::HD);
//! scene.render(&camera, PictureSize::HD).save_png("ring.png")?;
//! # Ok(())
//! # }
//! ```
//!
//! The stages: [`Scene`] collects; `raster` fills one grid with depths, normals and surfaces from the camera and
//! another with depths from the light (`shadow`); `occlusion` and `shade` turn them into the light of each pixel.
//! Every stage writes each value from one thread, so pictures do not depend on the number of threads.

mod buffer;
mod camera;
mod image;
mod mesh;
mod occlusion;
mod raster;
mod scene;
mod shade;
mod shadow;
#[cfg(test)]
mod tests;
mod water;

pub use camera::Camera;
pub use image::{Image, ImageError};
pub use mesh::Mesh;
pub use scene::{CutPlane, PictureSize, Scene, Section, Surface, WaterBlock};
