//! Rings that hang from each other and swing.

use clap::Parser;
use rapier_ist_examples::output::exit_code;
use rapier_ist_examples::run::{self, Defaults, RunArguments, SoakArguments};
use rapier_ist_examples::scenes::{SoakedChain, Swing};
use std::process::ExitCode;

/// Hangs twelve linked rings from a fixed one, pushes the lower half after two seconds, and watches them swing.
#[derive(Parser, Debug)]
#[command(after_help = "Examples:
  chain                                     20 seconds; chain.mcap, chain.png
  chain --steps 1920 --summary chain.json   half a minute of swinging
  chain --soak 3600                         an hour of pushes at random, for leaks and lost links")]
struct Arguments {
    #[command(flatten)]
    soak: SoakArguments,
    #[command(flatten)]
    run: RunArguments,
}

fn main() -> ExitCode {
    let defaults = Defaults { steps: "1200", spheres: "1000", mcap: "chain.mcap", png: "chain.png" };
    let Arguments { soak, run } = run::parse(&defaults);
    let packing = "packing a ring";
    exit_code(match soak.soak {
        Some(seconds) => run::build_and_soak(seconds, &run, |progress| {
            progress(packing);
            SoakedChain::new(run.spheres, soak.soak_seed)
        }),
        None => run::build_and_run(&run, |progress| {
            progress(packing);
            Swing::new(run.spheres)
        }),
    })
}
