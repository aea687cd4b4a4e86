//! Balls in blocks of eight, padded so that SIMD code may always load whole blocks.

use super::WIDTH;
use alloc::vec::Vec;
use glam::Vec3;

/// Coordinate of the padding: so far away that no test against it succeeds, and its square is still no NaN.
const FAR: f32 = 1e30;

/// Eight balls, struct-of-arrays in two cache lines: a block is loaded by vectors and read by single balls, and
/// either way all that belongs together lies together.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct BallBlock {
    pub(crate) x: [f32; WIDTH],
    pub(crate) y: [f32; WIDTH],
    pub(crate) z: [f32; WIDTH],
    pub(crate) radius: [f32; WIDTH],
}

impl BallBlock {
    /// Eight points that are far from everything.
    pub(crate) const FAR: Self =
        Self { x: [FAR; WIDTH], y: [FAR; WIDTH], z: [FAR; WIDTH], radius: [0.0; WIDTH] };
}

/// A list of balls in blocks.
#[derive(Clone, Debug, Default)]
pub(crate) struct Balls {
    pub(crate) blocks: Vec<BallBlock>,
    len: usize,
}

impl Balls {
    /// Collects `balls` and pads them.
    pub(crate) fn new(balls: impl Iterator<Item = (Vec3, f32)>) -> Self {
        let mut out = Self::default();
        for (center, radius) in balls {
            let lane = out.len % WIDTH;
            if lane == 0 {
                out.blocks.push(BallBlock::FAR);
            }
            if let Some(block) = out.blocks.last_mut() {
                (block.x[lane], block.y[lane], block.z[lane]) = center.into();
                block.radius[lane] = radius;
            }
            out.len += 1;
        }
        // No ball is ever added: a tree of 10,000 spheres took 82 bytes a sphere with the room that had grown, and takes 70.
        out.blocks.shrink_to_fit();
        out
    }

    /// Number of balls without the padding.
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// Centre and radius of ball `i`.
    pub(crate) fn get(&self, i: usize) -> (Vec3, f32) {
        let (block, lane) = (&self.blocks[i / WIDTH], i % WIDTH);
        (Vec3::new(block.x[lane], block.y[lane], block.z[lane]), block.radius[lane])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_room_is_left_over() {
        for count in [1, 8, 9, 1000, 10_000] {
            let balls = Balls::new((0..count).map(|i| (Vec3::splat(i as f32), 1.0)));
            assert_eq!(balls.len(), count);
            assert_eq!(balls.blocks.len(), count.div_ceil(WIDTH));
            assert_eq!(balls.blocks.capacity(), balls.blocks.len());
        }
    }
}
