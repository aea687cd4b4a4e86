//! The constants of the linear-time theorem, over random packings.
//!
//! *Lemma.* A ball of radius r has positive-volume overlap with at most twelve balls of radius at least r that are disjoint from
//! each other. *Theorem.* Two disjoint packings of n and m balls have at most 12(n + m) overlapping pairs.
//!
//! The assets are counted by the workspace's test `overlap`.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use glam::Vec3;
use glamx::Pose3;
use ist::{
    Engine, InnerSphere, InnerSphereTree, OverlapQuery, OverlapWorkspace, SolidProperties, SpherePacking,
    reference,
};
use proptest::prelude::*;
use proptest::strategy::ValueTree;

/// Depth of a pair over the smaller radius from which on it overlaps; below it touches, within rounding. Balls that touch
/// may be that deep in each other when their coordinates are rounded to f32.
const TOUCH: f64 = 1e-5;

/// How exactly a query in f32 places a pair, relative to the distances of both centres from the origin of A. Against a ball of
/// 0.6 mm a metre off, that is more than `TOUCH`.
const ROUNDING: f64 = 1e-6;

/// Most partners of a ball that are at least as large.
const MOST: u32 = 12;

type Ball = (Vec3, f32);

fn solid(balls: &[Ball]) -> InnerSphereTree {
    let spheres = balls.iter().map(|&(c, r)| InnerSphere::solid_ball(c, r, Vec3::Y)).collect();
    InnerSphereTree::new(&SpherePacking::new(spheres, SolidProperties::ball(1.0)).unwrap()).with_grid()
}

/// For each ball of `a` and of `b` the number of its partners that are at least as large, the number of pairs, and the number
/// of those that overlap by more than a query may err.
fn partners(a: &InnerSphereTree, b: &InnerSphereTree, pose: &Pose3) -> ([Vec<u32>; 2], [usize; 2]) {
    let radii = [a, b].map(|tree| tree.volume_balls().map(|(_, r)| r).collect::<Vec<_>>());
    let mut counts = [vec![0; a.len()], vec![0; b.len()]];
    let mut pairs = [0; 2];
    let (rotation, translation) = (pose.rotation.as_dquat().normalize(), pose.translation.as_dvec3());
    for pair in reference::pairs_at(a, b, rotation, translation) {
        let [i, j] = pair.spheres;
        let (r, s) = (f64::from(radii[0][i]), f64::from(radii[1][j]));
        let depth = r + s - pair.center_a.distance(pair.center_b);
        if depth > TOUCH * r.min(s) {
            counts[0][i] += u32::from(s >= r);
            counts[1][j] += u32::from(r >= s);
            pairs[0] += 1;
            pairs[1] += usize::from(depth > ROUNDING * (pair.center_a.length() + pair.center_b.length()));
        }
    }
    (counts, pairs)
}

/// Holds lemma and theorem at one pose; returns the most partners and the pairs per sphere.
fn check(a: &InnerSphereTree, b: &InnerSphereTree, pose: &Pose3) -> (u32, f64) {
    let (counts, [pairs, certain]) = partners(a, b, pose);
    let most = counts.iter().flatten().copied().max().unwrap_or(0);
    assert!(most <= MOST, "{most} partners");
    let spheres = a.len() + b.len();
    assert!(pairs <= MOST as usize * spheres);
    for engine in [Engine::Tree, Engine::Grid] {
        let query = OverlapQuery { engine, ..OverlapQuery::default() };
        let found = a.overlap_with(b, pose, query, &mut OverlapWorkspace::default()).pairs as usize;
        assert!(certain <= found, "{engine:?} missed {}", certain - found);
    }
    (most, pairs as f64 / spheres as f64)
}

fn disjoint(&(c, r): &Ball, &(d, s): &Ball) -> bool {
    c.as_dvec3().distance(d.as_dvec3()) >= f64::from(r) + f64::from(s)
}

/// Random sequential insertion: each candidate stays if it meets none before it. Radii over three octaves to ten.
fn inserted(most: usize) -> impl Strategy<Value = Vec<Ball>> {
    (1.0_f32..3.3).prop_flat_map(move |decades| {
        let ball = (prop::array::uniform3(-1.0_f32..1.0), 0.0_f32..1.0)
            .prop_map(move |(c, t)| (Vec3::from(c), 0.4 * 10.0_f32.powf(-decades * t)));
        prop::collection::vec(ball, 1..most).prop_map(|candidates| {
            let mut kept: Vec<Ball> = Vec::new();
            for ball in candidates {
                if kept.iter().all(|other| disjoint(&ball, other)) {
                    kept.push(ball);
                }
            }
            kept
        })
    })
}

/// As in an Apollonian filling, each ball grows until it touches another one or the unit ball's surface; the largest of
/// a few candidates first.
fn filled(most: usize) -> impl Strategy<Value = Vec<Ball>> {
    let points = prop::collection::vec(prop::array::uniform3(-1.0_f32..1.0), 1..most);
    points.prop_map(|points| {
        let mut kept: Vec<Ball> = Vec::new();
        for candidates in points.chunks(4) {
            let grown = candidates.iter().map(|&at| {
                let at = Vec3::from(at);
                let clearance = |&(c, r): &Ball| at.as_dvec3().distance(c.as_dvec3()) - f64::from(r);
                let room = kept.iter().map(clearance).fold(1.0 - at.as_dvec3().length(), f64::min);
                (at, (room * (1.0 - 1e-7)) as f32)
            });
            let largest =
                grown.fold((Vec3::ZERO, 0.0), |best, ball| if ball.1 > best.1 { ball } else { best });
            if largest.1 > 1e-4 {
                kept.push(largest);
            }
        }
        if kept.is_empty() {
            kept.push((Vec3::ZERO, 1.0));
        }
        kept
    })
}

/// Densest lattice packing of equal balls, `n` cubic cells along each side; every ball inside touches twelve.
fn face_centred(n: i16, radius: f32) -> Vec<Ball> {
    let step = radius * core::f32::consts::SQRT_2;
    let at = |x, y, z| Vec3::new(f32::from(x), f32::from(y), f32::from(z)) * step;
    let range = || -n..=n;
    range()
        .flat_map(|x| range().flat_map(move |y| range().map(move |z| (x, y, z))))
        .filter(|(x, y, z)| (x + y + z) % 2 == 0)
        .map(|(x, y, z)| (at(x, y, z), radius))
        .collect()
}

fn random_pose(reach: f32) -> impl Strategy<Value = Pose3> {
    (prop::array::uniform3(-reach..reach), prop::array::uniform3(-3.0_f32..3.0))
        .prop_map(|(t, r)| Pose3::from_parts(t.into(), glam::Quat::from_scaled_axis(r.into())))
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn randomly_inserted_balls(
        a in inserted(600), b in inserted(600), pose in random_pose(0.5), scale in 0.05_f32..2.0,
    ) {
        check(&solid(&a), &solid(&b).scaled(scale).unwrap(), &pose);
    }

    #[test]
    fn apollonian_fillings(a in filled(900), b in filled(900), pose in random_pose(0.3), scale in 0.3_f32..2.0) {
        check(&solid(&a), &solid(&b).scaled(scale).unwrap(), &pose);
    }

    #[test]
    fn dense_lattices(pose in random_pose(0.2), ratio in 0.3_f32..3.0) {
        let (a, b) = (solid(&face_centred(3, 0.1)), solid(&face_centred(3, 0.1)));
        check(&a, &b, &pose);
        check(&a, &b.scaled(ratio).unwrap(), &pose);
        check(&a, &b, &Pose3::from_translation(pose.translation));
    }
}

/// Twelve equal balls about a thirteenth of their size, at the corners of an icosahedron, have room to spare: the
/// lemma's number is reached.
#[test]
fn twelve_partners_are_possible() {
    let golden = 0.5 * (1.0 + 5.0_f32.sqrt());
    let corner = |a: f32, b: f32| [Vec3::new(0.0, a, b), Vec3::new(a, b, 0.0), Vec3::new(b, 0.0, a)];
    let signs = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
    // Radius 1 at a distance of 1.95: the centres of neighbours are 2.05 apart.
    let shell: Vec<Ball> =
        signs.iter().flat_map(|(s, t)| corner(*s, t * golden)).map(|c| (1.95 * c.normalize(), 1.0)).collect();
    for (i, ball) in shell.iter().enumerate() {
        assert!(shell[..i].iter().all(|other| disjoint(ball, other)));
    }
    let (most, pairs) = check(&solid(&shell), &solid(&[(Vec3::ZERO, 1.0)]), &Pose3::IDENTITY);
    assert_eq!(most, 12);
    assert!((pairs - 12.0 / 13.0).abs() < 1e-12);
}

/// Where all neighbours touch, rounding decides about each contact; none of them counts.
#[test]
fn coincident_lattices_overlap_ball_by_ball() {
    let lattice = solid(&face_centred(3, 0.1));
    let (counts, [pairs, _]) = partners(&lattice, &lattice, &Pose3::IDENTITY);
    assert!(counts.iter().flatten().all(|&count| count == 1));
    assert_eq!(pairs, lattice.len());
    let shifted = Pose3::translation(0.1, 0.03, 0.02);
    let (most, per_sphere) = check(&lattice, &lattice, &shifted);
    println!(
        "lattices of {} balls, shifted: at most {most} partners, {per_sphere:.2} pairs per sphere",
        lattice.len()
    );
}

/// The figures of the three kinds of packings, for the record.
#[test]
fn figures() {
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let mut row = |name: &str, packings: BoxedStrategy<Vec<Ball>>| {
        let (mut most, mut densest) = (0, 0.0_f64);
        for _ in 0..40 {
            let mut draw = || packings.new_tree(&mut runner).unwrap().current();
            let (a, b) = (draw(), draw());
            let pose = random_pose(0.2).new_tree(&mut runner).unwrap().current();
            let (partners, pairs) = check(&solid(&a), &solid(&b), &pose);
            (most, densest) = (most.max(partners), densest.max(pairs));
        }
        println!("{name}: at most {most} partners, {densest:.2} pairs per sphere");
    };
    row("random insertion", inserted(600).boxed());
    row("Apollonian filling", filled(900).boxed());
    row("lattice", Just(face_centred(3, 0.1)).boxed());
}

/// A tiny ball that a large one overlaps by less than its place is known to.
#[test]
fn issue_a_tiny_ball_is_placed_as_its_distance_allows() {
    let tiny = solid(&[(Vec3::new(0.5870648, 0.700523, 0.620396), 0.00064056827)]);
    let large =
        solid(&[(Vec3::new(-0.31991014, -0.16398086, 0.754128), 0.25355116)]).scaled(0.895655).unwrap();
    let rotation = glam::Quat::from_xyzw(-0.2644158, -0.54069626, -0.78084373, -0.16737635);
    check(&tiny, &large, &Pose3::from_parts(Vec3::new(0.098817505, 0.38091394, 0.48035666), rotation));
}
