//! Overlap of a tree with a solid that is given by its signed distance.
//!
//! Each ball meets the other solid as if that were the half-space behind its nearest surface point: a spherical
//! cap of height h on a ball of radius r, with volume πh²(3r−h)/3, base area πh(2r−h) and centroid
//! 3(2r−h)²/(4(3r−h)) from the centre. Exact for half-spaces and good where the balls are small against
//! the features of the other solid; against parts thinner than a ball the cap is too large.

use super::ContactSample;
use crate::InnerSphereTree;
use crate::tree::WIDTH;
use alloc::vec::Vec;
use core::f32::consts::PI;
use glam::Vec3;

/// The surface of a solid as one point sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceDistance {
    /// Distance to the surface (m), negative inside.
    pub distance: f32,
    /// Unit vector away from the solid.
    pub outward: Vec3,
}

impl InnerSphereTree {
    /// The overlap of this solid (A) with a solid B of the given signed distance, both in A's frame, as one sample
    /// per ball that B cuts, appended to `samples`.
    ///
    /// `surface` must be 1-Lipschitz, as distances are.
    pub fn contact_samples_with(
        &self,
        mut surface: impl FnMut(Vec3) -> SurfaceDistance,
        samples: &mut Vec<ContactSample>,
    ) {
        let data = self.data();
        // Deep enough for eight children on each of the at most eleven levels of 2³¹ spheres.
        let mut pending = Vec::with_capacity(11 * WIDTH);
        pending.push((data.height(), 0, Vec3::ZERO, f32::NEG_INFINITY));
        while let Some((level, node, parent, parent_distance)) = pending.pop() {
            let (center, radius) = data.levels[level].get(node);
            let (center, radius) = (center * self.unit(), radius * self.unit() + self.skin());
            // Distances change by no more than the way: most nodes need not be asked about.
            if parent_distance - center.distance(parent) >= radius {
                continue;
            }
            let SurfaceDistance { distance, outward } = surface(center);
            if distance >= radius {
                continue;
            }
            if level > 0 {
                let end = data.levels[level - 1].len().min((node + 1) * WIDTH);
                pending.extend((node * WIDTH..end).rev().map(|child| (level - 1, child, center, distance)));
                continue;
            }
            let h = (radius - distance).min(2.0 * radius);
            let along = 0.75 * (2.0 * radius - h) * (2.0 * radius - h) / (3.0 * radius - h);
            samples.push(ContactSample {
                point: center - outward * along,
                normal: -outward,
                volume: PI / 3.0 * h * h * (3.0 * radius - h),
                separation: outward * (-PI * h * (2.0 * radius - h)),
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree::tests::random_packing;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_half_space_cuts_every_ball_in_its_cap(packing in random_packing(200), height in -1.0_f32..1.0) {
            let tree = InnerSphereTree::new(&packing);
            let mut samples = Vec::new();
            let plane = |p: Vec3| SurfaceDistance { distance: p.y - height, outward: Vec3::Y };
            tree.contact_samples_with(plane, &mut samples);
            let cap = |(center, radius): (Vec3, f32)| {
                let h = f64::from(radius - (center.y - height)).clamp(0.0, 2.0 * f64::from(radius));
                core::f64::consts::PI / 3.0 * h * h * (3.0 * f64::from(radius) - h)
            };
            let exact: f64 = tree.volume_balls().map(cap).sum();
            let volume: f64 = samples.iter().map(|s| f64::from(s.volume)).sum();
            prop_assert!((volume - exact).abs() <= 1e-5 * exact.max(1e-3));
            prop_assert!(samples.iter().all(|s| s.point.y <= height + 1e-5));
        }
    }
}
