//! Growth of the time of a query of two fully overlapping solids with the number of spheres, and their memory.
//!
//! ```sh
//! cargo bench -p rapier-ist-benches --bench scaling
//! cargo bench -p rapier-ist-benches --bench scaling -- --svg docs/scaling.svg
//! ```
//! The first prints tables after Criterion's report. The second leaves Criterion out, and draws the tables too; the path
//! is relative to the workspace. With `--large`, the row of rabbits goes on to 1,000,000 spheres; they are packed once,
//! which takes minutes, and kept in Cargo's target folder.

mod arguments;
mod criterion;
mod measure;
mod plot;
mod solids;
mod table;
mod turn;

use arguments::Arguments;
use measure::{Measurement, Pools};
use solids::Row;
use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};
use std::alloc::System;
use std::error::Error;
use turn::Turn;

/// Counts bytes, so that the memory of trees and grids is what they ask for and not what they say of themselves.
#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// How the two solids lie: nearly coincident, nearly coincident in the measure of their spheres, and as any two do.
const TURNS: [Turn; 3] = [Turn::Angle(0.01), Turn::Radii(0.2), Turn::Angle(0.3)];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::parse()?;
    if !arguments.bench {
        return Ok(());
    }
    let rows = [Row::bars()?, Row::cubes()?, Row::rabbits(arguments.large)?];
    if arguments.criterion {
        criterion::run(&rows[2])?;
    }
    if !arguments.tables {
        return Ok(());
    }
    let pools = Pools::new()?;
    let mut drawn = Vec::new();
    for row in &rows {
        let mut last = Vec::new();
        for turn in row.turns {
            last = measure::measure(row, *turn, &pools)?;
            table::print(row, *turn, &last);
        }
        // One plot is enough: the others differ by a factor.
        drawn.push((row, last));
    }
    if let Some(path) = &arguments.svg {
        plot::draw(path, &drawn)?;
        println!("\n{} is drawn.", path.display());
    }
    Ok(())
}
