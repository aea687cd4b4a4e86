//! Closed meshes to pack.
#![allow(dead_code, reason = "each test file uses its part")]
#![allow(clippy::unwrap_used, reason = "a test that cannot build its mesh has failed")]

pub(crate) mod surface;

use glam::{DQuat, DVec2, DVec3};
use packer::{Solid, TriangleMesh};
use std::f64::consts::TAU;
use std::path::PathBuf;

pub(crate) fn asset(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../assets").join(name)
}

/// A box with corners `lower` and `upper`.
pub(crate) fn cuboid(lower: DVec3, upper: DVec3) -> TriangleMesh {
    let pick = |i: usize, bit: usize| if i >> bit & 1 == 1 { upper[bit] } else { lower[bit] };
    let vertices = (0..8).map(|i| DVec3::new(pick(i, 0), pick(i, 1), pick(i, 2))).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    TriangleMesh { vertices, triangles }
}

/// A torus about the z axis.
pub(crate) fn torus(major: f64, minor: f64, segments: u32) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    let sides = segments / 2;
    for i in 0..segments {
        for j in 0..sides {
            let (u, v) = (TAU * f64::from(i) / f64::from(segments), TAU * f64::from(j) / f64::from(sides));
            let radius = major + minor * v.cos();
            mesh.vertices.push(DVec3::new(radius * u.cos(), radius * u.sin(), minor * v.sin()));
            let at = |i: u32, j: u32| (i % segments) * sides + j % sides;
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

/// Both meshes in one.
pub(crate) fn join(a: &TriangleMesh, b: &TriangleMesh) -> TriangleMesh {
    let mut mesh = a.clone();
    let base = a.vertices.len() as u32;
    mesh.vertices.extend(&b.vertices);
    mesh.triangles.extend(b.triangles.iter().map(|t| t.map(|v| v + base)));
    mesh
}

/// The same surface facing the other way.
pub(crate) fn inverted(mesh: &TriangleMesh) -> TriangleMesh {
    let triangles = mesh.triangles.iter().map(|[a, b, c]| [*a, *c, *b]).collect();
    TriangleMesh { vertices: mesh.vertices.clone(), triangles }
}

/// Solids of different kinds: an organic mesh, a gear, and shapes with flat, thin and round parts.
pub(crate) fn solids() -> Vec<(&'static str, Solid)> {
    let box_with_cavity =
        join(&cuboid(DVec3::ZERO, DVec3::ONE), &cuboid(DVec3::splat(0.3), DVec3::splat(0.6)));
    let meshes = [
        ("bunny", TriangleMesh::load(asset("bunny.obj")).unwrap()),
        ("spider gear", TriangleMesh::load(asset("spider_gear.obj")).unwrap()),
        ("torus", torus(1.0, 0.3, 48)),
        ("cube", cuboid(DVec3::ZERO, DVec3::ONE)),
        ("plate", cuboid(DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.02))),
        ("distant", cuboid(DVec3::new(999.0, -500.0, 20.0), DVec3::new(1000.0, -499.0, 21.5))),
        ("box with cavity", box_with_cavity),
    ];
    meshes.into_iter().map(|(name, mesh)| (name, Solid::new(&mesh).unwrap())).collect()
}

/// The mesh turned about the origin and then moved.
pub(crate) fn rotated(mesh: &TriangleMesh, turn: DQuat, place: DVec3) -> TriangleMesh {
    let vertices = mesh.vertices.iter().map(|v| turn * *v + place).collect();
    TriangleMesh { vertices, triangles: mesh.triangles.clone() }
}

/// The mesh in another size, about the origin.
pub(crate) fn scaled(mesh: &TriangleMesh, scale: f64) -> TriangleMesh {
    let vertices = mesh.vertices.iter().map(|v| *v * scale).collect();
    TriangleMesh { vertices, triangles: mesh.triangles.clone() }
}

/// A sphere with waves of height `bump` on it, about the z axis; `seed` chooses them.
pub(crate) fn bumpy_sphere(rings: u32, radius: f64, bump: f64, seed: u32) -> TriangleMesh {
    let phase = |i: u32| f64::from(seed) * (1.7 + f64::from(i));
    let point = |latitude: f64, longitude: f64| {
        let direction =
            DVec3::new(latitude.sin() * longitude.cos(), latitude.sin() * longitude.sin(), latitude.cos());
        let waves = (0..3).map(|i| (4.0 * direction[i as usize] + phase(i)).sin()).sum::<f64>() / 3.0;
        direction * (radius + bump * waves)
    };
    let sides = 2 * rings;
    let mut mesh =
        TriangleMesh { vertices: vec![point(0.0, 0.0), point(0.5 * TAU, 0.0)], triangles: Vec::new() };
    for ring in 1..rings {
        let latitude = 0.5 * TAU * f64::from(ring) / f64::from(rings);
        mesh.vertices
            .extend((0..sides).map(|side| point(latitude, TAU * f64::from(side) / f64::from(sides))));
    }
    let at = |ring: u32, side: u32| 2 + (ring - 1) * sides + side % sides;
    for side in 0..sides {
        mesh.triangles.push([0, at(1, side), at(1, side + 1)]);
        mesh.triangles.push([1, at(rings - 1, side + 1), at(rings - 1, side)]);
        for ring in 1..rings - 1 {
            let (a, b) = (at(ring, side), at(ring, side + 1));
            let (c, d) = (at(ring + 1, side + 1), at(ring + 1, side));
            mesh.triangles.extend([[a, d, c], [a, c, b]]);
        }
    }
    mesh
}

/// A prism over the closed `outline`, which may cross itself; its ends are fans around the mean of the corners.
pub(crate) fn extruded(outline: &[DVec2], height: f64) -> TriangleMesh {
    let count = outline.len() as u32;
    let middle = outline.iter().sum::<DVec2>() / f64::from(count);
    let points = || outline.iter().chain([&middle]);
    let mut mesh = TriangleMesh::default();
    mesh.vertices.extend(points().map(|p| p.extend(0.0)));
    mesh.vertices.extend(points().map(|p| p.extend(height)));
    let top = count + 1;
    for i in 0..count {
        let j = (i + 1) % count;
        mesh.triangles.extend([
            [i, j, j + top],
            [i, j + top, i + top],
            [j, i, count],
            [i + top, j + top, count + top],
        ]);
    }
    mesh
}
