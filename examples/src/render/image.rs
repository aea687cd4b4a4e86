//! 8-bit sRGB pictures and their PNG files.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// A picture in 8-bit sRGB, rows from top to bottom.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    width: u32,
    height: u32,
    pixels: Vec<[u8; 3]>,
}

/// Why a picture was not saved.
#[derive(Debug, thiserror::Error)]
#[error("cannot save the picture {}: {source}; choose a folder that exists and is writable", path.display())]
pub struct ImageError {
    /// The file asked for.
    pub path: PathBuf,
    /// What the operating system said.
    pub source: io::Error,
}

impl Image {
    pub(super) fn new(width: u32, height: u32, pixels: Vec<[u8; 3]>) -> Self {
        Self { width, height, pixels }
    }

    /// Width in pixels.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The pixels, row by row from the top.
    #[must_use]
    pub fn pixels(&self) -> &[[u8; 3]] {
        &self.pixels
    }

    /// Saves the picture as PNG, replacing a file of that name only when the new one is complete.
    ///
    /// # Errors
    /// [`ImageError`] names the file.
    pub fn save_png(&self, path: impl AsRef<Path>) -> Result<(), ImageError> {
        let path = path.as_ref();
        let mut unfinished = path.as_os_str().to_owned();
        unfinished.push(".part");
        let unfinished = PathBuf::from(unfinished);
        let saved = self.write_png(&unfinished).and_then(|()| fs::rename(&unfinished, path));
        saved.map_err(|source| {
            // The first error is the one to report; a leftover that cannot be removed changes nothing.
            let _ = fs::remove_file(&unfinished);
            ImageError { path: path.into(), source }
        })
    }

    fn write_png(&self, path: &Path) -> io::Result<()> {
        let mut file = BufWriter::new(File::create(path)?);
        let mut encoder = png::Encoder::new(&mut file, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(self.pixels.as_flattened())?;
        writer.finish()?;
        file.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image() -> Image {
        Image::new(2, 1, vec![[1, 2, 3], [250, 251, 252]])
    }

    #[test]
    fn a_saved_picture_reads_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two pixels.png");
        image().save_png(&path).unwrap();
        let mut reader =
            png::Decoder::new(io::BufReader::new(File::open(&path).unwrap())).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        assert_eq!(bytes, [1, 2, 3, 250, 251, 252]);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "no leftover");
    }

    #[test]
    fn a_missing_folder_is_named() {
        let error = image().save_png("/nowhere/at/all.png").unwrap_err();
        assert!(error.to_string().contains("/nowhere/at/all.png"));
    }
}
