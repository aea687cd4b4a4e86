//! Exact mesh booleans, by boolmesh, a port of Manifold to Rust.
//!
//! A query moves B's vertices, prepares that mesh and intersects: boolmesh has no moved meshes. The volume comes from the surface
//! of the intersection by the divergence theorem; the push is that of a pressure on those faces which are B's.

use crate::engine::{Answer, Engine};
use crate::pair::MeshPair;
use boolmesh::prelude::{Manifold, OpType, compute_boolean};
use glam::DVec3;
use glamx::Pose3;
use packer::Solid;
use std::error::Error;
use std::time::Instant;

/// Values that boolmesh hands on to the faces of an intersection.
const FACE_OF_A: f64 = 0.0;
const FACE_OF_B: f64 = 1.0;

/// Two meshes and their last intersection.
pub(crate) struct MeshBoolean {
    build_seconds: f64,
    a: Manifold,
    vertices_b: Vec<DVec3>,
    indices_b: Vec<usize>,
    /// The moved B's, kept for its memory.
    positions: Vec<f64>,
    intersection: Option<Manifold>,
}

impl MeshBoolean {
    pub(crate) fn new(pair: &MeshPair) -> Result<Self, Box<dyn Error>> {
        let start = Instant::now();
        let [a, b] = &pair.solids;
        let positions: Vec<f64> = a.mesh().vertices.iter().flat_map(|vertex| vertex.to_array()).collect();
        let a = manifold(&positions, &indices(a), FACE_OF_A)?;
        let scale = f64::from(pair.scale_b);
        Ok(Self {
            build_seconds: start.elapsed().as_secs_f64(),
            a,
            vertices_b: b.mesh().vertices.iter().map(|vertex| *vertex * scale).collect(),
            indices_b: indices(b),
            positions: Vec::new(),
            intersection: None,
        })
    }
}

impl Engine for MeshBoolean {
    fn name(&self) -> &str {
        "exact boolean, boolmesh"
    }

    fn build_seconds(&self) -> f64 {
        self.build_seconds
    }

    fn query(&mut self, pose: &Pose3) {
        let (rotation, translation) = (pose.rotation.as_dquat(), pose.translation.as_dvec3());
        self.positions.clear();
        let placed = self.vertices_b.iter().map(|vertex| rotation * *vertex + translation);
        self.positions.extend(placed.flat_map(|vertex| vertex.to_array()));
        // Meshes that are apart have no intersection, which boolmesh reports as an error.
        self.intersection = manifold(&self.positions, &self.indices_b, FACE_OF_B)
            .and_then(|b| compute_boolean(&self.a, &b, OpType::Intersect))
            .ok();
    }

    fn answer(&self) -> Answer {
        let Some(mesh) = &self.intersection else { return Answer { volume: Some(0.0), ..Answer::default() } };
        let (mut volume, mut push) = (0.0, DVec3::ZERO);
        for (face, half_edges) in mesh.hs.chunks_exact(3).enumerate() {
            let corner = |i: usize| DVec3::from_array(mesh.ps[half_edges[i].tail].to_array());
            let [p, q, r] = [corner(0), corner(1), corner(2)];
            volume += p.dot(q.cross(r)) / 6.0;
            if mesh.vals.get(3 * face).is_some_and(|value| *value > 0.5) {
                push -= (q - p).cross(r - p);
            }
        }
        Answer { volume: Some(volume), push: push.as_vec3(), pairs: None }
    }
}

fn indices(solid: &Solid) -> Vec<usize> {
    solid.mesh().triangles.iter().flatten().map(|index| *index as usize).collect()
}

fn manifold(positions: &[f64], indices: &[usize], of: f64) -> Result<Manifold, String> {
    Manifold::new_with_values(positions, indices, &vec![of; indices.len()])
}
