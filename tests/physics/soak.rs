//! Short forms of the long runs of `pile --soak` and `chain --soak`: all that these check but time and memory.

use rapier_ist_examples::run::{Check, Soak, soak};
use rapier_ist_examples::scenes::{PileOptions, SoakedChain, SoakedPile};

/// Too short to be compared with itself.
const SECONDS: f64 = 12.0;

fn assert_sound(scene: &mut (impl Soak + Send), least_changes: usize) {
    let (figures, checks) = soak(scene, SECONDS).unwrap();
    assert_eq!(figures.steps, 720);
    assert!(figures.changes >= least_changes, "{} changes", figures.changes);
    assert!(figures.remembered_by_tenth.iter().all(|&entries| entries > 0));
    let failed: Vec<&Check> = checks.iter().filter(|check| !check.passed).collect();
    assert!(failed.is_empty(), "{failed:?}");
    assert!(checks.iter().any(|check| check.name.contains("entries of tables")));
}

#[test]
fn a_pile_to_which_bodies_come_and_from_which_they_go_loses_none() {
    let options = PileOptions { bodies: 10, spheres: 100, ..PileOptions::default() };
    assert_sound(&mut SoakedPile::new(&options, 1, |_| ()).unwrap(), 3);
}

#[test]
fn a_chain_that_is_pushed_again_and_again_stays_linked() {
    assert_sound(&mut SoakedChain::new(150, 1).unwrap(), 1);
}
