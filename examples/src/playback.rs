//! Pictures of a recording, made from its file alone.

use crate::palette;
use crate::render::{Camera, Image, Mesh, PictureSize, Scene, Surface};
use glam::{DVec3, Vec3};
use glamx::{Pose3, Rot3};
use packer::TriangleMesh;
use rapier_ist::record::UpAxis;
use rapier_ist::replay::{Replay, ReplayBody};
use std::f32::consts::FRAC_PI_2;

/// Direction from which scenes are looked at.
const VIEW: Vec3 = Vec3::new(0.45, 1.0, 0.8);

/// A recording and the meshes of its bodies, ready to be drawn at any time.
pub struct Playback<'a> {
    replay: &'a Replay,
    /// The body's mesh, for those that have one.
    meshes: Vec<Option<Mesh>>,
    /// Height of the ground (m), y upwards.
    ground: Option<f32>,
}

impl<'a> Playback<'a> {
    /// Prepares the meshes.
    #[must_use]
    pub fn new(replay: &'a Replay) -> Self {
        let meshes = replay.bodies().iter().map(mesh).collect();
        Self { replay, meshes, ground: ground_height(replay) }
    }

    /// A camera that has the bodies in its picture as they stand at the end.
    #[must_use]
    pub fn camera(&self, size: PictureSize) -> Camera {
        self.scene(self.replay.duration()).framed_from(VIEW, size)
    }

    /// The picture that `camera` takes at `time` (s).
    #[must_use]
    pub fn picture(&self, time: f64, camera: &Camera, size: PictureSize) -> Image {
        self.scene(time).render(camera, size)
    }

    /// Everything where it is at `time` (s): meshes, and spheres of bodies without one.
    fn scene(&self, time: f64) -> Scene<'_> {
        let mut scene = Scene::new();
        for (index, (body, mesh)) in self.replay.bodies().iter().zip(&self.meshes).enumerate() {
            let Some(pose) = self.replay.pose_at(index, time) else { continue };
            let pose = upright(self.replay.up()) * pose;
            let [red, green, blue] = color(body, index);
            let surface = Surface::new([red, green, blue]);
            match mesh {
                Some(mesh) => scene.add_mesh(mesh, pose, surface),
                None => scene.add_balls(body.spheres.iter().copied(), pose, surface),
            }
        }
        if let Some(height) = self.ground {
            scene.set_ground(height);
        }
        scene
    }
}

/// From the recording's frame to one with y upwards.
#[must_use]
pub fn upright(up: UpAxis) -> Pose3 {
    let rotation = match up {
        UpAxis::Y => Rot3::IDENTITY,
        UpAxis::Z => Rot3::from_rotation_x(-FRAC_PI_2),
    };
    Pose3::from_parts(Vec3::ZERO, rotation)
}

/// The body's colour (sRGB); one of the palette where none was recorded.
#[must_use]
pub fn color(body: &ReplayBody, index: usize) -> [f32; 3] {
    let recorded = body.mesh.as_ref().map(|mesh| mesh.color);
    recorded.map_or_else(|| palette::color(index), |[red, green, blue, _]| [red, green, blue])
}

/// Corners of the box around the bodies at the last step, y upwards (m); `None` where nothing can be drawn.
#[must_use]
pub fn bounds_at_the_end(replay: &Replay) -> Option<(Vec3, Vec3)> {
    bounds(replay, |_| true)
}

/// Where a ground would be (m): under what never moves, else under everything as it lies at the end.
#[must_use]
pub fn ground_height(replay: &Replay) -> Option<f32> {
    let first = replay.step(0)?;
    let last = replay.steps().next_back()?;
    let rests = |body: usize| first.pose(body).is_some() && first.pose(body) == last.pose(body);
    let resting = (first.index() != last.index()).then(|| bounds(replay, rests)).flatten();
    resting.or_else(|| bounds_at_the_end(replay)).map(|(lower, _)| lower.y)
}

fn bounds(replay: &Replay, counts: impl Fn(usize) -> bool) -> Option<(Vec3, Vec3)> {
    let last = replay.steps().next_back()?;
    let mut bounds: Option<(Vec3, Vec3)> = None;
    for (index, pose) in last.poses().filter(|(index, _)| counts(*index)) {
        let pose = upright(replay.up()) * pose;
        let body = &replay.bodies()[index];
        let mut include = |point: Vec3, radius: f32| {
            let point = pose.transform_point(point);
            let (lower, upper) = bounds.unwrap_or((point, point));
            bounds = Some((lower.min(point - radius), upper.max(point + radius)));
        };
        match &body.mesh {
            Some(mesh) => mesh.vertices.iter().for_each(|vertex| include(*vertex, 0.0)),
            None => body.spheres.iter().for_each(|(center, radius)| include(*center, *radius)),
        }
    }
    bounds
}

fn mesh(body: &ReplayBody) -> Option<Mesh> {
    let mesh = body.mesh.as_ref()?;
    let vertices = mesh.vertices.iter().map(|vertex| DVec3::from(*vertex)).collect();
    Some(Mesh::new(&TriangleMesh { vertices, triangles: mesh.triangles.clone() }))
}
