//! A nut on a coarse thread, against the closed form of a screw.

use rapier_ist_examples::scenes::Bolt;

fn run(friction: f64, steps: usize) -> Bolt {
    let mut bolt = Bolt::new(5000, friction).unwrap();
    for _ in 0..steps {
        bolt.step();
    }
    bolt
}

#[test]
fn a_nut_turns_down_its_thread_by_a_pitch_per_turn() {
    for friction in [0.0, 0.02] {
        let bolt = run(friction, 180);
        let (advance, ideal) = (bolt.advance_per_turn().unwrap(), bolt.ideal_acceleration());
        let share = bolt.acceleration().unwrap() / ideal;
        let (tilt, offset) = (bolt.tilt().to_degrees(), 1e3 * bolt.offset());
        println!(
            "μ = {friction}: {:.2} turns, {:.3} of the pitch per turn, {share:.2} of {ideal:.4} m/s², leans {tilt:.1}°, {offset:.1} mm off",
            bolt.turns(),
            advance / Bolt::pitch(),
        );
        assert!(bolt.turns() > 2.0, "{} turns", bolt.turns());
        assert!((advance / Bolt::pitch() - 1.0).abs() < 0.05, "{advance}");
        assert!(tilt < 3.0 && offset < 16.0, "{tilt}°, {offset} mm");
        assert!((0.9..1.02).contains(&share), "slower than on a smooth thread, and not faster: {share}");
    }
}

#[test]
fn a_nut_with_more_friction_than_lead_stays_where_it_is() {
    let bolt = run(0.3, 120);
    assert!(bolt.ideal_acceleration() < 0.0);
    assert!(bolt.turns().abs() < 0.02, "{} turns", bolt.turns());
}
