//! The sphere.

use glam::DVec3;
use packer::TriangleMesh;
use std::collections::HashMap;

/// A sphere of radius `radius` (m) about the origin: an icosahedron, each triangle split in four `subdivisions`
/// times (at most 7), vertices on the sphere. It has 20·4ⁿ triangles.
#[must_use]
pub fn sphere(radius: f64, subdivisions: u32) -> TriangleMesh {
    let mut mesh = icosahedron();
    for _ in 0..subdivisions.min(7) {
        subdivide(&mut mesh);
    }
    for vertex in &mut mesh.vertices {
        *vertex *= radius;
    }
    mesh
}

/// The icosahedron on the unit sphere.
fn icosahedron() -> TriangleMesh {
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let mut vertices = Vec::with_capacity(12);
    for (a, b) in [(-1.0, -golden), (-1.0, golden), (1.0, -golden), (1.0, golden)] {
        vertices.extend([DVec3::new(0.0, a, b), DVec3::new(a, b, 0.0), DVec3::new(b, 0.0, a)]);
    }
    // Every triple of mutual neighbours (distance 2 between the corners above) is a face.
    let near = |i: usize, j: usize| vertices[i].distance_squared(vertices[j]) < 4.5;
    let mut triangles = Vec::with_capacity(20);
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                if near(i, j) && near(j, k) && near(k, i) {
                    let outwards = vertices[i].dot(vertices[j].cross(vertices[k])) > 0.0;
                    let [i, j, k] = [i as u32, j as u32, k as u32];
                    triangles.push(if outwards { [i, j, k] } else { [i, k, j] });
                }
            }
        }
    }
    vertices.iter_mut().for_each(|v| *v = v.normalize());
    TriangleMesh { vertices, triangles }
}

/// Splits each triangle in four at the middles of its edges, pushed out onto the unit sphere.
fn subdivide(mesh: &mut TriangleMesh) {
    let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
    let vertices = &mut mesh.vertices;
    let mut middle = |a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            vertices.push((vertices[a as usize] + vertices[b as usize]).normalize());
            vertices.len() as u32 - 1
        })
    };
    mesh.triangles = mesh
        .triangles
        .iter()
        .flat_map(|&[a, b, c]| {
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        })
        .collect();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::check::{Expected, assert_solid};
    use std::f64::consts::PI;

    #[test]
    fn is_a_closed_sphere() {
        for (subdivisions, tolerance) in [(0, 0.4), (2, 0.04), (4, 3e-3)] {
            let mesh = sphere(0.3, subdivisions);
            assert_eq!(mesh.triangles.len(), 20 << (2 * subdivisions));
            let volume = 4.0 / 3.0 * PI * 0.3_f64.powi(3);
            assert_solid(&mesh, &Expected { volume, tolerance, euler: 2 });
        }
    }
}
