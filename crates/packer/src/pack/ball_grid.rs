//! The placed balls, in a hierarchy of grids by radius.
//!
//! Level `l` holds the balls of radius in `(R/2^(l+1), R/2^l]`, `R` the largest, filed by the cell of their
//! centre; its cells are as wide as its largest diameter. A ball of level `l` whose surface is nearer than
//! `b` to a point has its centre within `b + R/2^l`, so a query looks at 8 to 27 cells a level while `b` is
//! no more than the radii. After the hierarchical grids of M. Eitz and G. Lixu (2007).

use glam::{DVec3, IVec3};
use rustc_hash::FxHashMap;
use std::f64::consts::PI;

/// A query of more cells than this, and than there are balls, looks at the balls instead. On the way to 10,000 spheres the
/// assets, a cube, a brick of 4:2:1 and a rod of 100:1 ask for at most 1,728 cells, so their balls are found in the order of the
/// cells, which decides ties; a plate of 1000:1 asks for 4e5, a wire of 10,000:1 for 4e8.
const MANY_CELLS: f64 = 4096.0;

/// A placed ball, exactly as it is exported.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ball {
    pub(super) center: DVec3,
    pub(super) radius: f64,
}

impl Ball {
    pub(super) fn volume(&self) -> f64 {
        4.0 / 3.0 * PI * self.radius.powi(3)
    }

    /// Distance of `p` from the ball's surface, negative inside.
    #[inline]
    pub(super) fn distance(&self, p: DVec3) -> f64 {
        self.center.distance(p) - self.radius
    }
}

#[derive(Debug, Default)]
pub(super) struct BallGrid {
    balls: Vec<Ball>,
    levels: Vec<Level>,
}

#[derive(Debug)]
struct Level {
    largest_radius: f64,
    /// Reciprocal width of a cell.
    scale: f64,
    cells: FxHashMap<u64, Vec<Ball>>,
}

impl Level {
    fn new(largest_radius: f64) -> Self {
        Self { largest_radius, scale: 0.5 / largest_radius, cells: FxHashMap::default() }
    }

    #[inline]
    fn cell(&self, p: DVec3) -> IVec3 {
        let p = p * self.scale;
        // The floor, without the library call that it is on processors of before 2008.
        let toward_zero = p.as_ivec3();
        // Balls that are tiny against the distance to the origin share the outermost cells.
        toward_zero.saturating_sub(IVec3::from(p.cmplt(toward_zero.as_dvec3())))
    }
}

/// Key of a cell, 21 bits a coordinate. Cells that share a key do no harm: the balls in them are found to be far.
#[inline]
fn key(cell: IVec3) -> u64 {
    let bits = |x: i32| u64::from(x as u32 & 0x1F_FFFF);
    bits(cell.x) | bits(cell.y) << 21 | bits(cell.z) << 42
}

impl BallGrid {
    pub(super) fn balls(&self) -> &[Ball] {
        &self.balls
    }

    /// Adds a ball that is no larger than the first one.
    pub(super) fn insert(&mut self, ball: Ball) {
        if self.levels.is_empty() {
            self.levels.push(Level::new(ball.radius));
        }
        let mut level = 0;
        while ball.radius <= 0.5 * self.levels[level].largest_radius {
            level += 1;
            if level == self.levels.len() {
                let largest_radius = 0.5 * self.levels[level - 1].largest_radius;
                self.levels.push(Level::new(largest_radius));
            }
        }
        let level = &mut self.levels[level];
        level.cells.entry(key(level.cell(ball.center))).or_default().push(ball);
        self.balls.push(ball);
    }

    /// Distance from `p` to the nearest ball, negative inside one, or `bound` where none is nearer.
    pub(super) fn clearance(&self, p: DVec3, bound: f64) -> f64 {
        let mut nearest = bound;
        for level in self.levels.iter().rev() {
            let reach = level.largest_radius + nearest;
            if reach < 0.0 {
                continue;
            }
            level.visit(level.range(p, reach), &self.balls, |ball| nearest = nearest.min(ball.distance(p)));
        }
        nearest
    }

    /// Puts all balls whose surface is nearer than `bound` to `p` into `out`.
    pub(super) fn gather(&self, p: DVec3, bound: f64, out: &mut Vec<Ball>) {
        out.clear();
        for level in &self.levels {
            level.visit(level.range(p, level.largest_radius + bound), &self.balls, |ball| {
                if ball.distance(p) < bound {
                    out.push(*ball);
                }
            });
        }
    }
}

impl Level {
    fn holds(&self, ball: &Ball) -> bool {
        ball.radius <= self.largest_radius && ball.radius > 0.5 * self.largest_radius
    }

    /// The first and the last of the cells that centres within `reach` of `p` lie in.
    #[inline]
    fn range(&self, p: DVec3, reach: f64) -> (IVec3, IVec3) {
        (self.cell(p - reach), self.cell(p + reach))
    }

    /// Visits the balls of the level in the cells from `first` to `last`, and maybe others; `all` are those of all levels.
    #[inline]
    fn visit(&self, (first, last): (IVec3, IVec3), all: &[Ball], mut visit: impl FnMut(&Ball)) {
        let cells = (last.as_dvec3() - first.as_dvec3() + 1.0).element_product();
        if cells > MANY_CELLS.max(all.len() as f64) {
            all.iter().filter(|ball| self.holds(ball)).for_each(visit);
            return;
        }
        for z in first.z..=last.z {
            for y in first.y..=last.y {
                for x in first.x..=last.x {
                    if let Some(balls) = self.cells.get(&key(IVec3::new(x, y, z))) {
                        balls.iter().for_each(&mut visit);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Small seeds of a spike of 260 km lay beyond the cells that i32 counts.
    #[test]
    fn issue_balls_beyond_the_cells_are_found() {
        for far in [1.0, 1e6, -1e6, 1e12, -1e12, 1e100, -1e100] {
            let mut grid = BallGrid::default();
            let center = DVec3::new(far, 0.25, -far);
            grid.insert(Ball { center, radius: 1e-6 });
            grid.insert(Ball { center, radius: 1e-7 });
            assert_eq!(grid.clearance(center, 1e-7), -1e-6, "{far}");
            let mut near = Vec::new();
            grid.gather(center, 1e-7, &mut near);
            assert_eq!(near.len(), 2, "{far}");
        }
    }

    /// A large cell of the spike reached over 4e12 cells of small balls.
    #[test]
    fn issue_no_more_cells_are_looked_at_than_there_are_balls() {
        let mut grid = BallGrid::default();
        for radius in [1e-6, 1e-7] {
            grid.insert(Ball { center: DVec3::ZERO, radius });
        }
        let mut near = Vec::new();
        for far in [1.0, 1e3, 1e12] {
            assert_eq!(grid.clearance(DVec3::X * far, f64::INFINITY), far - 1e-6);
            grid.gather(DVec3::X * far, f64::INFINITY, &mut near);
            assert_eq!(near.len(), 2, "{far}");
        }
    }

    proptest! {
        #[test]
        fn finds_what_a_look_at_every_ball_finds(
            balls in prop::collection::vec((prop::array::uniform3(-1.0..1.0), 0.001_f64..0.1), 1..200),
            p in prop::array::uniform3(-1.5..1.5),
            bound in -0.05..1.0,
        ) {
            let mut balls: Vec<Ball> =
                balls.into_iter().map(|(center, radius)| Ball { center: center.into(), radius }).collect();
            balls.sort_by(|a, b| b.radius.total_cmp(&a.radius));
            let mut grid = BallGrid::default();
            balls.iter().for_each(|ball| grid.insert(*ball));
            let p = DVec3::from_array(p);
            let nearest = balls.iter().fold(bound, |nearest: f64, ball| nearest.min(ball.distance(p)));
            prop_assert_eq!(grid.clearance(p, bound), nearest);
            let mut found = Vec::new();
            grid.gather(p, bound, &mut found);
            let by_place = |a: &Ball, b: &Ball| a.center.x.total_cmp(&b.center.x);
            found.sort_by(by_place);
            balls.retain(|ball| ball.distance(p) < bound);
            balls.sort_by(by_place);
            prop_assert_eq!(found, balls);
        }
    }
}
