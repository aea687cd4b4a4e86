//! debug
use rapier_ist_examples::scenes::*;
fn main() {
    let sp: usize = std::env::args().nth(1).unwrap().parse().unwrap();
    let mut p = Pile::new(&PileOptions { bodies: 40, spheres: sp, ..Default::default() }, |_| {}).unwrap();
    for s in 0..240 {
        let before: Vec<_> = p.bodies.iter().map(|b| p.world.bodies[b.handle].linvel()).collect();
        p.step();
        let r = p.plugin.report().clone();
        for (i, b) in p.bodies.iter().enumerate() {
            let v = p.world.bodies[b.handle].linvel();
            if v.length() > 3.0 && (v - before[i]).length() > 1.5 && v.length() > before[i].length() * 0.9 {
                println!(
                    "{s} body {i} {} {:?} -> {:?} pos {:?} mass {}",
                    p.models[b.model].name,
                    before[i],
                    v,
                    p.world.bodies[b.handle].translation(),
                    p.world.bodies[b.handle].mass()
                );
                let co = p.world.bodies[b.handle].colliders()[0];
                for c in &r.contacts {
                    if c.collider_a == co || c.collider_b == co {
                        println!(
                            "     {:?} {:?} V {:.3e} d {:.4} F {:?} u {:?}",
                            c.collider_a.into_raw_parts().0,
                            c.collider_b.into_raw_parts().0,
                            c.volume,
                            c.depth,
                            c.force,
                            c.relative_velocity
                        );
                    }
                }
            }
        }
    }
}
