//! How many balls of which size.

use ist::InnerSphere;
use std::f64::consts::{PI, SQRT_2};

/// Balls of about one size.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde-serialize", derive(serde::Serialize))]
#[non_exhaustive]
pub struct RadiusBin {
    /// No radius in the bin is as small as this (m).
    pub above: f64,
    /// Largest radius that belongs to the bin (m).
    pub up_to: f64,
    /// Number of balls.
    pub count: usize,
    /// Their volume, as a share of the solid's.
    pub volume_share: f64,
}

/// Bins from the largest radius `R` down: `(R/√2^(k+1), R/√2^k]` is bin `k`. The last one has a ball; others may be
/// empty.
pub(super) fn histogram(spheres: &[InnerSphere], volume: f64) -> Vec<RadiusBin> {
    let mut radii: Vec<f64> = spheres.iter().map(|sphere| sphere.radius.into()).collect();
    radii.sort_by(|a, b| b.total_cmp(a));
    let mut bins: Vec<RadiusBin> = Vec::new();
    let mut edge = radii.first().copied().unwrap_or_default();
    for radius in radii {
        while bins.last().is_none_or(|bin| radius <= bin.above) {
            let above = edge / SQRT_2;
            bins.push(RadiusBin { above, up_to: edge, count: 0, volume_share: 0.0 });
            edge = above;
        }
        if let Some(bin) = bins.last_mut() {
            bin.count += 1;
            bin.volume_share += 4.0 / 3.0 * PI * radius.powi(3) / volume;
        }
    }
    bins
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn every_ball_is_in_the_bin_of_its_radius() {
        let radii = [1.0_f32, 0.9, 0.71, 0.7, 0.1, 0.1, 1e-6];
        let spheres: Vec<InnerSphere> =
            radii.iter().map(|r| InnerSphere::solid_ball(Vec3::ZERO, *r, Vec3::Z)).collect();
        let bins = histogram(&spheres, 10.0);
        assert_eq!((bins[0].count, bins[1].count), (3, 1));
        assert_eq!(bins.iter().map(|bin| bin.count).sum::<usize>(), radii.len());
        assert_eq!(bins.last().map(|bin| bin.count), Some(1));
        for pair in bins.windows(2) {
            assert_eq!(pair[0].above, pair[1].up_to);
        }
        let share: f64 = bins.iter().map(|bin| bin.volume_share).sum();
        let volume: f64 = radii.iter().map(|r| 4.0 / 3.0 * PI * f64::from(*r).powi(3)).sum();
        assert!((share - volume / 10.0).abs() < 1e-12);
        assert!(histogram(&[], 1.0).is_empty());
    }
}
