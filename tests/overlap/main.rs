//! What overlap queries promise, on the assets: figures of the theory, conservation laws, and equal results from every engine.
//!
//! `cargo test -p rapier-ist-tests --test overlap -- --nocapture` prints the figures.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod engines;
mod partners;
mod work;
mod wrench;

use glam::{Quat, Vec3};
use glamx::Pose3;
use ist::{InnerSphereTree, SpherePacking};
use packer::{PackOptions, Solid, TriangleMesh, pack};
use rapier_ist_examples::scenes::asset_folder;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock};

/// The meshes in `assets/`.
const ASSETS: [&str; 5] = ["bunny", "spider_gear", "pinion_gear", "pelvis", "femur"];

/// Name, meshes and scale of B of the pairs in `tests/data`.
const PAIRS: [(&str, [&str; 2], f32); 4] = [
    ("bunny_bunny", ["bunny", "bunny"], 1.0),
    ("gears", ["spider_gear", "pinion_gear"], 1.0),
    ("bones", ["pelvis", "femur"], 1.0),
    ("bunny_inside", ["bunny", "bunny"], 0.2),
];

/// The packing of an asset, made once for all tests.
fn packing(asset: &'static str, spheres: usize) -> Arc<SpherePacking> {
    type Made = BTreeMap<(&'static str, usize), Arc<OnceLock<Arc<SpherePacking>>>>;
    static MADE: Mutex<Made> = Mutex::new(BTreeMap::new());
    let cell = Arc::clone(MADE.lock().unwrap().entry((asset, spheres)).or_default());
    let made = cell.get_or_init(|| {
        let mesh = TriangleMesh::load(asset_folder().join(format!("{asset}.obj"))).unwrap();
        let options = PackOptions::balanced().spheres(spheres);
        Arc::new(pack(&Solid::new(&mesh).unwrap(), &options).unwrap().packing)
    });
    Arc::clone(made)
}

/// Trees with grids of two assets, B at its scale.
fn trees(assets: [&'static str; 2], scale_b: f32, spheres: usize) -> [InnerSphereTree; 2] {
    let [a, b] = assets.map(|asset| InnerSphereTree::new(&packing(asset, spheres)).with_grid());
    [a, b.scaled(scale_b).unwrap()]
}

/// Small numbers with one digit behind the point.
fn figures(numbers: &[f64]) -> String {
    numbers.iter().map(|number| format!("{number:.1e}")).collect::<Vec<_>>().join(", ")
}

/// Radius (m) of the ball of a solid's volume: its size.
fn size(tree: &InnerSphereTree) -> f64 {
    (tree.solid().volume * 0.75 / std::f64::consts::PI).cbrt()
}

/// Poses that bring B's centroid near A's, within `reach`, turned at random; always the same.
fn random_poses(trees: [&InnerSphereTree; 2], reach: f32, count: u32) -> impl Iterator<Item = Pose3> {
    let [to, from] = trees.map(|tree| tree.solid().centroid.as_vec3());
    // Steps along the roots of x⁷ = x + 1: evenly spread, whatever the count.
    let spread = move |i: u32, k: i32| {
        let step = 1.112_775_684_278_705_f64.powi(-k);
        2.0 * ((0.5 + f64::from(i) * step).fract() as f32) - 1.0
    };
    (1..=count).map(move |i| {
        let vector = |k: i32| Vec3::new(spread(i, k), spread(i, k + 1), spread(i, k + 2));
        let rotation = Quat::from_scaled_axis(vector(1) * std::f32::consts::PI);
        Pose3::from_parts(to + vector(4) * reach - rotation * from, rotation)
    })
}
