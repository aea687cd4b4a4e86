//! How a body looks: the caller's description and what becomes of it.

use super::RecordError;
use super::convert::{color, identity, point, timestamp};
use foxglove::bytes::Bytes;
use foxglove::messages::packed_element_field::NumericType;
use foxglove::messages::{PackedElementField, PointCloud, SceneEntity, TriangleListPrimitive};
use ist::SpherePacking;
use rapier3d::dynamics::RigidBodyHandle;
use rapier3d::math::Vector;
use std::borrow::Cow;

/// What a viewer needs to know of a body once: its name, mesh, packing and colour.
#[derive(Clone, Debug)]
pub struct BodyDescription<'a> {
    pub(super) handle: RigidBodyHandle,
    pub(super) name: Cow<'a, str>,
    mesh: Option<(&'a [Vector], &'a [[u32; 3]])>,
    pub(super) spheres: Option<&'a SpherePacking>,
    pub(super) scale: f32,
    color: [f32; 4],
}

impl<'a> BodyDescription<'a> {
    /// A body without a look: only its pose is recorded.
    #[must_use]
    pub fn new(handle: RigidBodyHandle, name: impl Into<Cow<'a, str>>) -> Self {
        Self { handle, name: name.into(), mesh: None, spheres: None, scale: 1.0, color: [0.7, 0.7, 0.7, 1.0] }
    }

    /// Its triangles, vertices in the body's frame (m, before [`Self::scale`]).
    #[must_use]
    pub fn mesh(mut self, vertices: &'a [Vector], triangles: &'a [[u32; 3]]) -> Self {
        self.mesh = Some((vertices, triangles));
        self
    }

    /// Its packing, in the body's frame (m, before [`Self::scale`]). It is written where the options are
    /// [`RecordOptions::everything`](super::RecordOptions::everything).
    #[must_use]
    pub fn spheres(mut self, packing: &'a SpherePacking) -> Self {
        self.spheres = Some(packing);
        self
    }

    /// Size of the body relative to its mesh and packing, positive.
    #[must_use]
    pub fn scale(mut self, scale: f32) -> Self {
        self.scale = scale;
        self
    }

    /// Colour of the mesh: red, green, blue and opacity, 0 to 1 each.
    #[must_use]
    pub fn color(mut self, color: [f32; 4]) -> Self {
        self.color = color;
        self
    }

    /// Refuses what would put broken geometry into the file.
    pub(super) fn check(&self) -> Result<(), RecordError> {
        match self.defect() {
            Some(what) => Err(RecordError::Body { name: self.name.to_string(), what }),
            None => Ok(()),
        }
    }

    fn defect(&self) -> Option<&'static str> {
        if !(self.scale.is_finite() && self.scale > 0.0) {
            return Some("the scale must be positive and finite");
        }
        if !self.color.iter().all(|channel| (0.0..=1.0).contains(channel)) {
            return Some("colour channels must lie between 0 and 1");
        }
        let (vertices, triangles) = self.mesh?;
        if !vertices.iter().all(|vertex| (*vertex * self.scale).is_finite()) {
            return Some("a vertex is not finite; repair the mesh");
        }
        let count = vertices.len();
        if triangles.iter().flatten().any(|&index| index as usize >= count) {
            return Some("a triangle names a vertex that is not there; repair the mesh");
        }
        None
    }

    /// Largest distance of a vertex or sphere from the body's origin (m), 0 for a body without a look.
    pub(super) fn radius(&self) -> f64 {
        let vertices = self.mesh.map_or(&[][..], |(vertices, _)| vertices);
        let mesh = vertices.iter().map(|vertex| vertex.length()).fold(0.0, f32::max);
        let spheres = self.spheres.map_or(&[][..], SpherePacking::spheres);
        let reach = spheres.iter().map(|s| s.center.length() + s.radius).fold(mesh, f32::max);
        f64::from(reach * self.scale)
    }

    /// The mesh as an entity that moves with the frame `name`.
    pub(super) fn entity(&self, name: &str, time: u64) -> Option<SceneEntity> {
        let (vertices, triangles) = self.mesh?;
        let triangles = TriangleListPrimitive {
            pose: Some(identity()),
            points: vertices.iter().map(|vertex| point(*vertex * self.scale)).collect(),
            color: Some(color(self.color)),
            colors: Vec::new(),
            indices: triangles.concat(),
        };
        Some(SceneEntity {
            timestamp: Some(timestamp(time)),
            frame_id: name.to_owned(),
            id: name.to_owned(),
            frame_locked: true,
            triangles: vec![triangles],
            ..Default::default()
        })
    }

    /// The packing as points with radii in the frame `name`.
    pub(super) fn point_cloud(&self, name: &str, time: u64) -> Option<PointCloud> {
        const FIELDS: [&str; 4] = ["x", "y", "z", "radius"];
        const STRIDE: u32 = 4 * FIELDS.len() as u32;
        let field = |(index, name): (u32, &str)| PackedElementField {
            name: name.to_owned(),
            offset: 4 * index,
            r#type: NumericType::Float32 as i32,
        };
        let numbers = self.spheres?.spheres().iter().flat_map(|sphere| {
            let [x, y, z] = sphere.center.to_array();
            [x, y, z, sphere.radius]
        });
        let data: Vec<u8> = numbers.flat_map(|number| (number * self.scale).to_le_bytes()).collect();
        Some(PointCloud {
            timestamp: Some(timestamp(time)),
            frame_id: name.to_owned(),
            pose: Some(identity()),
            point_stride: STRIDE,
            fields: (0..).zip(FIELDS).map(field).collect(),
            data: Bytes::from(data),
        })
    }
}
