//! Random closed meshes of many kinds, at random scales and places.

#![allow(dead_code, reason = "each test file uses its part")]

use super::common::{cuboid, inverted, join, torus};
use glam::{DMat3, DQuat, DVec3};
use packer::TriangleMesh;
use proptest::prelude::*;
use proptest::strategy::Union;
use std::collections::BTreeSet;
use std::f64::consts::TAU;

/// A mesh and what it is, for the message of a failure.
#[derive(Clone)]
pub(crate) struct RandomMesh {
    pub(crate) kind: &'static str,
    pub(crate) mesh: TriangleMesh,
}

impl std::fmt::Debug for RandomMesh {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (lower, upper) = self.mesh.bounds();
        write!(f, "{} of {} triangles in {lower}..{upper}", self.kind, self.mesh.triangles.len())
    }
}

/// Meshes of all kinds, 1e-3 to 1e3 m large, turned and up to three times their size away from the origin.
pub(crate) fn meshes() -> impl Strategy<Value = RandomMesh> {
    let kinds = [
        bumpy_sphere().prop_map(|mesh| ("bumpy sphere", mesh)).boxed(),
        uneven_torus().prop_map(|mesh| ("torus", mesh)).boxed(),
        polyhedron().prop_map(|mesh| ("polyhedron", mesh)).boxed(),
        box_with_cavities().prop_map(|mesh| ("box with cavities", mesh)).boxed(),
        plate().prop_map(|mesh| ("plate", mesh)).boxed(),
        needle().prop_map(|mesh| ("needle", mesh)).boxed(),
        several_shells().prop_map(|mesh| ("several shells", mesh)).boxed(),
        blocks().prop_map(|blocks| ("blocks", blocks.mesh)).boxed(),
    ];
    let turn = (point(-1.0, 1.0), 0.0..TAU);
    (Union::new(kinds), -3.0..3.0_f64, turn, point(-3.0, 3.0)).prop_map(
        |((kind, mut mesh), exponent, (axis, angle), place)| {
            let turn = DQuat::from_axis_angle(axis.normalize_or(DVec3::X), angle);
            let scale = 10.0_f64.powf(exponent);
            let (lower, upper) = mesh.bounds();
            let (center, size) = (0.5 * (lower + upper), lower.distance(upper));
            for v in &mut mesh.vertices {
                *v = scale * (turn * (*v - center) / size + place);
            }
            RandomMesh { kind, mesh }
        },
    )
}

fn point(lower: f64, upper: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(lower..upper).prop_map(DVec3::from_array)
}

/// A sphere whose radius varies with the direction; star-shaped, so that it does not cut itself.
fn bumpy_sphere() -> impl Strategy<Value = TriangleMesh> {
    prop::collection::vec((point(-4.0, 4.0), 0.0..TAU, 0.0..0.2_f64), 0..4).prop_map(|waves| {
        let mut mesh = sphere(16, 10);
        for v in &mut mesh.vertices {
            let height =
                waves.iter().map(|(wave, phase, height)| height * (wave.dot(*v) + phase).sin()).sum::<f64>();
            *v *= 1.0 + height;
        }
        mesh
    })
}

fn sphere(segments: u32, rings: u32) -> TriangleMesh {
    let mut mesh = TriangleMesh { vertices: vec![DVec3::Z, DVec3::NEG_Z], triangles: Vec::new() };
    for ring in 1..rings {
        for segment in 0..segments {
            let (u, v) = (
                TAU * f64::from(segment) / f64::from(segments),
                TAU / 2.0 * f64::from(ring) / f64::from(rings),
            );
            mesh.vertices.push(DVec3::new(v.sin() * u.cos(), v.sin() * u.sin(), v.cos()));
        }
    }
    let at = |ring: u32, segment: u32| 2 + (ring - 1) * segments + segment % segments;
    for s in 0..segments {
        mesh.triangles.extend([[0, at(1, s), at(1, s + 1)], [1, at(rings - 1, s + 1), at(rings - 1, s)]]);
        for ring in 1..rings - 1 {
            let (a, b, c, d) = (at(ring, s), at(ring + 1, s), at(ring + 1, s + 1), at(ring, s + 1));
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

/// A torus with waves along its way, squeezed along its axis.
fn uneven_torus() -> impl Strategy<Value = TriangleMesh> {
    (0.05..0.45_f64, 0.0..0.5_f64, 1..6_u32, 0.3..2.0_f64).prop_map(|(minor, wave, waves, squeeze)| {
        let mut mesh = torus(1.0, minor, 24);
        for v in &mut mesh.vertices {
            let around = DVec3::new(v.x, v.y, 0.0).normalize();
            let angle = v.y.atan2(v.x);
            let swell = 1.0 + wave * (f64::from(waves) * angle).sin();
            *v = around + (*v - around) * swell;
            v.z *= squeeze;
        }
        mesh
    })
}

/// The convex hull of points on an ellipsoid.
fn polyhedron() -> impl Strategy<Value = TriangleMesh> {
    let directions = prop::collection::vec(point(-1.0, 1.0), 4..18);
    (directions, point(0.2, 1.0)).prop_filter_map("points are too close to each other", |(points, axes)| {
        let points: Vec<DVec3> = points.iter().map(|p| p.normalize_or_zero()).collect();
        let apart = |(i, p): (usize, &DVec3)| points[..i].iter().all(|q| q.distance(*p) > 0.1);
        if !points.iter().enumerate().all(apart) {
            return None;
        }
        let mut mesh = hull(&points)?;
        mesh.vertices.iter_mut().for_each(|v| *v *= axes);
        Some(mesh)
    })
}

/// The hull of points on a sphere by brute force: a triangle is a face if all others lie on one side. None if it has
/// next to no volume.
fn hull(points: &[DVec3]) -> Option<TriangleMesh> {
    let mut triangles = Vec::new();
    let mut volume = 0.0;
    for c in 0..points.len() {
        for b in 0..c {
            for a in 0..b {
                let [p, q, r] = [a, b, c].map(|i| points[i]);
                let normal = (q - p).cross(r - p);
                let others = || (0..points.len()).filter(|i| ![a, b, c].contains(i));
                let heights: Vec<f64> = others().map(|i| normal.dot(points[i] - p)).collect();
                let face = [a, b, c].map(|i| i as u32);
                if heights.iter().all(|height| *height < 0.0) {
                    triangles.push(face);
                    volume += DMat3::from_cols(p, q, r).determinant() / 6.0;
                } else if heights.iter().all(|height| *height > 0.0) {
                    triangles.push([face[0], face[2], face[1]]);
                    volume -= DMat3::from_cols(p, q, r).determinant() / 6.0;
                }
            }
        }
    }
    // Euler: a triangulated hull of n points has 2n − 4 faces.
    let is_whole = triangles.len() == 2 * points.len() - 4 && volume > 0.05;
    is_whole.then(|| TriangleMesh { vertices: points.to_vec(), triangles })
}

/// A box with up to eight boxes in it, one in each octant, of either orientation.
fn box_with_cavities() -> impl Strategy<Value = TriangleMesh> {
    prop::collection::vec((point(0.05, 0.45), point(0.5, 0.9), any::<bool>(), any::<bool>()), 8).prop_map(
        |octants| {
            let mut mesh = cuboid(DVec3::ZERO, DVec3::splat(2.0));
            for (i, (lower, upper, exists, turned)) in octants.into_iter().enumerate() {
                let corner = DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2 & 1) as f64);
                let cavity = cuboid(corner + lower, corner + upper);
                if exists {
                    mesh = join(&mesh, &if turned { inverted(&cavity) } else { cavity });
                }
            }
            mesh
        },
    )
}

/// 20 to 100 times as wide as thick.
fn plate() -> impl Strategy<Value = TriangleMesh> {
    (0.01..0.05_f64, 0.5..1.0_f64).prop_map(|(thin, wide)| cuboid(DVec3::ZERO, DVec3::new(1.0, wide, thin)))
}

/// A slender double cone or bar, 20 to 1,000 times as long as thick.
fn needle() -> impl Strategy<Value = TriangleMesh> {
    (1.3..3.0_f64, any::<bool>()).prop_map(|(exponent, is_pointed)| {
        let thin = 10.0_f64.powf(-exponent);
        if !is_pointed {
            return cuboid(DVec3::ZERO, DVec3::new(thin, 1.0, thin));
        }
        let mut mesh = sphere(5, 2);
        mesh.vertices.iter_mut().for_each(|v| *v *= DVec3::new(0.5 * thin, 0.5 * thin, 0.5));
        mesh
    })
}

/// Two to four separate bodies.
fn several_shells() -> impl Strategy<Value = TriangleMesh> {
    let body = prop_oneof![bumpy_sphere(), polyhedron(), uneven_torus()];
    prop::collection::vec((body, 0.1..1.0_f64), 2..5).prop_map(|bodies| {
        bodies.into_iter().enumerate().fold(TriangleMesh::default(), |all, (i, (mut body, size))| {
            // No body is larger than 2 times its size from its centre.
            body.vertices.iter_mut().for_each(|v| *v = size * *v + DVec3::X * (4.1 * i as f64));
            join(&all, &body)
        })
    })
}

/// Unit cubes of a grid of three by three by three, and the surface of their union.
#[derive(Clone, Debug)]
pub(crate) struct Blocks {
    pub(crate) cubes: Vec<[i32; 3]>,
    pub(crate) mesh: TriangleMesh,
}

/// Cubes that touch in faces, edges and corners, or not at all.
pub(crate) fn blocks() -> impl Strategy<Value = Blocks> {
    prop::collection::btree_set(prop::array::uniform3(0..3), 1..14).prop_map(Blocks::of)
}

impl Blocks {
    /// Unit cubes at these places.
    pub(crate) fn of(cubes: BTreeSet<[i32; 3]>) -> Self {
        let mut mesh = TriangleMesh::default();
        for cube in &cubes {
            let lower = DVec3::from_array(cube.map(f64::from));
            let mut block = cuboid(lower, lower + 1.0);
            let TriangleMesh { vertices, triangles } = &mut block;
            triangles.retain(|triangle| {
                let [a, b, c] = triangle.map(|vertex| vertices[vertex as usize]);
                let normal = (b - a).cross(c - a);
                let next = [0, 1, 2].map(|axis| cube[axis] + normal[axis].round() as i32);
                !cubes.contains(&next)
            });
            mesh = join(&mesh, &block);
        }
        Self { cubes: cubes.into_iter().collect(), mesh }
    }
}
