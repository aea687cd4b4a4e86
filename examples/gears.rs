//! Two gears that turn each other.

use clap::Parser;
use rapier_ist_examples::run::{self, Defaults, RunArguments};
use rapier_ist_examples::scenes::Gears;
use std::process::ExitCode;

/// Turns a gear of 14 teeth by a motor in its joint; it turns one of 21 teeth against a load, by its teeth alone.
#[derive(Parser, Debug)]
#[command(after_help = "Examples:
  gears                                     20 seconds; gears.mcap, gears.png
  gears --spheres 10000 --steps 3600        finer teeth, a minute")]
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
    let defaults = Defaults { steps: "1200", spheres: "3000", mcap: "gears.mcap", png: "gears.png" };
    run::main(&defaults, |arguments: &Arguments, progress| {
        progress("packing gears");
        Gears::new(arguments.run.spheres)
    })
}
