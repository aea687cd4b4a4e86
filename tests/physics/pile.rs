//! Many gears in a bowl.

use rapier_ist_examples::figures::{Summary, Timings};
use rapier_ist_examples::scenes::{Pile, PileOptions, asset_folder};

/// Gears of 0.28 to 0.44 m, 1,000 spheres each.
const GEARS: usize = 100;

#[test]
fn a_hundred_gears_come_to_rest_in_the_bowl() {
    let meshes = vec![asset_folder().join("pinion_gear.obj")];
    let mut pile =
        Pile::new(&PileOptions { bodies: GEARS, meshes, ..PileOptions::default() }, |_| ()).unwrap();
    let mut steps = 0;
    while pile.bodies.iter().any(|body| !pile.world.bodies[body.handle].is_sleeping()) {
        pile.step();
        steps += 1;
        assert!(steps < 15 * 60, "still awake after 15 s");
    }
    let summary = Summary::of(&pile, &Timings::default());
    println!(
        "{GEARS} gears: asleep after {:.1} s, {} lost, deepest vertex {:.1} % of a gear's size",
        f64::from(steps) / 60.0,
        summary.lost,
        100.0 * summary.deepest_overlap
    );
    assert_eq!(summary.lost, 0);
    assert!(summary.deepest_overlap < 0.05, "{}", summary.deepest_overlap);
}
