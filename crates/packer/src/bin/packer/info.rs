//! `packer info`.

use crate::output;
use anyhow::Context;
use ist::SpherePacking;
use serde_json::json;
use std::fmt::Write;
use std::path::PathBuf;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Packing to show.
    input: PathBuf,
    /// Print as JSON.
    #[arg(long)]
    json: bool,
    /// Also write the spheres as a table.
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let packing = SpherePacking::load(&arguments.input)
        .with_context(|| format!("cannot show {}", arguments.input.display()))?;
    if let Some(path) = &arguments.csv {
        output::check_writable(path)?;
        output::write(path, to_csv(&packing).as_bytes())?;
    }
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

fn to_csv(packing: &SpherePacking) -> String {
    let mut csv = String::from("x,y,z,radius,cell_volume,nx,ny,nz\n");
    for s in packing.spheres() {
        let (c, n) = (s.center, s.normal);
        // Writing to a string does not fail.
        let _ =
            writeln!(csv, "{},{},{},{},{},{},{},{}", c.x, c.y, c.z, s.radius, s.cell_volume, n.x, n.y, n.z);
    }
    csv
}
