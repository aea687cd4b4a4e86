//! Times of single queries, and their ratios.
//!
//! Engines take turns, a round each over the poses of a band; a figure is the median over the rounds of what each round
//! gives. A ratio is taken within a round and over the same poses, so that it holds although the machine's speed wanders.
//! It does not hold where other programs take the processor away: a query of milliseconds is interrupted, one of
//! microseconds mostly is not. [`waiting_share`] tells.
//!
//! A processor learns which way the branches of a query go, and keeps what it read: the same query a second time takes
//! half as long. Two figures bracket what a simulation sees. A *jump* is the first query after one at an unrelated
//! pose; *moves* are the next ones, each a millimetre on, as of a body of 1 m with 6 cm/s at 60 Hz and nothing else in
//! the world, and their mean: some are slower than others, as those of a cache that makes a list. From move to move engines keep
//! what a world keeps of a pair: Rapier's shapes their contacts, which they then mostly need not look for again, and trees a
//! cache, where they have one.

use crate::engine::{Answer, Engine};
use crate::pair::ExactPose;
use glam::Vec3;
use glamx::Pose3;
use rapier_ist_tests::median;
use std::hint::black_box;
use std::time::Instant;

/// Rounds of an engine, if it is not too slow.
const ROUNDS: usize = 9;
/// An engine that has taken this many seconds in a band has no further poses.
const PATIENCE: f64 = 2.5;
/// Queries that follow a jump, and the way between two of them (m).
const MOVES: u8 = 5;
const STEP: f32 = 1e-3;

/// One engine at the poses of one band.
pub(crate) struct Run {
    /// Poses that were asked about, in this order; fewer than there are if the engine is slow.
    pub(crate) poses: Vec<usize>,
    /// What the engine answered there.
    pub(crate) answers: Vec<Answer>,
    pub(crate) jump: Times,
    pub(crate) moves: Times,
}

/// Seconds per query, one list of poses per round.
#[derive(Default)]
pub(crate) struct Times(Vec<Vec<f64>>);

impl Times {
    /// Median over the poses in each round, then over the rounds.
    pub(crate) fn median(&self) -> f64 {
        median(self.medians().collect())
    }

    /// How many times as long a query takes as one of `other`, which was asked about the same poses, and maybe more.
    pub(crate) fn ratio_to(&self, other: &Self) -> f64 {
        let rounds = self.0.iter().zip(&other.0);
        let ratio = |(here, there): (&Vec<f64>, &Vec<f64>)| {
            median(here.clone()) / median(there[..here.len().min(there.len())].to_vec())
        };
        median(rounds.map(ratio).collect())
    }

    /// All queries of a round together (s).
    pub(crate) fn total(&self) -> f64 {
        median(self.0.iter().map(|round| round.iter().sum()).collect())
    }

    fn medians(&self) -> impl Iterator<Item = f64> + '_ {
        self.0.iter().map(|round| median(round.clone()))
    }
}

/// Times all `engines` at all `poses`.
pub(crate) fn time(engines: &mut [Box<dyn Engine>], poses: &[ExactPose]) -> Vec<Run> {
    let mut runs: Vec<Run> = engines.iter().map(|_| Run::new(poses.len())).collect();
    let mut spent = vec![0.0; engines.len()];
    let clock = clock_seconds();
    for _ in 0..ROUNDS {
        for ((engine, run), spent) in engines.iter_mut().zip(&mut runs).zip(&mut spent) {
            if *spent < PATIENCE {
                *spent += run.round(engine.as_mut(), poses, clock);
            }
        }
    }
    runs
}

impl Run {
    fn new(count: usize) -> Self {
        let (answers, jump, moves) = Default::default();
        Self { poses: spread(count), answers, jump, moves }
    }

    /// Adds a round; returns the seconds that it took.
    fn round(&mut self, engine: &mut dyn Engine, poses: &[ExactPose], clock: f64) -> f64 {
        let start = Instant::now();
        let is_first = self.answers.is_empty();
        let (mut jumps, mut moves) = (Vec::new(), Vec::new());
        for &index in &self.poses {
            if is_first && start.elapsed().as_secs_f64() > PATIENCE {
                break;
            }
            engine.jump();
            let mut on_the_way = (0..=MOVES).rev().map(|steps| {
                let mut pose = poses[index].pose;
                pose.translation -= Vec3::X * (STEP * f32::from(steps));
                seconds(engine, &pose) - clock
            });
            jumps.extend(on_the_way.next());
            moves.push(on_the_way.sum::<f64>() / f64::from(MOVES));
            if is_first {
                self.answers.push(engine.answer());
            }
        }
        self.poses.truncate(self.answers.len());
        self.jump.0.push(jumps);
        self.moves.0.push(moves);
        start.elapsed().as_secs_f64()
    }
}

/// The numbers below `count` in an order whose beginnings are spread over all of them.
fn spread(count: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    let key = |index: &usize| (*index as u32).wrapping_mul(0x9E37_79B9);
    order.sort_by_key(key);
    order
}

fn seconds(engine: &mut dyn Engine, pose: &Pose3) -> f64 {
    let start = Instant::now();
    engine.query(black_box(pose));
    start.elapsed().as_secs_f64()
}

/// What reading the clock adds to a time (s).
fn clock_seconds() -> f64 {
    median((0..1001).map(|_| Instant::now().elapsed().as_secs_f64()).collect())
}

/// Share of the time between two calls of [`scheduled`] in which this thread was ready to run and did not, 0 to 1.
pub(crate) fn waiting_share(before: [f64; 2], after: [f64; 2]) -> f64 {
    let [running, waiting] = [0, 1].map(|i| after[i] - before[i]);
    waiting / (running + waiting).max(f64::MIN_POSITIVE)
}

/// Nanoseconds in which this thread ran, and in which it waited for a processor; none where the system does not tell.
pub(crate) fn scheduled() -> Option<[f64; 2]> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let mut numbers = text.split_whitespace().map(str::parse);
    Some([numbers.next()?.ok()?, numbers.next()?.ok()?])
}
