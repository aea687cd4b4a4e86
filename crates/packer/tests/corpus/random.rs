//! Random meshes and random bytes.

use crate::certificate::certify;
use crate::common::{bumpy_sphere, cuboid, join, rotated, scaled};
use crate::files::{cubes, outcome};
use crate::guarded;
use glam::{DQuat, DVec3};
use packer::{PackOptions, Solid, TriangleMesh, pack};
use proptest::prelude::*;
use tempfile::TempDir;

/// A rigid motion and a scale.
fn placement() -> impl Strategy<Value = (DQuat, DVec3, f64)> {
    let unit = -1.0..1.0_f64;
    (prop::array::uniform4(unit.clone()), prop::array::uniform3(unit), -4.0..4.0_f64).prop_map(
        |(q, place, scale)| {
            let turn = DQuat::from_array(q);
            let turn = if turn.length() > 0.1 { turn.normalize() } else { DQuat::IDENTITY };
            (turn, DVec3::from_array(place) * 20.0, 10.0_f64.powf(scale))
        },
    )
}

/// Boxes with corners on a lattice of sixths, turned so that faces are still flush but no longer exactly.
fn boxes() -> impl Strategy<Value = Vec<[[u8; 3]; 2]>> {
    let one = (prop::array::uniform3(0..5_u8), prop::array::uniform3(1..4_u8))
        .prop_map(|(lower, size)| [lower, [lower[0] + size[0], lower[1] + size[1], lower[2] + size[2]]]);
    prop::collection::vec(one, 2..5)
}

/// Volume of a union of boxes, counted in cells of the lattice.
fn union_volume(boxes: &[[[u8; 3]; 2]]) -> f64 {
    let inside = |p: [u8; 3]| boxes.iter().any(|[l, u]| (0..3).all(|i| l[i] <= p[i] && p[i] < u[i]));
    let cells = (0..8_u8).flat_map(|x| (0..8_u8).flat_map(move |y| (0..8_u8).map(move |z| [x, y, z])));
    cells.filter(|p| inside(*p)).count() as f64
}

fn certified(name: &str, mesh: TriangleMesh) {
    let name = name.to_owned();
    guarded(&name.clone(), move || {
        let solid = Solid::new(&mesh).unwrap();
        let packed = pack(&solid, &PackOptions::fast().spheres(50)).unwrap();
        certify(&name, &mesh, &solid, &packed.packing);
    });
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn bumpy_balls_anywhere_are_packed(seed in 0..1_000_u32, bump in 0.0..0.4_f64, (turn, place, scale) in placement()) {
        let ball = rotated(&bumpy_sphere(10, 1.0, bump, seed), turn, place);
        certified("bumpy ball", scaled(&ball, scale));
    }

    #[test]
    fn bumpy_balls_that_overlap_are_packed(seeds in prop::array::uniform3(0..1_000_u32), (turn, place, _) in placement()) {
        let ball = |i: usize| bumpy_sphere(8, 1.0, 0.3, seeds[i]);
        let three = join(&join(&ball(0), &rotated(&ball(1), turn, place * 0.04)), &rotated(&ball(2), turn, place * -0.03));
        certified("overlapping balls", three);
    }

    #[test]
    fn unions_of_boxes_are_packed(list in boxes(), (turn, place, scale) in placement()) {
        let mesh = list
            .iter()
            .map(|corners| {
                let [lower, upper] = corners.map(|c| DVec3::from_array(c.map(f64::from)));
                scaled(&rotated(&cuboid(lower, upper), turn, place), scale)
            })
            .reduce(|a, b| join(&a, &b))
            .unwrap();
        // A box that lies inside another and touches none of its faces is a cavity.
        let is_inside = |a: &[[u8; 3]; 2], b: &[[u8; 3]; 2]| (0..3).all(|i| b[0][i] < a[0][i] && a[1][i] < b[1][i]);
        prop_assume!(!list.iter().any(|a| list.iter().any(|b| is_inside(a, b))));
        let solid = Solid::new(&mesh).unwrap();
        prop_assert_eq!(solid.diagnosis().cavities, 0);
        let (volume, expected) = (solid.properties().volume, union_volume(&list) * scale.powi(3));
        prop_assert!((volume / expected - 1.0).abs() < 1e-9, "{} is not {}", volume, expected);
        certified("boxes", mesh);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_have_an_answer(format in 0..8_usize, bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let folder = TempDir::new().unwrap();
        let (extension, content) = cubes().swap_remove(format);
        let path = folder.path().join(format!("noise.{extension}"));
        // Alone, and behind the first half of a good file.
        let both = [&content[..content.len() / 2], &bytes].concat();
        guarded(extension, move || {
            let _ = (outcome(&path, &bytes), outcome(&path, &both));
        });
    }

    #[test]
    fn damaged_files_have_an_answer(format in 0..8_usize, damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)) {
        let folder = TempDir::new().unwrap();
        let (extension, mut content) = cubes().swap_remove(format);
        for (place, byte) in damage {
            let place = place.index(content.len());
            content[place] = byte;
        }
        let path = folder.path().join(format!("damaged.{extension}"));
        guarded(extension, move || {
            let _ = outcome(&path, &content);
        });
    }
}
