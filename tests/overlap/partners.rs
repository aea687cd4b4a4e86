//! The constants of the linear-time theorem on packings of the assets; random packings have them in the crate's own tests.
//!
//! *Lemma.* A ball of radius r has positive-volume overlap with at most twelve balls of radius at least r that are disjoint from
//! each other. *Theorem.* Two disjoint packings of n and m balls have at most 12(n + m) overlapping pairs. Both hold for the
//! certified inner balls; the volume balls of a packing meet each other.

use super::{ASSETS, packing, random_poses, size};
use glamx::Pose3;
use ist::{InnerSphereTree, SpherePacking, reference};
use rapier_ist_tests::plain;

/// Depth of a pair over the smaller radius from which on it overlaps; below it touches, within the rounding of places.
const TOUCH: f64 = 1e-5;

/// What was seen in a series of poses.
#[derive(Default)]
struct Seen {
    /// Most partners of one sphere that are at least as large.
    most: u32,
    /// Pairs per sphere of both packings.
    densest: f64,
    /// The same for volume balls, of which no theorem holds.
    volume_balls: f64,
}

/// For every sphere of both trees the number of its partners that are at least as large, and the number of pairs.
fn partners([a, b]: [&InnerSphereTree; 2], pose: &Pose3) -> (Vec<u32>, usize) {
    let radii = [a, b].map(|tree| tree.volume_balls().map(|(_, r)| f64::from(r)).collect::<Vec<_>>());
    let mut counts = vec![0; a.len() + b.len()];
    let (rotation, translation) = (pose.rotation.as_dquat().normalize(), pose.translation.as_dvec3());
    let mut pairs = 0;
    for pair in reference::pairs_at(a, b, rotation, translation) {
        let [i, j] = pair.spheres;
        let (r, s) = (radii[0][i], radii[1][j]);
        if r + s - pair.center_a.distance(pair.center_b) > TOUCH * r.min(s) {
            pairs += 1;
            counts[i] += u32::from(s >= r);
            counts[a.len() + j] += u32::from(r >= s);
        }
    }
    (counts, pairs)
}

impl Seen {
    /// Holds lemma and theorem.
    fn check(&mut self, trees: [&InnerSphereTree; 2], pose: &Pose3) {
        let (counts, pairs) = partners(trees, pose);
        let most = counts.iter().copied().max().unwrap_or(0);
        assert!(most <= 12, "{most} partners");
        assert!(pairs <= 12 * counts.len(), "{pairs} pairs of {} spheres", counts.len());
        self.most = self.most.max(most);
        self.densest = self.densest.max(pairs as f64 / counts.len() as f64);
    }

    fn count_volume_balls(&mut self, trees: [&InnerSphereTree; 2], pose: &Pose3) {
        let overlap = trees[0].overlap(trees[1], pose, &mut Default::default());
        let spheres = (trees[0].len() + trees[1].len()) as f64;
        self.volume_balls = self.volume_balls.max(f64::from(overlap.pairs) / spheres);
    }
}

/// The first inner balls of a packing, which are the packing of that many.
fn inner(whole: &SpherePacking, spheres: usize) -> InnerSphereTree {
    let first = whole.spheres()[..spheres].to_vec();
    let part = SpherePacking::new(first, *whole.solid()).unwrap();
    InnerSphereTree::new(&plain(&part).unwrap())
}

#[test]
fn at_most_twelve_partners_are_as_large() {
    for spheres in [100, 1_000] {
        let solids = ASSETS.map(|asset| (inner(&packing(asset, 1_000), spheres), packing(asset, 1_000)));
        for (index, asset) in ASSETS.iter().enumerate() {
            let mut seen = Seen::default();
            for partner in [index, (index + 1) % ASSETS.len()] {
                let a = &solids[index].0;
                for scale in [1.0, 0.6, 0.2] {
                    let b = solids[partner].0.scaled(scale).unwrap();
                    for pose in random_poses([a, &b], 0.3 * size(a) as f32, 5) {
                        seen.check([a, &b], &pose);
                        seen.check([&b, a], &pose.inverse());
                    }
                }
                // Where all balls coincide each has itself, and touches its neighbours.
                seen.check([a, a], &Pose3::IDENTITY);
                let whole = [index, partner].map(|i| InnerSphereTree::new(&solids[i].1));
                for pose in random_poses([&whole[0], &whole[1]], 0.3 * size(a) as f32, 5) {
                    seen.count_volume_balls([&whole[0], &whole[1]], &pose);
                }
            }
            let Seen { most, densest, volume_balls } = seen;
            println!(
                "{asset}, {spheres} balls: at most {most} partners as large, {densest:.2} pairs per sphere \
                 ({volume_balls:.2} of 1,000 volume balls)"
            );
        }
    }
}
