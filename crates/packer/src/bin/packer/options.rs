//! Arguments that say how to pack, shared by `pack` and `batch`.

use anyhow::bail;
use clap::ValueEnum;
use packer::PackOptions;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::path::Path;
use std::time::Duration;

/// Spheres that a request for a coverage alone may use: more are rarely meant.
const SPHERES_FOR_STOPS: usize = 1_000_000;

/// When a packing is done. To add an option, add a field here and a line to [`PackingArguments::options`].
#[derive(clap::Args)]
#[command(next_help_heading = "Packing")]
pub(crate) struct PackingArguments {
    /// Number of spheres and effort to start from; the other options change parts of it.
    #[arg(short, long, value_enum, default_value_t)]
    preset: Preset,
    /// Most spheres to place [default: as the preset, or a million with another stop].
    #[arg(short = 'n', long, value_name = "N")]
    spheres: Option<usize>,
    /// Stop once the balls fill this share of the volume, above 0 and at most 1.
    #[arg(short, long, value_name = "F", allow_negative_numbers = true)]
    coverage: Option<f64>,
    /// Place no ball of a smaller radius (in the unit of the mesh).
    #[arg(long, value_name = "R", allow_negative_numbers = true)]
    min_radius: Option<f64>,
    /// Stop once the volume balls misplace at most this share of the volume, above 0 and below 1.
    #[arg(long, value_name = "F", allow_negative_numbers = true)]
    volume_error: Option<f64>,
    /// Stop in time for the packing to be written this many seconds after the mesh has been read and checked; how far it
    /// comes depends on the machine.
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    time_limit: Option<Duration>,
}

#[derive(Clone, Copy, Default, ValueEnum)]
enum Preset {
    /// 300 spheres: a body among many, or a first look.
    Fast,
    /// 1,000 spheres: overlap volumes to a few per cent.
    #[default]
    Balanced,
    /// 5,000 spheres: thin or large bodies, reference.
    Fine,
}

impl PackingArguments {
    /// The options for the mesh file `mesh`, checked.
    pub(crate) fn options(&self, mesh: &Path) -> anyhow::Result<PackOptions> {
        let mut options = match self.preset {
            Preset::Fast => PackOptions::fast(),
            Preset::Balanced => PackOptions::balanced(),
            Preset::Fine => PackOptions::fine(),
        };
        let has_other_stop = self.coverage.is_some()
            || self.min_radius.is_some()
            || self.volume_error.is_some()
            || self.time_limit.is_some();
        let default = if has_other_stop { SPHERES_FOR_STOPS } else { options.spheres };
        options.spheres = self.spheres.unwrap_or(default);
        options.coverage = self.coverage;
        options.min_radius = self.min_radius;
        options.volume_error = self.volume_error;
        options.time_limit = self.time_limit;
        options.source = source(mesh);
        options.validate()?;
        Ok(options)
    }
}

fn seconds(text: &str) -> Result<Duration, String> {
    let seconds: f64 = text.parse().map_err(|_| "not a number of seconds".to_owned())?;
    Duration::try_from_secs_f64(seconds).map_err(|error| error.to_string())
}

/// The file name as it stands in a packing's provenance: one line without spaces around it.
fn source(mesh: &Path) -> String {
    let name = mesh.file_name().unwrap_or_default().to_string_lossy();
    name.replace(char::is_control, " ").trim().to_owned()
}

#[derive(clap::Args)]
pub(crate) struct ThreadArguments {
    /// Threads to use [default: all cores]; the result does not depend on it.
    #[arg(short, long, value_name = "N")]
    threads: Option<usize>,
}

/// Most threads per core: 3,000 on two cores that look for work in each other's queues took over 20 s for a cube and five balls, for
/// which two take 0.1 s.
const MOST_THREADS: usize = 8;

impl ThreadArguments {
    /// How many threads to use, at least one.
    pub(crate) fn count(&self) -> anyhow::Result<usize> {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        match self.threads {
            Some(0) => bail!("zero threads asked for; ask for at least one"),
            Some(count) => Ok(count.min(MOST_THREADS * cores)),
            None => Ok(cores),
        }
    }

    pub(crate) fn pool(&self) -> anyhow::Result<ThreadPool> {
        Ok(ThreadPoolBuilder::new().num_threads(self.count()?).build()?)
    }
}
