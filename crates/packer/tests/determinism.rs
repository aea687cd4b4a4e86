//! Packings and queries are to give the same bits whatever they were compiled for and on any number of threads.
//!
//! `tests/determinism.sh` compiles these tests with other flags. Where a change of an algorithm is meant to change results,
//! the values below are replaced by those that the failing test prints.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use glam::{Mat3, Quat, Vec3};
use glamx::Pose3;
use ist::{
    BallKind, Budget, Engine, ImpactOptions, InnerSphereTree, OverlapCache, OverlapQuery, OverlapWorkspace,
    ProximityWorkspace, Ray, RigidMotion, SpherePacking, TimeCriticalWorkspace,
};
use packer::{PackOptions, Solid, TriangleMesh, pack};
use std::fmt::Debug;
use std::path::Path;

const SPHERES: usize = 300;
const POSES: usize = 40;
const THREADS: [usize; 4] = [1, 2, 3, 8];

/// Checksums of the packings of two meshes.
const PACKINGS: [(&str, u32); 2] = [("bunny", 2_223_080_614), ("pinion_gear", 3_718_212_269)];
/// Checksums of what queries find in them, by kind.
const QUERIES: [(&str, u32); 6] = [
    ("overlap", 1_115_351_977),
    ("cached overlap", 1_930_806_662),
    ("samples", 3_736_660_009),
    ("time-critical", 2_024_979_025),
    ("proximity", 1_682_223_568),
    ("impact", 2_750_706_955),
];

/// Of the figures as text, which tells any two numbers apart.
fn checksum(results: &impl Debug) -> u32 {
    crc32fast::hash(format!("{results:?}").as_bytes())
}

fn packing(name: &str) -> SpherePacking {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../assets/{name}.obj"));
    let solid = Solid::new(&TriangleMesh::load(path).unwrap()).unwrap();
    pack(&solid, &PackOptions::balanced().spheres(SPHERES)).unwrap().packing
}

/// Runs `work` on every number of threads; the results have to agree.
fn on_any_number_of_threads<T: PartialEq + Debug + Send>(work: impl Fn() -> T + Sync) -> T {
    let results = THREADS.map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(&work)
    });
    let [first, others @ ..] = results;
    for (result, threads) in others.iter().zip(&THREADS[1..]) {
        assert_eq!(*result, first, "{threads} threads against one");
    }
    first
}

/// Trees of both packings with the longest sides about 1, so that one list of poses serves any of them.
fn trees() -> [InnerSphereTree; 2] {
    ["bunny", "pinion_gear"].map(|name| {
        let tree = InnerSphereTree::new(&packing(name));
        let size = tree.bounding_ball().1;
        tree.scaled(0.5 / size).unwrap().with_grid()
    })
}

/// Poses from far inside each other to apart, by integers and IEEE operations only.
fn poses([a, b]: &[InnerSphereTree; 2]) -> Vec<Pose3> {
    let mut state = 1_u32;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 23) as f32 - 1.0
    };
    let mut pose = || {
        let [x, y, z, w] = [next(), next(), next(), next() + 1.5];
        let length = (x * x + y * y + z * z + w * w).sqrt();
        let rotation = Quat::from_xyzw(x / length, y / length, z / length, w / length);
        let apart = 0.6 * Vec3::new(next(), next(), next());
        // The centres of their bounding balls are `apart`. By a matrix: glam multiplies quaternions with fused operations where
        // it is compiled for a processor that has them.
        let center = a.bounding_ball().0 - Mat3::from_quat(rotation) * b.bounding_ball().0;
        Pose3::from_parts(center + apart, rotation)
    };
    (0..POSES).map(|_| pose()).collect()
}

/// What every kind of query finds at all poses, in the order of [`QUERIES`].
fn queries(trees: &[InnerSphereTree; 2], poses: &[Pose3]) -> [u32; 6] {
    let [a, b] = trees;
    let (overlap_space, proximity_space) =
        (&mut OverlapWorkspace::default(), &mut ProximityWorkspace::default());
    let query = OverlapQuery { stiffness: true, ..OverlapQuery::default() };
    let overlaps: Vec<_> = poses
        .iter()
        .flat_map(|pose| [Engine::Tree, Engine::Grid].map(|engine| (pose, OverlapQuery { engine, ..query })))
        .map(|(pose, query)| a.overlap_with(b, pose, query, overlap_space))
        .collect();
    assert!(overlaps.iter().filter(|overlap| overlap.pairs > 0).count() > POSES, "half of the poses overlap");
    let cache = &mut OverlapCache::default();
    let cached: Vec<_> = poses
        .iter()
        .flat_map(|pose| {
            (0..3).map(|i| Pose3 { translation: pose.translation + Vec3::X * (0.001 * i as f32), ..*pose })
        })
        .map(|pose| a.overlap_cached(b, &pose, query, (cache, overlap_space)))
        .collect();
    let mut samples = Vec::new();
    let mut patches = Vec::new();
    let regions: Vec<_> = poses
        .iter()
        .map(|pose| {
            a.contact_samples(b, pose, overlap_space, &mut samples);
            a.flush_contact_samples(b, pose, overlap_space, &mut samples);
            a.contact_patches(b, pose, overlap_space, &mut patches);
            patches.clone()
        })
        .collect();
    let time_critical = &mut TimeCriticalWorkspace::default();
    let estimates: Vec<_> = poses
        .iter()
        .flat_map(|pose| [10, 100, 1000].map(|visits| (pose, Budget::Visits(visits))))
        .map(|(pose, budget)| a.overlap_within(b, pose, budget, time_critical))
        .collect();
    let proximity: Vec<_> = poses
        .iter()
        .map(|pose| {
            let point = pose.translation;
            let ray = Ray { origin: point * 3.0, direction: -point, max_time: 3.0 };
            let single = (a.nearest_sphere(point, BallKind::Volume), a.cast_ray(&ray, true, BallKind::Inner));
            let pair = (a.distance(b, pose, proximity_space), a.penetration(b, pose, proximity_space));
            (single, pair, a.intersects(b, pose, proximity_space))
        })
        .collect();
    let impacts: Vec<_> = poses
        .iter()
        .map(|pose| {
            let start = Pose3 { translation: pose.translation * 3.0, ..*pose };
            let moving = RigidMotion {
                linear_velocity: -2.0 * pose.translation,
                angular_velocity: Vec3::new(3.0, 1.0, -2.0),
                ..RigidMotion::at_rest(start)
            };
            let motions = [RigidMotion::at_rest(Pose3::IDENTITY), moving];
            let impact = a.time_of_impact(b, &motions, &ImpactOptions::default(), proximity_space);
            (impact, moving.pose_at(0.7))
        })
        .collect();
    [
        checksum(&overlaps),
        checksum(&cached),
        checksum(&(samples, regions)),
        checksum(&estimates),
        checksum(&proximity),
        checksum(&impacts),
    ]
}

#[test]
fn packings_are_the_same_everywhere() {
    let found = PACKINGS.map(|(name, _)| {
        (
            name,
            on_any_number_of_threads(|| {
                let packing = packing(name);
                checksum(&(packing.spheres(), packing.solid()))
            }),
        )
    });
    assert_eq!(found, PACKINGS);
}

#[test]
fn queries_are_the_same_everywhere() {
    let trees = trees();
    let poses = poses(&trees);
    let found = on_any_number_of_threads(|| queries(&trees, &poses));
    let found: Vec<_> = QUERIES.iter().map(|(kind, _)| *kind).zip(found).collect();
    assert_eq!(found, QUERIES);
}
