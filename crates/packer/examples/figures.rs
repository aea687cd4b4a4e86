//! Coverage and time on mesh files: `cargo run --release -p rapier-ist-packer --example figures -- N FILE...`
#![allow(clippy::unwrap_used, clippy::panic)]

use packer::{PackOptions, Solid, TriangleMesh, pack};
use std::f64::consts::PI;
use std::time::Instant;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let count: usize = arguments.next().unwrap().parse().unwrap();
    for file in arguments {
        let start = Instant::now();
        let solid = Solid::new(&TriangleMesh::load(&file).unwrap()).unwrap();
        let load = start.elapsed().as_secs_f64();
        let packed = pack(&solid, &PackOptions::balanced().spheres(count)).unwrap();
        let r = &packed.report;
        let volume = solid.properties().volume;
        let mut covered = 0.0;
        let mut line = String::new();
        for (i, s) in packed.packing.spheres().iter().enumerate() {
            covered += 4.0 / 3.0 * PI * f64::from(s.radius).powi(3) / volume;
            if [100, 1_000, 3_000, 10_000, 30_000, 100_000].contains(&(i + 1)) {
                line += &format!(" {}:{:.2}", i + 1, 100.0 * covered);
            }
        }
        let sum: f64 = packed.packing.spheres().iter().map(|s| f64::from(s.cell_volume)).sum();
        let name = file.rsplit('/').next().unwrap();
        println!(
            "{name:18}{line}  load {load:.2} place {:.2} cells {:.2} finish {:.2} s; protrusion {:.1e} overlap {:.1e} cells off {:.1e} {:?}",
            r.place_seconds,
            r.cells_seconds,
            r.finish_seconds,
            r.protrusion,
            r.overlap,
            sum / volume - 1.0,
            r.stop
        );
    }
}
