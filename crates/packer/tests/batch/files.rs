//! Which files count as meshes, and where packings may go.

use super::*;

#[test]
fn the_output_may_lie_inside_the_input() {
    let folder = folder();
    let at = folder.path();
    for out in ["in/packed", "in"] {
        for expected in [[8, 0, 0], [0, 8, 0]] {
            let output = run(at, &["batch", "in", "-o", out, "-n", "9", "--json"]);
            assert_eq!(counts(&serde_json::from_slice(&output.stdout).unwrap()), expected, "{out}");
        }
    }
    assert!(at.join("in/packed/rings/thin.obj.ist").is_file() && at.join("in/a.stl.ist").is_file());
}

#[test]
fn hidden_files_and_folders_are_left_out() {
    let folder = folder();
    let at = folder.path();
    write(at.join("in/.git/object.obj"), "no mesh");
    write(at.join("in/rings/._thin.obj"), "no mesh");
    assert_eq!(counts(&batch(at, &[])), [8, 0, 0]);
    // The input folder itself may be hidden.
    std::fs::rename(at.join("in"), at.join(".in")).unwrap();
    assert!(run(at, &["batch", ".in", "-o", "out"]).status.success());
}

#[test]
fn a_bad_mesh_does_not_stop_the_others() {
    let folder = folder();
    let at = folder.path();
    let cube = obj(&cuboid(1.0, 1.0, 1.0));
    write(at.join("in/m empty.stl"), "");
    write(at.join("in/m open.obj"), cube.rsplit_once("f ").unwrap().0);
    write(at.join("in/rings/noise.ply"), [7; 300]);
    let report = batch(at, &[]);
    assert_eq!(counts(&report), [8, 0, 3]);
    assert_eq!(names(&at.join("out")), OUTPUTS);
    let output = run(at, &["batch", "in", "-o", "out", "-n", "40"]);
    assert_eq!(output.status.code(), Some(2));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("0 packed, 8 unchanged, 3 failed"), "{text}");
    let listed: Vec<&str> = text.lines().filter(|line| line.starts_with("failed: ")).collect();
    assert!(listed[0].contains("m empty.stl") && listed[0].contains("is empty"), "{text}");
    assert!(listed[1].contains("m open.obj") && listed[1].contains("open edges"), "{text}");
    assert!(listed[2].contains("rings/noise.ply"), "{text}");
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(error.contains("3 of 11 meshes failed"), "{error}");
}

#[cfg(unix)]
#[test]
fn links_are_followed_but_not_in_circles() {
    use std::os::unix::fs::symlink;
    let folder = folder();
    let at = folder.path();
    write(at.join("elsewhere/far.obj"), obj(&cuboid(1.0, 4.0, 4.0)));
    symlink(".", at.join("in/rings/here")).unwrap();
    symlink("../..", at.join("in/rings/above")).unwrap();
    symlink("rings", at.join("in/same")).unwrap();
    symlink("../../elsewhere", at.join("in/rings/elsewhere")).unwrap();
    symlink("../../in", at.join("elsewhere")).unwrap_err();
    symlink("../in", at.join("elsewhere/back")).unwrap();
    symlink("a.obj", at.join("in/link.obj")).unwrap();
    symlink("nowhere", at.join("in/dead")).unwrap();
    symlink("user@host:1", at.join("in/.#a.obj")).unwrap();
    let report = batch(at, &[]);
    assert_eq!(counts(&report), [10, 0, 0]);
    assert_eq!(mesh(&report, "link.obj")["status"], "packed");
    assert_eq!(mesh(&report, "rings/elsewhere/far.obj")["status"], "packed");
}

#[cfg(unix)]
#[test]
fn pipes_and_dead_links_are_told_and_not_waited_for() {
    let folder = folder();
    let at = folder.path();
    std::os::unix::fs::symlink("nowhere.obj", at.join("in/dead.obj")).unwrap();
    assert!(Command::new("mkfifo").arg(at.join("in/pipe.obj")).status().unwrap().success());
    let report = batch(at, &[]);
    assert_eq!(counts(&report), [8, 0, 2]);
    assert!(mesh(&report, "dead.obj")["error"].as_str().unwrap().contains("cannot read in/dead.obj"));
    assert!(mesh(&report, "pipe.obj")["error"].as_str().unwrap().contains("neither a file nor a folder"));
}

#[cfg(target_os = "linux")]
#[test]
fn names_that_are_no_text_are_packed_too() {
    use std::os::unix::ffi::OsStrExt;
    let folder = folder();
    let at = folder.path();
    for name in [b"in/\xff\xfe.obj".as_slice(), b"in/two\nlines.obj", b"in/ .obj"] {
        write(at.join(std::ffi::OsStr::from_bytes(name)), obj(&cuboid(1.0, 1.5, 1.0)));
    }
    let long = format!("in/{}.obj", "x".repeat(247));
    write(at.join(long), obj(&cuboid(1.0, 1.5, 1.0)));
    assert_eq!(counts(&batch(at, &[])), [12, 0, 0]);
    assert_eq!(counts(&batch(at, &[])), [0, 12, 0]);
}
