//! A haptic loop: the overlap of two moving solids a thousand times per second.

use anyhow::{Context, Result, ensure};
use clap::Parser;
use glam::{Quat, Vec3};
use glamx::Pose3;
use ist::{Budget, InnerSphereTree, Overlap, OverlapWorkspace, SpherePacking, TimeCriticalWorkspace};
use packer::{PackOptions, Solid, TriangleMesh, pack};
use rapier_ist_examples::figures::percentile;
use rapier_ist_examples::output::{check_folder_of, exit_code, write_whole};
use rapier_ist_examples::run::Verdict;
use rapier_ist_examples::waiting::Waiting;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Moves one solid through another at ticks of 1 ms and measures the full overlap query and queries within a budget.
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
    #[arg(long, value_name = "N", default_value_t = 100)]
    budget_us: u64,
    /// Begin each tick when its time has come, as a device would, instead of as soon as possible.
    #[arg(long)]
    real_time: bool,
    /// Figures as JSON.
    #[arg(long, value_name = "FILE.json")]
    summary: Option<PathBuf>,
}

/// Length of a tick (s).
const TICK: f64 = 1e-3;
/// How much later than its budget a query may end before it counts as an overrun.
const TOLERANCE: f64 = 1.2;
/// Names of the phases and the share of the smaller solid's volume up to which the overlap belongs to them.
const PHASES: [(&str, f64); 4] = [("apart", 0.0), ("shallow", 0.05), ("mid", 0.25), ("deep", f64::INFINITY)];

fn main() -> ExitCode {
    exit_code(run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> Result<Verdict> {
    if let Some(path) = &arguments.summary {
        check_folder_of(path)?;
    }
    let valid = arguments.seconds >= TICK && arguments.seconds.is_finite();
    ensure!(valid, "--seconds must be a number of at least {TICK}");
    let a = tree(&arguments.a, arguments.spheres)?;
    let b = if arguments.b == arguments.a { a.clone() } else { tree(&arguments.b, arguments.spheres)? };
    let mut budgets = vec![20, 50, 100, 200, arguments.budget_us];
    budgets.sort_unstable();
    budgets.dedup();

    let ticks = simulate(&a, &b, &budgets, arguments);
    let summary = Summary::new(&a, &b, &budgets, &ticks);
    summary.print();
    if let Some(path) = &arguments.summary {
        write_whole(path, serde_json::to_string_pretty(&summary)?.as_bytes())?;
    }
    Ok(Verdict::Passed)
}

/// The tree of an `.ist` file, or of a mesh that is packed now.
fn tree(path: &Path, spheres: usize) -> Result<InnerSphereTree> {
    let load = || -> Result<SpherePacking> {
        if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ist")) {
            return Ok(SpherePacking::load(path)?);
        }
        let solid = Solid::new(&TriangleMesh::load(path)?)?;
        Ok(pack(&solid, &PackOptions::balanced().spheres(spheres))?.packing)
    };
    Ok(InnerSphereTree::new(&load().with_context(|| format!("cannot use {}", path.display()))?))
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

/// One query's time and result.
#[derive(Clone, Copy, Default)]
struct Measurement {
    /// Wall time (µs).
    wall: f64,
    /// Of it, waiting for a processor (µs).
    waited: f64,
    overlap: Overlap,
    /// Width of the interval of the volume (m³).
    width: f64,
}

/// What was measured at one tick.
struct Tick {
    phase: usize,
    full: Measurement,
    /// In the order of the budgets.
    within: Vec<Within>,
}

/// A query within a budget.
struct Within {
    query: Measurement,
    /// Just before it, a loop that reads the clock until the budget has passed: what the machine does to any program.
    clock: Measurement,
}

fn simulate(a: &InnerSphereTree, b: &InnerSphereTree, budgets: &[u64], arguments: &Arguments) -> Vec<Tick> {
    let (mut workspace, mut critical) = (OverlapWorkspace::default(), TimeCriticalWorkspace::default());
    critical.reserve(b.len());
    let waiting = Waiting::of_this_thread();
    if !waiting.is_known() {
        println!("the system does not tell how long a thread waits: all times are wall times");
    }
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
        let full = measure(&waiting, || (a.overlap(b, &pose, &mut workspace), 0.0));
        let within = budgets.iter().map(|us| {
            let time = Duration::from_micros(*us);
            let clock = measure(&waiting, || {
                let start = Instant::now();
                while start.elapsed() < time {}
                (Overlap::default(), 0.0)
            });
            let query = measure(&waiting, || {
                let result = a.overlap_within(b, &pose, Budget::Time(time), &mut critical);
                (result.expected, f64::from(result.upper) - f64::from(result.lower))
            });
            Within { query, clock }
        });
        let share = f64::from(full.overlap.volume) / smaller;
        let phase = PHASES.iter().position(|(_, most)| share <= *most).unwrap_or(PHASES.len() - 1);
        ticks.push(Tick { phase, full, within: within.collect() });
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

fn measure(waiting: &Waiting, query: impl FnOnce() -> (Overlap, f64)) -> Measurement {
    let waited = waiting.microseconds();
    let start = Instant::now();
    let (overlap, width) = query();
    let wall = start.elapsed().as_secs_f64() * 1e6;
    Measurement { wall, waited: (waiting.microseconds() - waited).min(wall), overlap, width }
}

/// Figures of a run; every file of `--summary` has these names.
#[derive(Serialize)]
struct Summary {
    spheres: [usize; 2],
    ticks: usize,
    /// One per phase and query.
    rows: Vec<Row>,
    /// Of every query the change of the force from one tick to the next relative to the median force: 99th percentile and
    /// greatest. A query within a budget that is interrupted early knows little.
    jumps: Vec<[f64; 2]>,
    /// Of every budget, over all phases in which the solids overlap.
    overruns: Vec<Overruns>,
}

/// How many queries took more than 1.2 times their budget, and how many loops that only read the clock until it had passed.
#[derive(Serialize)]
struct Overruns {
    budget_us: u64,
    queries: usize,
    /// By wall time and on the processor.
    of_queries: [usize; 2],
    of_clock: [usize; 2],
}

/// One query in one phase.
#[derive(Serialize)]
struct Row {
    phase: &'static str,
    /// Budget (µs); none for the full query.
    budget_us: Option<u64>,
    ticks: usize,
    /// Wall time (µs): median, 99th and 99.9th percentile, greatest.
    wall_us: [f64; 4],
    /// The same without waiting for a processor.
    processor_us: [f64; 4],
    /// Share of the queries that took more than 1.2 times their budget, by wall time and on the processor.
    overruns: [f64; 2],
    /// The same of loops that only read the clock until the budget has passed, each just before one of the queries.
    clock_overruns: [f64; 2],
    /// Error of the expected volume relative to the full query's: median and 95th percentile.
    volume_error: [f64; 2],
    /// Width of the interval relative to the volume: median.
    interval_width: f64,
}

impl Summary {
    fn new(a: &InnerSphereTree, b: &InnerSphereTree, budgets: &[u64], ticks: &[Tick]) -> Self {
        let queries: Vec<Option<usize>> = std::iter::once(None).chain((0..budgets.len()).map(Some)).collect();
        let mut rows = Vec::new();
        for (phase, (name, _)) in PHASES.iter().enumerate() {
            let of_phase: Vec<&Tick> = ticks.iter().filter(|tick| tick.phase == phase).collect();
            if of_phase.is_empty() {
                continue;
            }
            for query in &queries {
                rows.push(Row::new(name, query.map(|i| (i, budgets[i])), &of_phase));
            }
        }
        let jumps = queries.iter().map(|query| jumps(ticks, |tick| tick.query(*query)));
        Self {
            spheres: [a.len(), b.len()],
            ticks: ticks.len(),
            rows,
            jumps: jumps.collect(),
            overruns: budgets.iter().enumerate().map(|(i, us)| Overruns::new(i, *us, ticks)).collect(),
        }
    }

    fn print(&self) {
        println!("{} and {} spheres, {} ticks of 1 ms", self.spheres[0], self.spheres[1], self.ticks);
        println!(
            "                   wall time, µs                    on the processor, µs             overrun > 20 %   of the clock      volume error   interval"
        );
        println!(
            "phase    budget    median    p99   p99.9     max    median    p99   p99.9     max    wall  processor   wall  processor   median   p95   width"
        );
        for row in &self.rows {
            let budget = row.budget_us.map_or("full".to_owned(), |us| us.to_string());
            let times =
                |[median, p99, p999, max]: [f64; 4]| format!("{median:9.1} {p99:6.1} {p999:7.1} {max:7.1}");
            let percent = |share: f64| format!("{:.2} %", 100.0 * share);
            println!(
                "{:8} {budget:>6} {} {} {:>9} {:>8} {:>8} {:>8} {:>9} {:>8} {:>8}",
                row.phase,
                times(row.wall_us),
                times(row.processor_us),
                percent(row.overruns[0]),
                percent(row.overruns[1]),
                percent(row.clock_overruns[0]),
                percent(row.clock_overruns[1]),
                percent(row.volume_error[0]),
                percent(row.volume_error[1]),
                format!("{:.2}", row.interval_width),
            );
        }
        let jumps: Vec<String> = self.jumps.iter().map(|[p99, max]| format!("{p99:.3} / {max:.3}")).collect();
        println!(
            "change of the force in a tick, in median forces, p99 / max: {} (full, then by budget)",
            jumps.join(", ")
        );
        for overruns in &self.overruns {
            println!(
                "{} µs: of {} queries {} / {} overran on the wall / on the processor, of as many loops that only read the clock {} / {}",
                overruns.budget_us,
                overruns.queries,
                overruns.of_queries[0],
                overruns.of_queries[1],
                overruns.of_clock[0],
                overruns.of_clock[1],
            );
        }
    }
}

impl Overruns {
    /// Of the budget of this number, which is `us`.
    fn new(number: usize, us: u64, ticks: &[Tick]) -> Self {
        let overlapping: Vec<&Within> =
            ticks.iter().filter(|tick| tick.phase > 0).map(|tick| &tick.within[number]).collect();
        let count = |measurement: fn(&Within) -> &Measurement, time: fn(&Measurement) -> f64| {
            overlapping.iter().filter(|within| is_late(time(measurement(within)), us)).count()
        };
        Self {
            budget_us: us,
            queries: overlapping.len(),
            of_queries: [count(|w| &w.query, |m| m.wall), count(|w| &w.query, Measurement::on_processor)],
            of_clock: [count(|w| &w.clock, |m| m.wall), count(|w| &w.clock, Measurement::on_processor)],
        }
    }
}

/// Whether so many microseconds overrun a budget.
fn is_late(time: f64, budget_us: u64) -> bool {
    time > TOLERANCE * budget_us as f64
}

impl Measurement {
    /// Wall time without waiting (µs).
    fn on_processor(&self) -> f64 {
        self.wall - self.waited
    }
}

impl Tick {
    /// The query within the budget of this number, or the full query.
    fn query(&self, number: Option<usize>) -> &Measurement {
        number.map_or(&self.full, |i| &self.within[i].query)
    }
}

impl Row {
    fn new(phase: &'static str, budget: Option<(usize, u64)>, ticks: &[&Tick]) -> Self {
        let number = budget.map(|(number, _)| number);
        let collect =
            |value: &dyn Fn(&Tick) -> f64| -> Vec<f64> { ticks.iter().map(|tick| value(tick)).collect() };
        let wall = collect(&|tick| tick.query(number).wall);
        let processor = collect(&|tick| tick.query(number).on_processor());
        let relative = |tick: &Tick, value: f64| value / f64::from(tick.full.overlap.volume).max(1e-300);
        let error = collect(&|tick| {
            relative(tick, f64::from(tick.query(number).overlap.volume - tick.full.overlap.volume).abs())
        });
        let apart = ticks.iter().all(|tick| tick.full.overlap.volume == 0.0);
        let if_overlapping = |value: f64| if apart { 0.0 } else { value };
        let times = |values: &[f64]| [0.5, 0.99, 0.999, 1.0].map(|share| percentile(values, share));
        let overruns = |values: &[f64]| {
            let late = |us: u64| values.iter().filter(|value| is_late(**value, us)).count();
            budget.map_or(0.0, |(_, us)| late(us) as f64 / values.len() as f64)
        };
        let clock = |time: fn(&Measurement) -> f64| {
            budget.map_or(0.0, |(number, _)| overruns(&collect(&|tick| time(&tick.within[number].clock))))
        };
        Self {
            phase,
            budget_us: budget.map(|(_, us)| us),
            ticks: ticks.len(),
            wall_us: times(&wall),
            processor_us: times(&processor),
            overruns: [overruns(&wall), overruns(&processor)],
            clock_overruns: [clock(|m| m.wall), clock(Measurement::on_processor)],
            volume_error: [0.5, 0.95].map(|share| if_overlapping(percentile(&error, share))),
            interval_width: if_overlapping(percentile(
                &collect(&|tick| relative(tick, tick.query(number).width)),
                0.5,
            )),
        }
    }
}

/// 99th percentile and greatest change of the force from one tick with contact to the next, in units of the median force.
fn jumps(ticks: &[Tick], query: impl Fn(&Tick) -> &Measurement) -> [f64; 2] {
    let touching: Vec<&Tick> = ticks.iter().filter(|tick| tick.full.overlap.volume > 0.0).collect();
    let forces: Vec<f64> = touching.iter().map(|tick| f64::from(tick.full.overlap.force.length())).collect();
    let force = |tick: &Tick| query(tick).overlap.force;
    let jumps: Vec<f64> =
        touching.windows(2).map(|pair| f64::from(force(pair[0]).distance(force(pair[1])))).collect();
    let median = percentile(&forces, 0.5).max(f64::MIN_POSITIVE);
    [0.99, 1.0].map(|share| percentile(&jumps, share) / median)
}
