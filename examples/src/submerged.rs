//! Exact volume of a mesh under water.

use glam::DVec3;
use glamx::DPose3;
use packer::TriangleMesh;

/// A closed mesh somewhere in the world, y upwards.
#[derive(Clone, Copy, Debug)]
pub struct PlacedMesh<'a> {
    mesh: &'a TriangleMesh,
    pose: DPose3,
    scale: f64,
}

impl<'a> PlacedMesh<'a> {
    /// `mesh`, scaled by `scale` and then placed at `pose`.
    #[must_use]
    pub fn new(mesh: &'a TriangleMesh, pose: &glamx::Pose3, scale: f64) -> Self {
        let rotation = pose.rotation.as_dquat().normalize();
        Self { mesh, pose: DPose3::from_parts(pose.translation.as_dvec3(), rotation), scale }
    }

    fn vertex(&self, index: u32) -> DVec3 {
        self.pose * (self.mesh.vertices[index as usize] * self.scale)
    }

    /// Height of the lowest vertex (m); infinite for a mesh without any.
    #[must_use]
    pub fn lowest(&self) -> f64 {
        let vertices = self.mesh.vertices.iter().map(|&vertex| self.pose * (vertex * self.scale));
        vertices.map(|vertex| vertex.y).fold(f64::INFINITY, f64::min)
    }

    /// Height of the highest vertex (m).
    fn highest(&self) -> f64 {
        let vertices = self.mesh.vertices.iter().map(|&vertex| self.pose * (vertex * self.scale));
        vertices.map(|vertex| vertex.y).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Volume (m³) of the part that lies below `height` (m).
    ///
    /// By the divergence theorem it is the sum of the tetrahedra from a point to all triangles, each cut off at the water.
    /// The face that the water cuts adds nothing where the point lies in it. Takes time in proportion to the triangles.
    #[must_use]
    pub fn volume_below(&self, height: f64) -> f64 {
        let apex = DVec3::Y * height;
        let triangle = |indices: &[u32; 3]| {
            let corners = indices.map(|index| self.vertex(index) - apex);
            let (below, count) = cut_off(corners);
            (2..count).map(|i| below[0].dot(below[i - 1].cross(below[i])) / 6.0).sum::<f64>()
        };
        self.mesh.triangles.iter().map(triangle).sum()
    }

    /// Height up to which `volume` (m³) of the mesh lies below it: where the water stands on a body of given weight.
    ///
    /// The volume grows with the height; the height is exact to 2⁻⁵⁰ of the mesh's. Beyond the mesh's own volume it is
    /// the height of its highest vertex.
    #[must_use]
    pub fn height_of(&self, volume: f64) -> f64 {
        let (mut low, mut high) = (self.lowest(), self.highest());
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if self.volume_below(middle) < volume {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }
}

/// The part of a triangle with y ≤ 0: at most four corners, in the triangle's order, and how many they are.
fn cut_off(corners: [DVec3; 3]) -> ([DVec3; 4], usize) {
    let (mut below, mut count) = ([DVec3::ZERO; 4], 0);
    let mut keep = |point| {
        below[count] = point;
        count += 1;
    };
    for i in 0..3 {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        if a.y <= 0.0 {
            keep(a);
        }
        if (a.y <= 0.0) != (b.y <= 0.0) {
            keep(a.lerp(b, a.y / (a.y - b.y)));
        }
    }
    (below, count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;
    use glam::{Quat, Vec3};
    use glamx::Pose3;
    use std::f64::consts::PI;

    #[test]
    fn a_box_is_cut_like_a_box() {
        let mesh = shapes::cuboid(DVec3::new(0.3, 0.2, 0.5));
        let placed = PlacedMesh::new(&mesh, &Pose3::translation(5.0, 1.0, -3.0), 2.0);
        for (height, share) in [(0.0, 0.0), (0.6, 0.0), (0.8, 0.25), (1.0, 0.5), (1.4, 1.0), (9.0, 1.0)] {
            let volume = placed.volume_below(height);
            assert!((volume - share * 1.92).abs() < 1e-6, "{height}: {volume}");
        }
        assert!((placed.height_of(0.25 * 1.92) - 0.8).abs() < 1e-6);
        // Rotated by 45° about z, the edge is at the bottom and the cross-section below a depth d is d².
        let square = shapes::cuboid(DVec3::new(0.2, 0.2, 0.5));
        let turned = Pose3::from_parts(Vec3::ZERO, Quat::from_rotation_z(0.25 * std::f32::consts::PI));
        let placed = PlacedMesh::new(&square, &turned, 1.0);
        assert!((placed.volume_below(placed.lowest() + 0.1) - 0.01).abs() < 1e-6);
    }

    #[test]
    fn a_ball_is_cut_like_a_ball() {
        let mesh = shapes::sphere(1.0, 6);
        let turned = Pose3::from_parts(Vec3::new(1.0, 0.25, 2.0), Quat::from_rotation_x(0.7));
        let placed = PlacedMesh::new(&mesh, &turned, 0.5);
        for depth in [0.1, 0.4, 0.5, 0.9] {
            let cap = PI * depth * depth * (1.5 - depth) / 3.0;
            let volume = placed.volume_below(-0.25 + depth);
            assert!((volume - cap).abs() < 2e-3 * cap, "{depth}: {volume} for {cap}");
        }
    }
}
