//! Properties of overlaps with half-spaces and signed distances.

use super::*;
use crate::reference;
use crate::tree::tests::random_packing;
use crate::{InnerSphere, SolidProperties, SpherePacking, SurfaceDistance};
use alloc::vec::Vec;
use core::f32::consts::PI;
use glam::{DQuat, DVec3, Quat};
use proptest::prelude::*;

fn random_direction() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(-1.0_f32..1.0)
        .prop_filter_map("needs a direction", |v| Vec3::from(v).try_normalize())
}

/// The half-space of `normal` and `offset` as a signed distance.
fn plane(normal: Vec3, offset: f32) -> impl Fn(Vec3) -> SurfaceDistance {
    move |point| SurfaceDistance { distance: normal.dot(point) - offset, outward: normal }
}

fn tree_of(spheres: Vec<InnerSphere>) -> InnerSphereTree {
    InnerSphereTree::new(&SpherePacking::new(spheres, SolidProperties::ball(1.0)).unwrap())
}

fn ball(center: Vec3, radius: f32) -> InnerSphereTree {
    tree_of(alloc::vec![InnerSphere::solid_ball(center, radius, Vec3::X)])
}

proptest! {
    #[test]
    fn a_half_space_gives_the_sums_of_the_definition(
        packing in random_packing(300), normal in random_direction(), offset in -1.5_f32..1.5,
        scale in 0.2_f32..5.0, skin in 0.0_f32..0.1,
    ) {
        let tree = InnerSphereTree::new(&packing).scaled(scale).unwrap().with_skin(skin).unwrap();
        let overlap = tree.overlap_with_half_space(normal, offset * scale);
        let exact = reference::overlap_with_half_space(&tree, normal.as_dvec3().normalize(), f64::from(offset * scale));
        let reach = 2.0 * f64::from(scale + skin);
        // What rounding the distances to f32 moves.
        let shift = 3e-7 * reach;
        let volume = 1e-6 * exact.volume + shift * exact.area;
        prop_assert!((f64::from(overlap.volume) - exact.volume).abs() <= volume);
        let moments = f64::from(overlap.volume) * overlap.centroid.as_dvec3() - exact.volume * exact.centroid;
        prop_assert!(moments.length() <= volume * reach);
        let area = 1e-6 * exact.area + shift * f64::from(exact.pairs) * 7.0 * f64::from(0.4 * scale + skin);
        prop_assert!((overlap.gradient.as_dvec3() - exact.gradient).length() <= area);
        // The centroid moves too, by its share of the volume's error.
        let moved = 2.0 * volume / exact.volume.max(f64::MIN_POSITIVE) * reach * exact.area;
        prop_assert!((overlap.rotation_gradient.as_dvec3() - exact.rotation_gradient).length() <= area * reach + moved);
        prop_assert!(overlap.pairs.abs_diff(exact.pairs) <= 1 + exact.pairs / 100);
        let force = -normal * overlap.volume;
        prop_assert!((overlap.force - force).length() <= 1e-5 * overlap.volume, "{overlap:?}");
        let certain = tree.inner_balls().any(|(c, r, _)| normal.dot(c) - offset * scale < r - 1e-5 * scale);
        prop_assert!(overlap.intersects || !certain);
        let possible = tree.inner_balls().any(|(c, r, _)| normal.dot(c) - offset * scale < r + 1e-5 * scale);
        prop_assert!(possible || !overlap.intersects);
    }

    #[test]
    fn gradients_of_the_reference_are_derivatives(
        packing in random_packing(60), normal in random_direction(), offset in -1.0_f64..1.0,
    ) {
        let tree = InnerSphereTree::new(&packing);
        let normal = normal.as_dvec3().normalize();
        let exact = reference::overlap_with_half_space(&tree, normal, offset);
        let volume = |normal, offset| reference::overlap_with_half_space(&tree, normal, offset).volume;
        let e = 1e-6;
        for axis in DVec3::AXES {
            let moved = |s: f64| volume(normal, offset + s * axis.dot(normal));
            prop_assert!(((moved(e) - moved(-e)) / (2.0 * e) - exact.gradient.dot(axis)).abs() < 1e-4);
            let turned = |s: f64| {
                let turn = DQuat::from_axis_angle(axis, s);
                let (pivot, normal_turned) = (exact.centroid, turn * normal);
                let on_plane = pivot + turn * (normal * offset - pivot);
                volume(normal_turned, on_plane.dot(normal_turned))
            };
            prop_assert!(((turned(e) - turned(-e)) / (2.0 * e) - exact.rotation_gradient.dot(axis)).abs() < 1e-4);
        }
    }

    #[test]
    fn a_plane_as_signed_distance_is_the_half_space(
        packing in random_packing(200), normal in random_direction(), offset in -1.0_f32..1.0,
    ) {
        let tree = InnerSphereTree::new(&packing);
        let (here, there) =
            (tree.overlap_with_surface(plane(normal, offset)), tree.overlap_with_half_space(normal, offset));
        let tolerance = 1e-5 * (there.volume + 1e-3);
        prop_assert!((here.volume - there.volume).abs() <= tolerance);
        prop_assert!((here.gradient - there.gradient).length() <= 1e-4);
        let mut samples = Vec::new();
        let clearance = tree.contact_samples_with_surface(plane(normal, offset), &mut samples);
        let gaps = tree.volume_balls().map(|(center, radius)| normal.dot(center) - offset - radius);
        let least = gaps.filter(|gap| *gap >= 0.0).fold(f32::INFINITY, f32::min);
        prop_assert!((0.0..=least + 1e-6).contains(&clearance) || clearance == least, "{} {}", clearance, least);
        prop_assert_eq!(samples.len() as u32, here.pairs);
        prop_assert!((samples.iter().map(|s| s.volume).sum::<f32>() - here.volume).abs() <= tolerance * 10.0);
        let area: Vec3 = samples.iter().map(|s| s.vector_area).sum();
        prop_assert!((area + here.gradient).length() <= 1e-4 * (1.0 + here.gradient.length()));
        prop_assert!(samples.iter().all(|s| normal.dot(s.point) <= offset + 1e-5));
    }

    /// Volumes are those of all samples where the solid is deep inside, and end where no inner ball is within the offset.
    #[test]
    fn flush_contact_begins_at_the_inner_balls(
        packing in random_packing(200), normal in random_direction(), offset in -1.0_f32..1.0,
    ) {
        let tree = InnerSphereTree::new(&packing);
        let (mut all, mut flush) = (Vec::new(), Vec::new());
        tree.contact_samples_with_surface(plane(normal, offset), &mut all);
        let clearance = tree.flush_contact_samples_with_surface(plane(normal, offset), &mut flush);
        let sum = |samples: &[ContactSample]| samples.iter().map(|s| s.volume).sum::<f32>();
        prop_assert!(flush.len() <= all.len() && sum(&flush) <= sum(&all) * (1.0 + 1e-4));
        prop_assert!(flush.len() == all.len() || clearance == 0.0);
        prop_assert!(flush.iter().all(|s| s.vector_area.dot(normal) <= 0.0 && s.normal.dot(normal) < -0.99));
        // As deep as the volume ball is, and the inner ball with the offset.
        let deepest = packing.spheres().iter().map(|s| {
            let depth = |center: Vec3, radius: f32| offset - normal.dot(center) + radius;
            let (center, radius) = s.volume_ball();
            depth(center, radius).min(depth(s.center, s.radius + tree.contact_offset()))
        });
        let deepest = deepest.fold(f32::NEG_INFINITY, f32::max);
        prop_assert!(deepest.abs() < 1e-5 || flush.is_empty() == (deepest < 0.0), "{deepest}");
        let mut deep = Vec::new();
        tree.flush_contact_samples_with_surface(plane(normal, 10.0), &mut deep);
        let whole: f32 = tree.volume_balls().map(|(_, radius)| 4.0 / 3.0 * core::f32::consts::PI * radius.powi(3)).sum();
        prop_assert!((sum(&deep) - whole).abs() < 1e-3 * whole);
    }

    #[test]
    fn the_gradient_against_a_ball_is_the_derivative(
        packing in random_packing(60), at in prop::array::uniform3(-1.0_f32..1.0),
    ) {
        let (tree, at, radius) = (InnerSphereTree::new(&packing), Vec3::from(at), 0.7);
        let volume = |center: DVec3| {
            let caps = tree.volume_balls().map(|(c, r)| {
                let distance = c.as_dvec3().distance(center) - f64::from(radius);
                cap::Cap::new(f64::from(r), distance).volume
            });
            caps.sum::<f64>()
        };
        let overlap = tree.overlap_with_surface(|p: Vec3| {
            let way = p - at;
            SurfaceDistance { distance: way.length() - radius, outward: way.normalize_or(Vec3::Y) }
        });
        let exact = volume(at.as_dvec3());
        prop_assert!((f64::from(overlap.volume) - exact).abs() <= 1e-5 * exact + 1e-6);
        let e = 1e-6;
        let slope = DVec3::from(DVec3::AXES.map(|axis| {
            (volume(at.as_dvec3() + e * axis) - volume(at.as_dvec3() - e * axis)) / (2.0 * e)
        }));
        prop_assert!((overlap.gradient.as_dvec3() - slope).length() <= 1e-3 * (1.0 + slope.length()));
        // Turning a ball about its centre changes nothing.
        let about_ball = overlap.rotation_gradient + (overlap.centroid - at).cross(overlap.gradient);
        prop_assert!(about_ball.length() <= 1e-4 * (1.0 + overlap.gradient.length()));
    }
}

#[test]
fn a_ball_on_a_plane_is_cut_in_its_cap() {
    for scale in [1e-4_f32, 1.0, 1e4] {
        let tree = ball(Vec3::new(1.0, 0.0, 2.0), 0.5).scaled(scale).unwrap();
        let overlap = tree.overlap_with_half_space(Vec3::Y, -0.3 * scale);
        let (h, r) = (0.2_f32, 0.5_f32);
        let volume = PI / 3.0 * h * h * (3.0 * r - h);
        assert!((overlap.volume / (volume * scale.powi(3)) - 1.0).abs() < 1e-5);
        let base = PI * h * (2.0 * r - h) * scale * scale;
        assert!((overlap.gradient / base - Vec3::Y).length() < 1e-5);
        let below = 0.75 * (2.0 * r - h).powi(2) / (3.0 * r - h);
        assert!((overlap.centroid / scale - Vec3::new(1.0, -below, 2.0)).length() < 1e-5);
        assert!((overlap.force / overlap.volume + Vec3::Y).length() < 1e-5);
        assert!(overlap.torque.length() < 1e-5 * overlap.volume * scale);
        assert!((overlap.deepest.unwrap().depth / scale - h).abs() < 1e-5);
        assert!(overlap.intersects && overlap.pairs == 1 && overlap.stiffness.is_none());
    }
}

#[test]
fn a_solid_wholly_behind_the_plane_is_all_overlap() {
    let half = Quat::from_rotation_z(0.3) * Vec3::Y;
    let tree = ball(Vec3::ZERO, 1.0);
    let overlap = tree.overlap_with_half_space(half, 5.0);
    assert!((overlap.volume / (4.0 / 3.0 * PI) - 1.0).abs() < 1e-6);
    assert_eq!(overlap.gradient, Vec3::ZERO);
    assert!((overlap.force / overlap.volume + half).length() < 1e-5, "out of the half-space all the same");
}

#[test]
fn a_block_of_balls_sinks_in_by_its_footprint() {
    // Balls of the volume of their cells, 0.1 wide, in a block of 1 × 0.5 × 1 that stands on y = 0.
    let mut spheres = Vec::new();
    for i in 0..500 {
        let place = Vec3::new((i % 10) as f32, (i / 100) as f32, (i / 10 % 10) as f32);
        let mut sphere = InnerSphere::solid_ball(0.1 * place + 0.05, 0.05, Vec3::Y);
        sphere.cell_volume = 1e-3;
        spheres.push(sphere);
    }
    let tree = tree_of(spheres);
    for depth in [0.1, 0.2, 0.3, 0.4] {
        let overlap = tree.overlap_with_half_space(Vec3::Y, depth);
        assert!((overlap.volume / depth - 1.0).abs() < 0.01, "{depth}: {}", overlap.volume);
        let middle = Vec3::new(0.5, 0.5 * depth, 0.5);
        assert!(overlap.centroid.distance(middle) < 0.01 && overlap.torque.length() < 1e-3 * overlap.volume);
    }
}

#[test]
fn useless_half_spaces_and_distances_meet_nothing() {
    let tree = ball(Vec3::ZERO, 1.0);
    for normal in [Vec3::ZERO, Vec3::NAN, Vec3::splat(f32::INFINITY), 9.0 * Vec3::X] {
        assert_eq!(tree.overlap_with_half_space(normal, 0.0), Overlap::default());
    }
    for offset in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.5] {
        assert_eq!(tree.overlap_with_half_space(Vec3::X, offset), Overlap::default());
    }
    let nowhere = |_| SurfaceDistance { distance: f32::NAN, outward: Vec3::X };
    assert_eq!(tree.overlap_with_surface(nowhere), Overlap::default());
    let whole =
        tree.overlap_with_surface(|_| SurfaceDistance { distance: f32::NEG_INFINITY, outward: Vec3::X });
    assert!((whole.volume / (4.0 / 3.0 * PI) - 1.0).abs() < 1e-6 && whole.force.is_finite());
}

#[test]
fn size_ratios_do_not_matter() {
    let tree = tree_of(alloc::vec![
        InnerSphere::solid_ball(Vec3::ZERO, 1.0, Vec3::X),
        InnerSphere::solid_ball(Vec3::new(1.5, 0.0, 0.0), 1e-7, Vec3::X),
    ]);
    let overlap = tree.overlap_with_half_space(Vec3::X, 0.0);
    assert_eq!(overlap.pairs, 1);
    let both = tree.overlap_with_half_space(-Vec3::X, 0.0);
    assert_eq!(both.pairs, 2);
    assert!((overlap.volume + both.volume - 4.0 / 3.0 * PI).abs() < 1e-5);
}
