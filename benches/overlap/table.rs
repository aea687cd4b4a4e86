//! Times and errors of all engines on one pair of meshes, as a Markdown table.

use crate::engine::Engine;
use crate::pair::{BANDS, ExactPose, MeshPair, PoseBand};
use crate::stopwatch::{Run, scheduled, time, waiting_share};
use rapier_ist_tests::{Band, median};
use std::fmt::Write;

/// The engine that the others are compared with at unrelated poses, where nothing helps to have been asked before.
const YARDSTICK: &str = "tree, 1000 spheres";
/// The same from move to move, where Rapier's shapes keep their contacts.
const YARDSTICK_IN_MOTION: &str = "tree with a cache, 1000 spheres";
/// Least ratios to both yardsticks that the project aims at.
const GOALS: [(&str, f64, &[Band]); 2] = [
    ("parry VHACD", 8.0, &[Band::Shallow, Band::Mid, Band::Deep]),
    ("parry TriMesh, FIX", 200.0, &[Band::Mid, Band::Deep]),
];
/// Most nanoseconds per overlapping pair of spheres in deep overlap that the project aims at.
const PAIR_GOAL: f64 = 20.0;

/// Share of the time that the measurement may wait for a processor without a warning.
const BUSY: f64 = 0.02;

const HEAD: &str = "\
| engine | build s | µs, jump | µs, moves | times the tree, jump | times the tree with a cache, moves \
| ns per pair of spheres, moves | volume error % | direction error ° |
|---|---|---|---|---|---|---|---|---|
";

/// Figures of one engine in one band.
struct Cell {
    run: Run,
    /// Times of a jump over those of [`YARDSTICK`], and of moves over those of [`YARDSTICK_IN_MOTION`].
    ratio: [f64; 2],
    errors: Errors,
}

/// How far an engine is off at the poses of one band.
#[derive(Default)]
struct Errors {
    /// Median relative error of the volume.
    volume: Option<f64>,
    /// Median angle between the push and the steepest descent of the exact volume (degrees).
    direction: Option<f64>,
    /// Overlapping pairs of spheres at all poses.
    pairs: u32,
}

/// Measures all engines and reports.
pub(crate) fn markdown(pair: &MeshPair, engines: &mut [Box<dyn Engine>]) -> String {
    let bands = BANDS.map(|band| (band, pair.poses_in(band)));
    let before = scheduled();
    let columns: Vec<Vec<Cell>> = bands.iter().map(|(_, poses)| column(engines, poses)).collect();
    let waited = before.zip(scheduled()).map(|(before, after)| waiting_share(before, after));
    let join = |words: Vec<String>| words.join(" / ");
    let names = join(bands.iter().map(|(band, _)| band.name().into()).collect());
    let counts = join(bands.iter().map(|(_, poses)| poses.len().to_string()).collect());
    let mut out = format!("{}: {names} ({counts} poses), medians, one thread\n\n{HEAD}", pair.name);
    for (row, engine) in engines.iter().enumerate() {
        let figures = |figure: &dyn Fn(&Cell) -> Option<f64>| {
            join(columns.iter().map(|column| figure(&column[row]).map_or("–".into(), short)).collect())
        };
        let cells = [
            short(engine.build_seconds()),
            figures(&|cell| Some(cell.run.jump.median() * 1e6)),
            figures(&|cell| Some(cell.run.moves.median() * 1e6)),
            figures(&|cell| Some(cell.ratio[0])),
            figures(&|cell| Some(cell.ratio[1])),
            figures(&Cell::nanoseconds_per_pair),
            figures(&|cell| cell.errors.volume.map(|error| 100.0 * error)),
            figures(&|cell| cell.errors.direction),
        ];
        let _ = writeln!(out, "| {} | {} |", engine.name(), cells.join(" | "));
    }
    out += &notes(engines, &columns);
    if let Some(waited) = waited.filter(|share| *share > BUSY) {
        let percent = 100.0 * waited;
        let _ = writeln!(
            out,
            "Waited {percent:.0} % of the time for a processor: ratios of slow engines are too large.\n"
        );
    }
    out + &goals(engines, &columns)
}

/// Times and errors of all engines at the poses of one band.
fn column(engines: &mut [Box<dyn Engine>], poses: &[ExactPose]) -> Vec<Cell> {
    let runs = time(engines, poses);
    let named = |name| &runs[engines.iter().position(|engine| engine.name() == name).unwrap_or(0)];
    let (at_jumps, in_motion) = (named(YARDSTICK), named(YARDSTICK_IN_MOTION));
    let ratio = |run: &Run| [run.jump.ratio_to(&at_jumps.jump), run.moves.ratio_to(&in_motion.moves)];
    let ratios: Vec<[f64; 2]> = runs.iter().map(ratio).collect();
    let cells = runs.into_iter().zip(ratios);
    cells.map(|(run, ratio)| Cell { errors: Errors::new(&run, poses), run, ratio }).collect()
}

impl Cell {
    fn nanoseconds_per_pair(&self) -> Option<f64> {
        let pairs = f64::from(self.errors.pairs);
        (self.errors.volume.is_some() && pairs > 0.0).then(|| self.run.moves.total() * 1e9 / pairs)
    }
}

impl Errors {
    fn new(run: &Run, poses: &[ExactPose]) -> Self {
        let (mut volumes, mut directions, mut pairs) = (Vec::new(), Vec::new(), 0);
        for (index, answer) in run.poses.iter().zip(&run.answers) {
            let exact = &poses[*index];
            pairs += answer.pairs.unwrap_or(0);
            if exact.volume <= 0.0 {
                continue;
            }
            volumes.extend(answer.volume.map(|volume| (volume / exact.volume - 1.0).abs()));
            // An engine that finds no contact knows no direction: as wrong as can be.
            directions.extend(exact.descent.map(|descent| match answer.push.try_normalize() {
                Some(push) => f64::from(push.angle_between(descent).to_degrees()),
                None => 180.0,
            }));
        }
        let middle = |values: Vec<f64>| (!values.is_empty()).then(|| median(values));
        Self { volume: middle(volumes), direction: middle(directions), pairs }
    }
}

/// Which engines were too slow for all poses.
fn notes(engines: &[Box<dyn Engine>], columns: &[Vec<Cell>]) -> String {
    let mut out = String::from("\n");
    for (row, engine) in engines.iter().enumerate() {
        let counts: Vec<usize> = columns.iter().map(|column| column[row].run.poses.len()).collect();
        if counts.iter().zip(columns).any(|(count, column)| *count < column[0].run.poses.len()) {
            let _ = writeln!(
                out,
                "{} was asked about {counts:?} poses only, for its slowness: its medians are of those.\n",
                engine.name()
            );
        }
    }
    out
}

/// Which of the aims are met.
fn goals(engines: &[Box<dyn Engine>], columns: &[Vec<Cell>]) -> String {
    let mut out = String::new();
    let mut line = |what: &str, band: PoseBand, figure: String, is_met: bool| {
        let verdict = if is_met { "met" } else { "missed" };
        let _ = writeln!(out, "- {what}, {}: {figure} – {verdict}", band.name());
    };
    for (band, column) in BANDS.into_iter().zip(columns) {
        let PoseBand::Overlapping(depth) = band else { continue };
        for (engine, cell) in engines.iter().zip(column) {
            for (prefix, least, depths) in GOALS {
                if engine.name().starts_with(prefix) && depths.contains(&depth) {
                    let ways = [("jumps", YARDSTICK), ("moves", YARDSTICK_IN_MOTION)];
                    for ((way, yardstick), ratio) in ways.into_iter().zip(cell.ratio) {
                        let what = format!("{way}, {} over {yardstick}, at least {least}", engine.name());
                        line(&what, band, short(ratio), ratio >= least);
                    }
                }
            }
            if let (Band::Deep, YARDSTICK, Some(figure)) = (depth, engine.name(), cell.nanoseconds_per_pair())
            {
                let what = format!("ns per pair of {YARDSTICK}, at most {PAIR_GOAL}");
                line(&what, band, short(figure), figure <= PAIR_GOAL);
            }
        }
    }
    out
}

/// Two or three significant digits.
fn short(x: f64) -> String {
    match x {
        x if !x.is_finite() => "–".into(),
        x if x >= 10.0 => format!("{x:.0}"),
        x if x >= 1.0 => format!("{x:.1}"),
        x => format!("{x:.2}"),
    }
}
