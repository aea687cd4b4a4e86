//! debug
use rapier_ist_examples::figures::*;
use rapier_ist_examples::scenes::*;
fn main() {
    let a: Vec<u64> = std::env::args().skip(1).map(|s| s.parse().unwrap()).collect();
    for seed in a[1]..=a[2] {
        let mut p =
            Pile::new(&PileOptions { spheres: a[0] as usize, seed, ..Default::default() }, |_| {}).unwrap();
        let mut t = Timings::default();
        for _ in 0..600 {
            let s = std::time::Instant::now();
            p.step();
            t.step.push(s.elapsed().as_secs_f64() * 1e3);
            t.query.push(p.plugin.report().query_seconds * 1e3);
        }
        let s = Summary::of_pile(&p, &t);
        let awake = t.step.iter().filter(|x| **x > 1.0).count();
        println!(
            "seed {seed} exact {:.4} vmax {:.3} asleep {} lost {} p95 {:.1} awake steps {awake}",
            s.deepest_overlap, s.max_speed, s.asleep, s.lost, s.step_ms_p95
        );
        let solids = p.solids();
        for i in 0..solids.len() {
            for j in i + 1..solids.len() {
                let d = deepest_overlap(&[solids[i], solids[j]]);
                if d > 0.025 {
                    let name = |k: usize| {
                        if k < p.bodies.len() {
                            p.models[p.bodies[k].model].name.clone()
                        } else {
                            "bowl".into()
                        }
                    };
                    println!("    {} {} exact {:.4}", name(i), name(j), d);
                }
            }
        }
    }
}
