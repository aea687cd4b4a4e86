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
        ("big_endian.ply", big_endian_ply()),
        ("binary.GLB", glb()),
        ("text.gltf", gltf(&single_node(""), &tetrahedron_bytes(1.0))),
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

fn big_endian_ply() -> Vec<u8> {
    let mut out = b"ply\nformat binary_big_endian 1.0\nelement face 4\nproperty uchar flags\n\
        property list ushort int vertex_indices\nelement vertex 4\nproperty double x\nproperty double y\n\
        property double z\nend_header\n"
        .to_vec();
    for face in FACES {
        out.extend([9, 0, 3]);
        out.extend(face.iter().flat_map(|i| i.to_be_bytes()));
    }
    out.extend(CORNERS.iter().flatten().flat_map(|c| f64::from(*c).to_be_bytes()));
    out
}

/// Positions and 16-bit indices of the tetrahedron: 48 and 24 bytes.
fn tetrahedron_bytes(scale: f32) -> Vec<u8> {
    let mut bytes: Vec<u8> = CORNERS.iter().flatten().flat_map(|c| (scale * c).to_le_bytes()).collect();
    bytes.extend(FACES.iter().flatten().flat_map(|i| (*i as u16).to_le_bytes()));
    bytes
}

/// A scene with the mesh at one node, which has these further members.
fn single_node(members: &str) -> String {
    format!(
        r#""scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0{members}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],{TETRAHEDRON}"#
    )
}

const TETRAHEDRON: &str = r#""bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[2,2,2]},
                 {"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}]"#;

fn gltf(members: &str, buffer: &[u8]) -> Vec<u8> {
    use base64::Engine;
    let data = base64::engine::general_purpose::STANDARD.encode(buffer);
    format!(
        r#"{{"asset":{{"version":"2.0"}},{members},
        "buffers":[{{"byteLength":{},"uri":"data:application/octet-stream;base64,{data}"}}]}}"#,
        buffer.len()
    )
    .into_bytes()
}

/// The tetrahedron doubled in size and halved again by its node.
fn glb() -> Vec<u8> {
    let blob = tetrahedron_bytes(2.0);
    let node = single_node(r#","scale":[0.5,0.5,0.5],"translation":[3,0,0]"#);
    let mut json =
        format!(r#"{{"asset":{{"version":"2.0"}},{node},"buffers":[{{"byteLength":72}}]}}"#).into_bytes();
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

/// Signed volume of the triangles as they came.
fn signed_volume(mesh: &TriangleMesh) -> f64 {
    let tetrahedron = |triangle| {
        let [a, b, c] = mesh.corners(triangle);
        a.dot(b.cross(c)) / 6.0
    };
    (0..mesh.triangles.len()).map(tetrahedron).sum()
}

#[test]
fn a_gltf_scene_is_all_its_nodes_with_their_transforms() {
    let folder = TempDir::new().unwrap();
    // A parent moved by (10, 0, 0) and turned about z, two children with the same mesh: one twice as large, one
    // mirrored. A node outside the scene does not count.
    let members = format!(
        r#""scene":1,"scenes":[{{"nodes":[3]}},{{"nodes":[0]}}],"nodes":[
            {{"children":[1,2],"translation":[10,0,0],"rotation":[0,0,0.7071067811865476,0.7071067811865476]}},
            {{"mesh":0,"scale":[2,2,2]}},
            {{"mesh":0,"matrix":[-1,0,0,0, 0,1,0,0, 0,0,1,0, -5,0,0,1]}},
            {{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],{TETRAHEDRON}"#
    );
    let path = file(&folder, "scene.gltf", gltf(&members, &tetrahedron_bytes(1.0)));
    let mesh = TriangleMesh::load(&path).unwrap();
    assert_eq!(mesh.triangles.len(), 8);
    // The mirrored part still faces outwards.
    assert!((signed_volume(&mesh) - 1.5).abs() < 1e-6);
    let (lower, upper) = mesh.bounds();
    assert!(lower.distance(DVec3::new(8.0, -6.0, 0.0)) < 1e-6, "{lower}");
    assert!(upper.distance(DVec3::new(10.0, 2.0, 2.0)) < 1e-6, "{upper}");
}

#[test]
fn sparse_accessors_replace_values() {
    let folder = TempDir::new().unwrap();
    // The tip of the tetrahedron is raised to 3; and a mesh of zeros with three corners put in.
    let mut bytes = tetrahedron_bytes(1.0);
    bytes.extend([3, 0, 0, 0]);
    bytes.extend([0.0_f32, 0.0, 3.0].iter().flat_map(|c| c.to_le_bytes()));
    bytes.extend([1, 2, 3, 0]);
    bytes.extend(CORNERS[1..].iter().flatten().flat_map(|c| c.to_le_bytes()));
    for (base, sparse, volume) in [
        (
            r#""bufferView":0,"#,
            r#"{"count":1,"indices":{"bufferView":2,"componentType":5121},"values":{"bufferView":3}}"#,
            0.5,
        ),
        (
            "",
            r#"{"count":3,"indices":{"bufferView":4,"componentType":5121},"values":{"bufferView":5}}"#,
            1.0 / 6.0,
        ),
    ] {
        let members = format!(
            r#""scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
            "bufferViews":[{{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":24}},
                {{"buffer":0,"byteOffset":72,"byteLength":1}},{{"buffer":0,"byteOffset":76,"byteLength":12}},
                {{"buffer":0,"byteOffset":88,"byteLength":3}},{{"buffer":0,"byteOffset":92,"byteLength":36}}],
            "accessors":[{{{base}"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,3],"sparse":{sparse}}},
                {{"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}}]"#
        );
        let path = file(&folder, "sparse.gltf", gltf(&members, &bytes));
        assert!((self::volume(&path) - volume).abs() < 1e-6);
    }
}

#[test]
fn faces_of_many_corners_that_are_not_convex_keep_their_shape() {
    let folder = TempDir::new().unwrap();
    // An L-shaped prism of volume 3, in OBJ with negative indices and in PLY.
    let outline = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]];
    let (mut obj, mut ply) = (
        String::new(),
        String::from(
            "ply\nformat ascii 1.0\nelement vertex 12\nproperty float x\nproperty float y\nproperty float z\n\
         element face 8\nproperty list uchar int vertex_indices\nend_header\n",
        ),
    );
    for [x, y] in outline {
        for z in 0..2 {
            writeln!(obj, "v {x} {y} {z}").unwrap();
            writeln!(ply, "{x} {y} {z}").unwrap();
        }
    }
    let mut faces: Vec<Vec<i32>> =
        vec![(0..6).rev().map(|i| 2 * i).collect(), (0..6).map(|i| 2 * i + 1).collect()];
    faces.extend((0..6).map(|i| {
        let j = (i + 1) % 6;
        vec![2 * i, 2 * j, 2 * j + 1, 2 * i + 1]
    }));
    for face in &faces {
        // The last vertex is -1.
        let text: Vec<String> = face.iter().map(|i| (i - 12).to_string()).collect();
        writeln!(obj, "f {}", text.join(" ")).unwrap();
        let text: Vec<String> = face.iter().map(i32::to_string).collect();
        writeln!(ply, "{} {}", face.len(), text.join(" ")).unwrap();
    }
    for (name, text) in [("l.obj", obj), ("l.ply", ply)] {
        let path = file(&folder, name, text);
        let solid = Solid::new(&TriangleMesh::load(&path).unwrap()).unwrap();
        assert_eq!(solid.diagnosis().folds.count, 0, "{name}");
        assert_eq!(solid.diagnosis().covering_faces.count, 0, "{name}");
        assert!((solid.properties().volume - 3.0).abs() < 1e-12, "{name}");
        assert!(!solid.contains(DVec3::new(1.5, 1.5, 0.5)), "{name}");
    }
}

#[test]
fn names_in_other_encodings_and_several_solids_are_read() {
    let folder = TempDir::new().unwrap();
    let mut obj = b"# Gr\xF6\xDFe in Latin-1\no K\xF6rper\n".to_vec();
    CORNERS.iter().for_each(|[x, y, z]| obj.extend(format!("v {x} {y} {z}\n").bytes()));
    FACES.iter().for_each(|t| obj.extend(format!("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1).bytes()));
    assert!((volume(&file(&folder, "latin.obj", &obj)) - 1.0 / 6.0).abs() < 1e-9);

    let mut stl = Vec::new();
    for name in [&b"K\xF6rper"[..], b"second"] {
        let shift = if name == b"second" { 5.0 } else { 0.0 };
        stl.extend([&b"solid "[..], name, b"\n"].concat());
        for face in FACES {
            stl.extend(b"facet normal 0 0 0\nouter loop\n");
            for [x, y, z] in face.map(|i| CORNERS[i as usize]) {
                stl.extend(format!("vertex {} {y} {z}\n", x + shift).bytes());
            }
            stl.extend(b"endloop\nendfacet\n");
        }
        stl.extend([&b"endsolid "[..], name, b"\n"].concat());
    }
    assert!((volume(&file(&folder, "two.stl", &stl)) - 2.0 / 6.0).abs() < 1e-9);

    let ply = String::from_utf8(ascii_ply_header("comment Gr?sse\n")).unwrap();
    let mut ply: Vec<u8> = ply.bytes().map(|b| if b == b'?' { 0xF6 } else { b }).collect();
    CORNERS.iter().for_each(|[x, y, z]| ply.extend(format!("{x} {y} {z}\n").bytes()));
    FACES.iter().for_each(|[a, b, c]| ply.extend(format!("3 {a} {b} {c}\n").bytes()));
    assert!((volume(&file(&folder, "latin.ply", &ply)) - 1.0 / 6.0).abs() < 1e-9);
}

fn ascii_ply_header(comment: &str) -> Vec<u8> {
    format!(
        "ply\nformat ascii 1.0\n{comment}element vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
         element face 4\nproperty list uchar int vertex_indices\nend_header\n"
    )
    .into_bytes()
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
fn issue_only_the_positions_of_an_obj_file_matter() {
    let folder = TempDir::new().unwrap();
    let load = |face: &str| {
        let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf {face}\n");
        TriangleMesh::load_unchecked(file(&folder, "triangle.obj", text))
    };
    for face in ["1 2 3", "1/1/1 2//1 3/1", "-3/-11/-11 2/9/9 3//-11", "1/x 2/ 3//"] {
        assert_eq!(load(face).unwrap().triangles, [[0, 1, 2]], "{face}");
    }
    for face in ["/1 1 2 3", "//1 1 2 3", "/ 1 2 3", "1 2 4", "-4 2 3", "0 2 3", "x/1 2 3"] {
        let error = load(face).unwrap_err().to_string();
        assert!(!error.contains("gave up"), "{face}: {error}");
    }
}

#[test]
fn issue_an_obj_file_is_read_for_its_faces_alone() {
    let folder = TempDir::new().unwrap();
    let others = [
        ("polyline", "l 1 2 3"),
        ("polyline with texture", "vt 0 0\nl 1/1 2/1 4/1"),
        ("points", "p 1 2 3"),
        ("material without a name", "usemtl"),
        ("colour", "v 2 2 2 0.5 0.5 0.5"),
        ("colour with opacity", "v 2 2 2 0.5 0.5 0.5 1"),
    ];
    for (name, line) in others {
        let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n{line}\nf 1 2 3\nf 1 2 4\n");
        let mesh = TriangleMesh::load_unchecked(file(&folder, "corner.obj", text)).expect(name);
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 1, 3]], "{name}");
    }
}

#[test]
fn issue_lines_of_an_obj_file_may_go_on_and_end_in_comments() {
    let folder = TempDir::new().unwrap();
    let texts = [
        ("comments", "v 0 0 0 # first\nv 1 0 0#second\nv 0 1 0\nv 0 0 1\nf 1 2 3 # f 1 2 4\nf 1 2 4\n"),
        ("continued", "v 0 \\\n0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 \\\n  3\nf\\\n1 \\ \n2\\\n4\n"),
        ("continued in DOS", "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nv 0 0 1\r\nf 1 2 \\\r\n3\r\nf 1 2 4\r\n"),
        ("continued at the end", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4 \\"),
        (
            "folders",
            "# made in C:\\meshes\\\nv 0 0 0 # C:\\\nmtllib C:\\meshes\\\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n",
        ),
    ];
    for (name, text) in texts {
        let mesh = TriangleMesh::load_unchecked(file(&folder, "lines.obj", text)).expect(name);
        assert_eq!(mesh.vertices, [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z], "{name}");
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 1, 3]], "{name}");
    }
}

#[test]
fn an_obj_vertex_is_divided_by_its_weight() {
    let folder = TempDir::new().unwrap();
    let text = "v 0 0 0 1\nv 2 0 0 2\nv 0 1 0\nf 1 2 3\n";
    let mesh = TriangleMesh::load_unchecked(file(&folder, "weights.obj", text)).unwrap();
    assert_eq!(mesh.vertices[1], DVec3::X);
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

#[test]
fn issue_a_binary_file_shorter_than_its_header_is_refused() {
    let folder = TempDir::new().unwrap();
    for length in 0..12_u32 {
        let mut bytes = glb();
        bytes[8..12].copy_from_slice(&length.to_le_bytes());
        let error = TriangleMesh::load(file(&folder, "short.glb", bytes)).unwrap_err().to_string();
        assert!(error.contains(&format!("{length} bytes, fewer than the header")), "{error}");
    }
}
