//! Which way faces look: parts that touch along edges, whole or with faces turned.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

mod common;
#[path = "common/random.rs"]
mod random;

use common::inverted;
use glam::DVec3;
use packer::{MeshError, Solid, TriangleMesh};
use proptest::prelude::*;
use random::{Blocks, blocks};

/// The promise of [`Solid::mesh`]: it encloses the same solid, and nothing in it has to be turned again.
fn check_mended(solid: &Solid) -> Result<(), TestCaseError> {
    let again = Solid::new(solid.mesh())
        .map_err(|error| TestCaseError::fail(format!("what was mended is refused: {error}")))?;
    prop_assert_eq!((again.diagnosis().turned_faces, again.diagnosis().reversed_shells), (0, 0));
    let (first, second) = (solid.properties().volume, again.properties().volume);
    prop_assert!((first - second).abs() <= 1e-12 * first, "{first} m³ became {second} m³");
    Ok(())
}

/// Turns one face of `one_in`.
fn with_turned(mesh: &TriangleMesh, seed: u64, one_in: u64) -> TriangleMesh {
    let mut mesh = mesh.clone();
    for (index, triangle) in mesh.triangles.iter_mut().enumerate() {
        if hash(seed, index as u64).is_multiple_of(one_in) {
            triangle.swap(1, 2);
        }
    }
    mesh
}

/// Moves corners by up to `most` along each axis; those of one place stay together.
fn with_noise(mesh: &TriangleMesh, seed: u64, most: f64) -> TriangleMesh {
    let mut mesh = mesh.clone();
    for vertex in &mut mesh.vertices {
        let place = vertex.dot(DVec3::new(1.0, 4.0, 16.0)) as u64;
        let step = |axis: u64| (hash(seed, 3 * place + axis) % 2001) as f64 / 1000.0 - 1.0;
        *vertex += most * DVec3::new(step(0), step(1), step(2));
    }
    mesh
}

fn hash(seed: u64, index: u64) -> u64 {
    // The constant of Fibonacci hashing.
    (seed ^ index).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 20
}

/// Six cubes around an empty place, and two more, all inside out: turning the shells that were read from it had no end. One such mesh in
/// 20,000 was refused.
#[test]
fn issue_cubes_around_a_void_may_look_inwards() {
    let around = [[0, 1, 1], [1, 0, 1], [1, 1, 0], [1, 1, 2], [1, 2, 1], [2, 1, 1]];
    let blocks = Blocks::of(around.into_iter().chain([[0, 1, 0], [2, 0, 1]]).collect());
    for mesh in [&blocks.mesh, &inverted(&blocks.mesh)] {
        let solid = Solid::new(mesh).unwrap();
        assert!((solid.properties().volume - 8.0).abs() < 1e-12);
        assert!(!solid.contains(DVec3::splat(1.5)));
        assert_eq!(solid.diagnosis().turned_faces, 0);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn blocks_are_solids_of_their_volume_whichever_way_all_faces_look(blocks in blocks()) {
        for mesh in [&blocks.mesh, &inverted(&blocks.mesh)] {
            let solid = Solid::new(mesh).map_err(|error| TestCaseError::fail(error.to_string()))?;
            prop_assert!((solid.properties().volume - blocks.cubes.len() as f64).abs() < 1e-12);
            for cube in (0..27).map(|i| [i % 3, i / 3 % 3, i / 9]) {
                let center = DVec3::from_array(cube.map(f64::from)) + 0.5;
                prop_assert_eq!(solid.contains(center), blocks.cubes.contains(&cube), "{:?}", cube);
            }
            check_mended(&solid)?;
        }
    }

    #[test]
    fn blocks_with_turned_faces_are_mended_or_refused_by_name(
        blocks in blocks(),
        seed in any::<u64>(),
        one_in in 1..40_u64,
        noise in prop_oneof![Just(0.0), 0.0..2.0],
    ) {
        let mesh = with_noise(&with_turned(&blocks.mesh, seed, one_in), seed, noise);
        match Solid::new(&mesh) {
            Ok(solid) => check_mended(&solid)?,
            Err(error) => prop_assert!(
                matches!(error, MeshError::NonManifoldEdges { .. } | MeshError::NotOrientable { .. }),
                "{error}"
            ),
        }
    }
}
