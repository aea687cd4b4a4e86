//! Outputs that are damaged in every way, and places that cannot be written to.

use super::*;
use std::fs::{File, OpenOptions};
use std::process::Stdio;
use std::time::{Duration, Instant};

/// A folder with one mesh, packed, and the bytes of its packing.
fn packed() -> (TempDir, Vec<u8>) {
    let folder = TempDir::new().unwrap();
    write(folder.path().join("in/a.obj"), obj(&cuboid(1.0, 2.0, 3.0)));
    assert_eq!(counts(&batch(folder.path(), &[])), [1, 0, 0]);
    let bytes = std::fs::read(folder.path().join("out/a.obj.ist")).unwrap();
    (folder, bytes)
}

#[test]
fn whatever_a_cached_packing_was_damaged_to_it_is_made_again_or_told() {
    let (folder, whole) = packed();
    let output = folder.path().join("out/a.obj.ist");
    let mut version = whole.clone();
    // Behind the signature of eight bytes.
    version[8] += 1;
    let mut damaged: Vec<Vec<u8>> =
        vec![version, [&*whole, &*whole].concat(), [&whole[..8], &[0xff; 400]].concat()];
    damaged
        .extend([1, 7, 8, 11, 12, 13, 40, whole.len() / 2, whole.len() - 1].map(|len| whole[..len].to_vec()));
    for bytes in damaged {
        std::fs::write(&output, &bytes).unwrap();
        let report = batch(folder.path(), &[]);
        // Without its whole signature it could be anybody's file.
        if bytes.len() < 8 {
            let error = mesh(&report, "a.obj")["error"].as_str().unwrap();
            assert!(error.contains("a.obj.ist is no .ist file") && error.contains("move it away"), "{error}");
            assert!(std::fs::read(&output).unwrap() == bytes);
        } else {
            assert_eq!(counts(&report), [1, 0, 0], "{} bytes", bytes.len());
            assert!(std::fs::read(&output).unwrap() == whole);
        }
    }
}

#[test]
fn a_pipe_in_the_place_of_a_packing_is_told_and_not_waited_for() {
    let (folder, _) = packed();
    let output = folder.path().join("out/a.obj.ist");
    std::fs::remove_file(&output).unwrap();
    assert!(Command::new("mkfifo").arg(&output).status().unwrap().success());
    let mut child = packer(folder.path(), &["batch", "in", "-o", "out", "-n", "40", "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let started = Instant::now();
    while child.try_wait().unwrap().is_none() && started.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(5));
    }
    // Ends it where it waits.
    let _ = child.kill();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    let error = mesh(&report, "a.obj")["error"].as_str().unwrap();
    assert!(error.contains("out/a.obj.ist") && error.contains("no file"), "{error}");
}

/// Asserts that the program names `path`, says what to do, and does not panic.
fn assert_told(output: &Output, path: &str, remedy: &str) {
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains(path) && stderr.contains(remedy) && !stderr.contains("panicked"), "{stderr}");
}

/// `/proc` takes no files, whoever asks.
#[cfg(target_os = "linux")]
#[test]
fn folders_that_cannot_be_written_to_are_named() {
    let (folder, _) = packed();
    let at = folder.path();
    let before = contents(at);
    assert_told(&run(at, &["batch", "in", "-o", "/proc/out"]), "/proc/out", "choose one that is writable");
    assert_told(&run(at, &["batch", "in", "-o", "/proc"]), "/proc", "choose one that is writable");
    assert_told(&run(at, &["pack", "in/a.obj", "-o", "/proc/a.ist"]), "/proc", "choose one that is writable");
    let csv = run(at, &["info", "out/a.obj.ist", "--csv", "/proc/a.csv"]);
    assert_told(&csv, "/proc", "choose one that is writable");
    assert!(contents(at) == before);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_device_as_standard_output_is_told() {
    let (folder, whole) = packed();
    let at = folder.path();
    let full = || Stdio::from(OpenOptions::new().write(true).open("/dev/full").unwrap());
    for arguments in [
        &["info", "out/a.obj.ist"][..],
        &["info", "out/a.obj.ist", "--json"],
        &["check", "in/a.obj"],
        &["pack", "in/a.obj", "-o", "out/a.obj.ist", "-n", "40"],
        &["batch", "in", "-o", "out", "-n", "40"],
    ] {
        let output = packer(at, arguments).stdout(full()).output().unwrap();
        assert_told(&output, "standard output", "space");
    }
    assert!(std::fs::read(at.join("out/a.obj.ist")).unwrap() == whole, "the work was done all the same");
}

#[test]
fn a_killed_pack_leaves_the_old_packing_or_the_new_one() {
    let (folder, old) = packed();
    let at = folder.path();
    let arguments = ["pack", "in/a.obj", "-o", "out/a.obj.ist", "-n", "120"];
    assert!(packer(at, &arguments).stdout(Stdio::null()).status().unwrap().success());
    let new = std::fs::read(at.join("out/a.obj.ist")).unwrap();
    for moment in 0..12 {
        std::fs::write(at.join("out/a.obj.ist"), &old).unwrap();
        let mut child = packer(at, &arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(3 * moment));
        child.kill().unwrap();
        child.wait().unwrap();
        let left = std::fs::read(at.join("out/a.obj.ist")).unwrap();
        assert!(left == old || left == new, "{} bytes", left.len());
    }
}

#[test]
fn meshes_that_end_early_are_told() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let whole = ascii_stl(&cuboid(1.0, 2.0, 3.0));
    File::create_new(at.join("empty.stl")).unwrap();
    for (name, text) in [("cut.stl", &whole[..whole.len() / 2]), ("header.stl", "solid mesh\n")] {
        std::fs::write(at.join(name), text).unwrap();
    }
    for name in ["empty.stl", "cut.stl", "header.stl"] {
        let output = run(at, &["pack", name, "-o", "out.ist"]);
        assert_told(&output, name, "");
        assert!(!at.join("out.ist").exists());
    }
}
