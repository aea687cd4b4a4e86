//! Twelve rings that hang from a fixed one.

use super::{DENSITY, packed};
use glam::Vec3;
use rapier_ist::IstPlugin;
use rapier_ist_examples::scenes::{Chain, ring_shape};
use rapier_ist_examples::shapes;
use rapier3d::prelude::*;
use std::f32::consts::FRAC_PI_2;

#[test]
fn a_chain_swings_for_thirty_seconds_and_keeps_its_links() {
    let mut chain = Chain::new(12, &ring_shape(1000).unwrap(), 1000.0);
    let step = |chain: &mut Chain| {
        chain.plugin.step(&mut chain.world);
        assert!(chain.is_linked());
    };
    for _ in 0..120 {
        step(&mut chain);
    }
    let hanging = chain.length();
    for &ring in &chain.rings[7..] {
        let body = &mut chain.world.bodies[ring];
        body.set_linvel(body.linvel() + Vec3::X * 2.0, true);
    }
    let (mut farthest, mut fastest) = (0.0_f32, 0.0_f32);
    for _ in 0..1800 {
        step(&mut chain);
        let last = &chain.world.bodies[chain.rings[12]];
        (farthest, fastest) = (farthest.max(last.translation().x.abs()), fastest.max(last.linvel().length()));
    }
    let drift = chain.length() / hanging - 1.0;
    println!("length {hanging} m, drift {:.3} %, swing {farthest} m, at most {fastest} m/s", 100.0 * drift);
    assert!(drift.abs() < 0.01, "{drift}");
    assert!(farthest > 0.3 && fastest < 6.0, "{farthest} m, {fastest} m/s");
}

/// Eight rings of which the last is so many times as heavy as the others. By how much more than by the rings' own size two of them
/// are apart at most (m), and the speed of the last in the end (m/s).
fn hang([radius, tube]: [f64; 2], ratio: f32) -> (f32, f32) {
    let shape = packed(&shapes::ring(radius, tube, [48, 24]), 1000);
    let (mut world, pitch) = (PhysicsWorld::new(), 2.0 * (radius - tube) as f32);
    let mut plugin = IstPlugin::install(&mut world);
    let mut hang = |i: usize| {
        let body =
            if i == 0 { RigidBodyBuilder::fixed() } else { RigidBodyBuilder::dynamic().can_sleep(false) };
        let turn = FRAC_PI_2 * if i.is_multiple_of(2) { Vec3::X } else { Vec3::Z };
        let density = if i == 7 { ratio * DENSITY } else { DENSITY };
        let collider = shape.clone().into_collider().density(density);
        world.insert(body.translation(pitch * i as f32 * Vec3::NEG_Y).rotation(turn), collider).0
    };
    let rings: Vec<_> = (0..8).map(&mut hang).collect();
    let mut farthest = 0.0_f32;
    for _ in 0..300 {
        plugin.step(&mut world);
        let centers: Vec<Vec3> = rings.iter().map(|ring| world.bodies[*ring].translation()).collect();
        farthest = centers.windows(2).map(|pair| pair[0].distance(pair[1])).fold(farthest, f32::max);
    }
    (farthest - pitch, world.bodies[rings[7]].linvel().length())
}

#[test]
fn a_chain_carries_many_times_its_own_weight() {
    for (ring, ratio) in [([0.11, 0.04], 1000.0), ([0.12, 0.02], 100.0), ([0.125, 0.01], 100.0)] {
        let (stretched, speed) = hang(ring, ratio);
        println!("{ring:?} m, {ratio} times as heavy: {} mm longer, {speed} m/s", 1e3 * stretched);
        // Links come apart where tubes have passed through each other.
        assert!(
            stretched < ring[1] as f32 * 2.0 && speed < 0.02,
            "{ring:?}, {ratio}: {stretched} m, {speed} m/s"
        );
    }
}
