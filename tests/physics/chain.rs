//! Twelve rings that hang from a fixed one.

use glam::Vec3;
use rapier_ist_examples::scenes::{Chain, ring_shape};

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
