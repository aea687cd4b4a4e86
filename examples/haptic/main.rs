//! A haptic loop: the overlap of two moving solids a thousand times per second.

mod figures;

use anyhow::{Result, ensure};
use clap::Parser;
use figures::{Summary, jumps};
use glam::{Quat, Vec3};
use glamx::Pose3;
use ist::{
    Budget, InnerSphereTree, Overlap, OverlapCache, OverlapQuery, OverlapWorkspace, TimeCriticalWorkspace,
};
use rapier_ist_examples::output::{check_folder_of, exit_code};
use rapier_ist_examples::pair::{self, Cut, PairSolid};
use rapier_ist_examples::render::PictureSize;
use rapier_ist_examples::run::{Check, Verdict, Wanted, report, verdict, write_summary};
use rapier_ist_examples::waiting::Waiting;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Moves one solid through another at ticks of 1 ms and measures the full overlap query, with and without what a cache remembers
/// of the ticks before, and queries within a budget.
///
/// Of every query there is the wall time, and the same without what the thread waited for a processor ("on the
/// processor"), which is what a machine of one's own would give.
#[derive(Parser, Debug)]
#[command(after_help = "Examples:
  haptic                                     two rabbits of 10,000 spheres, 8 seconds
  haptic --seconds 30 --summary haptic.json
  haptic --a gear.obj --b pinion.ist --spheres 3000 --budget-us 30 --real-time")]
struct Arguments {
    /// The solid that rests: a closed mesh or an .ist file.
    #[arg(long, value_name = "FILE", default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/../assets/bunny.obj"))]
    a: PathBuf,
    /// The solid that moves: a closed mesh or an .ist file.
    #[arg(long, value_name = "FILE", default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/../assets/bunny.obj"))]
    b: PathBuf,
    /// Spheres per mesh; .ist files come with their own.
    #[arg(long, default_value_t = 10_000)]
    spheres: usize,
    /// Length of the path (s).
    #[arg(long, default_value_t = 8.0)]
    seconds: f64,
    /// A budget (µs) to measure besides 20, 50, 100 and 200.
    #[arg(long, value_name = "N", default_value_t = 500)]
    budget_us: u64,
    /// Begin each tick when its time has come, as a device would, instead of as soon as possible.
    #[arg(long)]
    real_time: bool,
    /// Recording of the path, one pose per 20 ms.
    #[arg(long, value_name = "FILE")]
    mcap: Option<PathBuf>,
    /// Picture of the solids, cut open, where they are deepest in each other.
    #[arg(long, value_name = "FILE.png")]
    png: Option<PathBuf>,
    /// Width of the picture in pixels; 16:9.
    #[arg(long, value_name = "PIXELS", default_value_t = 1280, value_parser = clap::value_parser!(u32).range(16..=7680))]
    png_width: u32,
    /// Figures and checks as JSON.
    #[arg(long, value_name = "FILE.json")]
    summary: Option<PathBuf>,
}

/// Length of a tick (s).
const TICK: f64 = 1e-3;
/// Ticks from one recorded pose to the next.
const RECORD_EVERY: f32 = 20.0;
/// Largest change of the force from one tick to the next that passes, in per cent of the median force.
const LARGEST_JUMP_PERCENT: f64 = 10.0;
/// Share of the volume by which a sum in another order may leave its bounds.
const ROUNDING: f64 = 1e-4;
/// How much later than its budget a query may end before it counts as an overrun.
const TOLERANCE: f64 = 1.2;
/// How often a query that overran is asked once more: what it does by itself it does again, an interruption it does not.
const REPEATS: usize = 2;
/// Names of the phases and the share of the smaller solid's volume up to which the overlap belongs to them.
const PHASES: [(&str, f64); 4] = [("apart", 0.0), ("shallow", 0.05), ("mid", 0.25), ("deep", f64::INFINITY)];

fn main() -> ExitCode {
    exit_code(run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> Result<Verdict> {
    for path in [&arguments.mcap, &arguments.png, &arguments.summary].into_iter().flatten() {
        check_folder_of(path)?;
    }
    let valid = arguments.seconds >= TICK && arguments.seconds.is_finite();
    ensure!(valid, "--seconds must be a number of at least {TICK}");
    let first = PairSolid::load(&arguments.a, arguments.spheres)?;
    let second = if arguments.b == arguments.a {
        first.clone()
    } else {
        PairSolid::load(&arguments.b, arguments.spheres)?
    };
    let (a, b) = (first.tree()?, second.tree()?);
    let mut budgets = vec![20, 50, 100, 200, arguments.budget_us];
    budgets.sort_unstable();
    budgets.dedup();

    let ticks = simulate(&a, &b, &budgets, arguments);
    let summary = Summary::new(&a, &b, &budgets, &ticks);
    summary.print()?;
    let checks = checks(&ticks);
    report(&checks)?;
    let pair = [&first, &second];
    if let Some(path) = &arguments.png {
        let at = ticks.get(ticks.len() / 2).map_or(Vec3::ZERO, |tick| tick.full.overlap.centroid);
        let size = PictureSize::wide(arguments.png_width);
        pair::draw(pair, &Cut { pose: pose(&a, &b, 0.5), at, size }, path)?;
    }
    if let Some(path) = &arguments.mcap {
        let poses: Vec<Pose3> =
            (0..ticks.len()).map(|tick| pose(&a, &b, tick as f64 / ticks.len() as f64)).collect();
        pair::record(pair, &poses, [TICK as f32, RECORD_EVERY], path)?;
    }
    if let Some(path) = &arguments.summary {
        write_summary(path, &summary, &checks)?;
    }
    Ok(verdict(&checks))
}

/// Where B stands at `share` of its path: from beside A into it and out again, turning on the way.
fn pose(a: &InnerSphereTree, b: &InnerSphereTree, share: f64) -> Pose3 {
    let ((center_a, radius_a), (center_b, radius_b)) = (a.bounding_ball(), b.bounding_ball());
    let apart = 0.5 + 0.5 * (std::f64::consts::TAU * share).cos();
    let distance = (radius_a + radius_b) * (0.1 + 0.85 * apart as f32);
    let direction = Vec3::new(0.8, 0.36, 0.48);
    let rotation = Quat::from_scaled_axis(Vec3::new(0.6, 1.1, -0.4) * (1.0 + 2.0 * share as f32));
    Pose3::from_parts(center_a + distance * direction - rotation * center_b, rotation)
}

/// What holds whatever the machine does: only the times depend on it.
fn checks(ticks: &[Tick]) -> Vec<Check> {
    let outside = |tick: &Tick| {
        let volume = f64::from(tick.full.overlap.volume);
        let slack = ROUNDING * volume;
        let holds = |within: &Within| {
            let [lower, upper] = within.query.bounds;
            (lower - slack..=upper + slack).contains(&volume)
        };
        tick.within.iter().filter(|within| !holds(within)).count()
    };
    let outside: usize = ticks.iter().map(outside).sum();
    let off = |tick: &Tick| {
        let [full, cached] = [tick.full, tick.cached].map(|query| f64::from(query.overlap.volume));
        (full - cached).abs() > ROUNDING * full
    };
    let off = ticks.iter().filter(|tick| off(tick)).count();
    let [_, jump] = jumps(ticks, |tick| &tick.full);
    let smaller = Wanted::AtMost(LARGEST_JUMP_PERCENT);
    vec![
        Check::new(
            "volumes outside the bounds of a query within a budget",
            outside as f64,
            "",
            Wanted::AtMost(0.0),
        ),
        Check::new("volumes that differ with the cache", off as f64, "", Wanted::AtMost(0.0)),
        Check::new("largest change of the force in a tick", 100.0 * jump, "% of the median force", smaller),
    ]
}

/// One query's time and result.
#[derive(Clone, Copy, Default)]
struct Measurement {
    /// Wall time (µs).
    wall: f64,
    /// Of it, waiting for a processor (µs).
    waited: f64,
    overlap: Overlap,
    /// Interval of the volume (m³); empty without a budget.
    bounds: [f64; 2],
}

/// What was measured at one tick.
struct Tick {
    phase: usize,
    full: Measurement,
    cached: Measurement,
    /// In the order of the budgets.
    within: Vec<Within>,
}

/// A query within a budget.
struct Within {
    query: Measurement,
    /// Just before it, a loop that reads the clock until the budget has passed: what the machine does to any program.
    clock: Measurement,
    /// Whether the query overran, on the processor, and did so again each time it was repeated.
    overran_again: bool,
}

fn simulate(a: &InnerSphereTree, b: &InnerSphereTree, budgets: &[u64], arguments: &Arguments) -> Vec<Tick> {
    let (mut workspace, mut critical) = (OverlapWorkspace::default(), TimeCriticalWorkspace::default());
    critical.reserve(b.len());
    let waiting = Waiting::of_this_thread();
    if !waiting.is_known() {
        eprintln!("the system does not tell how long a thread waits: all times are wall times");
    }
    let mut cache = OverlapCache::default();
    let count = (arguments.seconds / TICK) as usize;
    let smaller = a.solid().volume.min(b.solid().volume);
    a.prepare_overlap_within();
    b.prepare_overlap_within();
    // Memory is touched for the first time before the loop.
    let deepest = pose(a, b, 0.5);
    let _ = a.overlap(b, &deepest, &mut workspace);
    let _ = a.overlap_within(b, &deepest, Budget::Visits(u32::MAX), &mut critical);
    let begin = Instant::now();
    let mut ticks = Vec::with_capacity(count);
    for tick in 0..count {
        if arguments.real_time {
            wait_until(begin + Duration::from_secs_f64(tick as f64 * TICK));
        }
        let pose = pose(a, b, tick as f64 / count as f64);
        let full = measure(&waiting, || (a.overlap(b, &pose, &mut workspace), [0.0; 2]));
        let cached = measure(&waiting, || {
            let query = OverlapQuery::default();
            (a.overlap_cached(b, &pose, query, (&mut cache, &mut workspace)), [0.0; 2])
        });
        let within = budgets.iter().map(|us| {
            let time = Duration::from_micros(*us);
            let mut ask = || {
                let clock = measure(&waiting, || {
                    let start = Instant::now();
                    while start.elapsed() < time {}
                    (Overlap::default(), [0.0; 2])
                });
                let query = measure(&waiting, || {
                    let result = a.overlap_within(b, &pose, Budget::Time(time), &mut critical);
                    (result.expected, [f64::from(result.lower), f64::from(result.upper)])
                });
                (clock, query)
            };
            let (clock, query) = ask();
            let is_late = |query: &Measurement| query.on_processor() > TOLERANCE * *us as f64;
            let overran_again = is_late(&query) && (0..REPEATS).all(|_| is_late(&ask().1));
            Within { query, clock, overran_again }
        });
        let share = f64::from(full.overlap.volume) / smaller;
        let phase = PHASES.iter().position(|(_, most)| share <= *most).unwrap_or(PHASES.len() - 1);
        ticks.push(Tick { phase, full, cached, within: within.collect() });
    }
    ticks
}

/// Sleeps until shortly before `time`, then spins.
fn wait_until(time: Instant) {
    if let Some(left) = time.checked_duration_since(Instant::now() + Duration::from_micros(200)) {
        std::thread::sleep(left);
    }
    while Instant::now() < time {
        std::hint::spin_loop();
    }
}

fn measure(waiting: &Waiting, query: impl FnOnce() -> (Overlap, [f64; 2])) -> Measurement {
    let waited = waiting.microseconds();
    let start = Instant::now();
    let (overlap, bounds) = query();
    let wall = start.elapsed().as_secs_f64() * 1e6;
    Measurement { wall, waited: (waiting.microseconds() - waited).min(wall), overlap, bounds }
}
