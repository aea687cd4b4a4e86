//! Makes every picture of README.md and docs again: `cargo run --release -p rapier-ist-examples --bin gallery`.
//!
//! With a word as argument, as `-- chain`, it makes only the pictures whose command has that word; those of `replay` come
//! with `-- pile`, whose recording they need.
//!
//! Runs the examples as their users do, one after the other, and stops where a check fails. The whole takes about two minutes
//! on two cores. Pictures go to `docs`, recordings to a temporary folder.

use anyhow::{Context, Result, ensure};
use rapier_ist_examples::accuracy::compare;
use rapier_ist_examples::output::write_whole;
use rapier_ist_examples::pair::PairSolid;
use rapier_ist_examples::plot;
use rapier_ist_examples::poses::PoseFile;
use rapier_ist_examples::scenes::asset_folder;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Commands after `cargo run --release`, with `DOCS` and `TMP` for the folders. The package is named so that nothing is built
/// again that was built for this program.
const COMMANDS: &[&str] = &[
    "-p rapier-ist-examples --example pile -- --timings --png-width 960 --png DOCS/pile.png --mcap TMP/pile.mcap",
    "-p rapier-ist-examples --example chain -- --png-time 2.5 --png-width 480 --png DOCS/gallery/chain.png --mcap TMP/chain.mcap",
    "-p rapier-ist-examples --example inside -- --png-time 1 --png-width 480 --png DOCS/gallery/inside.png --mcap TMP/inside.mcap",
    "-p rapier-ist-examples --example buoyancy -- --png-width 480 --png DOCS/gallery/buoyancy.png --mcap TMP/buoyancy.mcap",
    "-p rapier-ist-examples --example gears -- --steps 600 --png-width 480 --png DOCS/gallery/gears.png --mcap TMP/gears.mcap",
    "-p rapier-ist-examples --example bolt -- --png-time 2.5 --png-width 480 --png DOCS/gallery/bolt.png --mcap TMP/bolt.mcap",
    "-p rapier-ist-examples --example assembly -- --png-time 2.9 --png-width 480 --png DOCS/gallery/assembly.png --mcap TMP/assembly.mcap",
    "-p rapier-ist-examples --example overlap -- assets/bunny.obj assets/bunny.obj tests/data/bunny_bunny.json --png-width 480 --png DOCS/gallery/overlap.png",
    "-p rapier-ist-examples --example haptic -- --seconds 1 --png-width 480 --png DOCS/gallery/haptic.png",
    "-p rapier-ist-examples --example replay -- TMP/pile.mcap --plot DOCS/gallery/pile.svg --apng DOCS/gallery/replay.png --apng-width 240 --until 2.5 --rate 12",
    "-p rapier-ist-packer --bin packer -- pack assets/bunny.obj -o TMP/bunny.ist --preview DOCS/packing.png",
];

/// Pairs of the plot of errors: pose file, meshes, name.
const PAIRS: [(&str, [&str; 2], &str); 3] = [
    ("bunny_bunny", ["bunny", "bunny"], "bunny, bunny"),
    ("gears", ["spider_gear", "pinion_gear"], "spider gear, pinion gear"),
    ("bunny_inside", ["bunny", "bunny"], "bunny, bunny a fifth as large"),
];
/// Spheres per solid of the plot.
const SPHERES: usize = 1000;

fn main() -> Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let (docs, temporary) = (root.join("docs"), tempfile::tempdir()?);
    std::fs::create_dir_all(docs.join("gallery")).context("cannot make the folder docs/gallery")?;
    let word = std::env::args().nth(1).unwrap_or_default();
    for command in COMMANDS.iter().filter(|command| command.contains(&word)) {
        run(command, &root, &docs, temporary.path())?;
    }
    if "accuracy".contains(&word) {
        println!("== accuracy");
        write_whole(&docs.join("accuracy.svg"), accuracy(&root)?.as_bytes())?;
    }
    Ok(())
}

/// Runs one command in the project's folder.
fn run(command: &str, root: &Path, docs: &Path, temporary: &Path) -> Result<()> {
    println!("== cargo run --release {command}");
    let folder = |path: &Path| path.to_string_lossy().into_owned();
    let (docs, temporary) = (folder(docs), folder(temporary));
    let arguments =
        command.split_whitespace().map(|word| word.replace("DOCS", &docs).replace("TMP", &temporary));
    // `cargo run` says which cargo it is.
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(cargo)
        .args(["run", "--quiet", "--release"])
        .args(arguments)
        .current_dir(root)
        .status()?;
    ensure!(status.success(), "{command}: {status}");
    Ok(())
}

/// The plot of errors.
fn accuracy(root: &Path) -> Result<String> {
    let group = |(poses, meshes, name): &(&str, [&str; 2], &str)| -> Result<_> {
        let file = PoseFile::load(&root.join(format!("tests/data/{poses}.json")))?;
        let path = |mesh: &str| -> PathBuf { asset_folder().join(format!("{mesh}.obj")) };
        let a = PairSolid::load(&path(meshes[0]), SPHERES)?;
        let b = PairSolid::load(&path(meshes[1]), SPHERES)?;
        let scale = file.scale_b.unwrap_or(1.0);
        compare(name, &file, &[a, PairSolid { scale, ..b }])
    };
    plot::accuracy(&PAIRS.iter().map(group).collect::<Result<Vec<_>>>()?)
}
