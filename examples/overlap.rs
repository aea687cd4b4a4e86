//! Overlap of two solids at the poses of a file.

use anyhow::{Context, Result, ensure};
use clap::Parser;
use glam::{Quat, Vec3};
use glamx::Pose3;
use ist::{InnerSphere, InnerSphereTree, OverlapWorkspace, SpherePacking};
use packer::{PackOptions, Solid, TriangleMesh, pack};
use rapier_ist_examples::figures::percentile;
use rapier_ist_examples::output::{check_folder_of, exit_code, write_whole};
use rapier_ist_examples::run::Verdict;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// Volume, force and centroid of the overlap of two solids at every pose of a file.
#[derive(Parser, Debug)]
#[command(after_help = "Examples:
  overlap bunny.obj bunny.obj poses.json --spheres 1000 --out results.json
  overlap a.ist b.ist poses.json --plain")]
struct Arguments {
    /// First solid: a closed mesh or an .ist file.
    a: PathBuf,
    /// Second solid: a closed mesh or an .ist file.
    b: PathBuf,
    /// JSON with `poses`: translation and rotation_xyzw of B in A's frame.
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
    /// Where to write the results as JSON.
    #[arg(long, value_name = "FILE.json")]
    out: Option<PathBuf>,
}

#[derive(Deserialize)]
struct Poses {
    poses: Vec<PoseRecord>,
}

#[derive(Deserialize)]
struct PoseRecord {
    translation: [f32; 3],
    rotation_xyzw: [f32; 4],
}

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

fn main() -> ExitCode {
    exit_code(run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> Result<Verdict> {
    if let Some(path) = &arguments.out {
        check_folder_of(path)?;
    }
    let poses = read_poses(&arguments.poses)?;
    let a = tree(&arguments.a, arguments)?;
    let b = if arguments.b == arguments.a { a.clone() } else { tree(&arguments.b, arguments)? };
    let b = b.scaled(arguments.scale_b).context("--scale-b must be a positive number")?;

    let mut workspace = OverlapWorkspace::default();
    let results: Vec<OverlapRecord> =
        poses.iter().map(|pose| measure(&a, &b, pose, &mut workspace)).collect();

    let hits = results.iter().filter(|r| r.intersects).count();
    let times: Vec<f64> = results.iter().filter(|r| r.intersects).map(|r| r.microseconds).collect();
    println!(
        "{} poses, {hits} intersect, median {:.1} µs, p95 {:.1} µs for those",
        results.len(),
        percentile(&times, 0.5),
        percentile(&times, 0.95)
    );
    if let Some(path) = &arguments.out {
        write_whole(path, serde_json::to_string(&Results { poses: results })?.as_bytes())?;
    }
    Ok(Verdict::Passed)
}

fn read_poses(path: &Path) -> Result<Vec<Pose3>> {
    let text = std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    let poses: Poses = serde_json::from_str(&text).with_context(|| {
        format!("{} is not a pose file: it needs poses with translation and rotation_xyzw", path.display())
    })?;
    let pose = |record: &PoseRecord| {
        Pose3::from_parts(
            Vec3::from_array(record.translation),
            Quat::from_array(record.rotation_xyzw).normalize(),
        )
    };
    let poses: Vec<Pose3> = poses.poses.iter().map(pose).collect();
    ensure!(
        poses.iter().all(Pose3::is_finite),
        "{}: a pose is not finite or its rotation is zero",
        path.display()
    );
    Ok(poses)
}

/// The tree of an `.ist` file, or of a mesh that is packed now.
fn tree(path: &Path, arguments: &Arguments) -> Result<InnerSphereTree> {
    let load = || -> Result<SpherePacking> {
        if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ist")) {
            return Ok(SpherePacking::load(path)?);
        }
        let solid = Solid::new(&TriangleMesh::load(path)?)?;
        Ok(pack(&solid, &PackOptions::balanced().spheres(arguments.spheres))?.packing)
    };
    let packing = load().with_context(|| format!("cannot use {}", path.display()))?;
    Ok(InnerSphereTree::new(&if arguments.plain { plain(&packing)? } else { packing }))
}

/// The packing with every power cell cut down to its inner ball.
fn plain(packing: &SpherePacking) -> Result<SpherePacking> {
    let ball = |s: &InnerSphere| InnerSphere::solid_ball(s.center, s.radius, s.normal);
    Ok(SpherePacking::new(packing.spheres().iter().map(ball).collect(), *packing.solid())?)
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
