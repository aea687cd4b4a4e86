//! A picture of a packing, cut open.
//!
//! The half of the solid in front of a plane is taken away ([`cut`]); an orthographic camera looks at the rest at an
//! angle ([`camera`]). Balls and, where the mesh is at hand, its surface are drawn into a depth buffer ([`raster`]) and
//! lit ([`shade`]). Balls that the plane cuts show a flat pale face. The number of threads changes no pixel.

mod blur;
mod camera;
mod cut;
mod legend;
mod raster;
mod scene;
mod shade;
#[cfg(test)]
mod tests;

use anyhow::Context;
use camera::Camera;
use cut::CutPlane;
use ist::SpherePacking;
use packer::Solid;
use scene::Scene;

/// Size of the picture in pixels.
const WIDTH: usize = 1000;
const HEIGHT: usize = 800;

/// The picture as a PNG file; with the surface of `solid`, if there is one.
pub(crate) fn png(packing: &SpherePacking, solid: Option<&Solid>) -> anyhow::Result<Vec<u8>> {
    let scene = Scene::new(packing, solid);
    let plane = CutPlane::largest_section(&scene);
    let camera = Camera::on(&scene, &plane);
    let grid = raster::draw(&scene, &plane, &camera);
    let mut pixels = shade::light(&scene, &plane, &camera, &grid);
    legend::draw(&scene, &mut pixels);
    encode(&pixels).context("cannot encode the picture")
}

fn encode(pixels: &[[u8; 3]]) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, WIDTH as u32, HEIGHT as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels.as_flattened())?;
    writer.finish()?;
    Ok(bytes)
}
