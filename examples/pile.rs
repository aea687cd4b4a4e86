//! Bodies of mixed shape and size fall into a bowl.

use anyhow::{Context, Result};
use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use rapier_ist::record::{RecordOptions, Recorder};
use rapier_ist_examples::figures::{Summary, Timings};
use rapier_ist_examples::output::{check_folder_of, exit_code, write_whole};
use rapier_ist_examples::palette;
use rapier_ist_examples::recording::describe_pile;
use rapier_ist_examples::render::{Mesh, PictureSize, Scene, Surface};
use rapier_ist_examples::scenes::{Pile, PileOptions, ShapeKind};
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// Drops bodies of mixed shape and size into a non-convex bowl at 60 Hz, records the run and draws a picture.
#[derive(Parser, Debug)]
#[command(after_help = "Examples:
  pile                                       40 bodies, 10 seconds; pile.mcap, pile.png
  pile --shape vhacd --summary vhacd.json    the same scene with Rapier's convex decomposition
  pile --mesh chair.obj --mesh cup.stl       your own meshes")]
struct Arguments {
    /// Number of bodies.
    #[arg(long, default_value_t = 40)]
    bodies: usize,
    /// Steps of 1/60 s.
    #[arg(long, default_value_t = 600)]
    steps: usize,
    /// Seed of sizes, places and rotations.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Spheres per body.
    #[arg(long, default_value_t = 1000)]
    spheres: usize,
    /// A closed mesh to use instead of the built-in ones (OBJ, STL, PLY, glTF); repeatable.
    #[arg(long = "mesh", value_name = "FILE")]
    meshes: Vec<PathBuf>,
    /// What stands for the meshes in the simulation.
    #[arg(long, value_enum, default_value_t)]
    shape: ShapeKind,
    /// Recording for Foxglove or Rerun.
    #[arg(long, value_name = "FILE", default_value = "pile.mcap")]
    mcap: PathBuf,
    /// Picture of the end.
    #[arg(long, value_name = "FILE", default_value = "pile.png")]
    png: PathBuf,
    /// Figures as JSON.
    #[arg(long, value_name = "FILE.json")]
    summary: Option<PathBuf>,
}

fn main() -> ExitCode {
    exit_code(run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> Result<()> {
    for path in
        [Some(&arguments.mcap), Some(&arguments.png), arguments.summary.as_ref()].into_iter().flatten()
    {
        check_folder_of(path)?;
    }
    let spinner = ProgressBar::new_spinner();
    let options = PileOptions {
        bodies: arguments.bodies,
        seed: arguments.seed,
        spheres: arguments.spheres,
        meshes: arguments.meshes.clone(),
        shape: arguments.shape,
    };
    let mut pile = Pile::new(&options, |message| {
        spinner.set_message(message.to_owned());
        spinner.tick();
    })?;
    spinner.finish_and_clear();

    let timings = simulate(&mut pile, arguments)?;
    let summary = Summary::of_pile(&pile, &timings);
    draw(&pile, &arguments.png)?;
    if let Some(path) = &arguments.summary {
        write_whole(path, serde_json::to_string_pretty(&summary)?.as_bytes())?;
    }
    println!(
        "pile, {:?} shapes, {:.1} s at 60 Hz\n{summary}",
        arguments.shape,
        arguments.steps as f64 / 60.0
    );
    println!("  recording {}, picture {}", arguments.mcap.display(), arguments.png.display());
    Ok(())
}

/// Runs the simulation and records it.
fn simulate(pile: &mut Pile, arguments: &Arguments) -> Result<Timings> {
    let mut recorder = describe(pile, arguments)?;
    recorder.record_start(&pile.world)?;
    let style = "{msg} {wide_bar} {pos}/{len} steps, {eta} left";
    let bar = ProgressBar::new(arguments.steps as u64).with_style(ProgressStyle::with_template(style)?);
    bar.set_message("simulating");
    let mut timings = Timings::default();
    for _ in 0..arguments.steps {
        let start = Instant::now();
        pile.step();
        timings.step.push(start.elapsed().as_secs_f64() * 1e3);
        timings.query.push(pile.plugin.report().query_seconds * 1e3);
        recorder.record(&pile.world, pile.plugin.report())?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    recorder.finish()?;
    Ok(timings)
}

/// Opens the recording and describes every body in it.
fn describe(pile: &Pile, arguments: &Arguments) -> Result<Recorder<BufWriter<File>>> {
    let options = RecordOptions::everything()
        .metadata("example", "pile")
        .metadata("seed", arguments.seed)
        .metadata("spheres", arguments.spheres)
        .metadata("shape", format!("{:?}", arguments.shape));
    let mut recorder = Recorder::create(&arguments.mcap, options)?;
    describe_pile(&mut recorder, pile)?;
    Ok(recorder)
}

/// Draws the pile from above.
fn draw(pile: &Pile, path: &Path) -> Result<()> {
    let meshes: Vec<Vec<Mesh>> = vec![
        pile.bodies
            .iter()
            .map(|body| Mesh::new(pile.models[body.model].solid.mesh()).scaled(body.size))
            .collect(),
        vec![Mesh::new(pile.bowl_solid.mesh())],
    ];
    let mut scene = Scene::new();
    for (body, mesh) in pile.bodies.iter().zip(&meshes[0]) {
        let surface = Surface::new(palette::color(body.model));
        scene.add_mesh(mesh, *pile.world.bodies[body.handle].position(), surface);
    }
    scene.add_mesh(&meshes[1][0], *pile.world.bodies[pile.bowl].position(), Surface::new(palette::NEUTRAL));
    scene.set_ground(pile.bowl_solid.bounds().0.y as f32);
    let camera = scene.framed_from(glam::Vec3::new(0.45, 1.0, 0.8), PictureSize::HD);
    scene.render(&camera, PictureSize::HD).save_png(path).context("cannot draw the picture")
}
