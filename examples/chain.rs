//! Rings that hang from each other and swing.

use clap::Parser;
use rapier_ist_examples::run::{self, Defaults, RunArguments};
use rapier_ist_examples::scenes::Swing;
use std::process::ExitCode;

/// Hangs twelve linked rings from a fixed one, pushes the lower half after two seconds, and watches them swing.
#[derive(Parser, Debug)]
#[command(after_help = "Examples:
  chain                                     20 seconds; chain.mcap, chain.png
  chain --steps 1920 --summary chain.json   half a minute of swinging")]
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
    let defaults = Defaults { steps: "1200", spheres: "1000", mcap: "chain.mcap", png: "chain.png" };
    run::main(&defaults, |arguments: &Arguments, progress| {
        progress("packing a ring");
        Swing::new(arguments.run.spheres)
    })
}
