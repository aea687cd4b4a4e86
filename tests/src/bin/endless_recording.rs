//! Records a small pile until it is killed: `endless-recording FILE CHUNK_SIZE BACKGROUND`.
//!
//! After each step that was recorded it prints a line with the step's number.

use anyhow::{Context, Result};
use rapier_ist::record::{RecordOptions, Recorder};
use rapier_ist_examples::recording::describe;
use rapier_ist_tests::small_pile;
use std::io::Write;

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let mut next = || arguments.next().context("arguments: FILE CHUNK_SIZE BACKGROUND");
    let (path, chunk_size, background) = (next()?, next()?.parse()?, next()?.parse()?);
    let options = RecordOptions::everything().chunk_size(chunk_size).background(background);
    let mut pile = small_pile()?;
    let mut recorder = Recorder::create(path, options)?;
    describe(&mut recorder, &pile)?;
    recorder.record_start(&pile.world)?;
    let mut output = std::io::stdout();
    for step in 1_u64.. {
        pile.step();
        recorder.record(&pile.world, pile.plugin.report())?;
        writeln!(output, "{step}")?;
        output.flush()?;
    }
    Ok(())
}
