//! Every engine gives the same, on any number of threads.

use super::{PAIRS, figures, size, trees};
use glamx::Pose3;
use ist::{
    Engine, ForceLaw, InnerSphereTree, Overlap, OverlapCache, OverlapPair, OverlapQuery, OverlapWorkspace,
    overlap_batch, reference,
};
use rapier_ist_tests::Truth;

const LAWS: [ForceLaw; 3] = [ForceLaw::VolumeGradient, ForceLaw::OutwardNormals, ForceLaw::Blended];

fn poses(name: &str) -> Vec<Pose3> {
    Truth::load(name).unwrap().poses.iter().map(|pose| pose.pose()).collect()
}

/// Bit for bit, and different from zero somewhere.
fn assert_equal(what: &str, results: &[Vec<Overlap>]) {
    assert!(results[0].iter().any(|overlap| overlap.pairs > 1_000), "{what}: not much to compare");
    for other in &results[1..] {
        for (i, (one, other)) in results[0].iter().zip(other).enumerate() {
            // Debug text tells every bit of a float apart, the sign of zeros too.
            assert_eq!(format!("{one:?}"), format!("{other:?}"), "{what}, pose {i}");
        }
    }
}

#[test]
fn threads_do_not_matter() {
    for (name, assets, scale) in PAIRS {
        let [a, b] = trees(assets, scale, 3_000);
        let poses: Vec<Pose3> = poses(name).into_iter().step_by(7).collect();
        let pairs: Vec<OverlapPair> = poses.iter().map(|&pose| OverlapPair { a: &a, b: &b, pose }).collect();
        for engine in [Engine::Tree, Engine::Grid, Engine::Auto] {
            let query = OverlapQuery { engine, stiffness: true, ..OverlapQuery::default() };
            let one_by_one = || -> Vec<Overlap> {
                let mut workspace = OverlapWorkspace::default();
                poses.iter().map(|pose| a.overlap_with(&b, pose, query, &mut workspace)).collect()
            };
            let results: Vec<Vec<Overlap>> = [1, 2, 3, 8]
                .into_iter()
                .flat_map(|threads| {
                    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                    pool.install(|| [one_by_one(), overlap_batch(&pairs, query)])
                })
                .collect();
            assert_equal(&format!("{name}, {engine:?}"), &results);
        }
    }
}

/// Greatest differences, each relative to its own scale.
#[derive(Debug, Default)]
struct Differences {
    volume: f64,
    gradient: f64,
    force: f64,
    torque: f64,
    stiffness: f64,
}

impl Differences {
    fn raise(&mut self, [one, other]: [&Overlap; 2], exact: &reference::ReferenceOverlap, reach: f64) {
        let far = |a: glam::Vec3, b: glam::Vec3| (a - b).as_dvec3().length();
        let (volume, area) = (exact.volume, exact.area);
        let raise = |greatest: &mut f64, value: f64| *greatest = greatest.max(value);
        raise(&mut self.volume, f64::from(one.volume - other.volume).abs() / volume);
        raise(&mut self.gradient, far(one.gradient, other.gradient) / area);
        raise(&mut self.gradient, far(one.rotation_gradient, other.rotation_gradient) / (area * reach));
        raise(&mut self.force, far(one.force, other.force) / volume);
        raise(&mut self.torque, far(one.torque, other.torque) / (volume * reach));
        let rows = |overlap: &Overlap| overlap.stiffness.map(|stiffness| stiffness.to_rows());
        for (i, (row, other)) in rows(one).iter().flatten().zip(rows(other).iter().flatten()).enumerate() {
            for (j, (x, y)) in row.iter().zip(other).enumerate() {
                let scale = exact.stiffness_scale * reach.powi(i32::from(i >= 3) + i32::from(j >= 3));
                raise(&mut self.stiffness, f64::from(x - y).abs() / scale);
            }
        }
    }

    fn all(&self) -> [f64; 5] {
        [self.volume, self.gradient, self.force, self.torque, self.stiffness]
    }
}

/// Results with all laws; the last one has the stiffness.
fn by(engine: Engine, [a, b]: [&InnerSphereTree; 2], pose: &Pose3) -> [Overlap; 3] {
    LAWS.map(|law| {
        let query = OverlapQuery { law, stiffness: true, engine };
        let mut overlap = a.overlap_with(b, pose, query, &mut OverlapWorkspace::default());
        if law == ForceLaw::VolumeGradient {
            // Its force is the gradient, an area: compared as that.
            (overlap.force, overlap.torque) = (glam::Vec3::ZERO, glam::Vec3::ZERO);
        }
        overlap
    })
}

#[test]
fn tree_grid_and_cache_agree() {
    for (name, assets, scale) in PAIRS {
        let [a, b] = trees(assets, scale, 1_000);
        let reach = size(&a).max(size(&b));
        let (mut grid, mut cached) = (Differences::default(), Differences::default());
        let (mut cache, mut workspace) = (OverlapCache::default(), OverlapWorkspace::default());
        let mut touching = 0;
        for pose in poses(name) {
            let by_tree = by(Engine::Tree, [&a, &b], &pose);
            let by_grid = by(Engine::Grid, [&a, &b], &pose);
            let query = OverlapQuery { stiffness: true, ..OverlapQuery::default() };
            // The cache makes its lists at the second of two poses that are close to each other.
            let mut by_cache = Overlap::default();
            for step in [2.0, 1.0, 0.0] {
                let near = Pose3::from_parts(pose.translation + step * 1e-3 * size(&b) as f32, pose.rotation);
                by_cache = a.overlap_cached(&b, &near, query, (&mut cache, &mut workspace));
            }
            let exact = reference::overlap(&a, &b, &pose);
            assert!(by_tree[0].pairs.abs_diff(exact.pairs) <= 1 + exact.pairs / 1000, "{name} at {pose:?}");
            if exact.volume == 0.0 {
                continue;
            }
            touching += 1;
            for (one, other) in by_tree.iter().zip(&by_grid) {
                assert_eq!(
                    (one.pairs, one.intersects),
                    (other.pairs, other.intersects),
                    "{name} at {pose:?}"
                );
                assert_eq!(one.deepest.map(|d| d.depth), other.deepest.map(|d| d.depth));
                grid.raise([one, other], &exact, reach);
            }
            assert_eq!((by_tree[2].pairs, by_tree[2].intersects), (by_cache.pairs, by_cache.intersects));
            cached.raise([&by_tree[2], &by_cache], &exact, reach);
        }
        let walks = cache.walks();
        println!(
            "{name}, {touching} poses, volume, gradient, force, torque, stiffness: tree against grid {}; against cache ({walks} walks) {}",
            figures(&grid.all()),
            figures(&cached.all())
        );
        assert!(touching > 50 && grid.all().into_iter().chain(cached.all()).all(|x| x < 1e-5), "{name}");
    }
}
