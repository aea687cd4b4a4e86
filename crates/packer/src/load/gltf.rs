//! glTF 2.0, text and binary: all triangles of the default scene, in its frame.

use super::Parsed;
use crate::TriangleMesh;
use base64::Engine;
use glam::{DMat4, DVec3, Mat4};
use gltf::accessor::{DataType, Dimensions};
use gltf::buffer::Source;
use gltf::mesh::Mode;
use gltf::{Gltf, Node, Primitive, Semantic};
use std::path::Path;

pub(super) fn parse(bytes: &[u8], folder: &Path) -> Parsed {
    let gltf = Gltf::from_slice(bytes).map_err(|error| error.to_string())?;
    let buffers = gltf
        .buffers()
        .map(|buffer| match buffer.source() {
            Source::Bin => gltf.blob.clone().ok_or_else(|| "the binary chunk is missing".to_owned()),
            Source::Uri(uri) => read_uri(uri, folder),
        })
        .collect::<Result<Vec<_>, _>>()?;
    let scene = gltf.default_scene().or_else(|| gltf.scenes().next()).ok_or("the file has no scene")?;
    let mut mesh = TriangleMesh::default();
    // Nodes form a forest in valid files; in others, a cycle must not run for ever.
    let mut budget = gltf.nodes().len();
    let mut open: Vec<(Node, DMat4)> = scene.nodes().map(|node| (node, DMat4::IDENTITY)).collect();
    while let Some((node, parent)) = open.pop() {
        budget = budget.checked_sub(1).ok_or("the nodes form a cycle")?;
        let pose = parent * Mat4::from_cols_array_2d(&node.transform().matrix()).as_dmat4();
        for primitive in node.mesh().iter().flat_map(|mesh| mesh.primitives()) {
            add_primitive(&mut mesh, &primitive, &pose, &buffers)?;
        }
        open.extend(node.children().map(|child| (child, pose)));
    }
    Ok(mesh)
}

fn add_primitive(
    mesh: &mut TriangleMesh,
    primitive: &Primitive,
    pose: &DMat4,
    buffers: &[Vec<u8>],
) -> Result<(), String> {
    if matches!(primitive.mode(), Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip) {
        return Ok(());
    }
    // The reader relies on a validation that leaves out these two.
    let accessor = primitive.get(&Semantic::Positions).ok_or("a primitive has no positions")?;
    let is_empty = accessor.count() == 0 || primitive.indices().is_some_and(|indices| indices.count() == 0);
    if is_empty || accessor.data_type() != DataType::F32 || accessor.dimensions() != Dimensions::Vec3 {
        return Err("the positions of a primitive are not three floats each".to_owned());
    }
    let reader = primitive.reader(|buffer| buffers.get(buffer.index()).map(Vec::as_slice));
    let positions = reader.read_positions().ok_or("positions lie outside their buffer")?;
    let base = mesh.vertices.len() as u32;
    mesh.vertices.extend(positions.map(|p| pose.transform_point3(DVec3::from_array(p.map(f64::from)))));
    let count = mesh.vertices.len() as u32 - base;
    let indices: Vec<u32> = match (reader.read_indices(), primitive.indices()) {
        (Some(indices), _) => indices.into_u32().map(|i| i.saturating_add(base)).collect(),
        (None, Some(_)) => return Err("indices lie outside their buffer".to_owned()),
        (None, None) => (base..base + count).collect(),
    };
    let strip = |(i, w): (usize, &[u32])| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] };
    match primitive.mode() {
        Mode::TriangleStrip => mesh.triangles.extend(indices.windows(3).enumerate().map(strip)),
        Mode::TriangleFan => super::add_fan(&mut mesh.triangles, &indices),
        _ => mesh.triangles.extend(indices.chunks_exact(3).map(|c| [c[0], c[1], c[2]])),
    }
    Ok(())
}

/// A buffer outside the file: inline as base64, or a file in the same folder.
fn read_uri(uri: &str, folder: &Path) -> Result<Vec<u8>, String> {
    if let Some(data) = uri.strip_prefix("data:") {
        let (_, text) = data.split_once(";base64,").ok_or("a buffer's data URI is not base64")?;
        let engine = base64::engine::general_purpose::STANDARD;
        return engine.decode(text).map_err(|error| format!("a buffer's base64 is damaged: {error}"));
    }
    let name = urlencoding::decode(uri).map_err(|error| error.to_string())?;
    let path = folder.join(name.as_ref());
    std::fs::read(&path).map_err(|error| format!("cannot read the buffer {}: {error}", path.display()))
}
