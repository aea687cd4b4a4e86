#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| rapier_ist_tests::fuzzing::proximity::check(data));
