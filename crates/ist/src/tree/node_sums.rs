//! What a node knows about the spheres below it: sums from which bounds and expected values of overlaps follow
//! before its spheres are looked at.

use super::covering_depth::covering_depths;
use super::{Balls, Leaf, WIDTH};
use alloc::vec::Vec;
use core::f32::consts::PI;
use glam::{DVec3, Vec3};

/// Skins for which depths are known, in units of the median volume radius. Between two of them the larger is used.
/// A pair of the pile example's bodies, of 1,000 spheres, has a skin of 0.7 of it.
const SKINS: [f32; 2] = [0.0, 0.75];

/// Sums over the volume balls below one node, or one volume ball's own.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct NodeSum {
    /// Number of balls.
    count: f32,
    /// Σ ρ, Σ ρ² and Σ ρ³ of their radii: the sum of their volumes under any skin is a polynomial of these.
    radii: [f32; 3],
    /// Mean of the outward normals, weighted by volume.
    pub(crate) normal: Vec3,
    /// For each of [`SKINS`], how many balls of the whole tree cover a point of one of these balls at most.
    depth: [f32; SKINS.len()],
}

/// The sums of all nodes of a tree.
#[derive(Debug)]
pub(crate) struct NodeSums {
    /// Of levels 1 and above.
    levels: Vec<Vec<NodeSum>>,
    /// [`SKINS`] in the tree's units.
    skins: [f32; SKINS.len()],
    /// The least volume radius.
    least_radius: f32,
    /// Number of leaves.
    count: f32,
}

/// Which of the known depths holds for a tree under its skin.
#[derive(Clone, Copy, Debug)]
pub(crate) enum DepthAt {
    /// The one with this number.
    Skin(usize),
    /// None: only the number of balls is known.
    Unknown,
}

impl NodeSum {
    /// Sum of the volumes of the balls when they are `scale` times as large and under a skin of `skin`.
    pub(crate) fn volume(&self, scale: f32, skin: f32) -> f32 {
        // 4/3 π Σ (kρ + s)³.
        let [one, two, three] = self.radii;
        let (one, two, three) = (one * scale, two * scale * scale, three * scale * scale * scale);
        4.0 / 3.0 * PI * (three + skin * (3.0 * two + skin * (3.0 * one + skin * self.count)))
    }
}

impl NodeSums {
    /// Of the tree with these levels and leaves.
    pub(super) fn new(levels: &[Balls], leaves: &[Leaf]) -> Self {
        let count = leaves.len();
        let radius = |leaf: usize| levels[0].get(leaf).1;
        let mut radii: Vec<f32> = (0..count).map(radius).collect();
        let (_, median, _) = radii.select_nth_unstable_by(count / 2, f32::total_cmp);
        let skins = SKINS.map(|skin| skin * *median);
        let mut depths = skins.map(|skin| covering_depths(levels, skin));
        let mut sums = Vec::new();
        let mut span = 1;
        for level in &levels[1..] {
            span *= WIDTH;
            sums.push(
                (0..level.len())
                    .map(|node| {
                        let below = node * span..((node + 1) * span).min(count);
                        let depth = |skin: usize| depths[skin][node] as f32;
                        let depth = core::array::from_fn(depth);
                        NodeSum { depth, ..sum_of(below.map(|leaf| (radius(leaf), leaves[leaf].normal()))) }
                    })
                    .collect(),
            );
            for depths in &mut depths {
                *depths =
                    depths.chunks(WIDTH).map(|block| block.iter().copied().max().unwrap_or(1)).collect();
            }
        }
        let least_radius = (0..count).map(radius).fold(f32::INFINITY, f32::min);
        Self { levels: sums, skins, least_radius, count: count as f32 }
    }

    /// Which depth holds under a skin of `skin`, in the tree's own units.
    pub(crate) fn depth_at(&self, skin: f32) -> DepthAt {
        self.skins.iter().position(|known| skin <= *known).map_or(DepthAt::Unknown, DepthAt::Skin)
    }

    /// The least radius of a volume ball.
    pub(crate) fn least_radius(&self) -> f32 {
        self.least_radius
    }

    /// The sums of node `index` of `level`, which for a leaf are those of the ball of radius `radius` with normal
    /// `normal`.
    #[inline(always)]
    pub(crate) fn get(&self, level: usize, index: usize, leaf: impl FnOnce() -> (f32, Vec3)) -> NodeSum {
        if level > 0 {
            return self.levels[level - 1][index];
        }
        let (radius, normal) = leaf();
        let depth = self.levels.first().map_or([1.0; SKINS.len()], |blocks| blocks[index / WIDTH].depth);
        NodeSum { count: 1.0, radii: [radius, radius * radius, radius * radius * radius], normal, depth }
    }

    /// How many balls of the whole tree cover a point of a ball below `node` at most.
    #[inline(always)]
    pub(crate) fn depth(&self, node: &NodeSum, at: DepthAt) -> f32 {
        match at {
            DepthAt::Skin(skin) => node.depth[skin],
            DepthAt::Unknown => self.count,
        }
    }
}

/// Sums over balls with these radii and normals, without their depth.
fn sum_of(balls: impl Iterator<Item = (f32, Vec3)>) -> NodeSum {
    let (mut count, mut sums, mut normal) = (0.0, [0.0; 3], DVec3::ZERO);
    for (radius, outward) in balls {
        let radius = f64::from(radius);
        let cube = radius * radius * radius;
        count += 1.0;
        for (sum, power) in sums.iter_mut().zip([radius, radius * radius, cube]) {
            *sum += power;
        }
        normal += cube * outward.as_dvec3();
    }
    let normal = (normal / sums[2].max(f64::MIN_POSITIVE)).as_vec3();
    NodeSum { count, radii: sums.map(|sum| sum as f32), normal, depth: [0.0; SKINS.len()] }
}

#[cfg(test)]
mod tests {
    use crate::InnerSphereTree;
    use crate::tree::tests::random_packing;
    use crate::tree::{DepthAt, WIDTH};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn sums_are_those_of_the_spheres_below(
            packing in random_packing(300), scale in 0.1_f32..10.0, skin in 0.0_f32..0.5,
        ) {
            let tree = InnerSphereTree::new(&packing);
            let data = tree.data();
            for level in 1..data.levels.len() {
                let span = WIDTH.pow(level as u32);
                for node in 0..data.levels[level].len() {
                    let sum = data.sums().get(level, node, || unreachable!());
                    let below = node * span..((node + 1) * span).min(tree.len());
                    let volume: f64 = below
                        .map(|leaf| {
                            let radius = f64::from(data.levels[0].get(leaf).1 * scale + skin);
                            4.0 / 3.0 * core::f64::consts::PI * radius * radius * radius
                        })
                        .sum();
                    prop_assert!((f64::from(sum.volume(scale, skin)) / volume - 1.0).abs() < 2e-6);
                }
            }
        }

        #[test]
        fn no_point_is_covered_more_often_than_the_depth_tells(
            packing in random_packing(500), share in 0.0_f32..1.0, places in prop::collection::vec(prop::array::uniform3(-0.6_f32..0.6), 8),
        ) {
            let tree = InnerSphereTree::new(&packing);
            let data = tree.data();
            let skin = share * data.sums().skins[1];
            let DepthAt::Skin(_) = data.sums().depth_at(skin) else { panic!("a skin that is known") };
            for leaf in 0..tree.len() {
                let (center, radius) = data.levels[0].get(leaf);
                for place in &places {
                    let point = center + (radius + skin) * glam::Vec3::from_array(*place).clamp_length_max(1.0);
                    let over = (0..tree.len()).filter(|i| {
                        let (c, r) = data.levels[0].get(*i);
                        c.distance(point) < r + skin
                    });
                    let covering = over.count() as f32;
                    for level in 0..data.levels.len() {
                        let node = data.sums().get(level, leaf / WIDTH.pow(level as u32), || (radius, glam::Vec3::X));
                        prop_assert!(covering <= data.sums().depth(&node, data.sums().depth_at(skin)));
                    }
                }
            }
        }
    }
}
