//! Arguments that ask for a packing in other formats, shared by `pack` and `info`.

use crate::{output, preview};
use ist::SpherePacking;
use packer::{Solid, export};
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
#[command(next_help_heading = "Exports")]
pub(crate) struct ExportArguments {
    /// Also write the spheres as a table: x,y,z,radius,cell_volume,nx,ny,nz.
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Also write the spheres and the solid's mass properties as JSON.
    #[arg(long, value_name = "FILE")]
    spheres_json: Option<PathBuf>,
    /// Also write a URDF link with a collision sphere per ball.
    #[arg(long, value_name = "FILE")]
    urdf: Option<PathBuf>,
    /// Density for the mass and inertia in the URDF file (kg/m³).
    #[arg(
        long,
        value_name = "D",
        default_value_t = 1000.0,
        requires = "urdf",
        allow_negative_numbers = true
    )]
    density: f64,
    /// Also draw the packing, cut open, as a PNG picture.
    #[arg(long, value_name = "FILE.png")]
    preview: Option<PathBuf>,
}

impl ExportArguments {
    /// Refuses files that cannot be written, before any work is done for them.
    pub(crate) fn check(&self) -> anyhow::Result<()> {
        self.kinds().try_for_each(|(path, kind)| output::check_writable(path, kind))?;
        if self.urdf.is_some() && !(self.density > 0.0 && self.density.is_finite()) {
            return Err(export::ExportError::InvalidDensity { density: self.density }.into());
        }
        Ok(())
    }

    /// The files asked for.
    pub(crate) fn files(&self) -> impl Iterator<Item = &Path> {
        self.kinds().map(|(path, _)| path)
    }

    fn kinds(&self) -> impl Iterator<Item = (&Path, output::Kind)> {
        [
            (&self.csv, output::TABLE),
            (&self.spheres_json, output::JSON),
            (&self.urdf, output::URDF),
            (&self.preview, output::PICTURE),
        ]
        .into_iter()
        .filter_map(|(path, kind)| Some((path.as_deref()?, kind)))
    }

    /// Writes the files. `name` is that of the packing's file; the picture shows the surface of `solid` if there
    /// is one.
    pub(crate) fn write(
        &self,
        packing: &SpherePacking,
        name: &Path,
        solid: Option<&Solid>,
    ) -> anyhow::Result<()> {
        if let Some(path) = &self.csv {
            output::write(path, export::to_csv(packing).as_bytes())?;
        }
        if let Some(path) = &self.spheres_json {
            output::write(path, export::to_json(packing)?.as_bytes())?;
        }
        if let Some(path) = &self.urdf {
            let name = name.file_stem().unwrap_or_default().to_string_lossy();
            output::write(path, export::to_urdf(packing, &name, self.density)?.as_bytes())?;
        }
        if let Some(path) = &self.preview {
            output::write(path, &preview::png(packing, solid)?)?;
        }
        Ok(())
    }
}
