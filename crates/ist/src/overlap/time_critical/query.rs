//! What does not change during one time-critical query.

use super::super::relative_pose::RelativePose;
use crate::tree::{DEPTH_TOLERANCE, DepthAt, NodeSum, NodeSums, TreeData};
use glam::Vec3;

/// Two trees at a pose, in A's unscaled frame.
pub(super) struct Query<'a> {
    pub(super) a: Side<'a>,
    pub(super) b: Side<'a>,
    pub(super) pose: &'a RelativePose,
    /// How far rounding moves a centre of B at most (m).
    pub(super) rounding: f32,
    /// By how much the balls of B's nodes are enlarged, so that they meet what spheres below them meet, and their lenses bound
    /// those of the spheres: centres that coincide are held 1e-6 of the sum of the radii apart by the lens.
    pub(super) enlargement: f32,
    /// Overlap volume (m³) that sums over nodes may lack or have too much of, because volumes of spheres vanish in f32.
    pub(super) vanishing: f64,
}

/// One of the trees.
pub(super) struct Side<'a> {
    pub(super) tree: &'a TreeData,
    sums: &'a NodeSums,
    scale: f32,
    pub(super) skin: f32,
    depth: DepthAt,
}

impl<'a> Query<'a> {
    pub(super) fn new((a, b): (&'a TreeData, &'a TreeData), pose: &'a RelativePose) -> Self {
        let (sums_a, sums_b) = (a.sums(), b.sums());
        let rounding = pose.rounding((a, b));
        // Depths hold for balls that are moved by less than their tolerance.
        let least = sums_b.least_radius() * pose.scale + pose.skin_b;
        let depth_b = if rounding < DEPTH_TOLERANCE * least {
            sums_b.depth_at(pose.skin_b / pose.scale)
        } else {
            DepthAt::Unknown
        };
        Self {
            a: Side {
                tree: a,
                sums: sums_a,
                scale: 1.0,
                skin: pose.skin_a,
                depth: sums_a.depth_at(pose.skin_a),
            },
            b: Side { tree: b, sums: sums_b, scale: pose.scale, skin: pose.skin_b, depth: depth_b },
            pose,
            rounding,
            enlargement: pose.enlargement((a, b)),
            vanishing: vanishing_volume(a, b, pose.scale),
        }
    }
}

/// Every pair's volume may be less than f32 holds in the unit of either tree; that of B is `scale` of A's.
fn vanishing_volume(a: &TreeData, b: &TreeData, scale: f32) -> f64 {
    let pairs = a.levels[0].len() as f64 * b.levels[0].len() as f64;
    let scale = f64::from(scale);
    pairs * f64::from(f32::MIN_POSITIVE) * (scale * scale * scale).max(1.0)
}

/// What bounds and expected values need to know about a node.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NodeFigures {
    /// Sum of the volumes of the volume balls below.
    pub(super) volume: f32,
    /// How many balls of the whole tree cover a point of one of them at most.
    pub(super) depth: f32,
    /// Mean outward normal, in the tree's own frame.
    pub(super) normal: Vec3,
}

impl Side<'_> {
    #[inline(always)]
    pub(super) fn figures(&self, level: usize, index: usize) -> NodeFigures {
        let leaf = || (self.tree.levels[0].get(index).1, self.tree.leaves[index].normal());
        let node: NodeSum = self.sums.get(level, index, leaf);
        NodeFigures {
            volume: node.volume(self.scale, self.skin),
            depth: self.sums.depth(&node, self.depth),
            normal: node.normal,
        }
    }
}

/// How many leaves a node of `level` has at most.
pub(super) fn leaves_below(level: usize) -> f32 {
    (1_u64 << (3 * level).min(63)) as f32
}
