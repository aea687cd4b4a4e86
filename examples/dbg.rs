//! debug
use rapier_ist_examples::figures::*;
use rapier_ist_examples::scenes::*;
fn main() {
    let n: usize = std::env::args().nth(1).unwrap().parse().unwrap();
    let sp: usize = std::env::args().nth(2).unwrap().parse().unwrap();
    let mut p = Pile::new(&PileOptions { bodies: n, spheres: sp, ..Default::default() }, |_| {}).unwrap();
    for s in 0..600 {
        p.step();
        let r = p.plugin.report().clone();
        if s % 60 == 59 {
            let solids = p.solids();
            println!(
                "{s} exact {:.4} contacts {} maxdepth {:.4} vmax {:.3} asleep {} step {:.2} q {:.2} s {:.2}",
                deepest_overlap(&solids),
                r.contacts.len(),
                r.contacts.iter().map(|c| c.depth).fold(0.0, f32::max),
                p.bodies.iter().map(|b| p.world.bodies[b.handle].linvel().length()).fold(0.0, f32::max),
                p.bodies.iter().filter(|b| p.world.bodies[b.handle].is_sleeping()).count(),
                r.step_seconds * 1e3,
                r.query_seconds * 1e3,
                r.solve_seconds * 1e3
            );
        }
    }
    let solids = p.solids();
    for i in 0..solids.len() {
        for j in i + 1..solids.len() {
            let d = deepest_overlap(&[solids[i], solids[j]]);
            if d > 0.03 {
                let name = |k: usize| {
                    if k < p.bodies.len() { p.models[p.bodies[k].model].name.clone() } else { "bowl".into() }
                };
                let info = if j < p.bodies.len() {
                    let (a, b) = (&p.bodies[i], &p.bodies[j]);
                    let t = |x: &PileBody| {
                        ist::InnerSphereTree::new(&p.models[x.model].packing).scaled(x.size).unwrap()
                    };
                    let pose =
                        p.world.bodies[a.handle].position().inv_mul(p.world.bodies[b.handle].position());
                    let mut ws = Default::default();
                    let o = t(a).overlap(&t(b), &pose, &mut ws);
                    format!(
                        "V {:.3e} V/|g| {:.4} pairs {}",
                        o.volume,
                        o.volume / o.gradient.length(),
                        o.pairs
                    )
                } else {
                    String::new()
                };
                println!(
                    "{} {} exact {:.4} size {:.3} {}",
                    name(i),
                    name(j),
                    d,
                    p.bodies[i].size.min(if j < p.bodies.len() { p.bodies[j].size } else { 9.0 }),
                    info
                );
            }
        }
    }
}
