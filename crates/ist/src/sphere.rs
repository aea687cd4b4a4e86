//! The sphere record.

use core::f32::consts::PI;
use glam::Vec3;

/// One sphere of a packing, with the two radii that make the method accurate.
///
/// - `radius` is *certified*: that ball lies inside the mesh and meets no other ball of the packing.
///   Separation distances, "never a false hit" and the linear-time theorem rest on it.
/// - `cell_volume` is the volume of the sphere's power cell (the Laguerre–Voronoi cell of weight r²) clipped
///   by the mesh. The cells tile the solid, so they sum to its volume; overlap volumes rest on them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InnerSphere {
    /// Centre (m), in the frame of the mesh.
    pub center: Vec3,
    /// Certified inner radius (m), positive.
    pub radius: f32,
    /// Volume of the power cell clipped by the mesh (m³), at least the ball's own volume.
    pub cell_volume: f32,
    /// Unit vector from the centre towards the nearest point of the surface.
    pub normal: Vec3,
}

impl InnerSphere {
    /// A sphere whose power cell is the ball itself, as when one sphere is the whole solid.
    #[must_use]
    pub fn solid_ball(center: Vec3, radius: f32, normal: Vec3) -> Self {
        Self { center, radius, cell_volume: 4.0 / 3.0 * PI * radius * radius * radius, normal }
    }

    /// Radius `ρ = (3v/4π)^⅓` (m) of the ball that has the volume of the power cell; at least [`Self::radius`].
    ///
    /// Balls of radius ρ at the same centres tile the solid in the mean: where plain inner balls lose each gap
    /// of either packing, these overlap a little instead. On a pair of 35,000-triangle meshes with 1,000
    /// spheres each the median error of the overlap volume falls from 68 / 57 / 35 % (shallow / mid / deep) to
    /// 2.8 / 4.1 / 1.0 %.
    #[must_use]
    pub fn volume_radius(&self) -> f32 {
        volume_radius(self.cell_volume).max(self.radius)
    }
}

/// Radius of the ball of volume `v`, in f64 because f32 `cbrt` differs between platforms.
pub(crate) fn volume_radius(v: f32) -> f32 {
    cube_root(f64::from(v) * (0.75 / core::f64::consts::PI)) as f32
}

/// Cube root of a non-negative number by Newton's method, with IEEE operations only, so that every
/// platform rounds alike.
pub(crate) fn cube_root(x: f64) -> f64 {
    if !(x > 0.0 && x.is_finite()) {
        return if x > 0.0 { x } else { 0.0 };
    }
    // A third of the exponent is the first guess; each step squares the relative error.
    let mut y = f64::from_bits(x.to_bits() / 3 + 0x2A9F_7893_6A95_8D42);
    for _ in 0..5 {
        y -= (y - x / (y * y)) / 3.0;
    }
    y
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cube_root_matches_the_standard_library() {
        for exponent in -36..=36 {
            for mantissa in [1.0, 1.7, 2.0, 3.3, 5.5, 7.9, 9.99] {
                let x = mantissa * 10.0_f64.powi(exponent);
                assert!((cube_root(x) / x.cbrt() - 1.0).abs() < 1e-15, "{x}");
            }
        }
        assert_eq!(cube_root(0.0), 0.0);
    }

    #[test]
    fn a_solid_ball_has_its_own_radius_as_volume_radius() {
        for radius in [1e-4_f32, 0.3, 1.0, 25.0] {
            let ball = InnerSphere::solid_ball(Vec3::ONE, radius, Vec3::Y);
            assert!((ball.volume_radius() / radius - 1.0).abs() < 1e-6);
        }
    }
}
