//! A hand puts a gear onto a shaft.

use clap::Parser;
use rapier_ist_examples::run::{self, Defaults, RunArguments};
use rapier_ist_examples::scenes::Assembly;
use std::process::ExitCode;

/// Takes a gear between three fingers, puts it onto a shaft beside another gear, so that their teeth mesh, and turns both by a
/// motor.
#[derive(Parser, Debug)]
#[command(after_help = "Examples:
  assembly                      10 seconds; assembly.mcap, assembly.png
  assembly --png-time 2.8       picture of the gear in the hand")]
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
    let defaults = Defaults { steps: "600", spheres: "3000", mcap: "assembly.mcap", png: "assembly.png" };
    run::main(&defaults, |arguments: &Arguments, progress| {
        progress("packing gears and hand");
        Assembly::new(arguments.run.spheres)
    })
}
