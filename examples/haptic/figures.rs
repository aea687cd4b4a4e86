//! What the loop measured, phase by phase and query by query.

use crate::{Measurement, PHASES, TOLERANCE, Tick, Within};
use anyhow::Result;
use ist::InnerSphereTree;
use rapier_ist_examples::figures::percentile;
use rapier_ist_examples::output::print_line;
use serde::Serialize;

/// Figures of a run; every file of `--summary` has these names.
#[derive(Serialize)]
pub(crate) struct Summary {
    spheres: [usize; 2],
    ticks: usize,
    /// One per phase and query.
    rows: Vec<Row>,
    /// Of every query, in the order of the rows, the change of the force from one tick to the next relative to the median
    /// force: 99th percentile and greatest. A query within a budget that is interrupted early knows little.
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
    /// Queries that overran on the processor, and again both times they were repeated at the same pose.
    again: usize,
    of_clock: [usize; 2],
}

/// What was asked at every tick.
#[derive(Clone, Copy)]
enum Query {
    Full,
    Cached,
    /// Within the budget of this number, and so many microseconds.
    Within(usize, u64),
}

/// One query in one phase.
#[derive(Serialize)]
struct Row {
    phase: &'static str,
    /// Whether what a cache remembers was used.
    cached: bool,
    /// Budget (µs); none for queries that run to their end.
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
    pub(crate) fn new(a: &InnerSphereTree, b: &InnerSphereTree, budgets: &[u64], ticks: &[Tick]) -> Self {
        let within = budgets.iter().enumerate().map(|(number, us)| Query::Within(number, *us));
        let queries: Vec<Query> = [Query::Full, Query::Cached].into_iter().chain(within).collect();
        let mut rows = Vec::new();
        for (phase, (name, _)) in PHASES.iter().enumerate() {
            let of_phase: Vec<&Tick> = ticks.iter().filter(|tick| tick.phase == phase).collect();
            if of_phase.is_empty() {
                continue;
            }
            for query in &queries {
                rows.push(Row::new(name, *query, &of_phase));
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

    pub(crate) fn print(&self) -> Result<()> {
        print_line(format_args!(
            "{} and {} spheres, {} ticks of 1 ms",
            self.spheres[0], self.spheres[1], self.ticks
        ))?;
        print_line(
            "                   wall time, µs                    on the processor, µs             overrun > 20 %   of the clock      volume error   interval",
        )?;
        print_line(
            "phase    budget    median    p99   p99.9     max    median    p99   p99.9     max    wall  processor   wall  processor   median   p95   width",
        )?;
        for row in &self.rows {
            let whole = if row.cached { "cached" } else { "full" };
            let budget = row.budget_us.map_or(whole.to_owned(), |us| us.to_string());
            let times =
                |[median, p99, p999, max]: [f64; 4]| format!("{median:9.1} {p99:6.1} {p999:7.1} {max:7.1}");
            let percent = |share: f64| format!("{:.2} %", 100.0 * share);
            print_line(format_args!(
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
            ))?;
        }
        let jumps: Vec<String> = self.jumps.iter().map(|[p99, max]| format!("{p99:.3} / {max:.3}")).collect();
        print_line(format_args!(
            "change of the force in a tick, in median forces, p99 / max: {} (full, cached, then by budget)",
            jumps.join(", ")
        ))?;
        for overruns in &self.overruns {
            print_line(format_args!(
                "{} µs: of {} queries {} / {} overran on the wall / on the processor, {} of them again both times they were repeated; of as many loops that only read the clock {} / {}",
                overruns.budget_us,
                overruns.queries,
                overruns.of_queries[0],
                overruns.of_queries[1],
                overruns.again,
                overruns.of_clock[0],
                overruns.of_clock[1],
            ))?;
        }
        Ok(())
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
            again: overlapping.iter().filter(|within| within.overran_again).count(),
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
    pub(crate) fn on_processor(&self) -> f64 {
        self.wall - self.waited
    }

    /// Width of the interval of the volume (m³).
    fn width(&self) -> f64 {
        self.bounds[1] - self.bounds[0]
    }
}

impl Tick {
    fn query(&self, query: Query) -> &Measurement {
        match query {
            Query::Full => &self.full,
            Query::Cached => &self.cached,
            Query::Within(number, _) => &self.within[number].query,
        }
    }
}

impl Row {
    fn new(phase: &'static str, query: Query, ticks: &[&Tick]) -> Self {
        let budget = match query {
            Query::Within(number, us) => Some((number, us)),
            Query::Full | Query::Cached => None,
        };
        let collect =
            |value: &dyn Fn(&Tick) -> f64| -> Vec<f64> { ticks.iter().map(|tick| value(tick)).collect() };
        let wall = collect(&|tick| tick.query(query).wall);
        let processor = collect(&|tick| tick.query(query).on_processor());
        let relative = |tick: &Tick, value: f64| value / f64::from(tick.full.overlap.volume).max(1e-300);
        let error = collect(&|tick| {
            relative(tick, f64::from(tick.query(query).overlap.volume - tick.full.overlap.volume).abs())
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
            cached: matches!(query, Query::Cached),
            budget_us: budget.map(|(_, us)| us),
            ticks: ticks.len(),
            wall_us: times(&wall),
            processor_us: times(&processor),
            overruns: [overruns(&wall), overruns(&processor)],
            clock_overruns: [clock(|m| m.wall), clock(Measurement::on_processor)],
            volume_error: [0.5, 0.95].map(|share| if_overlapping(percentile(&error, share))),
            interval_width: if_overlapping(percentile(
                &collect(&|tick| relative(tick, tick.query(query).width())),
                0.5,
            )),
        }
    }
}

/// 99th percentile and greatest change of the force from one tick with contact to the next, in units of the median force.
pub(crate) fn jumps(ticks: &[Tick], query: impl Fn(&Tick) -> &Measurement) -> [f64; 2] {
    let touching: Vec<&Tick> = ticks.iter().filter(|tick| tick.full.overlap.volume > 0.0).collect();
    let forces: Vec<f64> = touching.iter().map(|tick| f64::from(tick.full.overlap.force.length())).collect();
    let force = |tick: &Tick| query(tick).overlap.force;
    let jumps: Vec<f64> =
        touching.windows(2).map(|pair| f64::from(force(pair[0]).distance(force(pair[1])))).collect();
    let median = percentile(&forces, 0.5).max(f64::MIN_POSITIVE);
    [0.99, 1.0].map(|share| percentile(&jumps, share) / median)
}
