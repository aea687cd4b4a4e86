//! Triangles whose boxes meet that of a given one: candidates for intersection.

use super::{Bounds, Bvh, Leaf, WIDTH, Wide};
use glam::{DVec3, Vec3, Vec4};

impl Bvh {
    /// Calls `visit` with the index and the corners of every triangle whose bounding box is `within` (m) or less of that of
    /// `corners`, along each axis.
    pub(crate) fn for_each_near(
        &self,
        corners: &[DVec3; 3],
        within: f64,
        mut visit: impl FnMut(u32, &[DVec3; 3]),
    ) {
        let Bounds { lower, upper } = Leaf { corners: *corners, index: 0 }.bounds();
        let bounds = Bounds { lower: lower - within, upper: upper + within };
        let local = self.frame.enclose(&bounds);
        let mut open = vec![0];
        while let Some(index) = open.pop() {
            let node: &Wide = &self.nodes[index];
            let meets = node.meets_box(&local);
            for slot in (0..WIDTH).filter(|slot| meets[*slot]) {
                let child = node.children[slot];
                if child.count() == 0 {
                    open.push(child.first());
                }
                for triangle in &self.triangles[child.range()] {
                    if triangle.bounds().meets(&bounds) {
                        visit(triangle.index, &triangle.corners);
                    }
                }
            }
        }
    }
}

impl Bounds {
    fn meets(&self, other: &Self) -> bool {
        self.lower.cmple(other.upper).all() && other.lower.cmple(self.upper).all()
    }
}

impl Wide {
    /// Which children's boxes meet a box in the frame of the tree; those that are missing have empty boxes.
    fn meets_box(&self, [lower, upper]: &[Vec3; 2]) -> [bool; WIDTH] {
        let mut meets = [true; WIDTH];
        for axis in 0..3 {
            let below = self.lower[axis].cmple(Vec4::splat(upper[axis]));
            let above = self.upper[axis].cmpge(Vec4::splat(lower[axis]));
            let both = below & above;
            for (slot, meets) in meets.iter_mut().enumerate() {
                *meets &= both.test(slot);
            }
        }
        meets
    }
}
