//! Long runs that look for what short ones do not show: leaks, tables that grow, bodies that get lost, steps that slow down.

use super::resident::resident_mebibytes;
use super::{Check, RunArguments, Simulation, Verdict, Wanted, report, verdict, with_spinner, write_summary};
use crate::figures::percentile;
use crate::output::print_line;
use crate::waiting::Waiting;
use anyhow::{Result, ensure};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;
use std::time::Instant;

/// Shortest soak (s) that is compared with itself: in a tenth of less than a minute, what happens to happen decides.
const COMPARED_FROM: f64 = 600.0;
/// Most memory (MiB) by which the last tenth may exceed the second: allocators keep some of what is freed, in pieces.
/// Set beforehand; hours of the two scenes grew by 0.05 and 0.16.
const MOST_GROWTH: f64 = 4.0;
/// Most by which steps of the last tenth may take longer than those of the second. Both do the same work but for chance; other
/// work on the machine slows steps down even where it takes no processor away.
const MOST_SLOWING: f64 = 2.0;
/// How often memory is looked at, in all of the run.
const LOOKS: usize = 1000;

/// Asks for a soak: to be flattened into an example's own arguments.
#[derive(Args, Clone, Copy, Debug)]
pub struct SoakArguments {
    /// Run for so many seconds of simulated time, at random changes, without recording or picture, and look for leaks, lost
    /// bodies and steps that slow down.
    #[arg(long, value_name = "SECONDS")]
    pub soak: Option<f64>,
    /// Seed of the soak's changes.
    #[arg(long, default_value_t = 1)]
    pub soak_seed: u64,
}

/// A scene for a long run. Its steps change it at random; what it asserts is [`Simulation::checks`], of every step.
pub trait Soak: Simulation {
    /// Takes everything out that came in: a plugin then has nothing left to remember but what was there from the beginning.
    fn clear(&mut self);

    /// How many changes were made.
    fn changes(&self) -> usize;
}

/// What a soak has measured.
#[derive(Clone, Debug, Serialize)]
pub struct SoakFigures {
    /// Simulated time (s).
    pub simulated_seconds: f64,
    /// Wall time (s).
    pub wall_seconds: f64,
    /// Steps simulated.
    pub steps: usize,
    /// Random changes made.
    pub changes: usize,
    /// Median time (ms) of the steps in which something was awake, without that in the queue for a processor, in each tenth of
    /// the run.
    pub step_ms_by_tenth: Vec<f64>,
    /// Median of the resident memory (MiB) in each tenth of the run; empty where the system does not tell.
    pub resident_mib_by_tenth: Vec<f64>,
    /// Most entries of the plugin's tables in each tenth of the run.
    pub remembered_by_tenth: Vec<usize>,
    /// Entries of the plugin's tables after everything has been taken out.
    pub remembered_at_end: usize,
    /// Poses and velocities that were not finite, over all steps.
    pub not_finite: usize,
}

/// Builds a scene and soaks it.
///
/// # Errors
/// As `build`, where the time asked for is no time, and where the summary cannot be written.
pub fn build_and_soak<S: Soak + Send>(
    seconds: f64,
    arguments: &RunArguments,
    build: impl FnOnce(&mut dyn FnMut(&str)) -> Result<S>,
) -> Result<Verdict> {
    arguments.check()?;
    ensure!(seconds > 0.0 && seconds < 1e7, "--soak {seconds} is no time; ask for up to 1e7 seconds");
    let mut scene = with_spinner(build)?;
    let (figures, checks) = soak(&mut scene, seconds)?;
    if let Some(path) = &arguments.summary {
        write_summary(path, &figures, &checks)?;
    }
    print(&scene, &figures)?;
    report(&checks)?;
    Ok(verdict(&checks))
}

/// Steps `scene` for `seconds` of simulated time on one thread, takes everything out, and checks what it saw.
///
/// # Errors
/// Where the thread cannot be started.
pub fn soak(scene: &mut (impl Soak + Send), seconds: f64) -> Result<(SoakFigures, Vec<Check>)> {
    // On one thread, so that the time that it waited for a processor is known and can be left out.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    Ok(pool.install(|| soak_here(scene, seconds)))
}

fn soak_here(scene: &mut impl Soak, seconds: f64) -> (SoakFigures, Vec<Check>) {
    let dt = f64::from(scene.world().integration_parameters.dt);
    let steps = (seconds / dt).round().max(1.0) as usize;
    let style = ProgressStyle::with_template("soaking {wide_bar} {pos}/{len} steps, {eta} left");
    let bar =
        ProgressBar::new(steps as u64).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    let mut log = Log::new(steps);
    let (start, waiting) = (Instant::now(), Waiting::of_this_thread());
    for step in 0..steps {
        let (before, waited) = (Instant::now(), waiting.microseconds());
        scene.step();
        let waited = (waiting.microseconds() - waited) * 1e-3;
        log.look(step, before.elapsed().as_secs_f64() * 1e3 - waited, scene);
        bar.inc(1);
    }
    bar.finish_and_clear();
    let wall_seconds = start.elapsed().as_secs_f64();
    let checks = scene.checks(&crate::figures::Summary::default());
    scene.clear();
    scene.step();
    let figures = SoakFigures {
        simulated_seconds: steps as f64 * dt,
        wall_seconds,
        steps,
        changes: scene.changes(),
        step_ms_by_tenth: tenths(&log.step_ms).map(median_awake).collect(),
        resident_mib_by_tenth: tenths(&log.resident).map(|tenth| percentile(tenth, 0.5)).collect(),
        remembered_by_tenth: tenths(&log.remembered)
            .map(|tenth| tenth.iter().copied().max().unwrap_or(0))
            .collect(),
        remembered_at_end: scene.plugin().remembered().total(),
        not_finite: log.not_finite,
    };
    let checks = [checks, figures.checks()].concat();
    (figures, checks)
}

/// What is written down on the way, in memory that is there from the beginning.
struct Log {
    /// Of steps in which something was awake; else NaN.
    step_ms: Vec<f64>,
    resident: Vec<f64>,
    remembered: Vec<usize>,
    /// Steps from one look at the memory to the next.
    stride: usize,
    not_finite: usize,
}

impl Log {
    fn new(steps: usize) -> Self {
        // Written once, so that the pages are there before memory is looked at.
        let (mut step_ms, mut remembered) = (vec![f64::NAN; steps], vec![usize::MAX; steps]);
        step_ms.clear();
        remembered.clear();
        let stride = steps.div_ceil(LOOKS);
        Self { step_ms, resident: Vec::with_capacity(LOOKS), remembered, stride, not_finite: 0 }
    }

    fn look(&mut self, step: usize, step_ms: f64, scene: &impl Soak) {
        let is_awake = scene.world().active_bodies().next().is_some();
        self.step_ms.push(if is_awake { step_ms } else { f64::NAN });
        self.remembered.push(scene.plugin().remembered().total());
        if step.is_multiple_of(self.stride) {
            self.resident.extend(resident_mebibytes());
        }
        let finite = |body: &rapier3d::dynamics::RigidBody| {
            body.position().is_finite() && body.linvel().is_finite() && body.angvel().is_finite()
        };
        self.not_finite += scene.world().bodies.iter().filter(|(_, body)| !finite(body)).count();
    }
}

/// The run in ten parts; a run of less than ten entries has fewer.
fn tenths<T>(values: &[T]) -> impl Iterator<Item = &[T]> {
    values.chunks(values.len().div_ceil(10).max(1))
}

fn median_awake(step_ms: &[f64]) -> f64 {
    let awake: Vec<f64> = step_ms.iter().copied().filter(|time| !time.is_nan()).collect();
    percentile(&awake, 0.5)
}

impl SoakFigures {
    fn checks(&self) -> Vec<Check> {
        let mut checks = vec![
            Check::new("numbers that are not finite", self.not_finite as f64, "", Wanted::AtMost(0.0)),
            Check::new(
                "entries of tables in the end",
                self.remembered_at_end as f64,
                "",
                Wanted::AtMost(0.0),
            ),
        ];
        if self.simulated_seconds < COMPARED_FROM {
            return checks;
        }
        if let Some([second, last]) = second_and_last(&self.step_ms_by_tenth) {
            let wanted = Wanted::AtMost(MOST_SLOWING);
            checks.push(Check::new("step time, last tenth over second", last / second, "", wanted));
        }
        if let Some([second, last]) = second_and_last(&self.resident_mib_by_tenth) {
            let wanted = Wanted::AtMost(MOST_GROWTH);
            checks.push(Check::new("memory, last tenth over second", last - second, "MiB", wanted));
        }
        checks
    }
}

fn second_and_last(tenths: &[f64]) -> Option<[f64; 2]> {
    Some([*tenths.get(1)?, *tenths.last()?])
}

fn print(scene: &impl Soak, figures: &SoakFigures) -> Result<()> {
    let (title, seconds) = (scene.title(), figures.simulated_seconds);
    print_line(format_args!("{title}, soaked for {seconds:.0} s of simulated time"))?;
    let row = |name: &str, value: String| print_line(format_args!("  {name:<28}{value}"));
    let list =
        |values: &[f64]| values.iter().map(|value| format!("{value:.2}")).collect::<Vec<_>>().join(" ");
    row("wall time", format!("{:.1} s", figures.wall_seconds))?;
    row("steps, changes", format!("{}, {}", figures.steps, figures.changes))?;
    row("step time by tenth (ms)", list(&figures.step_ms_by_tenth))?;
    row("memory by tenth (MiB)", list(&figures.resident_mib_by_tenth))?;
    row("entries of tables by tenth", format!("{:?}", figures.remembered_by_tenth))
}
