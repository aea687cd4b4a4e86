//! Three bars across each other, as one surface.

use super::grid::push_quad;
use glam::DVec3;
use packer::TriangleMesh;

/// Three bars of square section along the axes, united at the origin: 32 vertices, 60 triangles, no face inside.
///
/// `reach` is half the length of a bar and `half_width` half its thickness (m), `half_width < reach`.
#[must_use]
pub fn cross(reach: f64, half_width: f64) -> TriangleMesh {
    // The cube where the bars meet has no face of its own: an arm grows from each of its six.
    let signs = |i: u32| DVec3::from([0, 1, 2].map(|axis| f64::from(i >> axis & 1) * 2.0 - 1.0));
    let mut mesh =
        TriangleMesh { vertices: (0..8).map(|i| signs(i) * half_width).collect(), triangles: vec![] };
    for axis in 0..3 {
        let (u, v, w) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3), 1 << axis);
        for root in [[0, v, u + v, u], [w, w + u, w + u + v, w + v]] {
            push_arm(&mut mesh, root, axis, reach);
        }
    }
    mesh
}

/// Grows an arm from the cube face `root`, counter-clockwise from outside, until it reaches `reach` along `axis`.
fn push_arm(mesh: &mut TriangleMesh, root: [u32; 4], axis: usize, reach: f64) {
    let first = mesh.vertices.len() as u32;
    for corner in root {
        let mut tip = mesh.vertices[corner as usize];
        tip[axis] = reach.copysign(tip[axis]);
        mesh.vertices.push(tip);
    }
    let tip = [first, first + 1, first + 2, first + 3];
    for (i, j) in [(0, 1), (1, 2), (2, 3), (3, 0)] {
        push_quad(mesh, [root[i], root[j], tip[j], tip[i]]);
    }
    push_quad(mesh, tip);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::check::{Expected, assert_solid};

    #[test]
    fn is_one_closed_surface() {
        let mesh = cross(0.5, 0.1);
        assert_eq!((mesh.vertices.len(), mesh.triangles.len()), (32, 60));
        // The middle cube and six arms.
        let volume = 0.2_f64.powi(3) + 6.0 * 0.4 * 0.2 * 0.2;
        assert_solid(&mesh, &Expected { volume, tolerance: 1e-12, euler: 2 });
    }
}
