//! The numbers of a recording as the page reads them.

use super::shapes::{Placement, Shapes};
use crate::playback::{bounds_at_the_end, color, ground_height, upright};
use anyhow::{Result, ensure};
use glam::Vec3;
use rapier_ist::replay::{Replay, ReplayBody};
use serde::Serialize;

/// Most bytes of numbers: longer texts are refused by browsers.
const MAX_BYTES: usize = 300_000_000;
/// The largest number in an unsigned position.
const FULL: f32 = 65535.0;

/// A recording as a description and numbers, all little-endian.
pub(super) struct Recording {
    pub(super) description: Description,
    pub(super) numbers: Vec<u8>,
}

/// What the page is told, lengths in metres and times in seconds, y upwards. Offsets are in bytes from the start of the
/// numbers and multiples of four.
#[derive(Serialize)]
pub(super) struct Description {
    title: String,
    steps: usize,
    bodies: Vec<Body>,
    meshes: Vec<Shape>,
    packings: Vec<Shape>,
    /// Offset of the times, one f32 per step.
    times: usize,
    /// Offset of the poses: for each step and body three u16 within the body's range, and a quaternion as four i16,
    /// zero for a body that is not there.
    poses: usize,
    /// Offset of the figures of each step as f32: kinetic energy (J), deepest overlap (m), contacts, bodies awake, all
    /// NaN where not recorded.
    figures: usize,
    ground: f32,
    center: [f32; 3],
    radius: f32,
}

#[derive(Serialize)]
struct Body {
    name: String,
    color: [f32; 4],
    mesh: Option<Placement>,
    spheres: Option<Placement>,
    /// Least position and length of the longest way along an axis.
    lower: [f32; 3],
    range: f32,
}

#[derive(Serialize)]
struct Shape {
    /// Offset of the coordinates, i16.
    numbers: usize,
    /// Number of coordinates.
    count: usize,
    /// Offset of the triangles' indices, u32.
    triangles: usize,
    triangle_count: usize,
}

impl Recording {
    pub(super) fn new(replay: &Replay, title: &str) -> Result<Self> {
        ensure!(
            replay.step_count() > 0,
            "the recording has no step to play; it ends where: {}",
            replay.end()
        );
        let (steps, count) = (replay.step_count(), replay.bodies().len());
        let mut numbers = Numbers::default();
        let mut meshes = Shapes::default();
        let mut packings = Shapes::default();
        let mut bodies: Vec<Body> = (0..)
            .zip(replay.bodies())
            .map(|(index, body)| describe(index, body, &mut meshes, &mut packings))
            .collect();
        let shapes_size: usize = meshes.list.iter().chain(&packings.list).map(|s| 2 * s.numbers.len()).sum();
        ensure!(
            steps.saturating_mul(14 * count + 20).saturating_add(shapes_size) < MAX_BYTES,
            "{steps} steps of {count} bodies are too much for a page; record every n-th step"
        );
        let shape = |numbers: &mut Numbers, shape: &super::shapes::Shape| Shape {
            numbers: numbers.add(shape.numbers.iter().flat_map(|n| n.to_le_bytes())),
            count: shape.numbers.len(),
            triangles: numbers.add(shape.triangles.as_flattened().iter().flat_map(|i| i.to_le_bytes())),
            triangle_count: shape.triangles.len(),
        };
        let mesh_list = meshes.list.iter().map(|mesh| shape(&mut numbers, mesh)).collect();
        let packing_list = packings.list.iter().map(|packing| shape(&mut numbers, packing)).collect();
        set_ranges(replay, &mut bodies);
        let (lower, upper) = bounds_at_the_end(replay).unwrap_or((Vec3::NEG_ONE, Vec3::ONE));
        let description = Description {
            title: title.to_owned(),
            steps,
            times: numbers.add(replay.steps().flat_map(|step| (step.time() as f32).to_le_bytes())),
            poses: numbers.add(poses(replay, &bodies)),
            figures: numbers.add(figures(replay)),
            bodies,
            meshes: mesh_list,
            packings: packing_list,
            ground: ground_height(replay).unwrap_or(0.0),
            center: ((lower + upper) / 2.0).to_array(),
            radius: ((upper - lower).length() / 2.0).max(1e-6),
        };
        Ok(Self { description, numbers: numbers.0 })
    }
}

/// Bytes, each part at a multiple of four.
#[derive(Default)]
struct Numbers(Vec<u8>);

impl Numbers {
    fn add(&mut self, bytes: impl IntoIterator<Item = u8>) -> usize {
        self.0.resize(self.0.len().next_multiple_of(4), 0);
        let offset = self.0.len();
        self.0.extend(bytes);
        offset
    }
}

fn describe(index: usize, body: &ReplayBody, meshes: &mut Shapes, packings: &mut Shapes) -> Body {
    let [red, green, blue] = color(body, index);
    let opacity = body.mesh.as_ref().map_or(1.0, |mesh| mesh.color[3]);
    Body {
        name: body.name.clone(),
        color: [red, green, blue, opacity],
        mesh: body.mesh.as_ref().and_then(|mesh| meshes.add_mesh(&mesh.vertices, &mesh.triangles)),
        spheres: packings.add_spheres(&body.spheres),
        lower: [f32::INFINITY; 3],
        range: 0.0,
    }
}

/// Gives every body the range of its own positions.
fn set_ranges(replay: &Replay, bodies: &mut [Body]) {
    let mut upper = vec![Vec3::NEG_INFINITY; bodies.len()];
    for (index, pose) in replay.steps().flat_map(|step| step.poses()) {
        let position = upright(replay.up()).transform_point(pose.translation);
        upper[index] = upper[index].max(position);
        bodies[index].lower = Vec3::from(bodies[index].lower).min(position).to_array();
    }
    for (body, upper) in bodies.iter_mut().zip(upper) {
        let lower = Vec3::from(body.lower);
        body.range = if lower.is_finite() { (upper - lower).max_element() } else { 0.0 };
        body.lower = if lower.is_finite() { body.lower } else { [0.0; 3] };
    }
}

fn poses(replay: &Replay, bodies: &[Body]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(14 * bodies.len() * replay.step_count());
    for step in replay.steps() {
        for (index, body) in bodies.iter().enumerate() {
            let Some(pose) = step.pose(index) else {
                bytes.extend([0; 14]);
                continue;
            };
            let pose = upright(replay.up()) * pose;
            let position = (pose.translation - Vec3::from(body.lower)) / body.range.max(f32::MIN_POSITIVE);
            bytes.extend(
                position.to_array().map(|p| (p * FULL).round() as u16).iter().flat_map(|n| n.to_le_bytes()),
            );
            let rotation = pose.rotation.to_array().map(|q| (q * 32767.0).round() as i16);
            bytes.extend(rotation.iter().flat_map(|n| n.to_le_bytes()));
        }
    }
    bytes
}

fn figures(replay: &Replay) -> Vec<u8> {
    let figures = replay.steps().flat_map(|step| match step.metrics() {
        Some(m) => {
            [m.kinetic_energy as f32, m.deepest_overlap as f32, m.contact_count as f32, m.awake_bodies as f32]
        }
        None => [f32::NAN; 4],
    });
    figures.flat_map(f32::to_le_bytes).collect()
}
