//! Mesh files of every format, and files that are none.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

mod common;

use glam::DVec3;
use packer::{MeshError, Solid, TriangleMesh};
use std::fmt::Write;
use std::path::PathBuf;
use tempfile::TempDir;

/// A tetrahedron of volume 1/6.
const CORNERS: [[f32; 3]; 4] = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
const FACES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

fn file(folder: &TempDir, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, content).unwrap();
    path
}

fn volume(path: &PathBuf) -> f64 {
    Solid::new(&TriangleMesh::load(path).unwrap()).unwrap().properties().volume
}

#[test]
fn the_same_tetrahedron_comes_from_every_format() {
    let folder = TempDir::new().unwrap();
    let mut ascii_stl = String::from("solid tetrahedron\n");
    let mut binary_stl = vec![0; 80];
    binary_stl.extend(4_u32.to_le_bytes());
    for face in FACES {
        ascii_stl += "facet normal 0 0 0\nouter loop\n";
        binary_stl.extend([0; 12]);
        for [x, y, z] in face.map(|i| CORNERS[i as usize]) {
            writeln!(ascii_stl, "vertex {x} {y} {z}").unwrap();
            binary_stl.extend([x, y, z].iter().flat_map(|c| c.to_le_bytes()));
        }
        ascii_stl += "endloop\nendfacet\n";
        binary_stl.extend([0; 2]);
    }
    ascii_stl += "endsolid tetrahedron\n";

    let mut ply = String::from(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty double z\n\
         property uchar red\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n",
    );
    CORNERS.iter().for_each(|[x, y, z]| writeln!(ply, "{x} {y} {z} 7").unwrap());
    FACES.iter().for_each(|[a, b, c]| writeln!(ply, "3 {a} {b} {c}").unwrap());

    for (name, content) in [
        ("ascii.stl", ascii_stl.into_bytes()),
        ("binary.stl", binary_stl),
        ("ascii.ply", ply.into_bytes()),
        ("binary.ply", binary_ply()),
        ("binary.GLB", glb()),
    ] {
        let path = file(&folder, name, content);
        assert!((volume(&path) - 1.0 / 6.0).abs() < 1e-9, "{name}");
    }
}

fn binary_ply() -> Vec<u8> {
    let mut out =
        b"ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
        property float z\nelement face 4\nproperty list uchar uint vertex_index\nend_header\n"
            .to_vec();
    out.extend(CORNERS.iter().flatten().flat_map(|c| c.to_le_bytes()));
    for face in FACES {
        out.push(3);
        out.extend(face.iter().flat_map(|i| i.to_le_bytes()));
    }
    out
}

/// The tetrahedron doubled in size and halved again by its node.
fn glb() -> Vec<u8> {
    let mut blob: Vec<u8> = CORNERS.iter().flatten().flat_map(|c| (2.0 * c).to_le_bytes()).collect();
    blob.extend(FACES.iter().flatten().flat_map(|i| (*i as u16).to_le_bytes()));
    let json = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
        "nodes":[{"mesh":0,"scale":[0.5,0.5,0.5],"translation":[3,0,0]}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
        "buffers":[{"byteLength":72}],
        "bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[2,2,2]},
                     {"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}]}"#;
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut out = b"glTF".to_vec();
    let total = 12 + 8 + json.len() + 8 + blob.len();
    out.extend(
        [2, total as u32, json.len() as u32, 0x4E4F_534A].iter().flat_map(|word: &u32| word.to_le_bytes()),
    );
    out.extend(json);
    out.extend([blob.len() as u32, 0x004E_4942].iter().flat_map(|word| word.to_le_bytes()));
    out.extend(blob);
    out
}

#[test]
fn polygons_and_groups_of_an_obj_file_become_one_mesh() {
    let folder = TempDir::new().unwrap();
    let mut text = String::from("mtllib missing.mtl\no lower\n");
    for i in 0..8 {
        writeln!(text, "v {} {} {}", i & 1, i >> 1 & 1, i >> 2 & 1).unwrap();
    }
    text += "usemtl red\ng front\nf 1 3 4 2\nf -4 -3 -1 -2\ng rest\nf 1/1/1 2//1 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    let path = file(&folder, "cube.obj", text);
    let mesh = TriangleMesh::load(&path).unwrap();
    assert_eq!(mesh.triangles.len(), 12);
    assert!((volume(&path) - 1.0).abs() < 1e-12);
}

#[test]
fn obj_coordinates_keep_double_precision() {
    let folder = TempDir::new().unwrap();
    let path = file(&folder, "far.obj", "v 1000000.125 0 0\nv 1 0 0\nv 0 0.1 0\nf 1 2 3\n");
    let mesh = TriangleMesh::load(path).unwrap();
    assert_eq!(mesh.vertices[0].x, 1_000_000.125);
    assert_eq!(mesh.vertices[2], DVec3::new(0.0, 0.1, 0.0));
}

#[test]
fn bad_files_are_named() {
    let folder = TempDir::new().unwrap();
    let error = |path: &PathBuf| TriangleMesh::load(path).unwrap_err();
    assert!(matches!(error(&folder.path().join("missing.obj")), MeshError::Io { .. }));
    assert!(matches!(error(&folder.path().join("missing")), MeshError::Io { .. }));
    assert!(matches!(error(&file(&folder, "notes.txt", "hello")), MeshError::UnknownFormat { .. }));
    assert!(matches!(error(&file(&folder, "points.obj", "v 0 0 0\nv 1 0 0\n")), MeshError::NoTriangles));
    let nan = file(&folder, "nan.obj", "v 0 0 0\nv 1 NaN 0\nv 0 1 0\nf 1 2 3\n");
    assert!(matches!(error(&nan), MeshError::VertexNotFinite { index: 1, .. }));
    let noise: Vec<u8> = (0..997_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    for extension in ["obj", "stl", "ply", "gltf", "glb"] {
        let empty = file(&folder, &format!("empty.{extension}"), "");
        assert!(matches!(error(&empty), MeshError::EmptyFile { .. }), "{extension}");
        let _ = error(&file(&folder, &format!("noise.{extension}"), &noise));
        let _ = error(&file(&folder, &format!("text.{extension}"), "Dear Sir or Madam,\n"));
    }
}

#[test]
fn truncated_files_never_panic() {
    let folder = TempDir::new().unwrap();
    for (name, content) in [("a.ply", binary_ply()), ("a.glb", glb())] {
        for length in (1..content.len()).step_by(7) {
            let path = file(&folder, name, &content[..length]);
            let _ = TriangleMesh::load(&path).map(|mesh| Solid::new(&mesh));
        }
    }
}
