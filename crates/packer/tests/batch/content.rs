//! What is packed again, and what is left alone.

use super::*;
use ist::SpherePacking;
use std::fs::{metadata, read, remove_file};

/// What changes when a file is written anew.
fn identity(path: &Path) -> (std::time::SystemTime, u64) {
    let metadata = metadata(path).unwrap();
    #[cfg(unix)]
    let number = std::os::unix::fs::MetadataExt::ino(&metadata);
    #[cfg(not(unix))]
    let number = 0;
    (metadata.modified().unwrap(), number)
}

#[test]
fn every_mesh_gets_the_packing_that_pack_gives() {
    let folder = folder();
    let at = folder.path();
    let report = batch(at, &[]);
    assert_eq!(counts(&report), [8, 0, 0]);
    assert_eq!(mesh(&report, "rings/thin.obj")["spheres"], 40);
    assert_eq!(names(&at.join("out")), OUTPUTS);
    for name in OUTPUTS {
        let input = format!("in/{}", name.strip_suffix(".ist").unwrap());
        assert!(run(at, &["pack", &input, "-o", "single.ist", "-n", "40"]).status.success());
        assert!(read(at.join("single.ist")).unwrap() == read(at.join("out").join(name)).unwrap(), "{name}");
    }
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let folder = folder();
    let at = folder.path();
    let with_threads = |count: &str, out: &str| {
        let output = run(at, &["batch", "in", "-o", out, "-n", "40", "--threads", count]);
        assert!(output.status.success(), "{output:?}");
        contents(&at.join(out))
    };
    let one = with_threads("1", "one");
    assert!(one == with_threads("3", "three") && one == with_threads("20", "twenty"));
}

#[test]
fn what_is_packed_is_not_touched_again() {
    let folder = folder();
    let at = folder.path();
    batch(at, &[]);
    let before = OUTPUTS.map(|name| identity(&at.join("out").join(name)));
    // A mesh that is written again with the same content is the same mesh.
    let text = read(at.join("in/a.obj")).unwrap();
    write(at.join("in/a.obj"), text);
    let report = batch(at, &[]);
    assert_eq!(counts(&report), [0, 8, 0]);
    assert_eq!(mesh(&report, "a.obj")["spheres"], 40);
    assert_eq!(before, OUTPUTS.map(|name| identity(&at.join("out").join(name))));
}

#[test]
fn changed_options_pack_again() {
    let folder = folder();
    let at = folder.path();
    batch(at, &[]);
    let output = run(at, &["batch", "in", "-o", "out", "-n", "41", "--json"]);
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(counts(&report), [8, 0, 0]);
    assert_eq!(SpherePacking::load(at.join("out/a.obj.ist")).unwrap().spheres().len(), 41);
    assert_eq!(counts(&batch(at, &["--coverage", "0.5"])), [8, 0, 0]);
    assert_eq!(counts(&batch(at, &["--coverage", "0.5"])), [0, 8, 0]);
    assert_eq!(counts(&batch(at, &["--min-radius", "0.01"])), [8, 0, 0]);
}

#[test]
fn a_changed_mesh_is_packed_again_and_no_other() {
    let folder = folder();
    let at = folder.path();
    batch(at, &[]);
    write(at.join("in/z.stl"), ascii_stl(&cuboid(1.0, 1.0, 6.0)));
    let report = batch(at, &[]);
    assert_eq!(counts(&report), [1, 7, 0]);
    assert_eq!(mesh(&report, "z.stl")["status"], "packed");
}

#[test]
fn a_changed_buffer_beside_a_gltf_file_is_noticed() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let json = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
        "buffers":[{"byteLength":72,"uri":"shape.bin"}],
        "bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[9,9,9]},
                     {"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}]}"#;
    let buffer = |size: f32| -> Vec<u8> {
        let corners = [0., 0., 0., size, 0., 0., 0., size, 0., 0., 0., size];
        let faces = [0_u16, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3];
        corners
            .iter()
            .flat_map(|c| c.to_le_bytes())
            .chain(faces.iter().flat_map(|i| i.to_le_bytes()))
            .collect()
    };
    write(at.join("in/shape.gltf"), json);
    write(at.join("in/shape.bin"), buffer(1.0));
    assert_eq!(counts(&batch(at, &[])), [1, 0, 0]);
    assert_eq!(counts(&batch(at, &[])), [0, 1, 0]);
    write(at.join("in/shape.bin"), buffer(2.0));
    assert_eq!(counts(&batch(at, &[])), [1, 0, 0]);
}

#[test]
fn damaged_outputs_are_made_again() {
    let folder = folder();
    let at = folder.path();
    batch(at, &[]);
    let whole = contents(&at.join("out"));
    let damaged = |name: &str, damage: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = whole[name].clone();
        damage(&mut bytes);
        write(at.join("out").join(name), bytes);
    };
    damaged("a.obj.ist", &|bytes| bytes.truncate(100));
    damaged("a.stl.ist", &|bytes| bytes.clear());
    damaged("z.stl.ist", &|bytes| bytes[200] ^= 1);
    damaged("B.OBJ.ist", &|bytes| bytes[9] ^= 1);
    remove_file(at.join("out/rings/thin.obj.ist")).unwrap();
    assert_eq!(counts(&batch(at, &[])), [5, 3, 0]);
    assert!(contents(&at.join("out")) == whole);
}

#[test]
fn what_the_program_did_not_make_is_not_replaced() {
    let folder = folder();
    let at = folder.path();
    write(at.join("out/a.obj.ist"), "shopping list");
    let foreign = SpherePacking::new(
        vec![ist::InnerSphere::solid_ball(glam::Vec3::ZERO, 1.0, glam::Vec3::X)],
        ist::SolidProperties::ball(1.0),
    );
    let foreign = foreign.unwrap().to_bytes();
    write(at.join("out/z.stl.ist"), &foreign);
    std::fs::create_dir_all(at.join("out/B.OBJ.ist")).unwrap();
    write(at.join("out/other.ist"), "kept");
    let report = batch(at, &[]);
    assert_eq!(counts(&report), [5, 0, 3]);
    for (input, message) in [
        ("a.obj", "a.obj.ist is no .ist file and is not overwritten; move it away"),
        ("z.stl", "was not made by this program"),
        ("B.OBJ", "is a folder"),
    ] {
        let error = mesh(&report, input)["error"].as_str().unwrap();
        assert!(error.contains(message), "{error}");
    }
    let after = contents(&at.join("out"));
    assert_eq!(after["a.obj.ist"], b"shopping list");
    assert_eq!(after["other.ist"], b"kept");
    assert!(after["z.stl.ist"] == foreign);
}

#[test]
fn outputs_of_meshes_that_are_gone_stay() {
    let folder = folder();
    let at = folder.path();
    batch(at, &[]);
    let before = contents(&at.join("out"));
    remove_file(at.join("in/a.obj")).unwrap();
    std::fs::remove_dir_all(at.join("in/rings")).unwrap();
    assert_eq!(counts(&batch(at, &[])), [0, 4, 0]);
    assert!(contents(&at.join("out")) == before);
}
