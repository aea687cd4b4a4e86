#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| rapier_ist_tests::fuzzing::overlap::check(data));
