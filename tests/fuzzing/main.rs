//! The properties of the fuzz targets on seeds, on inputs that once failed, on damaged seeds and on pseudo-random bytes.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use packer::{Solid, TriangleMesh};
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rapier_ist::replay::{Replay, ReplayEnd};
use rapier_ist_tests::fuzzing::{TARGETS, Target};
use std::path::{Path, PathBuf};

/// Files of a folder beside the fuzz targets, by name.
fn files(folder: &str, target: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz").join(folder).join(target);
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort_unstable();
    paths.into_iter().map(|path| (path.clone(), std::fs::read(path).unwrap())).collect()
}

fn target(name: &str) -> Target {
    *TARGETS.iter().find(|(target, _)| *target == name).unwrap()
}

/// Seeds and regressions as they are, and `damaged` times each seed with some bytes changed; then `random` inputs.
fn run(name: &str, damaged: u32, random: u32) {
    let (name, check) = target(name);
    let seeds = files("seeds", name);
    assert!(!seeds.is_empty(), "{name} has no seeds");
    for (path, bytes) in seeds.iter().chain(&files("regressions", name)) {
        // Shown if the check fails.
        println!("{}", path.display());
        check(bytes);
    }
    let mut rng = Pcg64Mcg::seed_from_u64(7);
    for (path, bytes) in &seeds {
        for round in 0..damaged {
            println!("{}, damaged for the {round}th time", path.display());
            check(&damage(bytes, &mut rng));
        }
    }
    for round in 0..random {
        println!("random bytes, round {round}");
        let mut bytes = vec![0; rng.random_range(0..1_500)];
        rng.fill_bytes(&mut bytes);
        check(&bytes);
    }
}

fn damage(bytes: &[u8], rng: &mut impl Rng) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..rng.random_range(1..4) {
        if bytes.is_empty() {
            break;
        }
        let at = rng.random_range(0..bytes.len());
        match rng.random_range(0..8) {
            0 => bytes.truncate(at),
            1 => drop(bytes.remove(at)),
            2 => bytes.insert(at, rng.random()),
            3 => bytes[at] = b'9',
            _ => bytes[at] ^= 1 << rng.random_range(0..8),
        }
    }
    bytes
}

#[test]
fn ist_reader() {
    run("ist_reader", 200, 2_000);
}

#[test]
fn mesh_readers() {
    run("mesh_readers", 20, 50);
}

#[test]
fn mcap_replay() {
    run("mcap_replay", 20, 100);
}

#[test]
fn overlap() {
    run("overlap", 20, 200);
}

#[test]
fn proximity() {
    run("proximity", 10, 100);
}

#[test]
fn plugin_steps() {
    run("plugin_steps", 5, 50);
}

/// Seeds of a format must be read: the others show nothing but how errors are told.
#[test]
fn seeds_are_what_their_names_say() {
    for (path, bytes) in files("seeds", "mesh_readers") {
        let is_solid = TriangleMesh::load(&path).is_ok_and(|mesh| Solid::new(&mesh).is_ok());
        let name = path.file_name().unwrap().to_string_lossy();
        assert_eq!(is_solid, name.starts_with("solid_"), "{name}, {} bytes", bytes.len());
    }
    for (path, bytes) in files("seeds", "ist_reader") {
        let name = path.file_name().unwrap().to_string_lossy();
        assert_eq!(ist::SpherePacking::from_bytes(&bytes).is_ok(), name.starts_with("packing_"), "{name}");
    }
    for (path, bytes) in files("seeds", "mcap_replay") {
        let name = path.file_name().unwrap().to_string_lossy();
        let is_whole = Replay::from_bytes(&bytes).is_ok_and(|replay| replay.end() == &ReplayEnd::Complete);
        assert_eq!(is_whole, name.starts_with("recording_"), "{name}");
    }
}

/// No seed or regression is large, and all of them together are small.
#[test]
fn seeds_are_few_and_small() {
    let sizes = TARGETS.iter().flat_map(|(name, _)| {
        files("seeds", name).into_iter().chain(files("regressions", name)).map(|(_, bytes)| bytes.len())
    });
    assert!(sizes.sum::<usize>() < 300_000);
}
