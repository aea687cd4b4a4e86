//! A small body wholly inside a large one, beside Rapier's own shapes.

use anyhow::Result;
use clap::{Parser, ValueEnum};
use packer::TriangleMesh;
use rapier_ist_examples::poses::PoseFile;
use rapier_ist_examples::run::{self, Defaults, RunArguments};
use rapier_ist_examples::scenes::{Model, Recovery, ShapeKind, asset_folder};
use std::path::Path;
use std::process::ExitCode;

/// Lets go of small bunnies wholly inside large ones, without gravity, and watches how they get out: as inner sphere trees,
/// and beside them as Rapier's own shapes for non-convex meshes.
#[derive(Parser, Debug)]
#[command(after_help = "Examples:
  inside                              all four shapes at four poses; inside.mcap, inside.png
  inside --shape ist --poses 32       one shape at more poses")]
struct Arguments {
    /// What stands for the meshes in the simulation; all kinds side by side if not given.
    #[arg(long, value_enum)]
    shape: Option<ShapeKind>,
    /// Number of poses, taken evenly from the 73 of tests/data/bunny_inside.json that are wholly inside.
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u8).range(1..=32))]
    poses: u8,
    #[command(flatten)]
    run: RunArguments,
}

impl AsRef<RunArguments> for Arguments {
    fn as_ref(&self) -> &RunArguments {
        &self.run
    }
}

fn main() -> ExitCode {
    let defaults = Defaults { steps: "180", spheres: "1000", mcap: "inside.mcap", png: "inside.png" };
    run::main(&defaults, build)
}

fn build(arguments: &Arguments, progress: &mut dyn FnMut(&str)) -> Result<Recovery> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/bunny_inside.json");
    let file = PoseFile::load(&data)?;
    let (all, count) = (file.contained(), usize::from(arguments.poses));
    // The first and the last are among them.
    let place = |index: usize| all.get(index * (all.len() - 1) / (count - 1).max(1)).copied();
    let poses: Vec<_> = (0..count).filter_map(place).collect();
    let kinds = arguments.shape.map_or_else(|| ShapeKind::value_variants().to_vec(), |kind| vec![kind]);
    let mesh = TriangleMesh::load(asset_folder().join("bunny.obj"))?;
    Recovery::new(&kinds, &poses, file.scale_b.unwrap_or(0.2), |kind| {
        progress(&format!("preparing {kind:?}"));
        Model::new("bunny", mesh.clone(), arguments.run.spheres, kind)
    })
}
