//! The program `packer`, from outside.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]
#![cfg(feature = "cli")]

mod common;

use ist::SpherePacking;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

fn packer<const N: usize>(folder: &Path, arguments: [&str; N]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_packer")).current_dir(folder).args(arguments).output().unwrap()
}

/// A folder with a mesh `cube.obj` in it.
fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    let mut text = String::new();
    let cube = common::cuboid(glam::DVec3::ZERO, glam::DVec3::ONE);
    cube.vertices.iter().for_each(|v| text += &format!("v {} {} {}\n", v.x, v.y, v.z));
    cube.triangles.iter().for_each(|t| text += &format!("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1));
    std::fs::write(folder.path().join("cube.obj"), text).unwrap();
    folder
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn json(output: &Output) -> serde_json::Value {
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn pack_writes_a_packing_and_reports_it() {
    let folder = folder();
    let at = folder.path();
    let output =
        packer(at, ["pack", "cube.obj", "-o", "cube.ist", "--spheres", "60", "--threads", "1", "--json"]);
    assert!(output.status.success(), "{output:?}");
    assert!(output.stderr.is_empty(), "no progress bar without a terminal");
    let report = json(&output);
    assert_eq!(report["spheres"], 60);
    assert_eq!(report["stop"], "sphere count");
    let packing = SpherePacking::load(at.join("cube.ist")).unwrap();
    assert_eq!(packing.spheres().len(), 60);
    assert!(packing.provenance().source.starts_with("cube.obj "));
    assert_eq!(names(at), ["cube.ist", "cube.obj"]);

    let first = std::fs::read(at.join("cube.ist")).unwrap();
    assert!(packer(at, ["pack", "cube.obj", "-o", "cube.ist", "--spheres", "60"]).status.success());
    assert!(first == std::fs::read(at.join("cube.ist")).unwrap(), "threads changed the file");
}

#[test]
fn info_shows_a_packing_and_writes_its_table() {
    let folder = folder();
    let at = folder.path();
    assert!(packer(at, ["pack", "cube.obj", "-o", "cube.ist", "-n", "9"]).status.success());
    let output = packer(at, ["info", "cube.ist", "--json", "--csv", "cube.csv"]);
    assert_eq!(json(&output)["spheres"], 9);
    let csv = std::fs::read_to_string(at.join("cube.csv")).unwrap();
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some("x,y,z,radius,cell_volume,nx,ny,nz"));
    let rows: Vec<Vec<f32>> = lines.map(|l| l.split(',').map(|x| x.parse().unwrap()).collect()).collect();
    assert!(rows.len() == 9 && rows.iter().all(|row| row.len() == 8));
    let text = String::from_utf8(packer(at, ["info", "cube.ist"]).stdout).unwrap();
    assert!(text.contains("9 spheres") && text.contains("rapier-ist-packer"), "{text}");
}

#[test]
fn check_tells_good_meshes_from_bad_ones() {
    let folder = folder();
    let at = folder.path();
    let output = packer(at, ["check", "cube.obj", "--json"]);
    assert!(output.status.success());
    assert_eq!(
        (json(&output)["packable"].as_bool(), json(&output)["triangles"].as_u64()),
        (Some(true), Some(12))
    );
    let text = std::fs::read_to_string(at.join("cube.obj")).unwrap();
    let open = text.rsplit_once("f ").unwrap().0;
    std::fs::write(at.join("open.obj"), open).unwrap();
    let output = packer(at, ["check", "open.obj", "--json"]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(json(&output)["packable"], false);
    assert!(json(&output)["error"].as_str().unwrap().contains("3 open edges"));
}

#[test]
fn bad_input_gives_a_message_and_status_2_and_leaves_nothing_behind() {
    let folder = folder();
    let at = folder.path();
    let text = std::fs::read_to_string(at.join("cube.obj")).unwrap();
    std::fs::write(at.join("empty.obj"), "").unwrap();
    std::fs::write(at.join("noise.stl"), [7_u8; 300]).unwrap();
    std::fs::write(at.join("notes.txt"), "hello").unwrap();
    std::fs::write(at.join("open.obj"), text.rsplit_once("f ").unwrap().0).unwrap();
    std::fs::write(at.join("nan.obj"), text.replacen("v 0 0 0", "v 0 NaN 0", 1)).unwrap();
    let before = names(at);
    for (arguments, message) in [
        (vec!["pack", "missing.obj", "-o", "out.ist"], "cannot read missing.obj"),
        (vec!["pack", "empty.obj", "-o", "out.ist"], "is empty"),
        (vec!["pack", "noise.stl", "-o", "out.ist"], "not readable as STL"),
        (vec!["pack", "notes.txt", "-o", "out.ist"], "no mesh file known here"),
        (vec!["pack", "open.obj", "-o", "out.ist"], "open edges"),
        (vec!["pack", "nan.obj", "-o", "out.ist"], "NaN"),
        (vec!["pack", "cube.obj", "-o", "out.ist", "--spheres", "0"], "zero spheres"),
        (vec!["pack", "cube.obj", "-o", "out.ist", "--coverage", "1.5"], "coverage 1.5"),
        (vec!["pack", "cube.obj", "-o", "out.ist", "--coverage", "-1"], "coverage -1"),
        (vec!["pack", "cube.obj", "-o", "out.ist", "--coverage", "NaN"], "coverage NaN"),
        (vec!["pack", "cube.obj", "-o", "out.ist", "--threads", "0"], "zero threads"),
        (vec!["pack", "cube.obj", "-o", "nowhere/out.ist"], "output folder nowhere does not exist"),
        (vec!["pack", "cube.obj", "-o", "."], "is a folder"),
        (vec!["pack", "cube.obj"], "--output"),
        (vec!["info", "cube.obj"], "not an .ist file"),
        (vec!["info", "missing.ist"], "cannot read missing.ist"),
    ] {
        let output =
            Command::new(env!("CARGO_BIN_EXE_packer")).current_dir(at).args(&arguments).output().unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {stderr}");
        assert!(stderr.contains(message), "{arguments:?}: {stderr}");
        assert!(!stderr.contains("panicked") && output.stdout.is_empty(), "{arguments:?}: {stderr}");
    }
    assert_eq!(names(at), before);
}

#[test]
fn help_has_examples() {
    let help = String::from_utf8(packer(Path::new("."), ["--help"]).stdout).unwrap();
    assert!(help.contains("packer pack bunny.obj -o bunny.ist"), "{help}");
}
