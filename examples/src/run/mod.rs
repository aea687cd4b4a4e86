//! What every example with a simulation does: step, record, draw, check its own physics, and say how it went.
//!
//! An example builds a [`Simulation`] and leaves the rest to [`main`]:
//!
//! ```no_run
//! use clap::Parser;
//! use rapier_ist_examples::run::{self, Defaults, RunArguments};
//! use rapier_ist_examples::scenes::{Pile, PileOptions};
//!
//! /// Drops bodies into a bowl.
//! #[derive(Parser)]
//! struct Arguments {
//!     #[command(flatten)]
//!     run: RunArguments,
//! }
//!
//! impl AsRef<RunArguments> for Arguments {
//!     fn as_ref(&self) -> &RunArguments {
//!         &self.run
//!     }
//! }
//!
//! fn main() -> std::process::ExitCode {
//!     let defaults = Defaults { steps: "600", spheres: "1000", mcap: "pile.mcap", png: "pile.png" };
//!     run::main(&defaults, |arguments: &Arguments, progress| {
//!         let options = PileOptions { spheres: arguments.run.spheres, ..PileOptions::default() };
//!         Pile::new(&options, progress)
//!     })
//! }
//! ```

mod arguments;
mod check;
mod picture;
mod resident;
mod simulation;
mod soak;
mod stepping;

pub use arguments::{Defaults, RunArguments, parse};
pub use check::{Check, Verdict, Wanted, report, verdict};
pub use picture::draw;
pub use simulation::{Body, Simulation, View};
pub use soak::{Soak, SoakArguments, SoakFigures, build_and_soak, soak};
pub use stepping::simulate;

use crate::figures::Summary;
use crate::output::{exit_code, print_line, write_whole};
use anyhow::Result;
use clap::Parser;
use indicatif::ProgressBar;
use serde::Serialize;
use std::path::Path;
use std::process::ExitCode;

/// A whole example: reads the arguments, builds the simulation, runs it.
///
/// `build` gets a function to tell what it is doing. Exit status: 0, 1 where a check failed, 2 for bad input.
pub fn main<A, S>(defaults: &Defaults, build: impl FnOnce(&A, &mut dyn FnMut(&str)) -> Result<S>) -> ExitCode
where
    A: Parser + AsRef<RunArguments>,
    S: Simulation,
{
    let arguments: A = parse(defaults);
    exit_code(build_and_run(arguments.as_ref(), |progress| build(&arguments, progress)))
}

/// As [`main`], for an example that has read its arguments.
///
/// # Errors
/// As `build`, and where a file cannot be written.
pub fn build_and_run<S: Simulation>(
    arguments: &RunArguments,
    build: impl FnOnce(&mut dyn FnMut(&str)) -> Result<S>,
) -> Result<Verdict> {
    arguments.check()?;
    run(&mut with_spinner(build)?, arguments)
}

/// Shows what `build` says it is doing, until it is done.
pub fn with_spinner<T>(build: impl FnOnce(&mut dyn FnMut(&str)) -> T) -> T {
    let spinner = ProgressBar::new_spinner();
    let built = build(&mut |message| {
        spinner.set_message(message.to_owned());
        spinner.tick();
    });
    spinner.finish_and_clear();
    built
}

/// Steps and records `simulation`, draws it, and prints and writes its figures and checks.
///
/// # Errors
/// Where a file cannot be written.
pub fn run(simulation: &mut impl Simulation, arguments: &RunArguments) -> Result<Verdict> {
    let timings = simulate(simulation, arguments)?;
    let summary = Summary::of(simulation, &timings);
    let checks = simulation.checks(&summary);
    if arguments.png_time.is_none() {
        draw(simulation, arguments)?;
    }
    if let Some(path) = &arguments.summary {
        write_summary(path, &figures_of(simulation, &summary), &checks)?;
    }
    let dt = f64::from(simulation.world().integration_parameters.dt);
    let (title, seconds, rate) = (simulation.title(), arguments.steps as f64 * dt, dt.recip());
    let text = format!("{title}, {seconds:.1} s at {rate:.0} Hz\n{summary}{}", simulation.remarks());
    print_line(text.trim_end())?;
    report(&checks)?;
    print_line(format_args!(
        "  recording {}, picture {}",
        arguments.mcap.display(),
        arguments.png.display()
    ))?;
    Ok(verdict(&checks))
}

/// Figures that all runs have, with the simulation's own under `scene`.
#[derive(Serialize)]
struct Figures<'a> {
    #[serde(flatten)]
    summary: &'a Summary,
    #[serde(skip_serializing_if = "serde_json::Value::is_null")]
    scene: serde_json::Value,
}

fn figures_of<'a>(simulation: &impl Simulation, summary: &'a Summary) -> Figures<'a> {
    Figures { summary, scene: simulation.figures() }
}

/// Writes the figures with the checks beside them as JSON.
///
/// # Errors
/// Where the file cannot be written.
pub fn write_summary(path: &Path, figures: &impl Serialize, checks: &[Check]) -> Result<()> {
    #[derive(Serialize)]
    struct File<'a, F> {
        #[serde(flatten)]
        figures: &'a F,
        checks: &'a [Check],
    }
    write_whole(path, serde_json::to_string_pretty(&File { figures, checks })?.as_bytes())
}
