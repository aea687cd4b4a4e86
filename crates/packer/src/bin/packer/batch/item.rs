//! One mesh of a batch.

use super::listing::Entry;
use super::{Arguments, shard};
use crate::options::PackingArguments;
use crate::output;
use anyhow::{Context, bail};
use ist::{FileError, SpherePacking};
use packer::{Solid, TriangleMesh, pack, provenance};
use std::io::ErrorKind;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Name of the program in the provenance of its packings.
const NAME: &str = env!("CARGO_PKG_NAME");

/// A mesh and the packing that is to be made of it.
pub(super) struct Item {
    entry: Entry,
    input: PathBuf,
    output: PathBuf,
    tag: String,
}

/// What became of a mesh.
pub(super) enum Outcome {
    /// The packing was made.
    Packed { spheres: usize, coverage: f64, stop: String, seconds: f64 },
    /// The packing was there.
    Unchanged { spheres: usize, coverage: f64 },
    /// There is no packing, and why.
    Failed { error: String },
}

/// What stands where the packing is to be.
enum Existing {
    /// Nothing, or a damaged file.
    Nothing,
    Packing(SpherePacking),
}

impl Item {
    pub(super) fn new(entry: Entry, arguments: &Arguments) -> Self {
        // The whole name is kept, so that a.obj and a.stl have outputs of their own.
        let mut output = arguments.output.join(&entry.path).into_os_string();
        output.push(".ist");
        let input = arguments.input.join(&entry.path);
        let tag = shard::tag(shard::path_hash(&entry.path));
        Self { input, output: output.into(), tag, entry }
    }

    /// Path of the mesh relative to the input folder.
    pub(super) fn path(&self) -> &Path {
        &self.entry.path
    }

    /// Path of the packing.
    pub(super) fn output(&self) -> &Path {
        &self.output
    }

    /// Packs the mesh unless its packing is there already. Never panics: one mesh does not end a batch.
    pub(super) fn process(&self, packing: &PackingArguments) -> Outcome {
        let error = match catch_unwind(AssertUnwindSafe(|| self.try_process(packing))) {
            Ok(Ok(outcome)) => return outcome,
            Ok(Err(error)) => output::message(&error),
            Err(_) => "the packer failed on this mesh; please report it as a bug".to_owned(),
        };
        Outcome::Failed { error }
    }

    fn try_process(&self, packing: &PackingArguments) -> anyhow::Result<Outcome> {
        let started = Instant::now();
        if let Some(error) = &self.entry.error {
            bail!("{error}");
        }
        let existing = self.existing()?;
        let options = packing.options(&self.input)?;
        let mesh = TriangleMesh::load(&self.input)?;
        let solid = Solid::new(&mesh)?;
        if let Existing::Packing(existing) = existing
            && *existing.provenance() == provenance(&solid, &options)
        {
            return Ok(Outcome::Unchanged {
                spheres: existing.spheres().len(),
                coverage: existing.coverage(),
            });
        }
        let packed = pack(&solid, &options.measure_quality(false))?;
        if let Some(folder) = self.output.parent() {
            std::fs::create_dir_all(folder)
                .with_context(|| format!("cannot make the folder {}", folder.display()))?;
        }
        output::write_tagged(&self.output, &packed.packing.to_bytes(), &self.tag)?;
        Ok(Outcome::Packed {
            spheres: packed.report.spheres,
            coverage: packed.report.coverage,
            stop: packed.report.stop.to_string(),
            seconds: started.elapsed().as_secs_f64(),
        })
    }

    /// Looks at the output, and refuses to replace what this program did not make.
    fn existing(&self) -> anyhow::Result<Existing> {
        let name = self.output.display();
        if self.output.is_dir() {
            bail!("{name}, which is to be written, is a folder; rename it");
        }
        // To read from a pipe would be to wait for whoever writes to it.
        if self.output.exists() && !self.output.is_file() {
            bail!("{name}, which is to be written, is no file; rename it");
        }
        match SpherePacking::load(&self.output) {
            Ok(packing) => {
                let generator = &packing.provenance().generator;
                if generator.split(' ').next() != Some(NAME) {
                    bail!("{name} was not made by this program but by '{generator}'; move it away");
                }
                Ok(Existing::Packing(packing))
            }
            Err(FileError::Io { source, .. }) if source.kind() == ErrorKind::NotFound => {
                Ok(Existing::Nothing)
            }
            Err(error @ FileError::Io { .. }) => Err(error.into()),
            // No content is lost with an empty file.
            Err(FileError::Signature) if self.output.metadata().is_ok_and(|m| m.len() == 0) => {
                Ok(Existing::Nothing)
            }
            Err(FileError::Signature) => {
                bail!("{name} is no .ist file and is not overwritten; move it away")
            }
            // Damaged, or of another version of the format: its mesh is here to make it again.
            Err(_) => Ok(Existing::Nothing),
        }
    }
}
