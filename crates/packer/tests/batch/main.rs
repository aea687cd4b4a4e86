//! `packer batch`, from outside.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail by panicking")]
#![cfg(feature = "cli")]

#[path = "../common/mod.rs"]
mod common;

mod bad_input;
mod content;
#[cfg(unix)]
mod faults;
mod files;
#[cfg(unix)]
mod interruption;
mod shards;

use glam::DVec3;
use packer::TriangleMesh;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// A command of the program, to be run in `folder`.
fn packer(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_packer"));
    command.current_dir(folder).args(arguments);
    command
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    packer(folder, arguments).output().unwrap()
}

/// The report of `packer batch in -o out -n 40 --json` with further arguments.
fn batch(folder: &Path, more: &[&str]) -> Value {
    let output = run(folder, &[&["batch", "in", "-o", "out", "-n", "40", "--json"], more].concat());
    assert!(output.stderr.is_empty() || output.status.code() == Some(2), "{output:?}");
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {output:?}"))
}

/// Packed, unchanged and failed meshes of a report.
fn counts(report: &Value) -> [u64; 3] {
    let counts = ["packed", "unchanged", "failed"].map(|name| report[name].as_u64().unwrap());
    for name in ["packed", "unchanged", "failed"] {
        let listed = report["meshes"].as_array().unwrap().iter().filter(|mesh| mesh["status"] == name);
        assert_eq!(Some(listed.count() as u64), report[name].as_u64());
    }
    counts
}

/// What the report says of one mesh.
fn mesh<'a>(report: &'a Value, input: &str) -> &'a Value {
    let meshes = report["meshes"].as_array().unwrap();
    meshes.iter().find(|mesh| mesh["input"] == input).unwrap_or_else(|| panic!("no {input} in {report}"))
}

fn obj(mesh: &TriangleMesh) -> String {
    let vertices = mesh.vertices.iter().map(|v| format!("v {} {} {}\n", v.x, v.y, v.z));
    let faces = mesh.triangles.iter().map(|t| format!("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1));
    vertices.chain(faces).collect()
}

fn ascii_stl(mesh: &TriangleMesh) -> String {
    let facet = |index| {
        let lines = mesh.corners(index).map(|c| format!("vertex {} {} {}\n", c.x, c.y, c.z)).concat();
        format!("facet normal 0 0 0\nouter loop\n{lines}endloop\nendfacet\n")
    };
    let facets: String = (0..mesh.triangles.len()).map(facet).collect();
    format!("solid mesh\n{facets}endsolid mesh\n")
}

fn cuboid(x: f64, y: f64, z: f64) -> TriangleMesh {
    common::cuboid(DVec3::ZERO, DVec3::new(x, y, z))
}

fn write(path: impl AsRef<Path>, content: impl AsRef<[u8]>) {
    std::fs::create_dir_all(path.as_ref().parent().unwrap()).unwrap();
    std::fs::write(path, content).unwrap();
}

/// A folder with eight meshes below `in`.
fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    let at = folder.path().join("in");
    write(at.join("a.obj"), obj(&cuboid(1.0, 2.0, 3.0)));
    write(at.join("a.stl"), ascii_stl(&cuboid(2.0, 2.0, 1.0)));
    write(at.join("B.OBJ"), obj(&cuboid(1.0, 1.0, 1.0)));
    write(at.join("notes.txt"), "no mesh");
    write(at.join("rings/thick.obj"), obj(&common::torus(1.0, 0.5, 24)));
    write(at.join("rings/thin.obj"), obj(&common::torus(1.0, 0.2, 24)));
    write(at.join("rings/deep/er/thinner.obj"), obj(&common::torus(1.0, 0.1, 24)));
    write(at.join("with space & süß.obj"), obj(&cuboid(3.0, 1.0, 1.0)));
    write(at.join("z.stl"), ascii_stl(&cuboid(1.0, 1.0, 5.0)));
    folder
}

/// Outputs that [`folder`] gives.
const OUTPUTS: [&str; 8] = [
    "B.OBJ.ist",
    "a.obj.ist",
    "a.stl.ist",
    "rings/deep/er/thinner.obj.ist",
    "rings/thick.obj.ist",
    "rings/thin.obj.ist",
    "with space & süß.obj.ist",
    "z.stl.ist",
];

/// All files below a folder, hidden ones too, with their bytes.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    let mut open = vec![PathBuf::new()];
    while let Some(path) = open.pop() {
        for entry in std::fs::read_dir(folder.join(&path)).unwrap().map(Result::unwrap) {
            let path = path.join(entry.file_name());
            if entry.file_type().unwrap().is_dir() {
                open.push(path);
            } else {
                let name = path.components().map(|c| c.as_os_str().to_str().unwrap()).collect::<Vec<_>>();
                files.insert(name.join("/"), std::fs::read(entry.path()).unwrap_or_default());
            }
        }
    }
    files
}

fn names(folder: &Path) -> Vec<String> {
    contents(folder).into_keys().collect()
}
