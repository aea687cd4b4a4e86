//! What the program `packer` writes, and what it leaves alone.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]
#![cfg(feature = "cli")]

mod common;
#[path = "common/program.rs"]
mod program;

use ist::SpherePacking;
use program::{folder, names, packer};

#[test]
fn no_output_replaces_the_input_or_another_output() {
    let folder = folder();
    let at = folder.path();
    assert!(packer(at, ["pack", "cube.obj", "-o", "cube.ist", "-n", "9"]).status.success());
    let read = |name: &str| std::fs::read(at.join(name)).unwrap();
    let before = (names(at), read("cube.obj"), read("cube.ist"));
    for (arguments, message) in [
        (vec!["pack", "cube.obj", "-o", "cube.obj"], "cube.obj is the input"),
        (vec!["pack", "cube.obj", "-o", "./cube.obj"], "./cube.obj is the input"),
        (vec!["pack", "cube.obj", "-o", "x.ist", "--csv", "cube.obj"], "cube.obj is the input"),
        (vec!["pack", "cube.obj", "-o", "x.ist", "--csv", "./x.ist"], "./x.ist is named for two outputs"),
        (vec!["info", "cube.ist", "--preview", "cube.ist"], "cube.ist is the input"),
        (vec!["info", "cube.ist", "--csv", "t", "--urdf", "t"], "t is named for two outputs"),
        (vec!["info", "cube.ist", "--csv", "no/t"], "output folder no does not exist"),
        (vec!["info", "cube.ist", "--preview", "."], "is a folder"),
        (vec!["info", "cube.ist", "--urdf", "t", "--density", "0"], "density 0"),
        (vec!["info", "cube.ist", "--urdf", "t", "--density", "-2"], "density -2"),
        (vec!["info", "cube.ist", "--urdf", "t", "--density", "inf"], "density inf"),
        (vec!["info", "cube.ist", "--density", "2"], "--urdf"),
        (vec!["completions", "basic"], "bash"),
    ] {
        let output = packer(at, &arguments);
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {stderr}");
        assert!(stderr.contains(message), "{arguments:?}: {stderr}");
    }
    assert_eq!((names(at), read("cube.obj"), read("cube.ist")), before);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("cube.obj", at.join("link.obj")).unwrap();
        let output = packer(at, ["pack", "link.obj", "-o", "cube.obj"]);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        assert!(read("cube.obj") == before.1);
    }
}

/// Outputs replaced whatever had their name: a mesh, the buffer of a glTF file that was just read, a pipe, `/dev/full`.
#[test]
fn issue_an_output_replaces_nothing_but_its_like() {
    let folder = folder();
    let at = folder.path();
    std::fs::write(at.join("notes"), "all that was made").unwrap();
    std::fs::write(at.join("empty"), "").unwrap();
    let all = ["--csv", "t.csv", "--spheres-json", "t.json", "--urdf", "t.urdf", "--preview", "t.png"];
    for _ in 0..2 {
        // The second time each replaces its like.
        let output = packer(at, [&["pack", "cube.obj", "-o", "cube.ist", "-n", "9"][..], &all].concat());
        assert!(output.status.success(), "{output:?}");
    }
    assert!(packer(at, ["pack", "cube.obj", "-o", "empty", "-n", "9"]).status.success());
    let read = |name: &str| std::fs::read(at.join(name)).unwrap();
    let before: Vec<_> = names(at).iter().map(|name| (name.clone(), read(name))).collect();
    let mut cases = Vec::new();
    for (option, own) in [
        ("-o", "cube.ist"),
        ("--csv", "t.csv"),
        ("--spheres-json", "t.json"),
        ("--urdf", "t.urdf"),
        ("--preview", "t.png"),
    ] {
        let others = ["notes", "cube.ist", "t.csv", "t.json", "t.urdf", "t.png"]
            .into_iter()
            .filter(|name| *name != own);
        cases.extend(others.map(|other| (option, other, "is there and is no ")));
    }
    #[cfg(unix)]
    cases.push(("-o", "/dev/full", "/dev/full is no regular file"));
    for (option, other, message) in cases {
        let mut arguments = vec!["pack", "cube.obj", option, other];
        if option != "-o" {
            arguments.extend(["-o", "new.ist"]);
        }
        let output = packer(at, &arguments);
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {stderr}");
        assert!(stderr.contains(other) && stderr.contains(message), "{arguments:?}: {stderr}");
    }
    let after: Vec<_> = names(at).iter().map(|name| (name.clone(), read(name))).collect();
    assert!(after == before);
}

/// A link was replaced by a file of its own.
#[cfg(unix)]
#[test]
fn issue_what_is_written_to_a_link_goes_where_it_leads() {
    let folder = folder();
    let at = folder.path();
    std::fs::write(at.join("kept.ist"), "").unwrap();
    std::os::unix::fs::symlink("kept.ist", at.join("link.ist")).unwrap();
    assert!(packer(at, ["pack", "cube.obj", "-o", "link.ist", "-n", "9"]).status.success());
    assert!(at.join("link.ist").is_symlink());
    assert_eq!(SpherePacking::load(at.join("kept.ist")).unwrap().spheres().len(), 9);
}

/// `info` waited for whoever writes to the pipe.
#[cfg(unix)]
#[test]
fn issue_a_pipe_is_no_packing() {
    let folder = folder();
    let at = folder.path();
    assert!(std::process::Command::new("mkfifo").arg(at.join("pipe.ist")).status().unwrap().success());
    let output = packer(at, ["info", "pipe.ist"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8(output.stderr).unwrap().contains("regular file"));
}
