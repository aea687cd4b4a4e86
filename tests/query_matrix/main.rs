//! Every query, against every shape, in both orders, over the poses that make a difference.
//!
//! An inner sphere tree of a few balls must answer as parry's compound of the same balls does.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test that cannot go on has failed")]

mod bad_poses;
mod casts;
mod compounds;
mod continuous;
mod left_alone;
mod shape;
mod static_queries;

use ist::{InnerSphere, SolidProperties, SpherePacking};
use rapier_ist::IstShape;
use rapier3d::glamx::DVec3;
use rapier3d::math::{Pose, Rotation, Vector};
use rapier3d::parry::shape::{Ball, Compound, SharedShape};
use rapier3d::prelude::{TriMeshFlags, Voxels};

/// Disjoint balls that no symmetry makes alike.
const BALLS: [(Vector, f32); 4] = [
    (Vector::new(0.0, 0.0, 0.0), 0.3),
    (Vector::new(0.6, 0.1, 0.0), 0.25),
    (Vector::new(-0.1, 0.55, 0.2), 0.2),
    (Vector::new(0.1, -0.2, -0.6), 0.22),
];

/// A tree of `balls` and parry's compound of them.
fn solid(balls: &[(Vector, f32)]) -> (IstShape, SharedShape) {
    let spheres = balls.iter().map(|(c, r)| InnerSphere::solid_ball(*c, *r, Vector::Y)).collect();
    let packing = SpherePacking::new(spheres, SolidProperties::ball(1.0)).unwrap();
    let parts = balls.iter().map(|(c, r)| (Pose::from_translation(*c), SharedShape::new(Ball::new(*r))));
    (IstShape::from_packing(&packing), SharedShape::new(Compound::new(parts.collect())))
}

/// One of each of parry's shapes, about the origin and about a metre in size.
fn shapes() -> Vec<(&'static str, SharedShape)> {
    let corners: Vec<Vector> = (0..8)
        .map(|i| Vector::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 0.8 - 0.4)
        .collect();
    let (vertices, triangles) = SharedShape::cuboid(0.4, 0.3, 0.5).as_cuboid().unwrap().to_trimesh();
    let [a, b, c] = [Vector::new(-0.5, 0.0, -0.4), Vector::new(0.6, 0.1, -0.3), Vector::new(0.0, 0.2, 0.6)];
    let heights =
        rapier3d::parry::utils::Array2::new(3, 3, vec![0.0, 0.1, 0.0, 0.2, 0.3, 0.1, 0.0, 0.1, 0.0]);
    let voxels: Vec<Vector> = corners.iter().map(|corner| *corner * 0.5).collect();
    let half = SharedShape::cuboid(0.2, 0.2, 0.2);
    let parts = vec![
        (Pose::translation(-0.3, 0.0, 0.0), half.clone()),
        (Pose::translation(0.3, 0.1, 0.0), SharedShape::ball(0.25)),
    ];
    vec![
        ("ball", SharedShape::ball(0.4)),
        ("cuboid", SharedShape::cuboid(0.3, 0.4, 0.5)),
        ("capsule", SharedShape::capsule_y(0.3, 0.2)),
        ("segment", SharedShape::segment(a, b)),
        ("triangle", SharedShape::triangle(a, b, c)),
        ("cylinder", SharedShape::cylinder(0.4, 0.3)),
        ("cone", SharedShape::cone(0.4, 0.3)),
        ("convex polyhedron", SharedShape::convex_hull(&corners).unwrap()),
        ("half-space", SharedShape::halfspace(Vector::new(0.0, 0.6, 0.8))),
        ("heightfield", SharedShape::heightfield(heights, Vector::new(2.0, 1.0, 2.0))),
        ("trimesh", SharedShape::trimesh(vertices.clone(), triangles.clone()).unwrap()),
        (
            "oriented trimesh",
            SharedShape::trimesh_with_flags(vertices, triangles, TriMeshFlags::ORIENTED).unwrap(),
        ),
        ("voxels", SharedShape::new(Voxels::from_points(Vector::splat(0.4), &voxels))),
        ("compound", SharedShape::compound(parts)),
        ("polyline", SharedShape::polyline(vec![a, b, c], None)),
        ("round cuboid", SharedShape::round_cuboid(0.3, 0.2, 0.3, 0.1)),
        ("round triangle", SharedShape::round_triangle(a, b, c, 0.1)),
        ("round cylinder", SharedShape::round_cylinder(0.3, 0.2, 0.1)),
        ("round cone", SharedShape::round_cone(0.3, 0.2, 0.1)),
        ("round convex polyhedron", SharedShape::round_convex_hull(&corners, 0.1).unwrap()),
    ]
}

/// Poses from far to contained, turned differently.
fn poses() -> Vec<Pose> {
    let directions = [Vector::new(1.0, 0.2, 0.1), Vector::new(-0.3, 1.0, 0.4), Vector::new(0.2, -0.5, -1.0)];
    let mut poses = Vec::new();
    for (i, direction) in directions.into_iter().enumerate() {
        for distance in [0.0, 0.2, 0.5, 0.8, 1.0, 1.3, 2.0, 20.0] {
            let turn = Rotation::from_scaled_axis(Vector::new(0.3, -0.7, 0.5) * (i as f32 + distance));
            poses.push(Pose::from_parts(direction.normalize() * distance, turn));
        }
    }
    poses
}

/// Distance of two points after rounding, for messages.
fn apart(a: Vector, b: Vector) -> f64 {
    let [a, b]: [DVec3; 2] = [a, b].map(|v| v.as_dvec3());
    a.distance(b)
}
