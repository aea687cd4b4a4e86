//! The order of the spheres and the balls over them.
//!
//! The tree is complete, so building it means choosing an order: spheres that stand together in a block of
//! eight should have a small common ball, and so should eight such blocks, and so on. The order comes from
//! recursive splits whose left part is always a whole number of full subtrees, and from exchanges between the blocks
//! of leaves, see [`refinement`](super::refinement).

use super::enclosing_ball::enclosing_ball;
use super::refinement::refine;
use super::{Balls, WIDTH};
use crate::InnerSphere;
use alloc::vec;
use alloc::vec::Vec;
use glam::Vec3;

/// Directions along which spheres are split: axes, and diagonals of faces and of the cube.
///
/// Time of deep queries, two rabbits and two gears of 1,000 spheres: 20.1 and 20.6 ns per pair with splits along the longest
/// axis, 18.5 and 19.7 with the best of the three axes, 17.9 and 18.6 with the best of these thirteen. The radius as a
/// fourth axis gained nothing.
const DIRECTIONS: [Vec3; 13] = [
    Vec3::X,
    Vec3::Y,
    Vec3::Z,
    Vec3::new(1.0, 1.0, 0.0),
    Vec3::new(1.0, -1.0, 0.0),
    Vec3::new(1.0, 0.0, 1.0),
    Vec3::new(1.0, 0.0, -1.0),
    Vec3::new(0.0, 1.0, 1.0),
    Vec3::new(0.0, 1.0, -1.0),
    Vec3::new(1.0, 1.0, 1.0),
    Vec3::new(1.0, 1.0, -1.0),
    Vec3::new(1.0, -1.0, 1.0),
    Vec3::new(-1.0, 1.0, 1.0),
];

/// Steps for the balls of nodes. With 5,000 there are 0.3 % fewer tests of leaves.
const STEPS: usize = 64;

/// Positions in `balls` in the order of the tree's leaves.
pub(super) fn clustered_order(balls: &[(Vec3, f32)]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..balls.len() as u32).collect();
    // Explicit stack: recursion depth would depend on the user's data.
    let mut pending = vec![(0, order.len())];
    while let Some((start, end)) = pending.pop() {
        if end - start <= WIDTH {
            continue;
        }
        let left = left_part(end - start);
        let part = &mut order[start..end];
        let (mut least, mut best) = (f32::INFINITY, DIRECTIONS[0]);
        for direction in DIRECTIONS {
            split(part, left, balls, direction);
            let (lower, upper) = part.split_at(left);
            let cost = weighted_size(lower, balls) + weighted_size(upper, balls);
            if cost < least {
                (least, best) = (cost, direction);
            }
        }
        split(part, left, balls, best);
        pending.push((start, start + left));
        pending.push((start + left, end));
    }
    refine(&mut order, balls);
    order
}

/// Moves the `left` balls that come first along `direction` to the front of `part`.
fn split(part: &mut [u32], left: usize, balls: &[(Vec3, f32)], direction: Vec3) {
    let along = |i: u32| balls[i as usize].0.dot(direction);
    // Ties broken by index: which balls come first must not depend on how the selection works inside.
    part.select_nth_unstable_by(left, |&a, &b| along(a).total_cmp(&along(b)).then(a.cmp(&b)));
}

/// Number of the balls of `part` times the diagonal of the box around them.
fn weighted_size(part: &[u32], balls: &[(Vec3, f32)]) -> f32 {
    let empty = (Vec3::splat(f32::INFINITY), Vec3::splat(f32::NEG_INFINITY));
    let (lower, upper) = part.iter().fold(empty, |(lower, upper), &i| {
        let (center, radius) = balls[i as usize];
        (lower.min(center - radius), upper.max(center + radius))
    });
    part.len() as f32 * lower.distance(upper)
}

/// How many of `count` spheres go into the left part: half of the subtrees, each a full one.
fn left_part(count: usize) -> usize {
    let mut subtree = WIDTH;
    while subtree * WIDTH < count {
        subtree *= WIDTH;
    }
    let subtrees = count.div_ceil(subtree);
    (subtrees / 2) * subtree
}

/// The power of two (m) next below the distance to which `spheres` reach from the origin: the unit in which their lengths
/// are stored.
///
/// Lenses take fourth powers of lengths in f32. In metres, centroids of bodies of 1e-10 m were off by 0.1 % of the body, of
/// bodies of 1e-12 m by a third, and from 1e10 m on they were NaN. By powers of two no number loses a digit.
pub(super) fn unit(spheres: &[InnerSphere]) -> f32 {
    let size = spheres.iter().map(InnerSphere::volume_ball).fold(0.0, |size, (center, radius)| {
        f64::max(size, f64::from(center.abs().max_element()) + f64::from(radius))
    });
    // The biased exponent of an f64 gives ⌊log₂⌋; a power of two of f32 has its own in the same place.
    let exponent = ((size.to_bits() >> 52) as i32 - 1023).clamp(-126, 127);
    f32::from_bits(((exponent + 127) as u32) << 23)
}

/// All levels over the volume balls `leaves`, up to the single ball around everything.
pub(super) fn wrapped_levels(leaves: impl Iterator<Item = (Vec3, f32)>) -> Vec<Balls> {
    let leaves = Balls::new(leaves);
    let count = leaves.len();
    let mut levels = vec![leaves];
    let mut span = 1;
    while levels[levels.len() - 1].len() > 1 {
        span *= WIDTH;
        let leaves = &levels[0];
        let level = Balls::new((0..count.div_ceil(span)).map(|node| {
            let below = node * span..((node + 1) * span).min(count);
            enclosing_ball(below.map(|leaf| leaves.get(leaf)), STEPS)
        }));
        levels.push(level);
    }
    levels
}
