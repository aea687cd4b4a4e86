//! What is drawn: about the solid's centroid, as large as its largest ball is, and in single precision.

use glam::{DVec3, Vec3};
use ist::SpherePacking;
use packer::Solid;

pub(super) struct Ball {
    pub(super) center: Vec3,
    pub(super) radius: f32,
}

pub(super) struct Scene {
    pub(super) balls: Vec<Ball>,
    /// The surface of the solid; empty where the mesh is not at hand.
    pub(super) triangles: Vec<[Vec3; 3]>,
    /// Smallest and largest radius, in units of the scene.
    pub(super) radii: (f32, f32),
    /// Length of the scene's unit (m).
    pub(super) unit: f64,
}

impl Scene {
    /// The scene of `packing`, and the surface of `solid`, if there is one.
    pub(super) fn new(packing: &SpherePacking, solid: Option<&Solid>) -> Self {
        // A mesh that is tiny, huge or far from the origin loses its digits unless it is brought to unit size there.
        let centroid = packing.solid().centroid;
        let unit = packing.spheres().iter().map(|s| f64::from(s.radius)).fold(0.0, f64::max);
        let place = |p: DVec3| ((p - centroid) / unit).as_vec3();
        let balls: Vec<Ball> = packing
            .spheres()
            .iter()
            .map(|s| Ball { center: place(s.center.as_dvec3()), radius: (f64::from(s.radius) / unit) as f32 })
            .collect();
        let mesh = solid.map(Solid::surface);
        let count = mesh.map_or(0, |mesh| mesh.triangles.len());
        let corners = |index| mesh.map(|mesh| mesh.corners(index).map(place));
        let triangles = (0..count).filter_map(corners).collect();
        let smallest = balls.iter().map(|ball| ball.radius).fold(1.0, f32::min);
        Self { balls, triangles, radii: (smallest, 1.0), unit }
    }
}
