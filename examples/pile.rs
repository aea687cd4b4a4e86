//! Bodies of mixed shape and size fall into a bowl.

use clap::Parser;
use rapier_ist_examples::output::exit_code;
use rapier_ist_examples::run::{self, Defaults, RunArguments, SoakArguments};
use rapier_ist_examples::scenes::{Pile, PileOptions, ShapeKind, SoakedPile};
use std::path::PathBuf;
use std::process::ExitCode;

/// Drops bodies of mixed shape and size into a non-convex bowl at 60 Hz, records the run and draws a picture.
#[derive(Parser, Debug)]
#[command(after_help = "Examples:
  pile                                       40 bodies, 10 seconds; pile.mcap, pile.png
  pile --shape vhacd --summary vhacd.json    the same scene with Rapier's convex decomposition
  pile --mesh chair.obj --mesh cup.stl       your own meshes
  pile --soak 3600 --bodies 25               an hour in which bodies come and go, for leaks and losses")]
struct Arguments {
    /// Number of bodies.
    #[arg(long, default_value_t = 40)]
    bodies: usize,
    /// Seed of sizes, places and rotations.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// A closed mesh to use instead of the built-in ones (OBJ, STL, PLY, glTF); repeatable.
    #[arg(long = "mesh", value_name = "FILE")]
    meshes: Vec<PathBuf>,
    /// What stands for the meshes in the simulation.
    #[arg(long, value_enum, default_value_t)]
    shape: ShapeKind,
    #[command(flatten)]
    soak: SoakArguments,
    #[command(flatten)]
    run: RunArguments,
}

fn main() -> ExitCode {
    let defaults = Defaults { steps: "600", spheres: "1000", mcap: "pile.mcap", png: "pile.png" };
    let Arguments { bodies, seed, meshes, shape, soak, run } = run::parse(&defaults);
    let options = PileOptions { bodies, seed, spheres: run.spheres, meshes, shape };
    exit_code(match soak.soak {
        Some(seconds) => {
            run::build_and_soak(seconds, &run, |progress| SoakedPile::new(&options, soak.soak_seed, progress))
        }
        None => run::build_and_run(&run, |progress| Pile::new(&options, progress)),
    })
}
