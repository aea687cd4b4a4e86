//! Sphere packings and their trees from bytes.

use super::numbers::{
    any_float, any_vector, below, finite_float, moderate, moderate_vector, power_of_two, raw,
};
use arbitrary::Unstructured;
use glam::Vec3;
use ist::{InnerSphere, InnerSphereTree, SolidProperties, SpherePacking};

/// Enough for three levels of nodes over the leaves' blocks.
const MOST_SPHERES: u8 = 80;

/// A tree, and whether its numbers are such that results have to be exact.
pub(super) struct Solid {
    pub(super) tree: InnerSphereTree,
    pub(super) is_ordinary: bool,
}

/// Any solid: mostly with sizes over a few powers of ten and a scale; sometimes with arbitrary numbers.
pub(super) fn solid(u: &mut Unstructured) -> Solid {
    if below(u, 8) == 7 {
        return Solid { tree: wild_tree(u), is_ordinary: false };
    }
    let packing = packing(u);
    let tree = InnerSphereTree::new(&packing);
    let tree = tree.scaled(power_of_two(u, 20)).unwrap_or(tree);
    let skin = tree.bounding_ball().1 * [0.0, 0.0, 0.01, 0.3][usize::from(below(u, 4))];
    Solid { tree: tree.with_skin(skin).unwrap_or(tree).with_grid(), is_ordinary: true }
}

/// A packing of spheres with usual numbers: scattered, on a lattice, coincident, or of very different radii.
pub(super) fn packing(u: &mut Unstructured) -> SpherePacking {
    let (kind, count) = (below(u, 4), 1 + below(u, MOST_SPHERES));
    let size = 0.05 + f32::from(raw::<u8>(u)) / 256.0;
    let first = moderate_vector(u);
    let spheres = (0..count).map(|i| {
        let (center, radius) = match kind {
            0 => (moderate_vector(u), size * power_of_two(u, 2)),
            1 => {
                let at = Vec3::new(f32::from(i % 4), f32::from(i / 4 % 4), f32::from(i / 16));
                (at * (2.0 * size), size)
            }
            2 => (first, size),
            _ => (moderate_vector(u) * power_of_two(u, 8), size * power_of_two(u, 12)),
        };
        let mut sphere = InnerSphere::solid_ball(center, radius, normal(u));
        sphere.cell_volume *= 1.0 + f32::from(raw::<u8>(u)) / 128.0;
        sphere.cell_centroid += radius * 0.125 * Vec3::from(raw::<[i8; 3]>(u).map(|x| f32::from(x) / 128.0));
        sphere
    });
    let spheres: Vec<InnerSphere> = spheres.collect();
    // About as large as they are: a body that reaches far and has next to no inertia is no usual one.
    let reach = spheres.iter().map(|s| s.center.length() + s.radius).fold(0.0, f32::max);
    let solid = SolidProperties::ball(f64::from(reach));
    SpherePacking::new(spheres, solid).unwrap_or_else(|_| one_ball())
}

/// A tree of whatever numbers a packing takes.
fn wild_tree(u: &mut Unstructured) -> InnerSphereTree {
    let spheres = (0..1 + below(u, 20)).map(|_| InnerSphere {
        center: any_vector(u),
        radius: any_float(u).abs(),
        cell_volume: any_float(u).abs(),
        cell_centroid: any_vector(u),
        normal: normal(u),
    });
    // One number that is not finite must not spoil all the others.
    let finite = |s: &InnerSphere| SpherePacking::new(vec![*s], SolidProperties::ball(1.0)).is_ok();
    let spheres: Vec<InnerSphere> = spheres.filter(finite).collect();
    let packing = SpherePacking::new(spheres, SolidProperties::ball(1.0)).unwrap_or_else(|_| one_ball());
    let tree = InnerSphereTree::new(&packing);
    let tree = tree.scaled(finite_float(u)).unwrap_or(tree);
    tree.with_skin(finite_float(u)).unwrap_or(tree).with_grid()
}

fn normal(u: &mut Unstructured) -> Vec3 {
    let [x, y, z] = raw::<[i8; 3]>(u).map(f32::from);
    Vec3::new(x, y, z).normalize_or(Vec3::Y)
}

/// A packing of a unit ball.
pub(super) fn one_ball() -> SpherePacking {
    let ball = InnerSphere::solid_ball(Vec3::ZERO, 1.0, Vec3::Y);
    match SpherePacking::new(vec![ball], SolidProperties::ball(1.0)) {
        Ok(packing) => packing,
        Err(error) => unreachable!("a unit ball is a packing: {error}"),
    }
}

/// How far the tree reaches from the origin of its frame (m), skin included.
pub(super) fn reach(tree: &InnerSphereTree) -> f64 {
    let (center, radius) = tree.bounding_ball();
    center.as_dvec3().length() + f64::from(radius)
}

/// A direction of unit length.
pub(super) fn unit_vector(u: &mut Unstructured) -> Vec3 {
    normal(u)
}

/// A place in or about a tree.
pub(super) fn point_near(u: &mut Unstructured, tree: &InnerSphereTree) -> Vec3 {
    let (center, radius) = tree.bounding_ball();
    center + Vec3::new(moderate(u), moderate(u), moderate(u)) * (0.25 * radius)
}
