//! A pile of 100 gears beside the same pile with Rapier's own shapes for non-convex meshes, one after the other in one run:
//! `cargo bench -p rapier-ist-benches --bench pile`.
//!
//! Each has up to 15 s of simulated time and [`LIMIT`] of wall time: the hollow triangle mesh does not get far. Contacts,
//! depths and energies are measured on the exact meshes and masses, whatever stands for them in the simulation.

use rapier_ist_examples::figures::{Summary, Timings, percentile};
use rapier_ist_examples::scenes::{Pile, PileOptions, ShapeKind, asset_folder};
use std::error::Error;
use std::time::{Duration, Instant};

/// Steps of 1/60 s.
const STEPS: usize = 900;

/// Wall time after which a pile is left as it is.
const LIMIT: Duration = Duration::from_secs(180);

/// Bodies.
const GEARS: usize = 100;

fn main() -> Result<(), Box<dyn Error>> {
    // `cargo test` runs benches too, without this argument.
    if !std::env::args().any(|argument| argument == "--bench") {
        return Ok(());
    }
    println!(
        "| shape | steps | ms awake, median / p95 | … asleep | at rest after | energy at the end | asleep | deepest | lost |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for kind in [ShapeKind::Ist, ShapeKind::Vhacd, ShapeKind::Voxels, ShapeKind::Trimesh] {
        println!("{}", run(kind)?);
    }
    Ok(())
}

/// A row of the table.
fn run(kind: ShapeKind) -> Result<String, Box<dyn Error>> {
    let meshes = vec![asset_folder().join("pinion_gear.obj")];
    let options = PileOptions { bodies: GEARS, meshes, shape: kind, ..PileOptions::default() };
    let mut pile = Pile::new(&options, |_| ())?;
    let (mut awake, mut asleep) = (Vec::new(), Vec::new());
    let start = Instant::now();
    for _ in 0..STEPS {
        let moved = pile.bodies.iter().any(|body| !pile.world.bodies[body.handle].is_sleeping());
        let step = Instant::now();
        pile.step();
        let list = if moved { &mut awake } else { &mut asleep };
        list.push(step.elapsed().as_secs_f64() * 1e3);
        if start.elapsed() > LIMIT {
            break;
        }
    }
    let (moving, resting) = (awake.len(), asleep.len());
    let [median, p95] = [0.5, 0.95].map(|share| percentile(&awake, share));
    let quiet = percentile(&asleep, 0.5);
    awake.append(&mut asleep);
    let summary = Summary::of(&pile, &Timings { step: awake, query: Vec::new() });
    let energy: f32 = pile.bodies.iter().map(|body| pile.world.bodies[body.handle].kinetic_energy()).sum();
    let rest = if resting > 0 { format!("{:.1} s", moving as f64 / 60.0) } else { "–".into() };
    let quiet = if resting > 0 { format!("{quiet:.2}") } else { "–".into() };
    Ok(format!(
        "| {kind:?} | {} | {median:.1} / {p95:.1} | {quiet} | {rest} | {energy:.2} J | {} of {GEARS} | {:.1} % | {} |",
        summary.steps,
        summary.asleep,
        100.0 * summary.deepest_overlap,
        summary.lost,
    ))
}
