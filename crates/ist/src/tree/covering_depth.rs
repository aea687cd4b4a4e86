//! How many volume balls of one tree cover a point, at most.
//!
//! Volume balls overlap a little, so the volume that a tree shares with anything is not that of its union. The
//! greatest number of balls over one point bounds the difference. It is found by halving cubes: the balls that
//! reach into a cube bound the depth inside it from above, the balls over its centre the greatest depth from
//! below, and only cubes whose bound is above the greatest depth known are looked at more closely. No point of
//! intersection of spheres is ever computed, so nothing can be ill-conditioned.

use super::{Balls, WIDTH};
use crate::simd_level::simd_level;
use alloc::vec;
use alloc::vec::Vec;
use fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use glam::{DVec3, Vec3};

/// Radii grow by this share before they are counted, so that the depth also holds for balls that rounding has
/// moved by so much.
pub(crate) const TOLERANCE: f32 = 3e-3;

/// Half the side of the smallest cubes, in radii of the ball. With 1/8, 1/16 and 1/32 the mean depth of the blocks of
/// eight of a rabbit of 10,000 spheres is 4.4, 3.7 and 3.3 and the greatest 7, 5 and 5, found in 9, 13 and 22 ms.
const FINEST: f32 = 0.0625;

/// Cubes per ball, after which their bounds stand as they are. Not tuned; packings need at most some hundred.
const CUBES: usize = 4096;

/// Neighbours of a ball that are looked at; balls with more are crowded.
const NEIGHBORS: usize = 64;

/// Balls near a block of eight that are looked at; blocks with more, as where all balls are equal, are crowded.
const NEARBY: usize = 2048;

/// A ball, already enlarged.
#[derive(Clone, Copy)]
struct Ball {
    center: DVec3,
    radius: f64,
}

impl Ball {
    fn of(level: &Balls, index: usize, skin: f32) -> Self {
        let (center, radius) = level.get(index);
        let radius = (f64::from(radius) + f64::from(skin)) * (1.0 + f64::from(TOLERANCE));
        Self { center: center.as_dvec3(), radius }
    }

    fn meets(&self, other: &Self) -> bool {
        let reach = self.radius + other.radius;
        self.center.distance_squared(other.center) <= reach * reach
    }
}

/// For every block of eight leaves, a number that no point inside one of its leaves is covered more often than, by
/// all leaves of the tree under a skin of `skin`. Empty for a tree of one sphere.
///
/// Time is linear in the leaves times their neighbours, of which no more than fixed numbers are looked at.
pub(super) fn covering_depths(levels: &[Balls], skin: f32) -> Vec<u32> {
    dispatch!(simd_level(), simd => block_depths(simd, levels, skin))
}

#[inline(always)]
fn block_depths<S: Simd>(simd: S, levels: &[Balls], skin: f32) -> Vec<u32> {
    let leaves = &levels[0];
    let Some(blocks) = levels.get(1) else { return Vec::new() };
    let mut depths = vec![0; blocks.len()];
    let mut crowded: Vec<Ball> = Vec::new();
    let mut crowded_blocks = Vec::new();
    let (mut nearby, mut near) = (Vec::new(), Vec::new());
    for (block, depth) in depths.iter_mut().enumerate() {
        let all_found = leaves_near(levels, &Ball::of(blocks, block, skin), skin, &mut nearby);
        let known = crowded.len();
        for leaf in block * WIDTH..((block + 1) * WIDTH).min(leaves.len()) {
            let ball = Ball::of(leaves, leaf, skin);
            near.clear();
            near.extend(nearby.iter().filter(|(i, other)| *i != leaf && ball.meets(other)).map(|(_, b)| *b));
            if all_found && near.len() <= NEIGHBORS {
                *depth = depth_inside(simd, &ball, &near, *depth);
            } else {
                crowded.push(ball);
            }
        }
        if crowded.len() > known {
            crowded_blocks.push(block);
        }
    }
    // A point under an uncrowded ball is covered as often as that ball's depth tells; any other point only by
    // crowded ones.
    let uncrowded = depths.iter().copied().max().unwrap_or(0);
    let depth = uncrowded.max(depth_among(simd, &crowded));
    for block in crowded_blocks {
        depths[block] = depth;
    }
    depths
}

/// Collects the leaves that meet `ball`; false if there are too many.
fn leaves_near(levels: &[Balls], ball: &Ball, skin: f32, found: &mut Vec<(usize, Ball)>) -> bool {
    found.clear();
    let top = levels.len() - 1;
    let mut pending = vec![(top, 0)];
    while let Some((level, node)) = pending.pop() {
        let other = Ball::of(&levels[level], node, skin);
        if !ball.meets(&other) {
            continue;
        }
        if level > 0 {
            let end = ((node + 1) * WIDTH).min(levels[level - 1].len());
            pending.extend((node * WIDTH..end).map(|child| (level - 1, child)));
        } else if found.len() == NEARBY {
            return false;
        } else {
            found.push((node, other));
        }
    }
    true
}

/// The greatest depth of `balls` alone: large ones among many small ones.
#[inline(always)]
fn depth_among<S: Simd>(simd: S, balls: &[Ball]) -> u32 {
    let all = balls.len() as u32;
    if balls.len() > NEARBY {
        return all;
    }
    let mut depth = 0;
    let mut near = Vec::new();
    for (index, ball) in balls.iter().enumerate() {
        near.clear();
        near.extend(balls.iter().enumerate().filter(|(i, b)| *i != index && ball.meets(b)).map(|(_, b)| *b));
        if near.len() > NEIGHBORS {
            return all;
        }
        depth = depth_inside(simd, ball, &near, depth);
    }
    depth
}

/// The greatest depth inside `ball`, whose at most [`NEIGHBORS`] neighbours are `near`, or `known` if that is more.
#[inline(always)]
fn depth_inside<S: Simd>(simd: S, ball: &Ball, near: &[Ball], known: u32) -> u32 {
    let near = Near::new(ball, near);
    let radius = ball.radius as f32;
    let mut deepest = known.max(1);
    let mut pending = vec![(Vec3::ZERO, radius)];
    let mut cubes = 0;
    while let Some((center, half)) = pending.pop() {
        cubes += 1;
        // Half the diagonal, rounded up.
        let around = half * 1.74;
        let from_center = center.length_squared();
        if from_center > (radius + around) * (radius + around) {
            continue;
        }
        let (reaching, over_center) = near.count(simd, center, around);
        if from_center <= radius * radius {
            deepest = deepest.max(1 + over_center);
        }
        let bound = 1 + reaching;
        if bound <= deepest {
            continue;
        }
        if half <= FINEST * radius || cubes >= CUBES {
            deepest = bound;
            continue;
        }
        let quarter = 0.5 * half;
        for corner in 0..8 {
            let sign = |axis: i32| if corner >> axis & 1 == 0 { -quarter } else { quarter };
            pending.push((center + Vec3::new(sign(0), sign(1), sign(2)), quarter));
        }
    }
    deepest
}

/// Neighbours of a ball, in struct-of-arrays order, about the ball's centre. Rounding to f32 is far below
/// [`TOLERANCE`].
struct Near {
    x: [f32; NEIGHBORS],
    y: [f32; NEIGHBORS],
    z: [f32; NEIGHBORS],
    /// Padded with balls that nothing is inside of or near to.
    radius: [f32; NEIGHBORS],
    blocks: usize,
}

impl Near {
    fn new(ball: &Ball, balls: &[Ball]) -> Self {
        let zero = [0.0; NEIGHBORS];
        let radius = [f32::NEG_INFINITY; NEIGHBORS];
        let blocks = balls.len().div_ceil(WIDTH);
        let mut near = Self { x: zero, y: zero, z: zero, radius, blocks };
        for (i, other) in balls.iter().enumerate() {
            let center = (other.center - ball.center).as_vec3();
            (near.x[i], near.y[i], near.z[i]) = center.into();
            near.radius[i] = other.radius as f32;
        }
        near
    }

    /// How many balls come closer to `point` than `around`, and how many `point` is in.
    #[inline(always)]
    fn count<S: Simd>(&self, simd: S, point: Vec3, around: f32) -> (u32, u32) {
        let (mut reaching, mut over) = (0, 0);
        for first in (0..self.blocks * WIDTH).step_by(WIDTH) {
            let block = first..first + WIDTH;
            let dx = f32x8::from_slice(simd, &self.x[block.clone()]) - point.x;
            let dy = f32x8::from_slice(simd, &self.y[block.clone()]) - point.y;
            let dz = f32x8::from_slice(simd, &self.z[block.clone()]) - point.z;
            let distance = (dx * dx + dy * dy + dz * dz).sqrt();
            let gap = distance - f32x8::from_slice(simd, &self.radius[block]);
            reaching += gap.simd_le(around).to_bitmask().count_ones();
            over += gap.simd_le(0.0).to_bitmask().count_ones();
        }
        (reaching, over)
    }
}
