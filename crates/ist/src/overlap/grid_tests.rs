//! The grids against the tree and against brute force.

use super::grid_search::GridScratch;
use super::tests::{random_pose, tree};
use super::*;
use crate::SpherePacking;
use crate::reference;
use crate::simd_level::simd_level;
use crate::tree::WIDTH;
use crate::tree::tests::random_packing;
use alloc::vec::Vec;
use fearless_simd::dispatch;
use glam::{Quat, Vec3};
use proptest::prelude::*;

fn engine(engine: Engine) -> OverlapQuery {
    OverlapQuery { engine, stiffness: true, ..OverlapQuery::default() }
}

/// All pairs that an engine finds, in order.
fn pairs(a: &InnerSphereTree, b: &InnerSphereTree, pose: &Pose3, by: Engine) -> Vec<[u32; 2]> {
    struct Keep(Vec<[u32; 2]>);
    impl pairs::PairSink for Keep {
        fn take<S: fearless_simd::Simd>(&mut self, _: S, pairs: &pairs::PairBuffer) {
            self.0.extend((0..pairs.len()).map(|i| [pairs.b[i], pairs.a[i]]));
        }
    }
    let pose = RelativePose::new(a, b, pose).unwrap();
    let (mut keep, mut workspace) = (Keep(Vec::new()), OverlapWorkspace::default());
    let trees = (a.data(), b.data());
    match by.grids([a, b], &pose) {
        None => {
            for_each_pair(trees, &pose, &mut workspace, &mut keep);
        }
        Some(grids) => {
            let (mut tasks, scratch) = (Vec::new(), &mut GridScratch::default());
            grids.list_tasks(&mut tasks);
            for task in tasks {
                dispatch!(simd_level(), simd => grids.find_pairs(simd, &task, scratch, &mut keep));
            }
            for [in_b, in_a] in &mut keep.0 {
                *in_b = grids.b.entries[*in_b as usize].position();
                *in_a = grids.a.entries[*in_a as usize].position();
            }
        }
    }
    keep.0.sort_unstable();
    keep.0
}

/// All pairs of spheres that pass the overlap's test, one by one.
fn meeting(a: &InnerSphereTree, b: &InnerSphereTree, pose: &Pose3) -> Vec<[u32; 2]> {
    let pose = RelativePose::new(a, b, pose).unwrap();
    let placed = |i: usize| {
        let block = dispatch!(simd_level(), simd => pose.place(simd, &b.data().levels[0].blocks[i / WIDTH]));
        let lane = i % WIDTH;
        (Vec3::new(block.x[lane], block.y[lane], block.z[lane]), block.radius[lane])
    };
    let mut found = Vec::new();
    for in_b in 0..b.len() {
        let (center_b, radius_b) = placed(in_b);
        for in_a in 0..a.len() {
            let (center_a, radius_a) = a.data().levels[0].get(in_a);
            let reach = radius_a + pose.skin_a + radius_b;
            if center_a.distance_squared(center_b) < reach * reach {
                found.push([in_b as u32, in_a as u32]);
            }
        }
    }
    found
}

proptest! {
    // One in some thousands shows what the cache missed, one in some ten thousands what the grid did; 2 s.
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    #[test]
    fn issue_a_small_solid_on_the_border_of_a_large_sphere_misses_no_pair(
        a in random_packing(12), b in random_packing(60), direction in prop::array::uniform3(-1.0_f32..1.0),
        of in (0_usize..12, 0_usize..60), exponent in 3_i32..8, is_at_origin in any::<bool>(),
        turn in prop::array::uniform3(-3.0_f32..3.0),
    ) {
        let (direction, size) = (Vec3::from(direction).normalize_or(Vec3::X), 10.0_f32.powi(-exponent));
        let mut spheres = a.spheres().to_vec();
        let sphere = spheres[of.0 % spheres.len()];
        let mut border = sphere.center + sphere.volume_radius() * direction;
        if is_at_origin {
            // There the small solid's coordinates have all their digits, and only the differences round.
            spheres.iter_mut().for_each(|s| (s.center, s.cell_centroid) = (s.center - border, s.cell_centroid - border));
            border = Vec3::ZERO;
        }
        let a = tree(&SpherePacking::new(spheres, *a.solid()).unwrap()).with_grid();
        let b = tree(&b).scaled(size).unwrap().with_grid();
        let rotation = Quat::from_scaled_axis(turn.into());
        let center = b.volume_balls().nth(of.1 % b.len()).unwrap().0;
        let (mut workspace, mut cache) = (OverlapWorkspace::default(), OverlapCache::default());
        for i in 0..4 {
            let translation = border - rotation * center + direction * (size * -0.02 * i as f32);
            let pose = Pose3::from_parts(translation, rotation);
            let all = meeting(&a, &b, &pose);
            for by in [Engine::Tree, Engine::Grid] {
                prop_assert_eq!(&pairs(&a, &b, &pose, by), &all, "{:?}", by);
            }
            let by_grid = a.overlap_with(&b, &pose, engine(Engine::Grid), &mut workspace);
            prop_assert_eq!(by_grid.pairs as usize, all.len(), "grid {}", i);
            let caches = (&mut cache, &mut workspace);
            let cached = a.overlap_cached(&b, &pose, engine(Engine::Tree), caches);
            prop_assert_eq!(cached.pairs as usize, all.len(), "cached {}", i);
        }
    }
}

proptest! {
    #[test]
    fn grids_find_the_pairs_of_the_tree(
        a in random_packing(300), b in random_packing(300), pose in random_pose(1.5),
        scale in prop::array::uniform2(0.2_f32..5.0), skin in prop::array::uniform2(0.0_f32..0.1),
        ratio in 0..3,
    ) {
        let scale = [scale[0], scale[1] * [1e-3, 1.0, 1e3][ratio as usize]];
        let solid = |packing, i: usize| {
            tree(packing).scaled(scale[i]).unwrap().with_skin(skin[i]).unwrap().with_grid()
        };
        let (a, b) = (solid(&a, 0), solid(&b, 1));
        let by_tree = pairs(&a, &b, &pose, Engine::Tree);
        prop_assert_eq!(&pairs(&a, &b, &pose, Engine::Grid), &by_tree);
        let exact = reference::overlap(&a, &b, &pose);
        prop_assert!((by_tree.len() as u32).abs_diff(exact.pairs) <= 1 + exact.pairs / 1000);

        let mut workspace = OverlapWorkspace::default();
        let tree = a.overlap_with(&b, &pose, engine(Engine::Tree), &mut workspace);
        let grid = a.overlap_with(&b, &pose, engine(Engine::Grid), &mut workspace);
        prop_assert_eq!(tree.pairs, grid.pairs);
        prop_assert_eq!(tree.intersects, grid.intersects);
        prop_assert_eq!(tree.deepest.map(|d| d.depth), grid.deepest.map(|d| d.depth));
        prop_assert!((tree.volume - grid.volume).abs() <= 1e-5 * tree.volume);
        prop_assert!(tree.gradient.distance(grid.gradient) <= 1e-5 * exact.area as f32);
        let reach = 2.0 * (a.bounding_ball().1 + a.bounding_ball().0.length());
        prop_assert!(tree.centroid.distance(grid.centroid) <= 1e-5 * reach);
        prop_assert!(tree.rotation_gradient.distance(grid.rotation_gradient) <= 2e-5 * exact.area as f32 * reach);
    }
}

#[test]
fn grids_serve_all_sizes_of_a_body() {
    // Radii over seven decades, at random places and then all at one.
    for spread in [1.0, 0.0] {
        let spheres = (0..200_u32)
            .map(|i| {
                let at = |k: u32| ((i * k) % 97) as f32 / 97.0 * spread;
                let radius = 10.0_f32.powf(-7.0 * i as f32 / 200.0);
                crate::InnerSphere::solid_ball(Vec3::new(at(31), at(57), at(73)), radius, Vec3::Y)
            })
            .collect();
        let packing = crate::SpherePacking::new(spheres, crate::SolidProperties::ball(1.0)).unwrap();
        let solid = tree(&packing).with_grid();
        assert_eq!(solid.grid().unwrap().levels(), 24);
        for pose in [Pose3::IDENTITY, Pose3::translation(0.1, 0.0, 0.0), Pose3::translation(1e-6, 0.0, 0.0)] {
            assert_eq!(
                pairs(&solid, &solid, &pose, Engine::Grid),
                pairs(&solid, &solid, &pose, Engine::Tree)
            );
        }
    }
}

#[cfg(feature = "parallel")]
#[test]
fn threads_do_not_show_in_the_result() {
    // A lattice of 8,000 balls: some tasks for every thread.
    let spheres = (0..8_000_u32)
        .map(|i| {
            let at = [i % 20, i / 20 % 20, i / 400].map(|k| k as f32);
            let radius = if i % 3 == 0 { 0.5 } else { 0.2 };
            crate::InnerSphere::solid_ball(Vec3::from_array(at), radius, Vec3::Y)
        })
        .collect();
    let packing = crate::SpherePacking::new(spheres, crate::SolidProperties::ball(1.0)).unwrap();
    let solid = tree(&packing).with_grid();
    let pose = Pose3::new(Vec3::new(0.3, 0.1, 0.2), Vec3::new(0.02, 0.1, 0.05));
    let overlap = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut workspace = OverlapWorkspace::default();
        pool.install(|| solid.overlap_with(&solid, &pose, engine(Engine::Grid), &mut workspace))
    };
    let one = overlap(1);
    assert!(one.pairs > 8_000);
    assert_eq!([overlap(2), overlap(3), overlap(7)], [one; 3]);
}
