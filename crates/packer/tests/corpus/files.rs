//! Files that are cut off, mislabelled, or lie about what is in them.

use crate::common::cuboid;
use crate::{guarded, variant};
use glam::DVec3;
use packer::{Solid, TriangleMesh};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A cube in every format: extension and content.
pub(crate) fn cubes() -> Vec<(&'static str, Vec<u8>)> {
    let cube = cuboid(DVec3::ZERO, DVec3::ONE);
    let (mut obj, mut ascii_stl) = (String::new(), String::from("solid cube\n"));
    let header = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n\
             element face 12\nproperty list uchar int vertex_indices\nend_header\n"
        )
    };
    let mut ascii_ply = header("ascii");
    let mut little_ply = header("binary_little_endian").into_bytes();
    let mut big_ply = header("binary_big_endian").into_bytes();
    let mut binary_stl = vec![b' '; 80];
    binary_stl.extend(12_u32.to_le_bytes());
    let mut buffer = Vec::new();
    for v in &cube.vertices {
        writeln!(obj, "v {} {} {}", v.x, v.y, v.z).unwrap();
        writeln!(ascii_ply, "{} {} {}", v.x, v.y, v.z).unwrap();
        for c in v.as_vec3().to_array() {
            little_ply.extend(c.to_le_bytes());
            big_ply.extend(c.to_be_bytes());
            buffer.extend(c.to_le_bytes());
        }
    }
    for (index, t) in cube.triangles.iter().enumerate() {
        writeln!(obj, "f {} {} {}", t[0] + 1, t[1] + 1, t[2] + 1).unwrap();
        writeln!(ascii_ply, "3 {} {} {}", t[0], t[1], t[2]).unwrap();
        little_ply.push(3);
        big_ply.push(3);
        ascii_stl += "facet normal 0 0 0\nouter loop\n";
        binary_stl.extend([0; 12]);
        for (corner, position) in t.iter().zip(cube.corners(index)) {
            little_ply.extend(corner.to_le_bytes());
            big_ply.extend(corner.to_be_bytes());
            buffer.extend((*corner as u16).to_le_bytes());
            writeln!(ascii_stl, "vertex {} {} {}", position.x, position.y, position.z).unwrap();
            binary_stl.extend(position.as_vec3().to_array().iter().flat_map(|c| c.to_le_bytes()));
        }
        ascii_stl += "endloop\nendfacet\n";
        binary_stl.extend([0; 2]);
    }
    ascii_stl += "endsolid cube\n";
    vec![
        ("obj", obj.into_bytes()),
        ("stl", ascii_stl.into_bytes()),
        ("stl", binary_stl),
        ("ply", ascii_ply.into_bytes()),
        ("ply", little_ply),
        ("ply", big_ply),
        ("gltf", gltf(ACCESSORS, &buffer)),
        ("glb", glb(&buffer)),
    ]
}

const ACCESSORS: &str = r#""scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
    "bufferViews":[{"buffer":0,"byteLength":96},{"buffer":0,"byteOffset":96,"byteLength":72}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3","min":[0,0,0],"max":[1,1,1]},
                 {"bufferView":1,"componentType":5123,"count":36,"type":"SCALAR"}]"#;

fn gltf(members: &str, buffer: &[u8]) -> Vec<u8> {
    use base64::Engine;
    let data = base64::engine::general_purpose::STANDARD.encode(buffer);
    format!(
        r#"{{"asset":{{"version":"2.0"}},{members},"buffers":[{{"byteLength":168,"uri":"data:x/y;base64,{data}"}}]}}"#
    )
    .into_bytes()
}

fn glb(buffer: &[u8]) -> Vec<u8> {
    let mut json = format!(r#"{{"asset":{{"version":"2.0"}},{ACCESSORS},"buffers":[{{"byteLength":168}}]}}"#)
        .into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut out = b"glTF".to_vec();
    let length = 28 + json.len() + buffer.len();
    out.extend([2, length as u32, json.len() as u32, 0x4E4F_534A].iter().flat_map(|w: &u32| w.to_le_bytes()));
    out.extend(json);
    out.extend([buffer.len() as u32, 0x004E_4942].iter().flat_map(|w| w.to_le_bytes()));
    out.extend(buffer);
    out
}

/// Writes the content, loads it, and makes it a solid: the names of the errors, or none.
pub(crate) fn outcome(path: &Path, content: &[u8]) -> Option<String> {
    std::fs::write(path, content).unwrap();
    match TriangleMesh::load(path) {
        Ok(mesh) => Solid::new(&mesh).err().map(|error| variant(&error)),
        Err(error) => Some(variant(&error)),
    }
}

#[test]
fn every_format_is_read() {
    let folder = TempDir::new().unwrap();
    for (extension, content) in cubes() {
        let path = folder.path().join(format!("cube.{extension}"));
        assert_eq!(outcome(&path, &content), None, "{extension}");
    }
}

#[test]
fn files_that_are_cut_off_anywhere_are_refused_by_name() {
    let folder = TempDir::new().unwrap();
    for (index, (extension, content)) in cubes().into_iter().enumerate() {
        let path = folder.path().join(format!("{index}.{extension}"));
        guarded(extension, move || {
            assert_eq!(outcome(&path, &[]).as_deref(), Some("EmptyFile"));
            // The last bytes of text files are line ends.
            for length in 1..content.len() - 16 {
                let error = outcome(&path, &content[..length]);
                let expected = ["Parse", "NoTriangles", "OpenEdges", "TooFewTriangles", "IndexOutOfRange"];
                let is_named = error.as_deref().is_some_and(|error| expected.contains(&error));
                assert!(is_named, "{}, {length} bytes: {error:?}", path.display());
            }
        });
    }
}

#[test]
fn files_of_another_kind_are_refused_by_name() {
    let folder = TempDir::new().unwrap();
    for (written_as, content) in cubes() {
        for extension in ["obj", "stl", "ply", "gltf", "glb", "txt", "step", "OBJ~"] {
            let path = folder.path().join(format!("cube.{extension}"));
            let content = content.clone();
            let error = guarded(extension, move || outcome(&path, &content));
            let both_gltf = written_as.starts_with("gl") && extension.starts_with("gl");
            if extension == written_as || both_gltf {
                assert_eq!(error, None, "{written_as} as {extension}");
            } else {
                let expected = ["Parse", "UnknownFormat", "NoTriangles"];
                assert!(
                    error.as_deref().is_some_and(|e| expected.contains(&e)),
                    "{written_as} as {extension}: {error:?}"
                );
            }
        }
    }
}

#[test]
fn paths_that_lead_to_no_file_are_refused_by_name() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    std::fs::create_dir(at.join("folder.obj")).unwrap();
    let error = |path: PathBuf| variant(&TriangleMesh::load(path).unwrap_err());
    assert_eq!(error(at.join("folder.obj")), "NotAFile");
    assert_eq!(error(at.to_path_buf()), "UnknownFormat");
    assert_eq!(error(at.join("missing.stl")), "Io");
    assert_eq!(error(at.join("folder.obj/inside.obj")), "Io");
    assert_eq!(error(PathBuf::new()), "Io");
    #[cfg(unix)]
    {
        // A device without end, under the name of a mesh.
        std::os::unix::fs::symlink("/dev/zero", at.join("endless.obj")).unwrap();
        assert_eq!(error(at.join("endless.obj")), "NotAFile");
        std::os::unix::fs::symlink(at.join("loop.ply"), at.join("loop.ply")).unwrap();
        assert_eq!(error(at.join("loop.ply")), "Io");
    }
}

#[test]
fn lies_in_headers_are_refused_by_name() {
    let ply = |header: &str, rest: &str| format!("ply\n{header}\nend_header\n{rest}").into_bytes();
    let stl = |count: u32| {
        let mut bytes = vec![b' '; 80];
        bytes.extend(count.to_le_bytes());
        bytes.extend([0; 100]);
        bytes
    };
    let scene = |members: &str| gltf(members, &[0; 168]);
    let huge = "9".repeat(400);
    let cases: Vec<(&'static str, &'static str, Vec<u8>, &str)> = vec![
        ("four thousand million triangles", "stl", stl(u32::MAX), "Parse"),
        ("more triangles than there are", "stl", stl(3), "Parse"),
        ("four thousand million vertices", "ply", ply("format ascii 1.0\nelement vertex 4000000000\nproperty float x", "0\n"), "Parse"),
        ("more vertices than a number holds", "ply", ply(&format!("format ascii 1.0\nelement vertex {huge}\nproperty float x"), ""), "Parse"),
        ("a list longer than the file", "ply", ply("format binary_little_endian 1.0\nelement face 1\nproperty list uint int vertex_indices", "\u{7f}\u{7f}\u{7f}\u{7f}"), "Parse"),
        ("a negative list", "ply", ply("format ascii 1.0\nelement face 1\nproperty list char int vertex_indices", "-3 0 1 2\n"), "Parse"),
        ("a format of the future", "ply", ply("format ascii 9.0\nelement vertex 0\nproperty float x", ""), "NoTriangles"),
        ("no format", "ply", ply("element vertex 1\nproperty float x", "0\n"), "Parse"),
        ("an endless value", "obj", format!("v {huge}{huge} 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").into_bytes(), "VertexNotFinite"),
        ("an endless line", "obj", format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf{}\n", " 1 2 3".repeat(100_000)).into_bytes(), "TooFewTriangles"),
        ("index zero", "obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n".to_vec(), "Parse"),
        ("an index out of range", "obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n".to_vec(), "Parse"),
        ("a negative index out of range", "obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -4\n".to_vec(), "Parse"),
        ("words for numbers", "obj", b"v zero 0 0\nf 1 1 1\n".to_vec(), "Parse"),
        ("no text", "obj", vec![0xFF; 500], "NoTriangles"),
        ("no text in the numbers", "obj", b"v \xFF\xFE 0 0\nf 1 1 1\n".to_vec(), "Parse"),
        ("nodes in a circle", "gltf", scene(r#""scenes":[{"nodes":[0]}],"nodes":[{"children":[1]},{"children":[0]}]"#), "Parse"),
        ("a node that is its own child", "gltf", scene(r#""scenes":[{"nodes":[0]}],"nodes":[{"children":[0]}]"#), "Parse"),
        ("a missing node", "gltf", scene(r#""scenes":[{"nodes":[7]}],"nodes":[]"#), "Parse"),
        ("no scene", "gltf", scene(r#""nodes":[]"#), "Parse"),
        ("no JSON", "gltf", b"{{{{".to_vec(), "Parse"),
        ("JSON of something else", "gltf", b"[1,2,3]".to_vec(), "Parse"),
        ("deeply nested JSON", "gltf", "[".repeat(200_000).into_bytes(), "Parse"),
        ("the wrong type of positions", "gltf", scene(&ACCESSORS.replace("5126", "5123")), "Parse"),
        ("two coordinates", "gltf", scene(&ACCESSORS.replace("VEC3", "VEC2")), "Parse"),
        ("indices that are floats", "gltf", scene(&ACCESSORS.replace("5123", "5126")), "Parse"),
        ("more positions than bytes", "gltf", scene(&ACCESSORS.replace("\"count\":8", "\"count\":900")), "Parse"),
        ("positions without end", "gltf", scene(&ACCESSORS.replace("\"count\":8", "\"count\":18446744073709551615")), "Parse"),
        ("no positions at all", "gltf", scene(&ACCESSORS.replace("\"count\":8", "\"count\":0")), "IndexOutOfRange"),
        ("a view beyond its buffer", "gltf", scene(&ACCESSORS.replace("\"byteLength\":72", "\"byteLength\":7200")), "Parse"),
        ("a view that starts at the end of numbers", "gltf", scene(&ACCESSORS.replace("\"byteOffset\":96", "\"byteOffset\":18446744073709551615")), "Parse"),
        ("values without a view", "gltf", scene(&ACCESSORS.replace("{\"bufferView\":0,\"componentType\":5126,\"count\":8", "{\"componentType\":5126,\"count\":4000000000")), "Parse"),
        ("a buffer that is missing", "gltf", br#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[]}],"buffers":[{"byteLength":4,"uri":"nowhere.bin"}]}"#.to_vec(), "Parse"),
        ("a buffer that is a folder", "gltf", br#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[]}],"buffers":[{"byteLength":4,"uri":"."}]}"#.to_vec(), "Parse"),
        ("damaged base64", "gltf", br#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[]}],"buffers":[{"byteLength":4,"uri":"data:x/y;base64,%%%"}]}"#.to_vec(), "Parse"),
        ("a buffer without a chunk", "gltf", br#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[]}],"buffers":[{"byteLength":4}]}"#.to_vec(), "Parse"),
        ("a compression that is not known", "gltf", scene(&format!(r#""extensionsRequired":["KHR_draco_mesh_compression"],"extensionsUsed":["KHR_draco_mesh_compression"],{ACCESSORS}"#)), "Parse"),
        ("a chunk longer than the file", "glb", [&b"glTF\x02\0\0\0\xFF\xFF\xFF\x7F\xFF\xFF\xFF\x7FJSON"[..], b"{}"].concat(), "Parse"),
    ];
    let folder = TempDir::new().unwrap();
    for (name, extension, content, expected) in cases {
        let path = folder.path().join(format!("file.{extension}"));
        let error = guarded(name, move || outcome(&path, &content));
        assert_eq!(error.as_deref(), Some(expected), "{name}");
    }
}

#[cfg(feature = "cli")]
#[test]
fn the_program_names_what_is_wrong_and_leaves_nothing_behind() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    std::fs::create_dir(&out).unwrap();
    let mut files: Vec<(String, Vec<u8>)> = Vec::new();
    for (index, (extension, content)) in cubes().into_iter().enumerate() {
        files.push((format!("half{index}.{extension}"), content[..content.len() / 2].to_vec()));
        files.push((format!("empty{index}.{extension}"), Vec::new()));
        files.push((
            format!("noise{index}.{extension}"),
            content.iter().map(|b| b.wrapping_mul(37) ^ 0x5A).collect(),
        ));
    }
    for (name, content) in files {
        std::fs::write(folder.path().join(&name), content).unwrap();
        for arguments in
            [vec!["pack", &name, "-o", "out/packing.ist", "-n", "20"], vec!["check", &name, "--json"]]
        {
            let output = std::process::Command::new(env!("CARGO_BIN_EXE_packer"))
                .current_dir(folder.path())
                .args(&arguments)
                .output()
                .unwrap();
            let stderr = String::from_utf8(output.stderr).unwrap();
            assert_eq!(output.status.code(), Some(2), "{arguments:?}: {stderr}");
            assert!(stderr.starts_with("error: ") && !stderr.contains("panicked"), "{arguments:?}: {stderr}");
            if arguments[0] == "check" {
                let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
                assert_eq!(report["packable"], false, "{name}");
                assert!(report["error"].as_str().is_some_and(|text| !text.is_empty()), "{name}");
            }
        }
        assert_eq!(std::fs::read_dir(&out).unwrap().count(), 0, "{name}");
    }
}
