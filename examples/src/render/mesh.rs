//! Triangle meshes made ready for drawing.

use glam::Vec3;
use packer::TriangleMesh;

/// Faces that meet at a smaller angle share their normals and look round, others keep their edge: 40° keeps the
/// hexagon of a nut (60°) and rounds a ring of a dozen facets (30°).
const CREASE_DEGREES: f32 = 40.0;

/// Geometry to draw any number of times.
#[derive(Clone, Debug)]
pub struct Mesh {
    pub(super) positions: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Unit normals at the corners of each triangle.
    pub(super) normals: Vec<[Vec3; 3]>,
}

impl Mesh {
    /// Prepares a mesh: smooth normals, except across edges sharper than 40°.
    ///
    /// Triangles that name a missing vertex or are not finite are left out.
    #[must_use]
    pub fn new(mesh: &TriangleMesh) -> Self {
        let positions: Vec<Vec3> = mesh.vertices.iter().map(|v| v.as_vec3()).collect();
        let drawable =
            |t: &&[u32; 3]| t.iter().all(|&i| positions.get(i as usize).is_some_and(|p| p.is_finite()));
        let triangles: Vec<[u32; 3]> = mesh.triangles.iter().filter(drawable).copied().collect();
        let normals = corner_normals(&positions, &triangles);
        Self { positions, triangles, normals }
    }

    /// The mesh, `factor` times as large.
    #[must_use]
    pub fn scaled(mut self, factor: f32) -> Self {
        for position in &mut self.positions {
            *position *= factor;
        }
        self
    }
}

/// For every corner, the normals of the faces around its vertex that turn less than the crease angle from the
/// corner's own, each weighted by its angle there, so that the triangulation does not show.
fn corner_normals(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<[Vec3; 3]> {
    let face_normals: Vec<Vec3> = triangles.iter().map(|t| face_normal(positions, t)).collect();
    let around = faces_around(positions.len(), triangles);
    let crease = CREASE_DEGREES.to_radians().cos();
    let corner = |face: usize, vertex: u32| {
        let own = face_normals[face];
        let neighbours = around.of(vertex).iter().map(|&other| other as usize);
        let smooth: Vec3 = neighbours
            .filter(|&other| face_normals[other].dot(own) >= crease)
            .map(|other| face_normals[other] * angle_at(positions, &triangles[other], vertex))
            .sum();
        smooth.try_normalize().unwrap_or(own)
    };
    triangles.iter().enumerate().map(|(face, t)| t.map(|vertex| corner(face, vertex))).collect()
}

fn face_normal(positions: &[Vec3], triangle: &[u32; 3]) -> Vec3 {
    let [a, b, c] = triangle.map(|i| positions[i as usize]);
    (b - a).cross(c - a).normalize_or_zero()
}

/// The triangle's angle at `vertex` (rad).
fn angle_at(positions: &[Vec3], triangle: &[u32; 3], vertex: u32) -> f32 {
    let at = triangle.iter().position(|&i| i == vertex).unwrap_or(0);
    let [a, b, c] = [0, 1, 2].map(|k| positions[triangle[(at + k) % 3] as usize]);
    (b - a).angle_between(c - a)
}

/// Faces around each vertex, one list after the other.
struct FacesAround {
    starts: Vec<u32>,
    faces: Vec<u32>,
}

impl FacesAround {
    fn of(&self, vertex: u32) -> &[u32] {
        &self.faces[self.starts[vertex as usize] as usize..self.starts[vertex as usize + 1] as usize]
    }
}

fn faces_around(vertices: usize, triangles: &[[u32; 3]]) -> FacesAround {
    let mut starts = vec![0; vertices + 2];
    for &vertex in triangles.as_flattened() {
        starts[vertex as usize + 2] += 1;
    }
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
    }
    let mut faces = vec![0; 3 * triangles.len()];
    for (face, triangle) in (0..).zip(triangles) {
        for &vertex in triangle {
            let next = &mut starts[vertex as usize + 1];
            faces[*next as usize] = face;
            *next += 1;
        }
    }
    FacesAround { starts, faces }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;
    use glam::DVec3;

    #[test]
    fn a_box_keeps_its_edges() {
        let mesh = Mesh::new(&shapes::cuboid(DVec3::ONE));
        for (triangle, normals) in mesh.triangles.iter().zip(&mesh.normals) {
            let flat = face_normal(&mesh.positions, triangle);
            assert!(normals.iter().all(|n| n.distance(flat) < 1e-6));
        }
    }

    #[test]
    fn a_sphere_is_round() {
        let mesh = Mesh::new(&shapes::sphere(2.0, 3));
        for (triangle, normals) in mesh.triangles.iter().zip(&mesh.normals) {
            for (&vertex, normal) in triangle.iter().zip(normals) {
                assert!(normal.distance(mesh.positions[vertex as usize] / 2.0) < 0.01);
            }
        }
    }

    #[test]
    fn broken_triangles_are_left_out() {
        let mut broken = shapes::cuboid(DVec3::ONE);
        broken.vertices[0].x = f64::NAN;
        broken.triangles.push([1, 2, 99]);
        let mesh = Mesh::new(&broken);
        assert!(mesh.triangles.len() < 12);
        assert!(mesh.triangles.as_flattened().iter().all(|&i| i != 0 && i < 8));
    }
}
