//! Greedy packing in rounds of falling radius.
//!
//! Exact greedy packing places each ball at the global maximum of the clearance, one by one. As in ProtoSphere
//! (R. Weller and G. Zachmann, 2010) many places are searched at once here, but a round takes only balls near
//! the largest radius that is left, which keeps the coverage of the greedy order: an octree cell with centre
//! `m` and half diagonal `h` holds no ball above `f(m) + h`, as the clearance `f` is 1-Lipschitz, and bounds
//! that are out of date stay valid, as `f` only falls. So a cell rests in the bucket of its bound until its
//! round comes. No step depends on how many balls are asked for, and all searches of a pass see the same
//! balls: a larger packing begins with the smaller one, and threads do not matter.
//!
//! What was chosen, and what it is worth:
//!
//! - Buckets of cells instead of a queue of single cells: all places of a round are searched in parallel. Two threads
//!   are 1.8 to 1.9 times as fast as one, and 10,000 balls of a gear of 14,800 triangles take 1.9 s, 100,000 15 s; exact
//!   greedy packing of comparable meshes with 10,000 balls took 28 to 81 s on one thread.
//! - Cells keep the place that their last search found, and search again only when a new ball covers it. For 10,000
//!   balls of the gear there were 38 searches a ball, of 3.4 evaluations each.
//! - Searches solve a linear model instead of taking small steps ([`super::search`]).
//! - Placed balls are found in grids by radius ([`super::ball_grid`]): a quarter of the time. Half goes into distances to
//!   the surface; beginning those with the triangle that was nearest before was no faster.
//! - Large balls come from Voronoi seeds ([`super::seeds`]), balls on plateaus in rows ([`super::plateau`]).

use super::ball_grid::{Ball, BallGrid};
use super::cells::{Cell, Visit, visit};
use super::field::{Candidate, Field, Scratch};
use super::plateau::{self, Waiting};
use super::seeds;
use super::stop_signal::Watch;
use crate::Solid;
use glam::DVec3;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Each round takes balls of at least this share of the radius of the round before. 0.85 was no faster and lost
/// 0.5 points at 100 balls on the pelvis, 0.1 at 1,000.
pub(super) const FALL: f64 = 0.9;
/// Cells along the longest side of the root grid.
const ROOT_CELLS: f64 = 12.0;
/// Cells that one task visits; small enough to share out the work of the first rounds.
const CHUNK: usize = 32;
/// Leaves that a pass looks at. Without this bound the assets get the same 3,000 balls, and at 10,000 up to 0.03 points
/// more.
const PASS: usize = 1 << 18;
/// Levels of a cell that are refined as one task. A choice.
const LEVELS: u32 = 4;

/// How small balls may be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Smallest {
    /// No ball is smaller (m). Balls within a ninth above it may depend on it.
    pub(super) radius: f64,
    /// If no ball after the first can be larger (m), it stays alone.
    pub(super) negligible: f64,
}

/// Places balls until `wanted` says stop, which is asked before each ball with the next one, or until `watch` is
/// over. A pass that it cuts short places nothing, so that the balls are still a beginning of the same sequence.
pub(super) fn place(
    solid: &Solid,
    smallest: Smallest,
    watch: &Watch,
    wanted: impl FnMut(&Ball) -> bool,
) -> BallGrid {
    let mut placing = Placing { solid, balls: BallGrid::default(), watch, wanted };
    let roots = roots(&placing.field());
    let Some(largest) = roots.iter().map(Cell::bound).max_by(f64::total_cmp) else { return placing.balls };
    let mut seeds = seeds::find(&placing.field());
    let mut buckets = Buckets::new(largest);
    // Rounds above the largest seed would search everything for nothing: what is larger comes first in the next one.
    let mut round = seeds.first().map_or(0, |seed| buckets.round_of(seed.radius));
    for root in roots {
        let bound = root.bound();
        buckets.add(root, bound, round);
    }
    while buckets.radii[round] >= smallest.radius {
        let is_first = placing.balls.balls().is_empty();
        buckets.extend(round + 1);
        let of_seeds = (seeds::SHARE * buckets.radii[round]).max(smallest.radius);
        if placing.place_seeds(&mut seeds, of_seeds).is_break()
            || placing.place_from_cells(&mut buckets, round, smallest.radius).is_break()
            || is_first && placing.largest_to_come() < smallest.negligible
        {
            break;
        }
        round += 1;
    }
    placing.balls
}

/// A packing under way.
struct Placing<'a, W> {
    solid: &'a Solid,
    balls: BallGrid,
    watch: &'a Watch<'a>,
    wanted: W,
}

impl<W: FnMut(&Ball) -> bool> Placing<'_, W> {
    fn field(&self) -> Field<'_> {
        Field { solid: self.solid, balls: &self.balls, watch: self.watch }
    }

    /// Bound of the radius of all balls after the first (m), infinite before it.
    ///
    /// A ball of radius `r` outside the first one, of radius `R`, has a point `R + 2 r` or more from the first one's
    /// centre, and in the solid nothing is farther than its farthest vertex.
    fn largest_to_come(&self) -> f64 {
        let Some(first) = self.balls.balls().first() else { return f64::INFINITY };
        let distances = self.solid.mesh().vertices.iter().map(|vertex| vertex.distance(first.center));
        0.5 * (distances.fold(0.0, f64::max) - first.radius)
    }

    /// Places the balls of at least `radius` that the seeds propose.
    fn place_seeds(&mut self, seeds: &mut Vec<Candidate>, radius: f64) -> ControlFlow<()> {
        loop {
            // In descending order; radii only fall.
            let rest = seeds.split_off(seeds.partition_point(|seed| seed.radius >= radius));
            let field = self.field();
            let updated: Vec<(Candidate, Option<Ball>)> = std::mem::take(seeds)
                .into_par_iter()
                .with_min_len(CHUNK)
                .map_init(Scratch::default, |scratch, seed| {
                    let seed = seeds::update(seed, &field, scratch)?;
                    Some((seed, (seed.radius >= radius).then(|| export(&seed, &field)).flatten()))
                })
                .flatten_iter()
                .collect();
            let mut balls = Vec::new();
            for (seed, ball) in updated {
                balls.extend(ball.filter(|ball| ball.radius >= radius));
                seeds.push(seed);
            }
            seeds.extend(rest);
            seeds.sort_by(|a, b| b.radius.total_cmp(&a.radius));
            let placed = self.balls.balls().len();
            self.accept(balls, radius)?;
            if self.balls.balls().len() == placed {
                return ControlFlow::Continue(());
            }
        }
    }

    /// Places the balls of at least `radius` that the cells of one round propose.
    ///
    /// A pass looks at a part of them, depth first, so that the first balls of a solid with more places than anyone
    /// asks for, such as a thin plate, do not wait for all the others.
    fn place_from_cells(&mut self, buckets: &mut Buckets, round: usize, smallest: f64) -> ControlFlow<()> {
        let radius = buckets.radii[round + 1].max(smallest);
        // A stack: the first cell is on top.
        let mut open = std::mem::take(&mut buckets.cells[round]);
        open.reverse();
        while !open.is_empty() {
            let mut later = Vec::new();
            let pass = self.next_pass(&mut open, radius, &mut later);
            let (mut balls, mut again) = (Vec::new(), Vec::new());
            for (visit, proposed) in visit_all(&pass, radius, &self.field()) {
                later.extend(visit.later);
                for (cell, ball) in visit.proposals.into_iter().zip(proposed) {
                    match ball {
                        Some(ball) if ball.radius >= radius => {
                            balls.push(ball);
                            again.push(cell);
                        }
                        _ => later.push((cell, radius)),
                    }
                }
            }
            for (cell, bound) in later {
                if bound >= smallest {
                    buckets.add(cell, bound, round + 1);
                }
            }
            let placed = self.balls.balls().len();
            self.accept(balls, radius)?;
            if self.balls.balls().len() > placed {
                open.extend(again.into_iter().rev());
            } else {
                // Not one fits where it was proposed: rounding. Again they would be proposed for ever.
                again.into_iter().for_each(|cell| buckets.add(cell, radius, round + 1));
            }
        }
        ControlFlow::Continue(())
    }

    /// Takes the cells of the next pass from the top of `open`; large ones are divided, and those parts that hold no
    /// ball of this round go to `later`.
    fn next_pass(&self, open: &mut Vec<Cell>, radius: f64, later: &mut Vec<(Cell, f64)>) -> Vec<Cell> {
        let field = self.field();
        let (mut pass, mut work) = (Vec::new(), 0);
        while work < PASS
            && !self.watch.is_over()
            && let Some(mut cell) = open.pop()
        {
            if cell.levels(radius) <= LEVELS {
                work += 1 << (3 * cell.levels(radius));
                pass.push(cell);
                continue;
            }
            cell.update(&field);
            let bound = cell.bound();
            if bound >= radius {
                let first = open.len();
                open.extend(cell.children());
                open[first..].reverse();
            } else if bound > 0.0 {
                later.push((cell, bound));
            }
        }
        pass
    }

    /// Places those of `proposals`, of at least `radius`, that do not meet an earlier one; see [`super::plateau`]
    /// for those that wait for the next pass. The first in order is always placed.
    fn accept(&mut self, proposals: Vec<Ball>, radius: f64) -> ControlFlow<()> {
        if self.watch.is_over() {
            return ControlFlow::Break(());
        }
        let mut waiting = Waiting::default();
        for (ball, contacts) in plateau::in_order(proposals, radius, &self.balls) {
            if waiting.holds(&ball, contacts) || self.balls.clearance(ball.center, ball.radius) < ball.radius
            {
                continue;
            }
            if !(self.wanted)(&ball) {
                return ControlFlow::Break(());
            }
            waiting.placed(&ball);
            self.balls.insert(ball);
        }
        ControlFlow::Continue(())
    }
}

/// Visits all cells, in parallel but with results in order; proposals come with their exported ball.
fn visit_all(cells: &[Cell], radius: f64, field: &Field) -> Vec<(Visit, Vec<Option<Ball>>)> {
    cells
        .par_chunks(CHUNK)
        .map_init(Scratch::default, |scratch, chunk| {
            let mut out = Visit::default();
            for cell in chunk {
                if field.watch.is_over() {
                    break;
                }
                visit(cell.clone(), radius, field, scratch, &mut out);
            }
            let balls = out.proposals.iter_mut().map(|cell| cell.proposal(field, export)).collect();
            (out, balls)
        })
        .collect()
}

/// The ball as it is stored: centre rounded to single precision, clearance taken there, radius rounded down.
fn export(candidate: &Candidate, field: &Field) -> Option<Ball> {
    let center = candidate.center.as_vec3().as_dvec3();
    let clearance = field.clearance(center, 2.0 * candidate.radius);
    let radius = round_down(clearance);
    // Where the surface cuts itself, its nearest point can misjudge the side.
    let is_inside = !field.solid.has_folds() || field.solid.winds_around(center);
    (radius > 0.0 && is_inside).then_some(Ball { center, radius: f64::from(radius) })
}

/// The largest f32 that is not larger than `x`.
pub(super) fn round_down(x: f64) -> f32 {
    let rounded = x as f32;
    if f64::from(rounded) > x { rounded.next_down() } else { rounded }
}

fn roots(field: &Field) -> Vec<Cell> {
    let (lower, upper) = field.solid.bounds();
    let extent = upper - lower;
    let edge = extent.max_element() / ROOT_CELLS;
    let counts = (extent / edge).ceil().max(DVec3::ONE).as_ivec3();
    let first = 0.5 * (lower + upper) - 0.5 * edge * counts.as_dvec3();
    let mut centers = Vec::new();
    for z in 0..counts.z {
        for y in 0..counts.y {
            for x in 0..counts.x {
                centers.push(first + (DVec3::new(x.into(), y.into(), z.into()) + 0.5) * edge);
            }
        }
    }
    centers
        .into_par_iter()
        .filter_map(|center| {
            let mut cell = Cell::root(center, 0.5 * edge);
            cell.update(field);
            (cell.bound() > 0.0).then_some(cell)
        })
        .collect()
}

/// Cells by the round in which they can first hold a ball.
struct Buckets {
    /// Largest radius in each bucket.
    radii: Vec<f64>,
    cells: Vec<Vec<Cell>>,
}

impl Buckets {
    fn new(largest: f64) -> Self {
        Self { radii: vec![largest * (1.0 + 1e-9)], cells: vec![Vec::new()] }
    }

    fn extend(&mut self, round: usize) {
        while self.radii.len() <= round + 1 {
            let last = self.radii[self.radii.len() - 1];
            self.radii.push(last * FALL);
            self.cells.push(Vec::new());
        }
    }

    /// The round that holds `bound`, at most the largest: round k has bounds in (radii[k + 1], radii[k]].
    fn round_of(&mut self, bound: f64) -> usize {
        while self.radii[self.radii.len() - 1] > bound {
            self.extend(self.radii.len());
        }
        self.radii.partition_point(|radius| *radius >= bound).saturating_sub(1)
    }

    /// Files `cell` under `bound`, but not before round `earliest`.
    fn add(&mut self, cell: Cell, bound: f64, earliest: usize) {
        let round = self.round_of(bound).max(earliest);
        self.extend(round);
        self.cells[round].push(cell);
    }
}
