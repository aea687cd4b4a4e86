//! A run that is killed leaves a recording that replays.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rapier_ist::replay::{Replay, ReplayEnd};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

/// Bytes of a chunk before compression; a step of the small pile has two to four thousand while bodies touch.
const CHUNK_SIZE: usize = 20_000;
/// Steps that a chunk of this size has at most, counted in 3,500 chunks: while nothing touches, before the fall and asleep,
/// a step is little more than seven poses.
const STEPS_PER_CHUNK: usize = 26;
/// Entries that may wait for a background recorder's thread, four of which are a step.
const STEPS_IN_QUEUE: usize = 17;

/// Runs the program until it has recorded `steps` steps and kills it; returns how many steps it has told by then.
fn run_and_kill(path: &Path, steps: usize, background: bool) -> usize {
    let mut program = Command::new(env!("CARGO_BIN_EXE_endless-recording"))
        .arg(path)
        .arg(CHUNK_SIZE.to_string())
        .arg(background.to_string())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(program.stdout.take().unwrap()).lines();
    let mut told = 0;
    while told < steps {
        told = lines.next().unwrap().unwrap().parse().unwrap();
    }
    // SIGKILL on Unix: no destructor runs, no buffer is written.
    program.kill().unwrap();
    program.wait().unwrap();
    // What it told until it died.
    lines.map_while(Result::ok).filter_map(|line| line.parse().ok()).last().unwrap_or(told)
}

#[test]
fn what_a_killed_run_leaves_replays_but_for_the_last_chunk() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = Pcg64Mcg::seed_from_u64(9);
    let mut longest: Option<Replay> = None;
    for moment in 0..10 {
        let path = folder.path().join(format!("killed {moment}.mcap"));
        let (steps, background) = (random.random_range(0..150), moment % 2 == 1);
        let told = run_and_kill(&path, steps, background);
        let replay = Replay::open(&path).unwrap();
        assert!(matches!(replay.end(), ReplayEnd::Truncated { .. }), "{}", replay.end());
        assert!(replay.defects().is_empty());
        // Until the first line nothing has been promised.
        if told == 0 {
            continue;
        }
        assert_eq!(replay.bodies().len(), 7, "all bodies were described before the first step");
        assert!(replay.bodies().iter().all(|body| body.mesh.is_some()));
        // The poses at the start count as a step.
        let lost = (told + 1).saturating_sub(replay.step_count());
        let most = STEPS_PER_CHUNK + if background { STEPS_IN_QUEUE } else { 0 };
        assert!(lost <= most, "{lost} of {told} steps are lost, background {background}");
        // All runs are the same run, so the longer one begins with the shorter one.
        if let Some(longest) = &longest {
            for (a, b) in replay.steps().zip(longest.steps()) {
                assert_eq!(a.nanoseconds(), b.nanoseconds());
                assert!(a.poses().eq(b.poses()));
            }
        }
        if longest.as_ref().is_none_or(|longest| longest.step_count() < replay.step_count()) {
            longest = Some(replay);
        }
    }
    assert!(longest.unwrap().step_count() > 50, "some run got somewhere");
}
