//! `packer check`.

mod findings;

use crate::output;
use anyhow::Context;
use packer::{Diagnosis, Solid, TriangleMesh, diagnose};
use serde_json::{Value, json};
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
    let mesh = match TriangleMesh::load_unchecked(&arguments.input) {
        Ok(mesh) => mesh,
        Err(error) => {
            let error = anyhow::Error::from(error);
            if arguments.json {
                output::print(json!({
                    "input": name.to_string(),
                    "packable": false,
                    "error": output::message(&error),
                }))?;
            }
            return Err(error);
        }
    };
    let solid = Solid::new(&mesh).with_context(|| format!("{name} cannot be packed"));
    let diagnosis = solid.as_ref().map_or_else(|_| diagnose(&mesh), |solid| solid.diagnosis().clone());
    if arguments.json {
        let mut report = to_json(&diagnosis);
        report["input"] = json!(name.to_string());
        report["packable"] = json!(solid.is_ok());
        match &solid {
            Ok(solid) => report["centroid"] = json!(solid.properties().centroid.to_array()),
            Err(error) => report["error"] = json!(output::message(error)),
        }
        output::print(report)?;
    } else {
        let verdict = if solid.is_ok() { "can be packed" } else { "cannot be packed" };
        output::print(format!("{name}: {verdict}\n{}", summary(&diagnosis)))?;
        if let Ok(solid) = &solid {
            output::print(format!("centroid {}", solid.properties().centroid))?;
        }
    }
    solid.map(drop)
}

fn summary(d: &Diagnosis) -> String {
    let mut lines = vec![format!(
        "{} triangles, {} vertices, {} shells, {} cavities",
        d.triangles, d.vertices, d.shells, d.cavities
    )];
    lines.extend(d.volume.map(|volume| format!("volume {volume:.6e}")));
    if d.overlap_volume > 1e-6 * d.volume.unwrap_or_default() {
        lines.push(format!("the shells enclose {:.6e} more than once", d.overlap_volume));
    }
    lines.extend(d.bounds.map(|(lower, upper)| format!("box from {lower} to {upper}")));
    for finding in findings::of(d) {
        lines.push(format!("{}: {} {}", finding.severity, finding.count, finding.what));
        lines.extend(finding.places.iter().take(3).map(|place| format!("    at {place}")));
        lines.extend(finding.remedy.map(|remedy| format!("    {remedy}")));
    }
    lines.join("\n")
}

fn to_json(d: &Diagnosis) -> Value {
    let findings: Vec<Value> = findings::of(d)
        .into_iter()
        .map(|finding| {
            json!({
                "kind": finding.kind,
                "severity": finding.severity.to_string(),
                "count": finding.count,
                "what": finding.what,
                "places": finding.places.iter().map(findings::Place::to_json).collect::<Vec<_>>(),
                "remedy": finding.remedy,
            })
        })
        .collect();
    json!({
        "triangles": d.triangles,
        "vertices": d.vertices,
        "shells": d.shells,
        "cavities": d.cavities,
        "holes": d.holes,
        "volume": d.volume,
        "overlap_volume": d.overlap_volume,
        "bounds": d.bounds.map(|(lower, upper)| [lower.to_array(), upper.to_array()]),
        "resolution": d.resolution,
        "input_triangles": d.input_triangles,
        "input_vertices": d.input_vertices,
        "mended": {
            "unused_vertices": d.unused_vertices,
            "merged_vertices": d.merged_vertices,
            "degenerate_faces": d.degenerate_faces,
            "duplicate_faces": d.duplicate_faces,
            "paired_faces": d.paired_faces,
            "turned_faces": d.turned_faces,
            "reversed_shells": d.reversed_shells,
            "hidden_faces": d.hidden_faces,
            "cut_faces": d.cut_faces,
        },
        "findings": findings,
    })
}
