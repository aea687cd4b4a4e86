//! A recording, replayed: figures, a table, pictures and a page that plays it.

use anyhow::{Context, Result};
use clap::Parser;
use rapier_ist::replay::{Replay, ReplayEnd};
use rapier_ist_examples::animation::save_apng;
use rapier_ist_examples::output::{check_folder_of, exit_code, write_whole};
use rapier_ist_examples::playback::Playback;
use rapier_ist_examples::player::page;
use rapier_ist_examples::render::PictureSize;
use rapier_ist_examples::run::Verdict;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Reads a recording of any example back and shows what is in it, from the file alone.
#[derive(Parser, Debug)]
#[command(after_help = "Examples:
  replay pile.mcap                                  what is in it
  replay pile.mcap --html pile.html                 a page that plays it
  replay pile.mcap --png half.png --time 5          a picture at 5 s
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
    /// Animation as an animated PNG, 480 × 270 pixels.
    #[arg(long, value_name = "FILE.png")]
    apng: Option<PathBuf>,
    /// Pictures per second of the animation.
    #[arg(long, default_value_t = 15, value_parser = clap::value_parser!(u16).range(1..=120))]
    rate: u16,
    /// Page that plays the recording in a browser, all in one file.
    #[arg(long, value_name = "FILE.html")]
    html: Option<PathBuf>,
}

/// Size of animations: at 15 pictures a second, ten seconds of the pile are 13 MB.
const ANIMATION: PictureSize = PictureSize { width: 480, height: 270 };

fn main() -> ExitCode {
    exit_code(run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> Result<Verdict> {
    let Arguments { recording, csv, png, time, apng, rate, html } = arguments;
    for path in [csv, png, apng, html].into_iter().flatten() {
        check_folder_of(path)?;
    }
    let replay = Replay::open(recording)?;
    print!("{}", summary(&replay, recording)?);
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
        let camera = playback.camera(ANIMATION);
        let count = (replay.duration() * f64::from(*rate)) as u32 + 1;
        let times = (0..count).map(|frame| f64::from(frame) / f64::from(*rate));
        let pictures: Vec<_> = times.map(|time| playback.picture(time, &camera, ANIMATION)).collect();
        save_apng(path, &pictures, *rate).context("cannot draw the animation")?;
    }
    if let Some(path) = html {
        write_whole(path, page(&replay, &name_of(recording))?.as_bytes())?;
    }
    for path in [csv, png, apng, html].into_iter().flatten() {
        println!("  wrote {}", path.display());
    }
    Ok(Verdict::Passed)
}

/// The file's name without folder and ending.
fn name_of(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

fn summary(replay: &Replay, path: &Path) -> Result<String> {
    let bodies = replay.bodies();
    let spheres: usize = bodies.iter().map(|body| body.spheres.len()).sum();
    let meshes = bodies.iter().filter(|body| body.mesh.is_some()).count();
    let contacts: usize = replay.steps().map(|step| step.contacts().len()).sum();
    let deepest =
        replay.steps().filter_map(|step| step.metrics()).map(|m| m.deepest_overlap).fold(0.0, f64::max);
    let mut text = format!("recording {}\n", path.display());
    let mut row = |name: &str, value: String| writeln!(text, "  {name:<18}{value}");
    row("end", replay.end().to_string())?;
    row("length", format!("{:.3} s, {} steps", replay.duration(), replay.step_count()))?;
    row("bodies", format!("{}, {meshes} with a mesh", bodies.len()))?;
    row("spheres", spheres.to_string())?;
    row("contacts", format!("{contacts}, deepest {:.3} mm", deepest * 1e3))?;
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
