//! `packer check` tells everything that is wrong at once, to people and to programs.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]
#![cfg(feature = "cli")]

mod common;

use common::{cuboid, join, rotated};
use glam::{DQuat, DVec3};
use packer::{TriangleMesh, diagnose};
use serde_json::Value;
use std::process::{Command, Output};
use tempfile::TempDir;

fn check(mesh: &TriangleMesh, arguments: &[&str]) -> Output {
    let folder = TempDir::new().unwrap();
    let mut text = String::new();
    mesh.vertices.iter().for_each(|v| text += &format!("v {} {} {}\n", v.x, v.y, v.z));
    mesh.triangles.iter().for_each(|t| text += &format!("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1));
    std::fs::write(folder.path().join("mesh.obj"), text).unwrap();
    Command::new(env!("CARGO_BIN_EXE_packer"))
        .current_dir(folder.path())
        .args(["check", "mesh.obj"])
        .args(arguments)
        .output()
        .unwrap()
}

/// A cube with two holes, a fin, an overlapping cube, a stray vertex and a coordinate that is no number.
fn broken() -> TriangleMesh {
    let mut mesh = join(&cuboid(DVec3::ZERO, DVec3::ONE), &cuboid(DVec3::splat(0.5), DVec3::splat(1.5)));
    mesh.triangles.retain(|t| *t != [0, 2, 3] && *t != [1, 7, 5]);
    mesh.vertices.extend([DVec3::new(-1.0, -1.0, 0.5), DVec3::splat(9.0), DVec3::new(0.0, f64::NAN, 0.0)]);
    mesh.triangles.extend([[0, 4, 16], [0, 1, 18], [5, 5, 4]]);
    mesh
}

#[test]
fn all_defects_of_a_mesh_are_found_at_once() {
    let d = diagnose(&broken());
    assert_eq!((d.not_finite.count, d.not_finite.some[0].0), (1, 18));
    assert_eq!((d.unused_vertices, d.degenerate_faces), (2, 1));
    // Three edges of each hole and two of the fin, which touches a hole.
    assert_eq!((d.open_edges.count, d.holes), (8, 2));
    assert_eq!(d.non_manifold_edges.some, [([DVec3::ZERO, DVec3::Z], 3)]);
    assert!(d.self_intersections.count > 0 && d.overlapping_shells > 0);
    assert!(d.volume.is_none());
    let (lower, upper) = d.bounds.unwrap();
    for place in &d.self_intersections.some {
        assert!(place.cmpge(lower).all() && place.cmple(upper).all());
    }
}

#[test]
fn a_report_is_complete_for_meshes_that_cannot_be_packed() {
    let output = check(&broken(), &["--json"]);
    assert_eq!(output.status.code(), Some(2));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["packable"], false);
    assert!(report["error"].as_str().unwrap().contains("NaN"));
    for key in
        ["triangles", "vertices", "shells", "cavities", "volume", "bounds", "mended", "holes", "resolution"]
    {
        assert!(report.get(key).is_some(), "{key}");
    }
    let kinds: Vec<&str> =
        report["findings"].as_array().unwrap().iter().map(|f| f["kind"].as_str().unwrap()).collect();
    let expected =
        ["not_finite", "open_edges", "non_manifold_edges", "self_intersections", "overlapping_shells"];
    assert!(expected.iter().all(|kind| kinds.contains(kind)), "{kinds:?}");
    let open = report["findings"].as_array().unwrap().iter().find(|f| f["kind"] == "open_edges").unwrap();
    assert_eq!((open["severity"].as_str(), open["count"].as_u64()), (Some("error"), Some(8)));
    assert_eq!(open["places"][0]["edge"].as_array().unwrap().len(), 2);
    assert!(open["remedy"].as_str().unwrap().contains("fill the holes"));

    let text = String::from_utf8(check(&broken(), &[]).stdout).unwrap();
    for part in [
        "cannot be packed",
        "8 open edges",
        "edge from [",
        "fill the holes",
        "1 edges with more than two faces",
    ] {
        assert!(text.contains(part), "{part} is not in {text}");
    }
}

#[test]
fn a_mesh_far_from_the_origin_is_warned_about() {
    for (far, is_far) in [(0.0, false), (100.0, false), (1e5, true)] {
        let output = check(&cuboid(DVec3::splat(far), DVec3::splat(far + 1.0)), &[]);
        assert_eq!(output.status.code(), Some(0));
        let text = String::from_utf8(output.stdout).unwrap();
        assert_eq!(text.contains("so far from the origin"), is_far, "{far}: {text}");
    }
}

#[test]
fn overlaps_are_a_warning_and_can_be_packed() {
    let cube = cuboid(DVec3::ZERO, DVec3::ONE);
    let mesh = join(&cube, &rotated(&cube, DQuat::IDENTITY, DVec3::new(0.5, 0.25, 0.25)));
    let output = check(&mesh, &["--json"]);
    assert_eq!(output.status.code(), Some(0));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["packable"], true);
    assert!((report["volume"].as_f64().unwrap() - (2.0 - 0.28125)).abs() < 1e-9);
    assert!((report["overlap_volume"].as_f64().unwrap() - 0.28125).abs() < 1e-9);
    assert_eq!(report["centroid"].as_array().unwrap().len(), 3);
    let output = check(&mesh, &[]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.contains("can be packed") && text.contains("warning: ") && !text.contains("error: "),
        "{text}"
    );
}
