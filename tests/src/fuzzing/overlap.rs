//! Overlap of two trees: by the tree, the grids, a cache and within a budget, against the reference in double precision.
//!
//! - Poses that are none give nothing.
//! - All ways see the same pairs and give the same results but for rounding.
//! - Volumes and gradients are those of the reference for balls whose distances are off by the rounding of their coordinates.
//! - The interval of a query within a budget contains the volume, and shrinks as the budget grows.
//! - Seen from B the gradient is the opposite. The blended force is no larger than the volume.
//! - No number is NaN, whatever the solids.

use super::numbers::{any_pose, below, is_usable, moderate_vector, pose};
use super::solids::{Solid, reach, solid};
use arbitrary::Unstructured;
use glam::{Quat, Vec3};
use glamx::Pose3;
use ist::reference::{self, ReferencePair};
use ist::{
    Budget, ContactPatch, Engine, ForceLaw, InnerSphereTree, Overlap, OverlapCache, OverlapEstimate,
    OverlapQuery, OverlapWorkspace, TimeCriticalWorkspace,
};
use std::f64::consts::PI;

const LAWS: [ForceLaw; 3] = [ForceLaw::VolumeGradient, ForceLaw::OutwardNormals, ForceLaw::Blended];

/// Two solids and a pose from bytes.
pub fn check(data: &[u8]) {
    let u = &mut Unstructured::new(data);
    let a = solid(u);
    let b = if below(u, 4) == 0 { Solid { tree: a.tree.clone(), ..a } } else { solid(u) };
    let size = a.tree.bounding_ball().1;
    let is_any = below(u, 8) == 7;
    let pose = if is_any { any_pose(u) } else { pose(u, size) };
    let case = Case { a: &a.tree, b: &b.tree, pose };
    if !is_usable(&pose) {
        return case.gives_nothing();
    }
    let step = moderate_vector(u) * (size * 1e-4);
    case.has_no_nan();
    case.interval_holds();
    // Where sizes differ by more, nothing is found: see the documentation of the overlap.
    let is_resolved = (1e-8..1e8).contains(&(reach(&b.tree) / reach(&a.tree)));
    if a.is_ordinary && b.is_ordinary && !is_any && is_resolved {
        case.all_ways_agree(step);
        case.is_that_of_the_reference();
    }
}

struct Case<'a> {
    a: &'a InnerSphereTree,
    b: &'a InnerSphereTree,
    pose: Pose3,
}

impl Case<'_> {
    fn overlap(&self, query: OverlapQuery) -> Overlap {
        self.a.overlap_with(self.b, &self.pose, query, &mut OverlapWorkspace::default())
    }

    fn gives_nothing(&self) {
        for engine in [Engine::Auto, Engine::Tree, Engine::Grid] {
            let query = OverlapQuery { engine, stiffness: true, ..OverlapQuery::default() };
            assert_eq!(self.overlap(query), Overlap::default());
        }
        let (mut workspace, mut cache) = (OverlapWorkspace::default(), OverlapCache::default());
        let query = OverlapQuery::default();
        let cached = self.a.overlap_cached(self.b, &self.pose, query, (&mut cache, &mut workspace));
        assert_eq!(cached, Overlap::default());
        let mut nothing = OverlapEstimate::default();
        nothing.complete = true;
        assert_eq!(self.within(7, &mut TimeCriticalWorkspace::default()), nothing);
        let (mut samples, mut patches) = (Vec::new(), Vec::new());
        self.a.contact_samples(self.b, &self.pose, &mut workspace, &mut samples);
        self.a.contact_patches(self.b, &self.pose, &mut workspace, &mut patches);
        assert!(samples.is_empty() && patches.is_empty());
    }

    fn within(&self, visits: u32, workspace: &mut TimeCriticalWorkspace) -> OverlapEstimate {
        self.a.overlap_within(self.b, &self.pose, Budget::Visits(visits), workspace)
    }

    /// Laws, stiffness, samples and patches.
    fn has_no_nan(&self) {
        for law in LAWS {
            let overlap = self.overlap(OverlapQuery { law, stiffness: true, ..OverlapQuery::default() });
            assert_no_nan(&overlap);
            if law == ForceLaw::Blended {
                let most = overlap.volume * 1.001 + f32::MIN_POSITIVE;
                assert!(overlap.force.as_dvec3().length() <= f64::from(most), "{overlap:?}");
            }
        }
        let (mut workspace, mut samples, mut patches) = (OverlapWorkspace::default(), Vec::new(), Vec::new());
        self.a.contact_samples(self.b, &self.pose, &mut workspace, &mut samples);
        for sample in &samples {
            assert!(!sample.point.is_nan() && !sample.vector_area.is_nan() && !sample.volume.is_nan());
            assert!((sample.normal.length() - 1.0).abs() < 1e-4, "{sample:?}");
        }
        self.a.contact_patches(self.b, &self.pose, &mut workspace, &mut patches);
        for patch in &patches {
            let ContactPatch { centroid, gradient, rotation_gradient, force, torque, bounds, points, .. } =
                patch;
            let vectors = [*centroid, *gradient, *rotation_gradient, *force, *torque, bounds.0, bounds.1];
            assert!(!vectors.iter().chain(points).any(|v| v.is_nan()), "{patch:?}");
            assert!(!patch.volume.is_nan() && !patch.area.is_nan());
        }
        let overlap = self.overlap(OverlapQuery::default());
        let volume: f64 = samples.iter().map(|s| f64::from(s.volume)).sum();
        // Each lens is rounded to f32 in units of A's size and once more in m³; at the lower end f32 has no digits left.
        let quantum = 1e-44 * reach(self.a).powi(3).max(1.0);
        let slack = 1e-4 * f64::from(overlap.volume) + quantum * (1.0 + samples.len() as f64);
        assert!(volume.is_infinite() || (volume - f64::from(overlap.volume)).abs() <= slack || volume > 3e38);
    }

    /// Tree, grids and cache, the latter before and after a small `step`.
    fn all_ways_agree(&self, step: Vec3) {
        let by = |engine| OverlapQuery { engine, ..OverlapQuery::default() };
        let tree = self.overlap(by(Engine::Tree));
        assert_alike(&tree, &self.overlap(by(Engine::Grid)));
        let (mut workspace, mut cache) = (OverlapWorkspace::default(), OverlapCache::default());
        for i in 0..4 {
            let turn = Quat::from_rotation_y(1e-3 * i as f32);
            let translation = self.pose.translation + step * (i as f32);
            let pose = Pose3::from_parts(translation, turn * self.pose.rotation);
            let plain = self.a.overlap_with(self.b, &pose, by(Engine::Tree), &mut workspace);
            let caches = (&mut cache, &mut workspace);
            assert_alike(&plain, &self.a.overlap_cached(self.b, &pose, by(Engine::Tree), caches));
        }
        let meet = self.a.intersects(self.b, &self.pose, &mut ist::ProximityWorkspace::default());
        assert!(!tree.intersects || meet, "{tree:?}");
    }

    fn interval_holds(&self) {
        let full = self.overlap(OverlapQuery { engine: Engine::Tree, ..OverlapQuery::default() });
        let mut workspace = TimeCriticalWorkspace::default();
        let mut last = OverlapEstimate::default();
        last.upper = f32::INFINITY;
        for budget in [0, 1, 3, 10, 100, 1_000, u32::MAX] {
            let now = self.within(budget, &mut workspace);
            assert_no_nan(&now.expected);
            assert!(now.lower <= full.volume && full.volume <= now.upper, "{full:?} {now:?}");
            assert!(now.lower <= now.expected.volume && now.expected.volume <= now.upper, "{now:?}");
            assert!(now.lower >= last.lower && now.upper <= last.upper, "{last:?} {now:?}");
            assert!(!now.expected.intersects || full.intersects, "{full:?} {now:?}");
            assert!(now.visits <= budget);
            last = now;
        }
        assert!(last.complete);
        assert_eq!((last.expected.pairs, last.expected.intersects), (full.pairs, full.intersects));
    }

    fn is_that_of_the_reference(&self) {
        let full = self.overlap(OverlapQuery::default());
        let bounds = Bounds::new(self);
        bounds.contain(&full, ("A", reach(self.a)));
        let back = self.pose.inverse();
        let mut other = self.b.overlap(self.a, &back, &mut OverlapWorkspace::default());
        other.gradient = self.pose.rotation * -other.gradient;
        bounds.contain(&other, ("B", reach(self.b)));
    }
}

fn assert_no_nan(overlap: &Overlap) {
    let Overlap { volume, centroid, gradient, rotation_gradient, force, torque, stiffness, deepest, .. } =
        overlap;
    let vectors = [centroid, gradient, rotation_gradient, force, torque];
    let rows = stiffness.map(|stiffness| stiffness.to_rows());
    let is_nan = volume.is_nan()
        || vectors.iter().any(|v| v.is_nan())
        || deepest.is_some_and(|pair| pair.depth.is_nan())
        || rows.is_some_and(|rows| rows.as_flattened().iter().any(|x| x.is_nan()));
    assert!(!is_nan, "{overlap:?}");
}

/// The same pairs, and the same sums but for the order of the terms.
fn assert_alike(one: &Overlap, other: &Overlap) {
    let counts = |overlap: &Overlap| (overlap.pairs, overlap.intersects, overlap.deepest.map(|d| d.depth));
    assert_eq!(counts(one), counts(other), "{one:?} {other:?}");
    let is_same = one.volume == other.volume;
    let slack = 1e-5 * one.volume + 1e-44;
    assert!(is_same || (one.volume - other.volume).abs() <= slack, "{one:?} {other:?}");
}

/// Between what volume and gradient have to be.
struct Bounds {
    pairs: [u32; 2],
    volume: [f64; 2],
    gradient: glam::DVec3,
    gradient_error: f64,
}

impl Bounds {
    fn new(case: &Case) -> Self {
        let Case { a, b, pose } = case;
        // Of every coordinate that enters a distance, four roundings.
        let shift = 5e-7 * (reach(a) + reach(b) + pose.translation.as_dvec3().length());
        let (rotation, translation) = (pose.rotation.as_dquat().normalize(), pose.translation.as_dvec3());
        let mut bounds =
            Self { pairs: [0; 2], volume: [0.0; 2], gradient: glam::DVec3::ZERO, gradient_error: 0.0 };
        for (center_b, radius_b) in b.volume_balls() {
            let center_b = rotation * center_b.as_dvec3() + translation;
            for (center_a, radius_a) in a.volume_balls() {
                let center_a = center_a.as_dvec3();
                let distance = center_a.distance(center_b);
                let lens = |d: f64| ist::lens::Lens::new(f64::from(radius_a), f64::from(radius_b), d);
                let pair = ReferencePair { spheres: [0, 0], lens: lens(distance), center_a, center_b };
                bounds.add(&pair, [lens(distance + shift), lens((distance - shift).max(0.0))], shift);
            }
        }
        let exact = reference::overlap(a, b, pose);
        assert!(
            bounds.volume[0] <= exact.volume * (1.0 + 1e-9)
                && exact.volume <= bounds.volume[1] * (1.0 + 1e-9)
        );
        bounds
    }

    /// A pair whose lens lies between `farther` and `nearer`.
    fn add(&mut self, pair: &ReferencePair, [farther, nearer]: [ist::lens::Lens; 2], shift: f64) {
        self.pairs[0] += u32::from(farther.volume > 0.0);
        self.pairs[1] += u32::from(nearer.volume > 0.0);
        self.volume[0] += farther.volume;
        self.volume[1] += nearer.volume;
        self.gradient -= pair.lens.area * pair.axis();
        let areas = [farther.area, pair.lens.area, nearer.area];
        let (least, most) = areas.iter().fold((f64::INFINITY, 0.0_f64), |(l, m), x| (l.min(*x), m.max(*x)));
        // Where the area passes its maximum within the shift the ends say little, and so does the axis of balls that coincide.
        let distance = pair.center_a.distance(pair.center_b);
        let turned = most * (2.0 * shift / distance.max(1e-300)).min(2.0);
        self.gradient_error += 2.0 * (most - least) + turned + 1e-5 * most;
    }

    /// As the solid `seen_from` of size `unit` (m) sees it.
    fn contain(&self, overlap: &Overlap, (seen_from, unit): (&str, f64)) {
        let volume = f64::from(overlap.volume);
        // Volumes of single pairs, in the unit of the solid, may have next to no digits left: f32 ends at 1.4e-45.
        let vanishing = 1e-42 * f64::from(overlap.pairs) * unit.powi(3) + 1e-44;
        let rounding = 2e-5;
        assert!(
            self.pairs[0] <= overlap.pairs && overlap.pairs <= self.pairs[1],
            "{seen_from}: {} pairs, not {:?}",
            overlap.pairs,
            self.pairs
        );
        assert!(
            volume >= self.volume[0] * (1.0 - rounding) - vanishing
                && volume <= self.volume[1] * (1.0 + rounding) + vanishing,
            "{seen_from}: {volume} is not in {:?}",
            self.volume
        );
        let error = overlap.gradient.as_dvec3().distance(self.gradient);
        let slack = self.gradient_error * (1.0 + PI * 1e-3) + 1e-44;
        assert!(error <= slack, "{seen_from}: {error} > {slack}, {overlap:?}, {}", self.gradient);
    }
}
