//! Runs that are killed, run at once, or find no space.

use super::*;
use std::collections::BTreeSet;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

/// A long enough run that it can be killed in the middle.
const ARGUMENTS: [&str; 8] = ["batch", "in", "-o", "out", "-n", "150", "--threads", "2"];

/// Numbers that are the same in every run (Knuth's MMIX generator).
struct Dice(u64);

impl Dice {
    fn below(&mut self, bound: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % bound
    }
}

/// What an uninterrupted run gives; `out` is left empty.
fn uninterrupted(at: &Path) -> BTreeMap<String, Vec<u8>> {
    assert!(run(at, &ARGUMENTS).status.success());
    let whole = contents(&at.join("out"));
    std::fs::remove_dir_all(at.join("out")).unwrap();
    whole
}

fn start(at: &Path) -> Child {
    packer(at, &ARGUMENTS).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

fn finished(out: &Path) -> usize {
    if out.is_dir() { names(out).iter().filter(|name| name.ends_with(".ist")).count() } else { 0 }
}

#[test]
fn a_killed_run_goes_on_where_it_was() {
    let folder = folder();
    let at = folder.path();
    let out = at.join("out");
    let whole = uninterrupted(at);
    let mut interrupted = 0;
    for seed in 0..4 {
        let mut dice = Dice(seed);
        for _ in 0..4 {
            // Kill it some while after a mesh more is done: sometimes at once, sometimes in the middle of a packing.
            let before = finished(&out);
            let mut child =
                packer(at, &ARGUMENTS).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
            let started = Instant::now();
            let wanted = before + dice.below(3) as usize;
            while finished(&out) < wanted
                && child.try_wait().unwrap().is_none()
                && started.elapsed() < Duration::from_secs(60)
            {
                std::thread::sleep(Duration::from_micros(200));
            }
            std::thread::sleep(Duration::from_micros(dice.below(30_000)));
            child.kill().unwrap();
            let was_running = child.wait().unwrap().code().is_none();
            interrupted += usize::from(was_running && finished(&out) < whole.len());
            // What can be seen is whole at any moment.
            for (name, bytes) in contents(&out).iter().filter(|(name, _)| name.ends_with(".ist")) {
                assert!(whole[name] == *bytes, "seed {seed}: {name}");
            }
        }
        let output = run(at, &ARGUMENTS);
        assert!(output.status.success(), "{output:?}");
        assert!(contents(&out) == whole, "seed {seed}: {:?}", names(&out));
        std::fs::remove_dir_all(&out).unwrap();
    }
    assert!(interrupted >= 4, "only {interrupted} of 16 runs were killed at work");
}

#[test]
fn a_run_killed_at_random_times_goes_on() {
    let folder = folder();
    let at = folder.path();
    let whole = uninterrupted(at);
    let mut dice = Dice(2024);
    for _ in 0..8 {
        let mut child = start(at);
        std::thread::sleep(Duration::from_micros(dice.below(150_000)));
        child.kill().unwrap();
        child.wait().unwrap();
    }
    assert!(run(at, &ARGUMENTS).status.success());
    assert!(contents(&at.join("out")) == whole);
}

/// Names of the temporary files directly in `out`.
fn unfinished(out: &Path) -> BTreeSet<String> {
    let entries = std::fs::read_dir(out).into_iter().flatten().map(Result::unwrap);
    let names = entries.map(|entry| entry.file_name().into_string().unwrap());
    names.filter(|name| name.starts_with(".packer-")).collect()
}

#[test]
fn a_run_killed_while_it_writes_goes_on() {
    let folder = folder();
    let at = folder.path();
    let out = at.join("out");
    let whole = uninterrupted(at);
    for _ in 0..6 {
        let left_over = unfinished(&out);
        let mut child = start(at);
        // Whether the kill comes before the file is renamed is up to the machine; the outcome must not be.
        let is_writing = || !unfinished(&out).is_subset(&left_over);
        while !is_writing() && child.try_wait().unwrap().is_none() {
            std::hint::spin_loop();
        }
        child.kill().unwrap();
        child.wait().unwrap();
        for (name, bytes) in contents(&out).iter().filter(|(name, _)| name.ends_with(".ist")) {
            assert!(whole[name] == *bytes, "{name}");
        }
    }
    assert!(run(at, &ARGUMENTS).status.success());
    assert!(contents(&out) == whole, "{:?}", names(&out));
}

#[test]
fn the_same_run_several_times_at_once_gives_the_same_files() {
    let folder = folder();
    let at = folder.path();
    let whole = uninterrupted(at);
    for _ in 0..2 {
        let children: Vec<_> = (0..3)
            .map(|_| packer(at, &ARGUMENTS).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap())
            .collect();
        for child in children {
            let output = child.wait_with_output().unwrap();
            assert!(output.status.success(), "{output:?}");
        }
        assert!(contents(&at.join("out")) == whole, "{:?}", names(&at.join("out")));
        std::fs::remove_dir_all(at.join("out")).unwrap();
    }
}

#[test]
fn a_full_disk_leaves_no_half_file() {
    let folder = folder();
    let at = folder.path();
    batch(at, &[]);
    let before = contents(&at.join("out"));
    // A limit on the size of files, with its signal ignored, fails like a full disk: in the middle of a write.
    let limited = |arguments: &str| {
        let line = format!("trap '' XFSZ; ulimit -f 1; exec \"$0\" {arguments}");
        Command::new("sh").current_dir(at).args(["-c", &line, env!("CARGO_BIN_EXE_packer")]).output().unwrap()
    };
    let output = limited("batch in -o out -n 200 --json");
    assert_eq!(output.status.code(), Some(2));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(counts(&report), [0, 0, 8]);
    let error = mesh(&report, "a.obj")["error"].as_str().unwrap();
    assert!(error.contains("cannot write out/a.obj.ist") && error.contains("space"), "{error}");
    assert!(contents(&at.join("out")) == before, "the old packings are still there, and nothing else");
    let output = limited("pack in/a.obj -o single.ist -n 200");
    assert_eq!(output.status.code(), Some(2));
    assert!(!names(at).iter().any(|name| !name.contains('/')), "{:?}", names(at));
}

#[test]
fn a_reader_that_goes_away_does_not_stop_the_work() {
    let folder = folder();
    let at = folder.path();
    let mut child = packer(at, &ARGUMENTS).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{output:?}");
    assert_eq!(finished(&at.join("out")), 8);
}
