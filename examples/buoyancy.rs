//! Bodies float in water.

use clap::Parser;
use rapier_ist_examples::run::{self, Defaults, RunArguments};
use rapier_ist_examples::scenes::Floating;
use std::process::ExitCode;

/// Drops a bunny, a box, a beam, a ring and a knot into water and compares how they float with the exact volumes of their
/// meshes.
///
/// The force of the water is that of the volume that it shares with the body's spheres. It is no part of the plugin: the
/// example sets it as a user force before each step.
#[derive(Parser, Debug)]
#[command(after_help = "Examples:
  buoyancy                                  12 seconds; buoyancy.mcap, buoyancy.png
  buoyancy --spheres 300 --summary b.json   fewer spheres")]
struct Arguments {
    #[command(flatten)]
    run: RunArguments,
}

impl AsRef<RunArguments> for Arguments {
    fn as_ref(&self) -> &RunArguments {
        &self.run
    }
}

fn main() -> ExitCode {
    let defaults = Defaults { steps: "720", spheres: "1000", mcap: "buoyancy.mcap", png: "buoyancy.png" };
    run::main(&defaults, |arguments: &Arguments, progress| Floating::new(arguments.run.spheres, progress))
}
