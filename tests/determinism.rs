//! The pile comes out the same on any number of threads.
//!
//! `tests/determinism.sh pile` compiles this test with other flags and compares the checksums that it prints. Packings
//! and queries are held to the same, without the feature, by `crates/packer/tests/determinism.rs`.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use rapier_ist_examples::scenes::{Pile, PileOptions};

const THREADS: [usize; 4] = [1, 2, 3, 8];
const STEPS: usize = 600;

/// Of the poses and velocities after every tenth step.
fn checksum(threads: usize) -> u32 {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| {
        let options = PileOptions { bodies: 20, spheres: 60, ..PileOptions::default() };
        let mut pile = Pile::new(&options, |_| ()).unwrap();
        let mut hasher = crc32fast::Hasher::new();
        for step in 1..=STEPS {
            pile.step();
            if step % 10 == 0 {
                for (_, body) in pile.world.bodies.iter() {
                    let numbers =
                        [body.translation().to_array(), body.linvel().to_array(), body.angvel().to_array()];
                    let rotation = body.rotation().to_array();
                    for number in numbers.iter().flatten().chain(&rotation) {
                        hasher.update(&number.to_le_bytes());
                    }
                }
            }
        }
        hasher.finalize()
    })
}

#[test]
fn piles_are_the_same_on_any_number_of_threads() {
    let [first, others @ ..] = THREADS.map(checksum);
    assert_eq!(others, [first; 3]);
    println!("checksum of the pile {first:#010x}");
}
