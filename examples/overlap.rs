//! Overlap of two solids at the poses of a file.

use anyhow::{Result, ensure};
use clap::Parser;
use glam::Vec3;
use glamx::Pose3;
use ist::{InnerSphereTree, OverlapWorkspace};
use rapier_ist_examples::accuracy::{compare, median_errors, trees};
use rapier_ist_examples::figures::percentile;
use rapier_ist_examples::output::{check_folder_of, exit_code, print_line, write_whole};
use rapier_ist_examples::pair::{self, Cut, PairSolid};
use rapier_ist_examples::plot::{self, BAND_NAMES};
use rapier_ist_examples::poses::{KnownPose, PoseFile};
use rapier_ist_examples::render::PictureSize;
use rapier_ist_examples::run::{Check, Verdict, Wanted, report, verdict, write_summary};
use serde::Serialize;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

/// Volume, force and centroid of the overlap of two solids at every pose of a file.
///
/// Where the file has the exact volumes, the errors are told and checked.
#[derive(Parser, Debug)]
#[command(after_help = "Examples:
  overlap bunny.obj bunny.obj poses.json --spheres 1000 --out results.json
  overlap bunny.obj bunny.obj poses.json --plot errors.svg --png pose.png --limits 0.041,0.003,0.003
  overlap a.ist b.ist poses.json --plain")]
struct Arguments {
    /// First solid: a closed mesh or an .ist file.
    a: PathBuf,
    /// Second solid: a closed mesh or an .ist file.
    b: PathBuf,
    /// JSON with `poses`: translation and rotation_xyzw of B in A's frame, and the exact volume where it is known.
    poses: PathBuf,
    /// Spheres per mesh; .ist files come with their own.
    #[arg(long, default_value_t = 1000)]
    spheres: usize,
    /// Size of B relative to its file.
    #[arg(long, default_value_t = 1.0)]
    scale_b: f32,
    /// Overlap of the plain inner spheres, without the volume of their power cells, for comparison.
    #[arg(long)]
    plain: bool,
    /// Largest median error of the volume that passes: shallow, mid, deep.
    #[arg(long, value_name = "S,M,D", value_delimiter = ',')]
    limits: Vec<f64>,
    /// Where to write the results as JSON.
    #[arg(long, value_name = "FILE.json")]
    out: Option<PathBuf>,
    /// Recording of the poses, one per 1/60 s.
    #[arg(long, value_name = "FILE")]
    mcap: Option<PathBuf>,
    /// Picture of the solids, cut open, at the pose whose overlap is nearest to a tenth of the smaller one.
    #[arg(long, value_name = "FILE.png")]
    png: Option<PathBuf>,
    /// Width of the picture in pixels; 16:9.
    #[arg(long, value_name = "PIXELS", default_value_t = 1280, value_parser = clap::value_parser!(u32).range(16..=7680))]
    png_width: u32,
    /// Plot of the errors, with power cells and without, where the exact volumes are known.
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
    /// Figures and checks as JSON.
    #[arg(long, value_name = "FILE.json")]
    summary: Option<PathBuf>,
}

/// Poses that the solids pass through per second in a recording.
const RATE: f32 = 60.0;
/// Overlap that has to be found, as a share of the smaller solid.
const NOTICED: f64 = 0.002;

#[derive(Serialize)]
struct Results {
    poses: Vec<OverlapRecord>,
}

/// Overlap at one pose, in A's frame, for a stiffness of 1 N/m³.
#[derive(Serialize)]
struct OverlapRecord {
    volume: f32,
    force: [f32; 3],
    centroid: [f32; 3],
    intersects: bool,
    pairs: u32,
    microseconds: f64,
}

/// Figures of a run; every file of `--summary` has these names.
#[derive(Serialize)]
struct Figures {
    poses: usize,
    spheres: [usize; 2],
    intersecting: usize,
    /// Wall time of a query of solids that intersect (µs): median and 95th percentile.
    microseconds: [f64; 2],
    /// Median relative errors of the volume where it is known: shallow, mid, deep.
    volume_errors: [Option<f64>; 3],
}

fn main() -> ExitCode {
    exit_code(run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> Result<Verdict> {
    let Arguments { out, mcap, png, plot, summary, .. } = arguments;
    for path in [out, mcap, png, plot, summary].into_iter().flatten() {
        check_folder_of(path)?;
    }
    let file = PoseFile::load(&arguments.poses)?.for_scale(arguments.scale_b);
    let solids = load(arguments)?;
    let trees = trees(&solids, arguments.plain)?;
    let results = measure_all(&trees, &file.poses);
    let figures = figures(&file, &trees, &results);
    print_line(format_args!(
        "{} poses, {} intersect, median {:.1} µs, p95 {:.1} µs for those",
        figures.poses, figures.intersecting, figures.microseconds[0], figures.microseconds[1]
    ))?;
    let checks = checks(&file, &results, &figures, &arguments.limits);
    report(&checks)?;
    let [a, b] = &solids;
    if let Some(path) = plot {
        let name = arguments.poses.file_stem().unwrap_or_default().to_string_lossy();
        let groups = [compare(&name, &file, &solids)?];
        write_whole(path, plot::accuracy(&groups)?.as_bytes())?;
    }
    if let Some(path) = png {
        let (pose, at) = typical(&file, &trees, &results);
        let size = PictureSize::wide(arguments.png_width);
        pair::draw([a, b], &Cut { pose, at, size }, path)?;
    }
    if let Some(path) = mcap {
        let poses: Vec<Pose3> = file.poses.iter().map(|known| known.pose).collect();
        pair::record([a, b], &poses, [RATE.recip(), 1.0], path)?;
    }
    if let Some(path) = out {
        write_whole(path, serde_json::to_string(&Results { poses: results })?.as_bytes())?;
    }
    if let Some(path) = summary {
        write_summary(path, &figures, &checks)?;
    }
    Ok(verdict(&checks))
}

fn load(arguments: &Arguments) -> Result<[PairSolid; 2]> {
    let a = PairSolid::load(&arguments.a, arguments.spheres)?;
    let b = if arguments.b == arguments.a {
        a.clone()
    } else {
        PairSolid::load(&arguments.b, arguments.spheres)?
    };
    ensure!(arguments.limits.is_empty() || arguments.limits.len() == 3, "--limits needs three numbers");
    Ok([a, PairSolid { scale: arguments.scale_b, ..b }])
}

fn measure_all([a, b]: &[InnerSphereTree; 2], poses: &[KnownPose]) -> Vec<OverlapRecord> {
    let mut workspace = OverlapWorkspace::default();
    poses.iter().map(|known| measure(a, b, &known.pose, &mut workspace)).collect()
}

/// Measured and exact volumes where the latter are known.
fn volumes(file: &PoseFile, results: &[OverlapRecord]) -> Vec<(f64, f64)> {
    let pairs = file.poses.iter().zip(results);
    pairs.filter_map(|(known, result)| Some((f64::from(result.volume), known.volume?))).collect()
}

fn figures(file: &PoseFile, [a, b]: &[InnerSphereTree; 2], results: &[OverlapRecord]) -> Figures {
    let times: Vec<f64> = results.iter().filter(|r| r.intersects).map(|r| r.microseconds).collect();
    let errors = |smaller| median_errors(&volumes(file, results), smaller);
    Figures {
        poses: results.len(),
        spheres: [a.len(), b.len()],
        intersecting: times.len(),
        microseconds: [0.5, 0.95].map(|share| percentile(&times, share)),
        volume_errors: file.smaller_volume.map_or([None; 3], errors),
    }
}

fn checks(file: &PoseFile, results: &[OverlapRecord], figures: &Figures, limits: &[f64]) -> Vec<Check> {
    let Some(smaller) = file.smaller_volume else { return Vec::new() };
    let known =
        || file.poses.iter().zip(results).filter_map(|(known, r)| Some((known.volume?, r.intersects)));
    let count = |wrong: fn(f64, bool) -> bool| {
        known().filter(|(volume, found)| wrong(volume / smaller, *found)).count() as f64
    };
    let mut checks = vec![
        Check::new(
            "separated, found to intersect",
            count(|share, found| share == 0.0 && found),
            "",
            Wanted::AtMost(0.0),
        ),
        Check::new(
            "overlap missed",
            count(|share, found| share >= NOTICED && !found),
            "",
            Wanted::AtMost(0.0),
        ),
    ];
    for (band, (name, error)) in BAND_NAMES.iter().zip(figures.volume_errors).enumerate() {
        let Some(error) = error else { continue };
        let wanted = limits.get(band).map_or(Wanted::Reported, |limit| Wanted::AtMost(100.0 * limit));
        checks.push(Check::new(format!("error of the volume, {name}"), 100.0 * error, "%", wanted));
    }
    checks
}

/// The pose whose overlap is nearest to a tenth of the smaller solid, and the overlap's centroid there.
fn typical(file: &PoseFile, [a, b]: &[InnerSphereTree; 2], results: &[OverlapRecord]) -> (Pose3, Vec3) {
    let wanted = 0.1 * a.solid().volume.min(b.solid().volume);
    let distance = |result: &OverlapRecord| (f64::from(result.volume) - wanted).abs();
    let pairs = file.poses.iter().zip(results);
    let nearest = pairs.min_by(|x, y| distance(x.1).total_cmp(&distance(y.1)));
    nearest.map_or((Pose3::IDENTITY, Vec3::ZERO), |(known, result)| (known.pose, Vec3::from(result.centroid)))
}

/// Best of five runs, as other processes share the machine.
fn measure(
    a: &InnerSphereTree,
    b: &InnerSphereTree,
    pose: &Pose3,
    workspace: &mut OverlapWorkspace,
) -> OverlapRecord {
    let mut microseconds = f64::INFINITY;
    let mut overlap = ist::Overlap::default();
    for _ in 0..5 {
        let start = Instant::now();
        overlap = a.overlap(b, pose, workspace);
        microseconds = microseconds.min(start.elapsed().as_secs_f64() * 1e6);
    }
    OverlapRecord {
        volume: overlap.volume,
        force: overlap.force.to_array(),
        centroid: overlap.centroid.to_array(),
        intersects: overlap.intersects,
        pairs: overlap.pairs,
        microseconds,
    }
}
