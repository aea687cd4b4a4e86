//! The box.

use super::grid::push_quad;
use glam::DVec3;
use packer::TriangleMesh;

/// A box about the origin with the given half extents (m), 12 triangles.
#[must_use]
pub fn cuboid(half_extents: DVec3) -> TriangleMesh {
    // Corner `i` lies on the positive side of axis `a` where bit `a` of `i` is set.
    let vertices = (0..8)
        .map(|i| half_extents * DVec3::from([0, 1, 2].map(|axis| f64::from(i >> axis & 1) * 2.0 - 1.0)))
        .collect();
    let mut mesh = TriangleMesh { vertices, triangles: Vec::with_capacity(12) };
    for axis in 0..3 {
        let (u, v, w) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3), 1 << axis);
        push_quad(&mut mesh, [0, v, u + v, u]);
        push_quad(&mut mesh, [w, w + u, w + u + v, w + v]);
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::check::{Expected, assert_solid};

    #[test]
    fn is_a_closed_box() {
        let mesh = cuboid(DVec3::new(0.1, 0.2, 0.7));
        assert_solid(&mesh, &Expected { volume: 8.0 * 0.014, tolerance: 1e-12, euler: 2 });
    }
}
