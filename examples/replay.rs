//! A recording, replayed: figures, a table, pictures and a page that plays it.

use anyhow::{Context, Result};
use clap::Parser;
use rapier_ist::replay::{Replay, ReplayEnd, ReplayStep};
use rapier_ist_examples::animation::save_apng;
use rapier_ist_examples::output::{check_folder_of, exit_code, print_line, write_whole};
use rapier_ist_examples::playback::Playback;
use rapier_ist_examples::player::page;
use rapier_ist_examples::plot;
use rapier_ist_examples::render::PictureSize;
use rapier_ist_examples::run::{Check, Verdict, Wanted, verdict, write_summary};
use serde::Serialize;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Reads a recording of any example back and shows what is in it, from the file alone.
#[derive(Parser, Debug)]
#[command(after_help = "Examples:
  replay pile.mcap                                  what is in it
  replay pile.mcap --html pile.html                 a page that plays it
  replay pile.mcap --png half.png --time 5          a picture at 5 s
  replay pile.mcap --plot pile.svg                  energy, deepest overlap and step time
  replay pile.mcap --apng pile.png --rate 20        an animation")]
struct Arguments {
    /// The recording, finished or cut off.
    #[arg(value_name = "FILE.mcap")]
    recording: PathBuf,
    /// Table of all poses: time (s), body, position (m), rotation as a quaternion.
    #[arg(long, value_name = "FILE.csv")]
    csv: Option<PathBuf>,
    /// Picture at the time asked for.
    #[arg(long, value_name = "FILE.png")]
    png: Option<PathBuf>,
    /// Time of the picture (s); the end if not given.
    #[arg(long, requires = "png")]
    time: Option<f64>,
    /// Animation as an animated PNG.
    #[arg(long, value_name = "FILE.png")]
    apng: Option<PathBuf>,
    /// Width of the animation in pixels; 16:9.
    #[arg(long, value_name = "PIXELS", default_value_t = 480, value_parser = clap::value_parser!(u32).range(16..=7680))]
    apng_width: u32,
    /// Where the animation ends (s); the recording's end if not given.
    #[arg(long, requires = "apng")]
    until: Option<f64>,
    /// Pictures per second of the animation.
    #[arg(long, default_value_t = 15, value_parser = clap::value_parser!(u16).range(1..=120))]
    rate: u16,
    /// Plot of energy, deepest overlap and, if it was recorded, step time.
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
    /// What is in the recording, as JSON.
    #[arg(long, value_name = "FILE.json")]
    summary: Option<PathBuf>,
    /// Page that plays the recording in a browser, all in one file.
    #[arg(long, value_name = "FILE.html")]
    html: Option<PathBuf>,
}

fn main() -> ExitCode {
    exit_code(run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> Result<Verdict> {
    let Arguments { recording, csv, png, time, apng, rate, until, plot, summary, html, .. } = arguments;
    for path in [csv, png, apng, plot, summary, html].into_iter().flatten() {
        check_folder_of(path)?;
    }
    let replay = Replay::open(recording)?;
    let contents = Contents::of(&replay);
    print_line(table_of_contents(&contents, &replay, recording)?.trim_end())?;
    let checks = contents.checks();
    if let Some(path) = summary {
        write_summary(path, &contents, &checks)?;
    }
    if let Some(path) = csv {
        write_whole(path, table(&replay)?.as_bytes())?;
    }
    let playback = Playback::new(&replay);
    if let Some(path) = png {
        let size = PictureSize::HD;
        let picture = playback.picture(time.unwrap_or(replay.duration()), &playback.camera(size), size);
        picture.save_png(path).context("cannot draw the picture")?;
    }
    if let Some(path) = apng {
        let size = PictureSize::wide(arguments.apng_width);
        let camera = playback.camera(size);
        let end = until.unwrap_or(f64::INFINITY).clamp(0.0, replay.duration());
        let count = (end * f64::from(*rate)) as u32 + 1;
        let times = (0..count).map(|frame| f64::from(frame) / f64::from(*rate));
        let pictures: Vec<_> = times.map(|time| playback.picture(time, &camera, size)).collect();
        save_apng(path, &pictures, *rate).context("cannot draw the animation")?;
    }
    if let Some(path) = plot {
        write_whole(path, plot::course(&replay)?.as_bytes())?;
    }
    if let Some(path) = html {
        write_whole(path, page(&replay, &name_of(recording))?.as_bytes())?;
    }
    for path in [csv, png, apng, plot, summary, html].into_iter().flatten() {
        print_line(format_args!("  wrote {}", path.display()))?;
    }
    Ok(verdict(&checks))
}

/// The file's name without folder and ending.
fn name_of(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// What is in a recording; every file of `--summary` has these names.
#[derive(Serialize)]
struct Contents {
    /// How the file ends.
    end: String,
    /// Length (s).
    seconds: f64,
    steps: usize,
    bodies: usize,
    meshes: usize,
    spheres: usize,
    /// Of all steps.
    contacts: usize,
    /// Largest depth of a contact (m).
    deepest_overlap: f64,
    /// Errors in the log.
    errors: usize,
    /// Things that could not be replayed.
    left_out: usize,
}

impl Contents {
    fn of(replay: &Replay) -> Self {
        let bodies = replay.bodies();
        let depth = |step: ReplayStep<'_>| step.metrics().map(|metrics| metrics.deepest_overlap);
        Self {
            end: replay.end().to_string(),
            seconds: replay.duration(),
            steps: replay.step_count(),
            bodies: bodies.len(),
            meshes: bodies.iter().filter(|body| body.mesh.is_some()).count(),
            spheres: bodies.iter().map(|body| body.spheres.len()).sum(),
            contacts: replay.steps().map(|step| step.contacts().len()).sum(),
            deepest_overlap: replay.steps().filter_map(depth).fold(0.0, f64::max),
            errors: replay.log().iter().filter(|line| line.is_error).count(),
            left_out: replay.defects().len(),
        }
    }

    fn checks(&self) -> Vec<Check> {
        vec![Check::new("things that could not be replayed", self.left_out as f64, "", Wanted::AtMost(0.0))]
    }
}

fn table_of_contents(contents: &Contents, replay: &Replay, path: &Path) -> Result<String> {
    let mut text = format!("recording {}\n", path.display());
    let mut row = |name: &str, value: String| writeln!(text, "  {name:<18}{value}");
    row("end", contents.end.clone())?;
    row("length", format!("{:.3} s, {} steps", contents.seconds, contents.steps))?;
    row("bodies", format!("{}, {} with a mesh", contents.bodies, contents.meshes))?;
    row("spheres", contents.spheres.to_string())?;
    let unseen = replay.bodies().iter().filter(|body| body.mesh.is_none() && body.spheres.is_empty()).count();
    if unseen > 0 {
        row("not drawn", format!("{unseen} bodies: describe them by BodyDescription::mesh or spheres"))?;
    }
    row("contacts", format!("{}, deepest {:.3} mm", contents.contacts, contents.deepest_overlap * 1e3))?;
    for (record, entries) in replay.metadata() {
        let entries: Vec<String> = entries.iter().map(|(key, value)| format!("{key} {value}")).collect();
        row(record, entries.join(", "))?;
    }
    for line in replay.log().iter().filter(|line| line.is_error) {
        row("error", format!("at {:.3} s: {}", line.time, line.message))?;
    }
    for defect in replay.defects() {
        row("left out", defect.clone())?;
    }
    if *replay.end() != ReplayEnd::Complete {
        row("note", "replayed up to its end; finish() writes the rest".to_owned())?;
    }
    Ok(text)
}

/// All poses as comma-separated values. Names have no commas: a recorder replaces them.
fn table(replay: &Replay) -> Result<String> {
    let mut text = String::from("time,body,x,y,z,qx,qy,qz,qw\n");
    for step in replay.steps() {
        for (body, pose) in step.poses() {
            let ([x, y, z], [qx, qy, qz, qw]) = (pose.translation.to_array(), pose.rotation.to_array());
            let name = &replay.bodies()[body].name;
            writeln!(text, "{},{name},{x},{y},{z},{qx},{qy},{qz},{qw}", step.time())?;
        }
    }
    Ok(text)
}
