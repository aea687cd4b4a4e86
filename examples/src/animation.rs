//! Animated PNG files, which every browser shows.

use crate::output::write_whole;
use crate::render::Image;
use anyhow::{Context, Result, ensure};
use std::path::Path;

/// Writes the pictures as one animated PNG that repeats, `rate` pictures a second; it is there as a whole or not at all.
///
/// # Errors
/// Where there is no picture, they differ in size, or the file cannot be written.
pub fn save_apng(path: &Path, pictures: &[Image], rate: u16) -> Result<()> {
    let first = pictures.first().context("an animation needs at least one picture")?;
    let size = (first.width(), first.height());
    ensure!(pictures.iter().all(|p| (p.width(), p.height()) == size), "pictures of different sizes");
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, size.0, size.1);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_animated(u32::try_from(pictures.len())?, 0)?;
    encoder.set_frame_delay(1, rate.max(1))?;
    let mut writer = encoder.write_header()?;
    for picture in pictures {
        writer.write_image_data(picture.pixels().as_flattened())?;
    }
    writer.finish()?;
    write_whole(path, &bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::{PictureSize, Scene, Surface};
    use glam::Vec3;
    use glamx::Pose3;
    use std::fs::File;
    use std::io::BufReader;

    #[test]
    fn every_picture_reads_back() {
        let size = PictureSize { width: 32, height: 20 };
        let picture = |radius: f32| {
            let mut scene = Scene::new();
            scene.add_balls([(Vec3::ZERO, radius)], Pose3::IDENTITY, Surface::new([0.8, 0.2, 0.1]));
            let camera = crate::render::Camera::new(Vec3::Z * 5.0, Vec3::ZERO);
            scene.render(&camera, size)
        };
        let pictures = [0.5, 0.7, 0.9].map(picture);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("balls.png");
        save_apng(&path, &pictures, 20).unwrap();
        let mut reader = png::Decoder::new(BufReader::new(File::open(&path).unwrap())).read_info().unwrap();
        let animation = reader.info().animation_control.unwrap();
        assert_eq!((animation.num_frames, animation.num_plays), (3, 0));
        for picture in &pictures {
            let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut bytes).unwrap();
            assert_eq!(bytes, picture.pixels().as_flattened());
        }
        assert_ne!(pictures[0], pictures[2]);
    }

    #[test]
    fn no_picture_is_refused() {
        assert!(save_apng(Path::new("none.png"), &[], 20).is_err());
    }
}
