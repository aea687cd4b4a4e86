//! `packer info`.

use crate::exports::ExportArguments;
use crate::output;
use anyhow::Context;
use ist::SpherePacking;
use serde_json::json;
use std::path::PathBuf;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Packing to show.
    input: PathBuf,
    /// Print as JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    exports: ExportArguments,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    output::check_distinct(&arguments.input, arguments.exports.files())?;
    arguments.exports.check()?;
    let packing = SpherePacking::load(&arguments.input)
        .with_context(|| format!("cannot show {}", arguments.input.display()))?;
    arguments.exports.write(&packing, &arguments.input, None)?;
    let (solid, provenance) = (packing.solid(), packing.provenance());
    let mut radii: Vec<f32> = packing.spheres().iter().map(|s| s.radius).collect();
    radii.sort_by(f32::total_cmp);
    let (min, median, max) = (radii[0], radii[radii.len() / 2], radii[radii.len() - 1]);
    if arguments.json {
        return output::print(json!({
            "input": arguments.input.display().to_string(),
            "spheres": packing.spheres().len(),
            "coverage": packing.coverage(),
            "radius": { "min": min, "median": median, "max": max },
            "volume": solid.volume,
            "centroid": solid.centroid.to_array(),
            "generator": provenance.generator,
            "source": provenance.source,
            "options": provenance.options,
        }));
    }
    output::print(format!(
        "{}: {} spheres fill {:.2} % of {:.6e}\nradii {min:.3e} to {max:.3e}, median {median:.3e}\n\
         made by {}\nfrom {}\nwith {}",
        arguments.input.display(),
        packing.spheres().len(),
        100.0 * packing.coverage(),
        solid.volume,
        provenance.generator,
        provenance.source,
        provenance.options,
    ))
}
