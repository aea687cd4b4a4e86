//! What Rapier offers for a dynamic body that is not convex: shapes of parry, asked as Rapier asks them.
//!
//! A query is one call of `contact_manifolds` of the default dispatcher. At a pose that has nothing to do with the last one the
//! workspace is a fresh one and the manifolds are cleared, but their vector keeps its memory; from move to move both are kept,
//! as for two colliders of a world. The prediction distance is 0, in favour of the peers: Rapier's default for bodies of this size is 0.02 m.

use crate::engine::{Answer, Engine};
use crate::pair::MeshPair;
use glam::Vec3;
use glamx::Pose3;
use packer::Solid;
use rapier_ist_examples::scenes::single_precision;
use rapier3d::geometry::{SharedShape, TriMesh};
use rapier3d::parry::query::{
    ContactManifold, ContactManifoldsWorkspace, DefaultQueryDispatcher, PersistentQueryDispatcher,
};
use rapier3d::parry::transformation::voxelization::FillMode;
use rapier3d::prelude::TriMeshFlags;
use std::collections::HashMap;
use std::error::Error;
use std::time::Instant;

/// Balls of the packing that the ball compounds are made of.
const PACKED: usize = 3_000;
/// Voxels along the longest side.
const VOXELS: f32 = 32.0;
/// Distance up to which bodies that are apart get contacts (m).
const PREDICTION: f32 = 0.0;

/// Both solids as a shape of parry.
pub(crate) struct Peer {
    name: String,
    build_seconds: f64,
    shapes: [SharedShape; 2],
    manifolds: Vec<ContactManifold<(), ()>>,
    workspace: Option<ContactManifoldsWorkspace>,
}

impl Peer {
    /// The compound of convex parts that Rapier's `convex_decomposition` makes with its default parameters.
    pub(crate) fn convex_parts(pair: &MeshPair) -> Self {
        let start = Instant::now();
        let shapes = [0, 1].map(|side| {
            let (vertices, triangles) = mesh(pair, side);
            SharedShape::convex_decomposition(&vertices, &triangles)
        });
        let parts = shapes.each_ref().map(parts);
        Self::new(&format!("VHACD compound, {} / {} parts", parts[0], parts[1]), shapes, start)
    }

    /// The hollow mesh, its edges cut into `parts` first; with `FIX_INTERNAL_EDGES` contacts keep to the outer side of faces.
    pub(crate) fn triangles(
        pair: &MeshPair,
        parts: u32,
        flags: TriMeshFlags,
    ) -> Result<Self, Box<dyn Error>> {
        let start = Instant::now();
        let shape = |side| {
            let (vertices, triangles) = subdivided(mesh(pair, side), parts);
            SharedShape::trimesh_with_flags(vertices, triangles, flags)
        };
        let shapes = [shape(0)?, shape(1)?];
        let counts = shapes.each_ref().map(|shape| shape.as_trimesh().map_or(0, TriMesh::num_triangles));
        let kind = if flags.is_empty() { "TriMesh" } else { "TriMesh, FIX_INTERNAL_EDGES" };
        Ok(Self::new(&format!("{kind}, {} / {} triangles", counts[0], counts[1]), shapes, start))
    }

    /// Filled voxels, 32 along the longest side.
    pub(crate) fn voxels(pair: &MeshPair) -> Self {
        let start = Instant::now();
        let shapes = [0, 1].map(|side| {
            let (vertices, triangles) = mesh(pair, side);
            let empty = (Vec3::splat(f32::INFINITY), Vec3::splat(f32::NEG_INFINITY));
            let (lower, upper) = vertices.iter().fold(empty, |(l, u), v| (l.min(*v), u.max(*v)));
            let size = (upper - lower).max_element() / VOXELS;
            let fill = FillMode::FloodFill { detect_cavities: false };
            SharedShape::voxelized_mesh(&vertices, &triangles, size, fill)
        });
        Self::new("Voxels, 1/32", shapes, start)
    }

    /// The `count` largest inner balls of a packing, as a compound. Unlike fitted balls they do not stick out of the mesh.
    pub(crate) fn balls(pair: &MeshPair, count: usize) -> Result<Self, Box<dyn Error>> {
        let packed = pair.packed(PACKED)?;
        let start = Instant::now();
        let [a, b] = &packed.packings;
        let compound = |packing: &ist::SpherePacking, scale: f32| {
            let mut spheres = packing.spheres().to_vec();
            spheres.sort_by(|a, b| b.radius.total_cmp(&a.radius));
            spheres.truncate(count);
            let ball = |s: &ist::InnerSphere| {
                (Pose3::from_translation(s.center * scale), SharedShape::ball(s.radius * scale))
            };
            SharedShape::compound(spheres.iter().map(ball).collect())
        };
        let shapes = [compound(a, 1.0), compound(b, pair.scale_b)];
        let mut peer = Self::new(&format!("{count} largest inner balls, compound"), shapes, start);
        peer.build_seconds += packed.seconds;
        Ok(peer)
    }

    fn new(name: &str, shapes: [SharedShape; 2], start: Instant) -> Self {
        let build_seconds = start.elapsed().as_secs_f64();
        Self { name: format!("parry {name}"), build_seconds, shapes, manifolds: Vec::new(), workspace: None }
    }
}

impl Engine for Peer {
    fn name(&self) -> &str {
        &self.name
    }

    fn build_seconds(&self) -> f64 {
        self.build_seconds
    }

    fn jump(&mut self) {
        self.manifolds.clear();
        self.workspace = None;
    }

    fn query(&mut self, pose: &Pose3) {
        let [a, b] = &self.shapes;
        let supported = DefaultQueryDispatcher.contact_manifolds(
            pose,
            &**a,
            &**b,
            PREDICTION,
            &mut self.manifolds,
            &mut self.workspace,
        );
        debug_assert!(supported.is_ok(), "{}", self.name);
    }

    /// Pushes along the contacts' normals, weighted by their depths.
    fn answer(&self) -> Answer {
        let push = |manifold: &ContactManifold<(), ()>| {
            let normal = match manifold.subshape_pos1() {
                Some(pose) => pose.rotation * manifold.local_n1,
                None => manifold.local_n1,
            };
            normal * manifold.points.iter().map(|point| (-point.dist).max(0.0)).sum::<f32>()
        };
        Answer { push: self.manifolds.iter().map(push).sum(), ..Answer::default() }
    }
}

fn parts(shape: &SharedShape) -> usize {
    shape.as_compound().map_or(1, |compound| compound.shapes().len())
}

fn mesh(pair: &MeshPair, side: usize) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let solids: &[Solid; 2] = &pair.solids;
    let (mut vertices, triangles) = single_precision(&solids[side]);
    if side == 1 {
        for vertex in &mut vertices {
            *vertex *= pair.scale_b;
        }
    }
    (vertices, triangles)
}

/// The same surface with every edge cut into `parts` and every triangle into their square.
fn subdivided((corners, faces): (Vec<Vec3>, Vec<[u32; 3]>), parts: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    let mut known: HashMap<[u32; 6], u32> = HashMap::new();
    for face in faces {
        // The vertex with these weights of the three corners, which sum to `parts`. Neighbours find the same one, as
        // corners of no weight do not count.
        let mut vertex = |weights: [u32; 3]| {
            let mut terms =
                [0, 1, 2].map(|i| if weights[i] > 0 { (face[i], weights[i]) } else { (u32::MAX, 0) });
            terms.sort_unstable();
            let key = [terms[0].0, terms[0].1, terms[1].0, terms[1].1, terms[2].0, terms[2].1];
            *known.entry(key).or_insert_with(|| {
                let terms = terms.iter().filter(|(_, weight)| *weight > 0);
                vertices.push(terms.map(|(i, w)| corners[*i as usize] * (*w as f32 / parts as f32)).sum());
                vertices.len() as u32 - 1
            })
        };
        for i in 0..parts {
            for j in 0..parts - i {
                let mut at = |i: u32, j: u32| vertex([parts - i - j, i, j]);
                triangles.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
                if i + j + 1 < parts {
                    triangles.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
    }
    (vertices, triangles)
}
