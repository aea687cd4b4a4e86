//! `packer check`.

use crate::output;
use anyhow::Context;
use packer::{Solid, TriangleMesh};
use serde_json::json;
use std::path::PathBuf;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Mesh to check.
    input: PathBuf,
    /// Print the diagnosis as JSON.
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let name = arguments.input.display();
    let solid = TriangleMesh::load(&arguments.input)
        .map_err(anyhow::Error::from)
        .and_then(|mesh| Solid::new(&mesh).with_context(|| format!("{name} cannot be packed")));
    if arguments.json {
        let report = match &solid {
            Ok(solid) => to_json(solid, arguments),
            Err(error) => json!({
                "input": name.to_string(),
                "packable": false,
                "error": output::message(error),
            }),
        };
        output::print(report)?;
        return solid.map(drop);
    }
    output::print(summary(&solid?, arguments))
}

fn summary(solid: &Solid, arguments: &Arguments) -> String {
    let (d, properties) = (solid.diagnosis(), solid.properties());
    let (lower, upper) = solid.bounds();
    let mut lines = vec![
        format!("{}: closed, can be packed", arguments.input.display()),
        format!(
            "{} triangles, {} vertices, {} shells, {} cavities",
            d.triangles, d.vertices, d.shells, d.cavities
        ),
        format!("volume {:.6e}, centroid {}", properties.volume, properties.centroid),
        format!("box from {lower} to {upper}"),
    ];
    let mended = [
        (d.merged_vertices, "coincident vertices merged"),
        (d.degenerate_faces, "degenerate faces dropped"),
        (d.duplicate_faces, "duplicate faces dropped"),
        (d.turned_faces, "faces turned to agree with their neighbours"),
        (d.reversed_shells, "shells turned inside out"),
    ];
    lines.extend(
        mended.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("mended: {count} {what}")),
    );
    lines.join("\n")
}

fn to_json(solid: &Solid, arguments: &Arguments) -> serde_json::Value {
    let (d, properties) = (solid.diagnosis(), solid.properties());
    let (lower, upper) = solid.bounds();
    json!({
        "input": arguments.input.display().to_string(),
        "packable": true,
        "triangles": d.triangles,
        "vertices": d.vertices,
        "shells": d.shells,
        "cavities": d.cavities,
        "volume": properties.volume,
        "centroid": properties.centroid.to_array(),
        "bounds": [lower.to_array(), upper.to_array()],
        "mended": {
            "merged_vertices": d.merged_vertices,
            "degenerate_faces": d.degenerate_faces,
            "duplicate_faces": d.duplicate_faces,
            "turned_faces": d.turned_faces,
            "reversed_shells": d.reversed_shells,
        },
    })
}
