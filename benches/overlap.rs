//! Overlap queries beside brute force, on the same poses in one run.

use criterion::{Criterion, criterion_group, criterion_main};
use ist::{InnerSphereTree, OverlapWorkspace, reference};
use rapier_ist_tests::{Band, TruePose, Truth};
use std::hint::black_box;

fn overlap(criterion: &mut Criterion) {
    let Ok((truth, [a, b])) = solids(1000) else { return };
    let mut workspace = OverlapWorkspace::default();
    for band in [Band::Shallow, Band::Mid, Band::Deep] {
        let poses: Vec<_> = truth
            .poses
            .iter()
            .filter(|pose| truth.band(pose.volume) == Some(band))
            .map(TruePose::pose)
            .collect();
        let mut group = criterion.benchmark_group(format!("{} rabbit poses, {band:?}", poses.len()));
        group.bench_function("tree", |bencher| {
            bencher.iter(|| {
                poses.iter().map(|pose| a.overlap(&b, black_box(pose), &mut workspace).volume).sum::<f32>()
            });
        });
        group.sample_size(10);
        group.bench_function("brute force", |bencher| {
            bencher.iter(|| {
                poses.iter().map(|pose| reference::overlap(&a, &b, black_box(pose)).volume).sum::<f64>()
            });
        });
        group.finish();
    }
}

fn solids(spheres: usize) -> Result<(Truth, [InnerSphereTree; 2]), Box<dyn std::error::Error>> {
    let truth = Truth::load("bunny_bunny")?;
    let packings = truth.packings(spheres)?;
    let trees = truth.trees(&packings).ok_or("the scale is positive")?;
    Ok((truth, trees))
}

criterion_group!(benches, overlap);
criterion_main!(benches);
