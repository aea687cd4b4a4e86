//! A nut on a bolt.

use clap::Parser;
use rapier_ist_examples::run::{self, Defaults, RunArguments};
use rapier_ist_examples::scenes::Bolt;
use std::process::ExitCode;

/// Lets a nut turn down the coarse thread of a standing bolt, by its weight alone.
#[derive(Parser, Debug)]
#[command(after_help = "Examples:
  bolt                     3 seconds; bolt.mcap, bolt.png
  bolt --friction 0        without friction, as in the closed form
  bolt --friction 0.3      the thread locks itself: the nut stays where it is")]
struct Arguments {
    /// Coulomb friction of the thread, 0 or more; from about 0.13 on it holds the nut.
    #[arg(long, default_value_t = Bolt::default_friction(), value_parser = friction)]
    friction: f64,
    #[command(flatten)]
    run: RunArguments,
}

fn friction(text: &str) -> Result<f64, String> {
    let friction: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if (0.0..=100.0).contains(&friction) { Ok(friction) } else { Err("not from 0 to 100".to_owned()) }
}

impl AsRef<RunArguments> for Arguments {
    fn as_ref(&self) -> &RunArguments {
        &self.run
    }
}

fn main() -> ExitCode {
    let defaults = Defaults { steps: "180", spheres: "5000", mcap: "bolt.mcap", png: "bolt.png" };
    run::main(&defaults, |arguments: &Arguments, progress| {
        progress("packing bolt and nut");
        Bolt::new(arguments.run.spheres, arguments.friction)
    })
}
