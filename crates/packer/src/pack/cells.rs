//! Octree cells, sorted into buckets by the largest ball that may still fit.

use super::ball_grid::Ball;
use super::field::{Candidate, Field, Scratch};
use super::search;
use crate::Solid;
use glam::DVec3;

/// A leaf is a cell whose half diagonal is at most this share of the radius sought. On the five assets 0.4 to
/// 0.85 filled the same to 0.3 points at 3,000 balls, 0.85 in half the time of 0.4; 1.0 lost up to 1.3 points
/// at 100 balls on the spider gear.
pub(super) const LEAF: f64 = 0.85;
/// How far an ascent may leave its cell, in half diagonals. 1.0 was a quarter faster and lost 2 points at 100
/// balls on the bunny, 0.8 at 1,000.
pub(super) const REACH: f64 = 1.5;

/// A cube of space in which a ball's centre may still lie.
#[derive(Clone, Debug)]
pub(super) struct Cell {
    pub(super) center: DVec3,
    /// Half of the edge.
    pub(super) half: f64,
    /// Clearance at the centre when it was last looked at; it only falls.
    pub(super) clearance: f64,
    /// Bounds of the surface's distance from the centre.
    surface: [f64; 2],
    /// What the last ascent from here found.
    candidate: Option<Candidate>,
    /// The candidate as it would be stored, once that is known.
    ball: Option<Ball>,
}

/// What became of a cell in a round.
#[derive(Debug, Default)]
pub(super) struct Visit {
    /// Cells that cannot hold a ball of this round, with the largest radius they may hold.
    pub(super) later: Vec<(Cell, f64)>,
    /// Cells that propose a ball.
    pub(super) proposals: Vec<Cell>,
}

impl Cell {
    pub(super) fn root(center: DVec3, half: f64) -> Self {
        Self {
            center,
            half,
            clearance: f64::INFINITY,
            surface: [0.0, f64::INFINITY],
            candidate: None,
            ball: None,
        }
    }

    fn half_diagonal(&self) -> f64 {
        self.half * 3.0_f64.sqrt()
    }

    /// No ball with its centre in the cell is larger.
    pub(super) fn bound(&self) -> f64 {
        self.clearance + self.half_diagonal()
    }

    /// The ball that the cell proposes, as `export` makes it of its candidate; asked only once while it fits.
    pub(super) fn proposal(
        &mut self,
        field: &Field,
        export: impl FnOnce(&Candidate, &Field) -> Option<Ball>,
    ) -> Option<Ball> {
        let fits = |ball: &Ball| field.balls.clearance(ball.center, ball.radius) >= ball.radius;
        if !self.ball.as_ref().is_some_and(fits) {
            self.ball = self.candidate.as_ref().and_then(|candidate| export(candidate, field));
        }
        self.ball
    }

    /// Brings [`Self::clearance`] up to date with all balls.
    pub(super) fn update(&mut self, field: &Field) {
        let known = self.known();
        let to_balls = field.balls.clearance(self.center, known);
        self.refresh(field.solid, known, to_balls);
    }

    /// As [`Self::update`], where `balls` holds all that can be nearest to a point of the cell.
    fn update_among(&mut self, balls: &[Ball], solid: &Solid) {
        let known = self.known();
        let to_balls = balls.iter().fold(known, |nearest, ball| nearest.min(ball.distance(self.center)));
        self.refresh(solid, known, to_balls);
    }

    /// What the clearance cannot exceed.
    fn known(&self) -> f64 {
        self.clearance.min(self.surface[1] * (1.0 + 1e-6))
    }

    fn refresh(&mut self, solid: &Solid, known: f64, to_balls: f64) {
        let [lower, upper] = self.surface;
        self.clearance = to_balls;
        if to_balls <= lower || to_balls <= 0.0 || lower == upper {
            return;
        }
        // Balls lie inside: from a point outside, the surface is nearer than any of them.
        let bound = if to_balls < known { to_balls } else { upper * (1.0 + 1e-6) };
        match solid.closest_point_within(self.center, bound) {
            Some(nearest) => {
                self.clearance = to_balls.min(nearest.depth);
                self.surface = [nearest.depth.abs(); 2];
            }
            None => self.surface[0] = bound.min(upper),
        }
    }

    /// How often the cell is divided until its parts are leaves for balls of `radius`.
    pub(super) fn levels(&self, radius: f64) -> u32 {
        let (mut levels, mut size) = (0, self.half_diagonal());
        while size > LEAF * radius && levels < 64 {
            (levels, size) = (levels + 1, 0.5 * size);
        }
        levels
    }

    pub(super) fn children(&self) -> impl Iterator<Item = Self> + '_ {
        let half = 0.5 * self.half;
        let offset = 0.5 * self.half_diagonal();
        let [lower, upper] = self.surface;
        let surface = [(lower - offset).max(0.0), upper + offset];
        (0..8).map(move |i| {
            let side = |bit: i32| if i >> bit & 1 == 1 { half } else { -half };
            let center = self.center + DVec3::new(side(0), side(1), side(2));
            Self { center, half, clearance: self.clearance + offset, surface, candidate: None, ball: None }
        })
    }
}

/// Refines `cell` until its parts either propose a ball of at least `radius` or cannot hold one.
pub(super) fn visit(mut cell: Cell, radius: f64, field: &Field, scratch: &mut Scratch, out: &mut Visit) {
    cell.update(field);
    if cell.bound() < radius || cell.half_diagonal() <= LEAF * radius {
        settle(cell, radius, field, scratch, out);
        return;
    }
    // One look at the grid serves all descendants: a point of the cell is within h of the centre, and the
    // clearance there is at most f + h.
    let mut balls = std::mem::take(&mut scratch.nearby);
    field.balls.gather(cell.center, cell.clearance + 2.0 * cell.half_diagonal(), &mut balls);
    refine(&cell, &balls, radius, &mut Work { field, scratch, out });
    scratch.nearby = balls;
}

/// What the descendants of a cell share.
struct Work<'a, 'f> {
    field: &'a Field<'f>,
    scratch: &'a mut Scratch,
    out: &'a mut Visit,
}

fn refine(cell: &Cell, balls: &[Ball], radius: f64, work: &mut Work) {
    for mut child in cell.children() {
        if work.field.watch.is_over() {
            return;
        }
        child.update_among(balls, work.field.solid);
        if child.bound() < radius || child.half_diagonal() <= LEAF * radius {
            settle(child, radius, work.field, work.scratch, work.out);
        } else {
            let reach = child.clearance + 2.0 * child.half_diagonal();
            let near = |ball: &&Ball| ball.distance(child.center) < reach;
            let balls: Vec<Ball> = balls.iter().filter(near).copied().collect();
            refine(&child, &balls, radius, work);
        }
    }
}

/// Files an up-to-date cell that is not refined further.
fn settle(mut cell: Cell, radius: f64, field: &Field, scratch: &mut Scratch, out: &mut Visit) {
    let bound = cell.bound();
    if bound < radius {
        // A cell inside a ball or outside the solid is done with.
        if bound > 0.0 {
            out.later.push((cell, bound));
        }
        return;
    }
    let still_there = cell
        .candidate
        .is_some_and(|c| !c.at_boundary && field.balls.clearance(c.center, c.radius) >= c.radius);
    if !still_there {
        let reach = REACH * cell.half_diagonal();
        cell.ball = None;
        cell.candidate =
            Some(search::ascend(field, cell.center, cell.clearance, reach, &mut scratch.obstacles));
    }
    match cell.candidate {
        Some(k) if k.radius >= radius && !k.at_boundary => out.proposals.push(cell),
        Some(c) => {
            // At the boundary the better place belongs to another cell: look again in the next round.
            out.later.push((cell, c.radius.min(bound)));
        }
        None => {}
    }
}
