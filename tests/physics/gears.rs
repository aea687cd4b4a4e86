//! Two spur gears, one driven by a motor, the other by the first.

use rapier_ist_examples::scenes::Gears;

#[test]
fn gears_turn_each_other_at_the_ratio_of_their_teeth() {
    for spheres in [1000, 3000] {
        let mut gears = Gears::new(spheres).unwrap();
        for _ in 0..600 {
            gears.step();
        }
        let [driving, driven] = gears.turns();
        let (ratio, efficiency) = (driven / driving, gears.efficiency());
        println!(
            "{spheres} spheres: {driving:.2} turns, ratio {ratio:.5}, at most {:.1} % of half a tooth off, {:.1} % of the work",
            100.0 * gears.deviation(),
            100.0 * efficiency
        );
        assert!(driving > 1.5, "{driving} turns");
        assert!((ratio / (-14.0 / 21.0) - 1.0).abs() < 0.01, "{ratio}");
        assert!(gears.deviation() < 0.2, "{} of half a tooth", gears.deviation());
        assert!((0.8..1.0).contains(&efficiency), "teeth take work and make none: {efficiency}");
    }
}
