//! glTF 2.0, text and binary: all triangles of the default scene, in its frame.

use super::{Parsed, accessor, polygon};
use crate::TriangleMesh;
use base64::Engine;
use glam::{DMat4, DQuat, DVec3, Mat4};
use gltf::buffer::Source;
use gltf::json::Root;
use gltf::json::validation::Checked;
use gltf::mesh::Mode;
use gltf::scene::Transform;
use gltf::{Document, Gltf, Node, Primitive, Semantic};
use std::path::Path;

/// Most vertices, and faces: nodes can place a mesh so often that a file of a megabyte needs all memory. A choice: together
/// they take 1.8 GB.
const MOST: usize = 50_000_000;

pub(super) fn parse(bytes: &[u8], folder: &Path) -> Parsed {
    check_length(bytes)?;
    let Gltf { document, blob } =
        Gltf::from_slice_without_validation(bytes).map_err(|error| error.to_string())?;
    let json = document.into_json();
    check_positions(&json)?;
    let gltf = Document::from_json(json).map_err(|error| error.to_string())?;
    let buffers = gltf
        .buffers()
        .map(|buffer| match buffer.source() {
            Source::Bin => blob.clone().ok_or_else(|| "the binary chunk is missing".to_owned()),
            Source::Uri(uri) => read_uri(uri, folder),
        })
        .collect::<Result<Vec<_>, _>>()?;
    let scene = gltf.default_scene().or_else(|| gltf.scenes().next()).ok_or("the file has no scene")?;
    let primitives = placed(&gltf, scene.nodes().collect())?;
    let count = |size: fn(&Primitive) -> usize| {
        primitives.iter().fold(0, |sum: usize, (primitive, _)| sum.saturating_add(size(primitive)))
    };
    if count(vertices).max(count(faces)) > MOST {
        return Err(format!("its nodes place more than {MOST} vertices or faces; leave out copies"));
    }
    let mut mesh = TriangleMesh::default();
    for (primitive, pose) in &primitives {
        add_primitive(&mut mesh, primitive, pose, &buffers)?;
    }
    Ok(mesh)
}

/// All primitives of surfaces below the nodes `roots`, and their poses in the scene.
fn placed<'a>(gltf: &Document, roots: Vec<Node<'a>>) -> Result<Vec<(Primitive<'a>, DMat4)>, String> {
    // Nodes form a forest in valid files; in others, a cycle must not run for ever.
    let mut is_placed = vec![false; gltf.nodes().len()];
    let mut open: Vec<(Node, DMat4)> = roots.into_iter().map(|node| (node, DMat4::IDENTITY)).collect();
    let mut primitives = Vec::new();
    while let Some((node, parent)) = open.pop() {
        if std::mem::replace(&mut is_placed[node.index()], true) {
            return Err(format!(
                "node {} has two parents, or is its own; nodes must form trees",
                node.index()
            ));
        }
        let pose = parent * pose_in_parent(&node);
        let all = node.mesh().into_iter().flat_map(|mesh| mesh.primitives());
        primitives.extend(all.filter(|primitive| has_faces(primitive)).map(|primitive| (primitive, pose)));
        open.extend(node.children().map(|child| (child, pose)));
    }
    Ok(primitives)
}

fn has_faces(primitive: &Primitive) -> bool {
    matches!(primitive.mode(), Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)
}

/// Number of vertices of a primitive, as announced.
fn vertices(primitive: &Primitive) -> usize {
    primitive.get(&Semantic::Positions).map_or(0, |positions| positions.count())
}

/// Number of faces of a primitive, as announced.
fn faces(primitive: &Primitive) -> usize {
    let corners = primitive.indices().map_or(vertices(primitive), |indices| indices.count());
    if primitive.mode() == Mode::Triangles { corners / 3 } else { corners }
}

/// The crate gltf subtracts the header's size from the length that a binary file claims, whatever that is.
fn check_length(bytes: &[u8]) -> Result<(), String> {
    const HEADER: usize = 12;
    let Some(length) = bytes.strip_prefix(b"glTF").and_then(|rest| rest.get(4..8)) else { return Ok(()) };
    match u32::from_le_bytes([length[0], length[1], length[2], length[3]]) as usize {
        length if length < HEADER => {
            Err(format!("the header says that the file has {length} bytes, fewer than the header itself"))
        }
        _ => Ok(()),
    }
}

/// The crate gltf panics at positions that are an accessor which does not exist, before it tells that.
fn check_positions(json: &Root) -> Result<(), String> {
    let positions = &Checked::Valid(Semantic::Positions);
    for (index, mesh) in json.meshes.iter().enumerate() {
        let accessors = mesh.primitives.iter().filter_map(|primitive| primitive.attributes.get(positions));
        for accessor in accessors.map(|accessor| accessor.value()) {
            if accessor >= json.accessors.len() {
                return Err(format!(
                    "the positions of mesh {index} are accessor {accessor} of {}, counted from 0",
                    json.accessors.len()
                ));
            }
        }
    }
    Ok(())
}

/// Composed in double precision, which keeps rotated right angles right.
fn pose_in_parent(node: &Node) -> DMat4 {
    match node.transform() {
        Transform::Matrix { matrix } => Mat4::from_cols_array_2d(&matrix).as_dmat4(),
        Transform::Decomposed { translation, rotation, scale } => {
            let [translation, scale] = [translation, scale].map(|v| DVec3::from_array(v.map(f64::from)));
            let rotation = DQuat::from_array(rotation.map(f64::from));
            // A quaternion of zeros has no direction; it is not finite then, and so are the vertices.
            DMat4::from_scale_rotation_translation(scale, rotation.normalize(), translation)
        }
    }
}

fn add_primitive(
    mesh: &mut TriangleMesh,
    primitive: &Primitive,
    pose: &DMat4,
    buffers: &[Vec<u8>],
) -> Result<(), String> {
    let accessor = primitive.get(&Semantic::Positions).ok_or("a primitive has no positions")?;
    let positions = accessor::positions(&accessor, buffers)?;
    let base = mesh.vertices.len() as u32;
    let count = positions.len() as u32;
    mesh.vertices.extend(positions.into_iter().map(|p| pose.transform_point3(p)));
    let indices: Vec<u32> = match primitive.indices() {
        // An index that is out of range of its own primitive must not find a vertex of the next one.
        Some(indices) => accessor::indices(&indices, buffers)?
            .into_iter()
            .map(|i| if i < count { base + i } else { u32::MAX })
            .collect(),
        None => (base..base + count).collect(),
    };
    let mut triangles = Vec::new();
    let strip = |(i, w): (usize, &[u32])| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] };
    match primitive.mode() {
        Mode::TriangleStrip => triangles.extend(indices.windows(3).enumerate().map(strip)),
        Mode::TriangleFan => polygon::add_fan(&mut triangles, &indices),
        _ => triangles.extend(indices.chunks_exact(3).map(|c| [c[0], c[1], c[2]])),
    }
    if pose.determinant() < 0.0 {
        // A mirror image has the other orientation.
        triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }
    mesh.triangles.append(&mut triangles);
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
    let failed = |error: std::io::Error| format!("cannot read the buffer {}: {error}", path.display());
    if !std::fs::metadata(&path).map_err(failed)?.is_file() {
        return Err(format!("the buffer {} is no regular file", path.display()));
    }
    std::fs::read(&path).map_err(failed)
}
