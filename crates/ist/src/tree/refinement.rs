//! Exchanging spheres between blocks that stand side by side, so that the balls around the blocks become smaller.
//!
//! Splits along planes leave blocks with a sphere that a neighbour would hold better. Most of the time of a query goes into
//! tests of blocks of leaves and of the leaves in them, whose number grows with the third power of the balls' radii.

use super::WIDTH;
use super::enclosing_ball::enclosing_ball;
use alloc::vec::Vec;
use core::ops::Range;
use glam::Vec3;

// Measured together, on rabbits of 1,000 and 10,000 spheres and gears of 1,000 in deep overlap: blocks of leaves that are
// tested per overlapping pair 0.52 / 0.49 / 0.59 without exchanges, 0.43 / 0.41 / 0.50 with these constants; leaves 1.23 /
// 1.14 / 1.51 and 1.05 / 1.00 / 1.32. To build a tree takes 2.5 times as long. To try every exchange with every block finds
// 0.43 / 0.39 / 0.48 and 1.07 / 0.97 / 1.24, and takes a hundred times as long.

/// Blocks at hand that a block exchanges with. With 4: 0.45 / 0.43 / 0.51 and 1.08 / 1.04 / 1.33.
const NEIGHBORS: usize = 8;

/// Blocks in a row among which neighbours are looked for: a subtree, so that the time of a level stays O(n). With 64 the 10,000
/// spheres have 0.43 and 1.04.
const REGION: usize = WIDTH * WIDTH * WIDTH;

/// How often every block is looked at. A third time gains 1 % of the tests, in a fifth more time.
const PASSES: usize = 2;

/// Steps for the balls of exchanges that are tried. Of 16 as good, of 4 up to 2 % more tests.
const STEPS: usize = 8;

// The three below leave out what seldom pays. Halved, as 0.05, 1.1 and 0.3, they leave 1 to 5 % more tests; as 0.2, 1.2 and 1.0
// as many, in half as much time again.

/// How far below the surface of its block's ball, in radii of it, a sphere may end whose leaving is tried: centres move when
/// the others close up.
const SURFACE: f32 = 0.1;

/// How much farther than the leaving sphere, relative to its reach, the entering one may reach.
const ENTERING: f32 = 1.2;

/// How far the leaving sphere may stand out of its new block's ball, in radii of the old.
const STANDING_OUT: f32 = 0.5;

/// Part of the cost below which a gain is rounding. Not tuned.
const ROUNDING: f32 = 1e-4;

type Ball = (Vec3, f32);

/// Exchanges elements of `order`, positions in `balls`, between its blocks of eight where that makes the balls around both
/// smaller on the whole; then whole blocks between blocks of blocks, and so on. Takes O(n log n) time.
pub(super) fn refine(order: &mut [u32], balls: &[Ball]) {
    let mut span = 1;
    while span * WIDTH < order.len() {
        refine_level(order, span, balls);
        span *= WIDTH;
    }
}

/// Exchanges runs of `span` elements, where one begins at every multiple of `span`. A shorter one at the end stays there.
fn refine_level(order: &mut [u32], span: usize, balls: &[Ball]) {
    let old = order.to_vec();
    let runs: Vec<Ball> = old.chunks_exact(span).map(|run| bound(run, balls)).collect();
    let mut numbers: Vec<u32> = (0..runs.len() as u32).collect();
    for region in numbers.chunks_mut(REGION * WIDTH) {
        let bounds = region.chunks(WIDTH).map(|block| bound(block, &runs)).collect();
        Region { order: region, balls: &runs, bounds }.refine();
    }
    for (run, number) in order.chunks_exact_mut(span).zip(numbers) {
        run.copy_from_slice(&old[number as usize * span..][..span]);
    }
}

/// A run of blocks.
struct Region<'a> {
    order: &'a mut [u32],
    balls: &'a [Ball],
    /// The balls around the blocks.
    bounds: Vec<Ball>,
}

impl Region<'_> {
    fn refine(mut self) {
        let mut neighbors = Vec::new();
        for _ in 0..PASSES {
            let mut changed = false;
            for block in 0..self.bounds.len() {
                self.find_neighbors(block, &mut neighbors);
                for leaving in self.range(block) {
                    for &(_, neighbor) in &neighbors {
                        for entering in self.range(neighbor) {
                            changed |=
                                self.promises([leaving, entering]) && self.exchange([leaving, entering]);
                        }
                    }
                }
            }
            if !changed {
                break;
            }
        }
    }

    /// Where the elements of `block` stand.
    fn range(&self, block: usize) -> Range<usize> {
        block * WIDTH..((block + 1) * WIDTH).min(self.order.len())
    }

    /// The blocks next to `block`, by the distance of its centre from their surfaces.
    fn find_neighbors(&self, block: usize, neighbors: &mut Vec<(f32, usize)>) {
        let center = self.bounds[block].0;
        let others = self.bounds.iter().enumerate().filter(|&(other, _)| other != block);
        neighbors.clear();
        neighbors.extend(others.map(|(other, bound)| (bound.0.distance(center) - bound.1, other)));
        // Ties broken by number, so that the order does not depend on how the selection works inside.
        let nearer = |a: &(f32, usize), b: &(f32, usize)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        if neighbors.len() > NEIGHBORS {
            neighbors.select_nth_unstable_by(NEIGHBORS, nearer);
            neighbors.truncate(NEIGHBORS);
        }
        neighbors.sort_unstable_by(nearer);
    }

    /// How far the element at `place` reaches from the centre of the ball around `block`.
    fn reach(&self, block: usize, place: usize) -> f32 {
        let (center, radius) = self.balls[self.order[place] as usize];
        self.bounds[block].0.distance(center) + radius
    }

    /// Whether an exchange may make the block of `leaving` smaller without making the other much larger.
    fn promises(&self, [leaving, entering]: [usize; 2]) -> bool {
        let [from, to] = [leaving, entering].map(|place| place / WIDTH);
        let [from_radius, to_radius] = [from, to].map(|block| self.bounds[block].1);
        let reach = self.reach(from, leaving);
        reach >= from_radius * (1.0 - SURFACE)
            && self.reach(from, entering) < reach * ENTERING
            && self.reach(to, leaving) < to_radius + STANDING_OUT * from_radius
    }

    /// Exchanges the elements at two places if that pays, and says whether it did.
    fn exchange(&mut self, places: [usize; 2]) -> bool {
        let blocks = places.map(|place| place / WIDTH);
        let cost = |bounds: [Ball; 2]| bounds.iter().map(|bound| bound.1 * bound.1).sum::<f32>();
        let before = cost(blocks.map(|block| self.bounds[block]));
        self.order.swap(places[0], places[1]);
        let bounds = blocks.map(|block| bound(&self.order[self.range(block)], self.balls));
        let pays = cost(bounds) < before * (1.0 - ROUNDING);
        if pays {
            for (block, bound) in blocks.into_iter().zip(bounds) {
                self.bounds[block] = bound;
            }
        } else {
            self.order.swap(places[0], places[1]);
        }
        pays
    }
}

fn bound(block: &[u32], balls: &[Ball]) -> Ball {
    enclosing_ball(block.iter().map(|&i| balls[i as usize]), STEPS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Σ radius² of the balls around runs of `span`.
    fn cost(order: &[u32], span: usize, balls: &[Ball]) -> f32 {
        order
            .chunks(span)
            .map(|run| enclosing_ball(run.iter().map(|&i| balls[i as usize]), 64).1.powi(2))
            .sum()
    }

    proptest! {
        #[test]
        fn blocks_become_smaller(
            balls in prop::collection::vec((prop::array::uniform3(-1.0_f32..1.0).prop_map(Vec3::from), 1e-3_f32..0.3), 1..600),
        ) {
            let before: Vec<u32> = (0..balls.len() as u32).collect();
            let mut after = before.clone();
            refine(&mut after, &balls);
            // Balls of exchanges are a little larger than those that are compared here.
            prop_assert!(cost(&after, WIDTH, &balls) <= cost(&before, WIDTH, &balls) * 1.02);
            let mut sorted = after;
            sorted.sort_unstable();
            prop_assert_eq!(sorted, before);
        }
    }

    #[test]
    fn a_stray_sphere_returns() {
        let row = |at: f32| (0..8).map(move |i| (Vec3::new(at + 0.1 * i as f32, 0.0, 0.0), 0.05));
        let balls: Vec<Ball> = row(0.0).chain(row(10.0)).collect();
        let mut order: Vec<u32> = (0..16).collect();
        order.swap(3, 12);
        refine(&mut order, &balls);
        assert!(order[..8].iter().all(|&i| i < 8), "{order:?}");
    }

    #[test]
    fn whole_blocks_move_and_a_shorter_one_stays_last() {
        let center = |i: usize| Vec3::splat((i / WIDTH * 11 % 18) as f32);
        let balls: Vec<Ball> = (0..137).map(|i| (center(i), 1.0)).collect();
        let before: Vec<u32> = (0..137).collect();
        let mut after = before.clone();
        refine_level(&mut after, WIDTH, &balls);
        assert!(cost(&after, WIDTH * WIDTH, &balls) < 0.7 * cost(&before, WIDTH * WIDTH, &balls));
        assert_eq!(after[136], 136);
        let blocks = after.as_chunks::<WIDTH>().0;
        assert!(blocks.iter().all(|block| block[0] % 8 == 0 && block.is_sorted()), "{after:?}");
    }
}
