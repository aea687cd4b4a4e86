//! Mesh files as other programs write them, good and bad.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail by panicking")]

mod common;

use base64::Engine;
use common::cuboid;
use glam::DVec3;
use packer::{MeshError, TriangleMesh};
use std::fmt::Write;
use tempfile::TempDir;

fn cube() -> TriangleMesh {
    cuboid(DVec3::ZERO, DVec3::ONE)
}

fn load(name: &str, content: &[u8]) -> Result<TriangleMesh, MeshError> {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, content).unwrap();
    TriangleMesh::load(path)
}

/// Reads the cube from `content`.
fn assert_is_cube(what: &str, name: &str, content: &[u8]) {
    let mesh = load(name, content).unwrap_or_else(|error| panic!("{what}: {error}"));
    assert_eq!((mesh.bounds(), mesh.triangles.len()), ((DVec3::ZERO, DVec3::ONE), 12), "{what}");
}

fn ascii_stl(normal: &str) -> String {
    let mut text = String::from("solid cube\n");
    let mesh = cube();
    for triangle in 0..12 {
        let [a, b, c] = mesh.corners(triangle);
        write!(text, "facet normal {normal}\nouter loop\n").unwrap();
        [a, b, c].iter().for_each(|p| writeln!(text, "vertex {} {} {}", p.x, p.y, p.z).unwrap());
        text += "endloop\nendfacet\n";
    }
    text + "endsolid cube\n"
}

fn binary_stl(header: &[u8]) -> Vec<u8> {
    let mut bytes = [header, &vec![b' '; 80 - header.len()], &12_u32.to_le_bytes()].concat();
    let mesh = cube();
    for triangle in 0..12 {
        bytes.extend([0; 12]);
        let numbers = mesh.corners(triangle).into_iter().flat_map(|p| p.to_array().map(|x| x as f32));
        bytes.extend(numbers.flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    bytes
}

fn obj() -> String {
    let mesh = cube();
    let vertices = mesh.vertices.iter().map(|p| format!("v {} {} {}\n", p.x, p.y, p.z));
    let faces = mesh.triangles.iter().map(|t| format!("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1));
    vertices.chain(faces).collect()
}

fn ply() -> String {
    let mesh = cube();
    let header = "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n\
                  element face 12\nproperty list uchar int vertex_indices\nend_header\n";
    let vertices = mesh.vertices.iter().map(|p| format!("{} {} {}\n", p.x, p.y, p.z));
    let faces = mesh.triangles.iter().map(|t| format!("3 {} {} {}\n", t[0], t[1], t[2]));
    std::iter::once(header.to_owned()).chain(vertices).chain(faces).collect()
}

/// The cube in a buffer, without scene and nodes.
fn gltf(scene: &serde_json::Value, nodes: &serde_json::Value) -> Vec<u8> {
    let mesh = cube();
    let mut buffer: Vec<u8> =
        mesh.vertices.iter().flat_map(|p| p.as_vec3().to_array()).flat_map(f32::to_le_bytes).collect();
    buffer.extend(mesh.triangles.iter().flatten().flat_map(|i| (*i as u16).to_le_bytes()));
    let data = base64::engine::general_purpose::STANDARD.encode(&buffer);
    let file = serde_json::json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": scene }],
        "nodes": nodes,
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "buffers": [{ "byteLength": buffer.len(), "uri": format!("data:application/octet-stream;base64,{data}") }],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": 96 },
            { "buffer": 0, "byteOffset": 96, "byteLength": 72 },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1] },
            { "bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR" },
        ],
    });
    serde_json::to_vec(&file).unwrap()
}

/// The first vertex of an OBJ file was lost, and the others moved up; files of the other kinds were refused.
#[test]
fn issue_text_may_begin_with_a_byte_order_mark() {
    let one = gltf(&serde_json::json!([0]), &serde_json::json!([{ "mesh": 0 }]));
    for (name, content) in [
        ("a.obj", obj().into_bytes()),
        ("a.stl", ascii_stl("0 0 1").into_bytes()),
        ("a.ply", ply().into_bytes()),
        ("a.gltf", one),
    ] {
        assert_is_cube(name, name, &content);
        assert_is_cube("with a mark", name, &[b"\xEF\xBB\xBF", &content[..]].concat());
    }
    // What looks like a mark may be the beginning of a binary header.
    assert_is_cube("binary", "a.stl", &binary_stl(b"\xEF\xBB\xBF"));
}

#[test]
fn issue_stl_files_of_other_programs_are_read() {
    for normal in ["nan nan nan", "-nan(ind) 0 0", "1.#QNAN 0 0", "inf 0 0"] {
        assert_is_cube(normal, "a.stl", ascii_stl(normal).as_bytes());
    }
    assert_is_cube("a blank line first", "a.stl", format!("\r\n  \n{}", ascii_stl("0 0 1")).as_bytes());
    for header in [&b"solid cube"[..], b"exported"] {
        assert_is_cube("binary", "a.stl", &binary_stl(header));
        for rest in [&b"\n"[..], &[0; 50], b"made by hand, and kept with care"] {
            assert_is_cube("binary, and more", "a.stl", &[&binary_stl(header), rest].concat());
        }
    }
    let cut = binary_stl(b"solid cube");
    assert!(matches!(load("a.stl", &cut[..cut.len() - 1]), Err(MeshError::Parse { .. })));
}

/// A megabyte of nodes took all memory.
#[test]
fn issue_a_gltf_file_places_no_more_than_memory_holds() {
    let nodes = vec![serde_json::json!({ "mesh": 0 }); 501];
    let all: Vec<usize> = (0..nodes.len()).collect();
    let mut file: serde_json::Value =
        serde_json::from_slice(&gltf(&serde_json::json!(all), &serde_json::json!(nodes))).unwrap();
    let zeros = base64::engine::general_purpose::STANDARD.encode(vec![0; 1_200_000]);
    file["buffers"][0] = serde_json::json!({
        "byteLength": 1_200_000, "uri": format!("data:application/octet-stream;base64,{zeros}"),
    });
    file["bufferViews"][0] = serde_json::json!({ "buffer": 0, "byteLength": 1_200_000 });
    file["accessors"][0] = serde_json::json!({
        "bufferView": 0, "componentType": 5126, "count": 100_000, "type": "VEC3", "min": [0, 0, 0], "max": [0, 0, 0],
    });
    let error = load("a.gltf", &serde_json::to_vec(&file).unwrap()).unwrap_err();
    assert!(error.to_string().contains("more than 50000000 vertices or faces"), "{error}");
}

#[test]
fn gltf_nodes_are_trees() {
    let mesh = serde_json::json!({ "mesh": 0 });
    let shared = serde_json::json!([{ "children": [2] }, { "children": [2] }, mesh]);
    let own = serde_json::json!([{ "children": [0] }, { "children": [0] }, mesh]);
    for (scene, nodes, which) in [
        (serde_json::json!([0, 1]), shared, 2),
        (serde_json::json!([0]), own.clone(), 0),
        (serde_json::json!([2, 2]), own, 2),
    ] {
        let error = load("a.gltf", &gltf(&scene, &nodes)).unwrap_err();
        assert!(
            error.to_string().contains(&format!("node {which} has two parents, or is its own")),
            "{error}"
        );
    }
    let tree =
        serde_json::json!([{ "children": [1, 2] }, { "mesh": 0 }, { "translation": [2, 0, 0], "mesh": 0 }]);
    assert_eq!(load("a.gltf", &gltf(&serde_json::json!([0]), &tree)).unwrap().triangles.len(), 24);
}

/// The reader panicked, and said nothing but that.
#[test]
fn issue_positions_without_an_accessor_are_named() {
    let file = gltf(&serde_json::json!([0]), &serde_json::json!([{ "mesh": 0 }]));
    for (accessors, told) in [(0, "accessor 2 of 0"), (2, "accessor 2 of 2")] {
        let mut file: serde_json::Value = serde_json::from_slice(&file).unwrap();
        file["accessors"].as_array_mut().unwrap().truncate(accessors);
        file["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 2.into();
        let error = load("a.gltf", &serde_json::to_vec(&file).unwrap()).unwrap_err().to_string();
        assert!(error.contains("positions of mesh 0") && error.contains(told), "{error}");
    }
}
