//! The order of the spheres and the balls over them.
//!
//! The tree is complete, so building it means choosing an order: spheres that stand together in a block of
//! eight should have a small common ball, and so should eight such blocks, and so on. The order comes from
//! recursive splits whose left part is always a whole number of full subtrees.

use super::enclosing_ball::enclosing_ball;
use super::{Balls, WIDTH};
use crate::InnerSphere;
use alloc::vec;
use alloc::vec::Vec;
use glam::Vec3;

/// Positions in `spheres` in the order of the tree's leaves.
pub(super) fn clustered_order(spheres: &[InnerSphere]) -> Vec<u32> {
    let keys: Vec<[f32; 3]> = spheres.iter().map(|s| s.volume_ball().0.to_array()).collect();
    let mut order: Vec<u32> = (0..spheres.len() as u32).collect();
    // Explicit stack: recursion depth would depend on the user's data.
    let mut pending = vec![(0, order.len())];
    while let Some((start, end)) = pending.pop() {
        if end - start <= WIDTH {
            continue;
        }
        let middle = start + left_part(end - start);
        let part = &mut order[start..end];
        let axis = longest_axis(part.iter().map(|&i| keys[i as usize]));
        // Ties broken by index: the order must not depend on how the selection works inside.
        part.select_nth_unstable_by(middle - start, |&a, &b| {
            keys[a as usize][axis].total_cmp(&keys[b as usize][axis]).then(a.cmp(&b))
        });
        pending.push((start, middle));
        pending.push((middle, end));
    }
    order
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

/// The axis along which the points spread most.
fn longest_axis(points: impl Iterator<Item = [f32; 3]>) -> usize {
    let (mut lower, mut upper) = (Vec3::splat(f32::INFINITY), Vec3::splat(f32::NEG_INFINITY));
    for point in points {
        lower = lower.min(point.into());
        upper = upper.max(point.into());
    }
    (upper - lower).max_position()
}

/// All levels over `spheres`, from the volume balls up to the single ball around everything.
pub(super) fn wrapped_levels<'a>(spheres: impl Iterator<Item = &'a InnerSphere>) -> Vec<Balls> {
    let leaves = Balls::new(spheres.map(InnerSphere::volume_ball));
    let count = leaves.len();
    let mut levels = vec![leaves];
    let mut span = 1;
    while levels[levels.len() - 1].len() > 1 {
        span *= WIDTH;
        let leaves = &levels[0];
        let level = Balls::new((0..count.div_ceil(span)).map(|node| {
            enclosing_ball((node * span..((node + 1) * span).min(count)).map(|leaf| leaves.get(leaf)))
        }));
        levels.push(level);
    }
    levels
}
