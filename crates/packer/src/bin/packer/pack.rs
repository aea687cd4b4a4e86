//! `packer pack`.

use crate::exports::ExportArguments;
use crate::options::{PackingArguments, ThreadArguments};
use crate::output;
use anyhow::Context;
use indicatif::{ProgressBar, ProgressStyle};
use packer::{PackOptions, PackReport, Packed, Progress, Solid, TriangleMesh, pack_with_progress};
use serde_json::json;
use std::io::IsTerminal;
use std::path::PathBuf;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Mesh to pack.
    input: PathBuf,
    /// File to write.
    #[arg(short, long, value_name = "OUT.ist")]
    output: PathBuf,
    #[command(flatten)]
    threads: ThreadArguments,
    /// Print the report as JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    packing: PackingArguments,
    #[command(flatten)]
    exports: ExportArguments,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let options = arguments.packing.options(&arguments.input)?;
    let outputs = std::iter::once(arguments.output.as_path()).chain(arguments.exports.files());
    output::check_distinct(&arguments.input, outputs)?;
    output::check_writable(&arguments.output, output::PACKING)?;
    arguments.exports.check()?;
    let report = arguments.threads.pool()?.install(|| {
        let (solid, packed) = pack_file(arguments, &options)?;
        output::write(&arguments.output, &packed.packing.to_bytes())?;
        arguments.exports.write(&packed.packing, &arguments.output, Some(&solid))?;
        anyhow::Ok(packed.report)
    })?;
    if arguments.json {
        output::print(to_json(&report, arguments))
    } else {
        output::print(summary(&report, arguments))
    }
}

fn pack_file(arguments: &Arguments, options: &PackOptions) -> anyhow::Result<(Solid, Packed)> {
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
    Ok((solid, packed?))
}

fn summary(report: &PackReport, arguments: &Arguments) -> String {
    let mut text = format!(
        "{}: {} spheres fill {:.2} % of {} (stop: {})\n\
         radii {:.3e} to {:.3e}, median {:.3e}\n\
         placed in {:.2} s, power cells in {:.2} s, checked in {:.2} s\n\
         balls stick out by {:.1e} and overlap by {:.1e}: none does unless a number is positive",
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
        report.protrusion,
        report.overlap,
    );
    if let Some(quality) = &report.quality {
        let gap = &quality.surface_gap;
        text += &format!(
            "\nvolume error {:.2} %, surface gap mean {:.3e}, p95 {:.3e}, largest {:.3e} at {}",
            100.0 * quality.volume_error,
            gap.mean,
            gap.p95,
            gap.max,
            gap.farthest,
        );
        if let Some(gap) = quality.largest_gap {
            text += &format!("\nlargest gap between the balls: radius {:.3e} at {}", gap.radius, gap.center);
        }
    }
    text
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
        "quality": report.quality,
        "seconds": {
            "place": report.place_seconds,
            "cells": report.cells_seconds,
            "finish": report.finish_seconds,
            "quality": report.quality_seconds,
        },
    })
}
