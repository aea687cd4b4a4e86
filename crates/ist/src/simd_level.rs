//! The instruction set that queries run on.

use fearless_simd::Level;

/// The best that the processor has. Without feature `std` nobody asks it, and this is what the crate was compiled for.
/// Results are the same on every one.
#[cfg(not(test))]
pub(crate) fn simd_level() -> Level {
    best()
}

fn best() -> Level {
    Level::try_detect().unwrap_or_else(Level::baseline)
}

#[cfg(test)]
pub(crate) use tests::simd_level;

#[cfg(test)]
mod tests {
    use super::best;
    use crate::overlap::tests::random_pose;
    use crate::tree::tests::random_packing;
    use crate::{
        BallKind, DistanceOptions, Engine, InnerSphereTree, OverlapCache, OverlapQuery, OverlapWorkspace,
        ProximityWorkspace, Ray, SpherePacking,
    };
    use alloc::{format, string::String, vec, vec::Vec};
    use core::cell::Cell;
    use fearless_simd::Level;
    use glam::Vec3;
    use glamx::Pose3;
    use proptest::prelude::*;

    std::thread_local! {
        static FIXED: Cell<Option<Level>> = const { Cell::new(None) };
    }

    /// The level that a test has fixed, else the best.
    pub(crate) fn simd_level() -> Level {
        FIXED.get().unwrap_or_else(best)
    }

    /// All levels that this processor has.
    fn levels() -> Vec<Level> {
        let mut levels = vec![best(), Level::baseline()];
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        {
            levels.extend(best().as_sse2().map(Level::Sse2));
            levels.extend(best().as_sse4_2().map(Level::Sse4_2));
            levels.extend(best().as_avx2().map(Level::Avx2));
        }
        levels
    }

    /// A packing at some scale and under some skin, with grids. What a tree prepares for queries it prepares anew.
    fn tree((packing, scale, skin): &(SpherePacking, f32, f32)) -> InnerSphereTree {
        InnerSphereTree::new(packing).with_grid().scaled(*scale).unwrap().with_skin(*skin).unwrap()
    }

    fn random_solid() -> impl Strategy<Value = (SpherePacking, f32, f32)> {
        (random_packing(400), 0.5_f32..2.0, 0.0_f32..0.02)
    }

    /// What all kinds of query find, as text, which tells any two numbers apart.
    fn found([a, b]: [InnerSphereTree; 2], pose: &Pose3) -> Vec<String> {
        let (a, b) = (&a, &b);
        let (space, near) = (&mut OverlapWorkspace::default(), &mut ProximityWorkspace::default());
        let overlap = |engine, space: &mut _| {
            let query = OverlapQuery { stiffness: true, engine, ..OverlapQuery::default() };
            format!("{:?}", a.overlap_with(b, pose, query, space))
        };
        let mut found = vec![overlap(Engine::Tree, space), overlap(Engine::Grid, space)];
        let cache = &mut OverlapCache::default();
        for step in 0..3 {
            let moved = Pose3 { translation: pose.translation + Vec3::splat(1e-3 * step as f32), ..*pose };
            let query = OverlapQuery::default();
            found.push(format!("{:?}", a.overlap_cached(b, &moved, query, (&mut *cache, &mut *space))));
        }
        let (mut samples, mut patches) = (Vec::new(), Vec::new());
        a.contact_samples(b, pose, space, &mut samples);
        a.contact_patches(b, pose, space, &mut patches);
        found.push(format!("{samples:?} {patches:?}"));
        for balls in [BallKind::Inner, BallKind::Volume] {
            let options = DistanceOptions { balls, ..DistanceOptions::default() };
            let ray = Ray { origin: pose.translation, direction: -pose.translation, max_time: 2.0 };
            found.push(format!("{:?}", a.distance_with(b, pose, &options, near)));
            found.push(format!("{:?}", a.nearest_sphere(pose.translation, balls)));
            found.push(format!("{:?}", a.cast_ray(&ray, false, balls)));
        }
        found.push(format!("{} {:?}", a.intersects(b, pose, near), a.penetration(b, pose, near)));
        #[cfg(feature = "std")]
        for visits in [10, 1000] {
            let budget = crate::Budget::Visits(visits);
            let space = &mut crate::TimeCriticalWorkspace::default();
            found.push(format!("{:?}", a.overlap_within(b, pose, budget, space)));
        }
        found
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]

        #[test]
        fn every_instruction_set_gives_the_same_bits(a in random_solid(), b in random_solid(), pose in random_pose(1.0)) {
            let best = found([tree(&a), tree(&b)], &pose);
            for level in levels() {
                FIXED.set(Some(level));
                let found = found([tree(&a), tree(&b)], &pose);
                FIXED.set(None);
                prop_assert_eq!(&found, &best, "{:?}", level);
            }
        }
    }
}
