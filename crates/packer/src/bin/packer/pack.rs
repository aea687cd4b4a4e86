//! `packer pack`.

use crate::output;
use anyhow::{Context, bail};
use indicatif::{ProgressBar, ProgressStyle};
use packer::{PackOptions, PackReport, Packed, Progress, Solid, TriangleMesh, pack_with_progress};
use serde_json::json;
use std::io::IsTerminal;
use std::path::PathBuf;

/// Spheres that a request for a coverage alone may use: more are rarely meant.
const SPHERES_FOR_COVERAGE: usize = 1_000_000;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Mesh to pack.
    input: PathBuf,
    /// File to write.
    #[arg(short, long, value_name = "OUT.ist")]
    output: PathBuf,
    /// Most spheres to place [default: 1000, or a million with --coverage or --min-radius].
    #[arg(short = 'n', long, value_name = "N")]
    spheres: Option<usize>,
    /// Stop once the balls fill this share of the volume, above 0 and at most 1.
    #[arg(short, long, value_name = "F", allow_negative_numbers = true)]
    coverage: Option<f64>,
    /// Place no ball of a smaller radius (in the unit of the mesh).
    #[arg(long, value_name = "R", allow_negative_numbers = true)]
    min_radius: Option<f64>,
    /// Threads to use [default: all cores]; the result does not depend on it.
    #[arg(short, long, value_name = "N")]
    threads: Option<usize>,
    /// Print the report as JSON.
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let options = options(arguments)?;
    output::check_writable(&arguments.output)?;
    if arguments.threads == Some(0) {
        bail!("zero threads asked for; ask for at least one");
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(arguments.threads.unwrap_or(0)).build()?;
    let packed = pool.install(|| pack_file(arguments, &options))?;
    output::write(&arguments.output, &packed.packing.to_bytes())?;
    if arguments.json {
        output::print(to_json(&packed.report, arguments))
    } else {
        output::print(summary(&packed.report, arguments))
    }
}

fn options(arguments: &Arguments) -> anyhow::Result<PackOptions> {
    let has_other_stop = arguments.coverage.is_some() || arguments.min_radius.is_some();
    let default = if has_other_stop { SPHERES_FOR_COVERAGE } else { PackOptions::balanced().spheres };
    let mut options = PackOptions::balanced().spheres(arguments.spheres.unwrap_or(default));
    options.coverage = arguments.coverage;
    options.min_radius = arguments.min_radius;
    let name = arguments.input.file_name().unwrap_or_default();
    options = options.source(name.to_string_lossy());
    options.validate()?;
    Ok(options)
}

fn pack_file(arguments: &Arguments, options: &PackOptions) -> anyhow::Result<Packed> {
    let mesh = TriangleMesh::load(&arguments.input)?;
    let name = arguments.input.display();
    let solid = Solid::new(&mesh).with_context(|| format!("{name} cannot be packed"))?;
    let bar = if std::io::stderr().is_terminal() && !arguments.json {
        ProgressBar::new(1_000).with_style(
            ProgressStyle::with_template("{bar:40} {percent:>3} % {msg} {elapsed}")
                .unwrap_or_else(|_| ProgressStyle::default_bar()),
        )
    } else {
        ProgressBar::hidden()
    };
    let packed = pack_with_progress(&solid, options, |progress: Progress| {
        bar.set_position((1_000.0 * progress.fraction) as u64);
        bar.set_message(format!("{} spheres, {:.1} % filled", progress.spheres, 100.0 * progress.coverage));
    });
    bar.finish_and_clear();
    Ok(packed?)
}

fn summary(report: &PackReport, arguments: &Arguments) -> String {
    format!(
        "{}: {} spheres fill {:.2} % of {} (stop: {})\n\
         radii {:.3e} to {:.3e}, median {:.3e}\n\
         placed in {:.2} s, power cells in {:.2} s, checked in {:.2} s",
        arguments.output.display(),
        report.spheres,
        100.0 * report.coverage,
        arguments.input.display(),
        report.stop,
        report.radius_min,
        report.radius_max,
        report.radius_median,
        report.place_seconds,
        report.cells_seconds,
        report.finish_seconds,
    )
}

fn to_json(report: &PackReport, arguments: &Arguments) -> serde_json::Value {
    json!({
        "input": arguments.input.display().to_string(),
        "output": arguments.output.display().to_string(),
        "spheres": report.spheres,
        "coverage": report.coverage,
        "stop": report.stop.to_string(),
        "radius": { "min": report.radius_min, "median": report.radius_median, "max": report.radius_max },
        "residuals": { "protrusion": report.protrusion, "overlap": report.overlap },
        "seconds": {
            "place": report.place_seconds,
            "cells": report.cells_seconds,
            "finish": report.finish_seconds,
        },
    })
}
