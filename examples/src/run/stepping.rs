//! The loop: step, time, record.

use super::{RunArguments, Simulation, draw};
use crate::figures::Timings;
use crate::recording::describe;
use anyhow::Result;
use indicatif::{ProgressBar, ProgressStyle};
use rapier_ist::record::{RecordOptions, Recorder};
use std::fs::File;
use std::io::BufWriter;
use std::time::Instant;

/// Runs the simulation and records it; draws it on the way where the picture is wanted before the end.
///
/// # Errors
/// Where the recording or the picture cannot be written.
pub fn simulate(simulation: &mut impl Simulation, arguments: &RunArguments) -> Result<Timings> {
    let mut recorder = open(simulation, arguments)?;
    recorder.record_start(simulation.world())?;
    let style = "{msg} {wide_bar} {pos}/{len} steps, {eta} left";
    let bar = ProgressBar::new(arguments.steps as u64).with_style(ProgressStyle::with_template(style)?);
    bar.set_message("simulating");
    let mut timings = Timings::default();
    for step in 0..=arguments.steps {
        if arguments.picture_step() == Some(step) {
            draw(simulation, arguments)?;
        }
        if step == arguments.steps {
            break;
        }
        let start = Instant::now();
        simulation.step();
        timings.step.push(start.elapsed().as_secs_f64() * 1e3);
        timings.query.push(simulation.plugin().report().query_seconds * 1e3);
        recorder.record(simulation.world(), simulation.plugin().report())?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    recorder.finish()?;
    Ok(timings)
}

/// Opens the recording and describes every body in it.
fn open(simulation: &impl Simulation, arguments: &RunArguments) -> Result<Recorder<BufWriter<File>>> {
    let mut options =
        RecordOptions::everything().timings(arguments.timings).metadata("spheres", arguments.spheres);
    for (key, value) in simulation.metadata() {
        options = options.metadata(key, value);
    }
    let mut recorder = Recorder::create(&arguments.mcap, options)?;
    describe(&mut recorder, simulation)?;
    Ok(recorder)
}
