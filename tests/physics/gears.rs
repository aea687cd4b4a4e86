//! Two spur gears, one driven by a motor, the other by the first.

use rapier_ist_examples::scenes::Gears;
use rapier3d::prelude::JointAxis;

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

/// However strong the motor is: it pushed a gear over its teeth when the contacts were solved as if nothing drove them.
#[test]
fn motors_of_any_strength_skip_no_tooth() {
    for (speed, damping, load) in [(3.0, 1e3, 20.0), (3.0, 1e5, 20.0), (10.0, 1e4, 20.0), (3.0, 1e5, 2000.0)]
    {
        let mut gears = Gears::new(3000).unwrap();
        let motors = [(gears.gears[0], speed, damping), (gears.gears[1], 0.0, load)];
        for (gear, speed, damping) in motors {
            let joints = gears.world.impulse_joints.attached_joints(gear).map(|(_, _, joint, _)| joint);
            for joint in joints.collect::<Vec<_>>() {
                let joint = gears.world.impulse_joints.get_mut(joint, true).unwrap();
                joint.data.set_motor_velocity(JointAxis::AngX, speed, damping);
            }
        }
        for _ in 0..360 {
            gears.step();
        }
        let ([driving, driven], deviation) = (gears.turns(), gears.deviation());
        println!(
            "{speed} rad/s, {damping} against {load} N·m·s: {driving:.2} turns, {deviation:.3} of half a tooth off"
        );
        assert!(driving.abs() > 1.0, "{driving} turns");
        assert!(
            (driven / driving / (-14.0 / 21.0) - 1.0).abs() < 0.02 && deviation < 0.4,
            "{driven} {deviation}"
        );
    }
}
