//! Recordings to places that take none.

use rapier_ist::record::{RecordOptions, Recorder};
use rapier_ist_examples::recording::describe;
use rapier_ist_tests::small_pile;

/// A device that is always full: it can be opened, and every write fails.
#[cfg(target_os = "linux")]
#[test]
fn a_full_device_is_named_with_what_to_do_and_the_run_goes_on() {
    let mut undisturbed = small_pile().unwrap();
    for _ in 0..30 {
        undisturbed.step();
    }
    for background in [false, true] {
        let mut pile = small_pile().unwrap();
        let options = RecordOptions::everything().chunk_size(5000).background(background);
        let mut errors = Vec::new();
        match Recorder::create("/dev/full", options) {
            Ok(mut recorder) => {
                errors.extend(describe(&mut recorder, &pile).err().map(|error| error.to_string()));
                errors.extend(recorder.record_start(&pile.world).err().map(|error| error.to_string()));
                for _ in 0..30 {
                    pile.step();
                    let recorded = recorder.record(&pile.world, pile.plugin.report());
                    errors.extend(recorded.err().map(|error| error.to_string()));
                }
                errors.extend(recorder.finish().err().map(|error| error.to_string()));
            }
            // Whether the first write is made here or later is the writer's business.
            Err(error) => {
                errors.push(error.to_string());
                for _ in 0..30 {
                    pile.step();
                }
            }
        }
        assert!(!errors.is_empty());
        for error in errors {
            assert!(error.contains("/dev/full") && error.contains("record to another place"), "{error}");
        }
        for (mine, other) in pile.bodies.iter().zip(&undisturbed.bodies) {
            assert_eq!(
                pile.world.bodies[mine.handle].position(),
                undisturbed.world.bodies[other.handle].position()
            );
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_takes_no_files_is_named_with_what_to_do() {
    let error = Recorder::create("/proc/run.mcap", RecordOptions::poses()).err().unwrap().to_string();
    assert!(error.contains("/proc/run.mcap") && error.contains("choose a folder"), "{error}");
}
