//! Surfaces with something special about them.

use crate::common::{bumpy_sphere, cuboid, extruded, join};
use glam::{DVec2, DVec3};
use packer::TriangleMesh;
use std::f64::consts::{PI, TAU};

/// A grid of quads that closes in both directions; `twisted` reverses the second one at the seam of the first.
fn closed_grid(rows: u32, columns: u32, twisted: bool, point: impl Fn(f64, f64) -> DVec3) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    for i in 0..rows {
        for j in 0..columns {
            mesh.vertices.push(point(f64::from(i) / f64::from(rows), f64::from(j) / f64::from(columns)));
            let at = |i: u32, j: u32| {
                let j = if i == rows && twisted { columns - j % columns } else { j };
                i % rows * columns + j % columns
            };
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

/// A Klein bottle in its figure-eight immersion.
pub(crate) fn klein_bottle() -> TriangleMesh {
    closed_grid(40, 24, true, |u, v| {
        let (u, v) = (TAU * u, TAU * v);
        let radius = 2.0 + (0.5 * u).cos() * v.sin() - (0.5 * u).sin() * (2.0 * v).sin();
        let z = (0.5 * u).sin() * v.sin() + (0.5 * u).cos() * (2.0 * v).sin();
        DVec3::new(radius * u.cos(), radius * u.sin(), z)
    })
}

pub(crate) fn moebius_strip() -> TriangleMesh {
    let count = 30;
    let mut mesh = TriangleMesh::default();
    for i in 0..count {
        let turn = TAU * f64::from(i) / f64::from(count);
        for side in [-0.3, 0.3] {
            let radius = 1.0 + side * (0.5 * turn).cos();
            mesh.vertices.push(DVec3::new(
                radius * turn.cos(),
                radius * turn.sin(),
                side * (0.5 * turn).sin(),
            ));
        }
        let (a, b) = (2 * i, 2 * i + 1);
        let (c, d) = if i + 1 == count { (1, 0) } else { (a + 2, b + 2) };
        mesh.triangles.extend([[a, c, d], [a, d, b]]);
    }
    mesh
}

/// A tube along a figure eight: it passes through itself in the middle.
pub(crate) fn figure_eight_torus() -> TriangleMesh {
    closed_grid(64, 16, false, |u, v| {
        let (u, v) = (TAU * u, TAU * v);
        let along = DVec2::new(u.cos(), (2.0 * u).cos()).normalize();
        let middle = DVec3::new(u.sin(), 0.5 * (2.0 * u).sin(), 0.0);
        middle + 0.15 * (v.cos() * DVec3::new(along.y, -along.x, 0.0) + v.sin() * DVec3::Z)
    })
}

/// An outline that runs around the middle `turns` times with `tips` tips.
pub(crate) fn star(tips: u32, turns: u32) -> TriangleMesh {
    let tip = |i: u32| DVec2::from_angle(TAU * f64::from(i * turns) / f64::from(tips));
    extruded(&(0..tips).map(tip).collect::<Vec<_>>(), 0.4)
}

/// Two tetrahedra that have their tip in common.
pub(crate) fn hourglass() -> TriangleMesh {
    let up = tetrahedron(1.0);
    let down = tetrahedron(-1.0);
    join(&up, &down)
}

/// A tetrahedron with its tip in the origin.
pub(crate) fn tetrahedron(height: f64) -> TriangleMesh {
    let corner = |i: f64| DVec3::new((TAU * i / 3.0).cos(), (TAU * i / 3.0).sin(), height);
    let vertices = vec![DVec3::ZERO, corner(0.0), corner(1.0), corner(2.0)];
    let triangles = vec![[1, 2, 3], [0, 2, 1], [0, 3, 2], [0, 1, 3]];
    TriangleMesh { vertices, triangles }
}

/// A ball with long needles.
pub(crate) fn hedgehog() -> TriangleMesh {
    let mut mesh = bumpy_sphere(16, 1.0, 0.0, 0);
    for vertex in mesh.vertices.iter_mut().step_by(7) {
        *vertex *= 3.0;
    }
    mesh
}

/// A cube of which one face has a vertex in the middle of an edge; `split` tells whether the neighbour has it too.
pub(crate) fn t_junction(split: bool) -> TriangleMesh {
    let mut mesh = cuboid(DVec3::ZERO, DVec3::ONE);
    // The edge from 0 to 1 belongs to a triangle of the floor and to one of the front.
    let faces: Vec<usize> = (0..12)
        .filter(|t| mesh.triangles[*t].contains(&0) && mesh.triangles[*t].contains(&1))
        .take(if split { 2 } else { 1 })
        .collect();
    mesh.vertices.push(DVec3::new(0.5, 0.0, 0.0));
    for face in faces {
        let triangle = mesh.triangles[face];
        mesh.triangles[face] = triangle.map(|v| if v == 0 { 8 } else { v });
        mesh.triangles.push(triangle.map(|v| if v == 1 { 8 } else { v }));
    }
    mesh
}

/// The same, with the gap closed by a triangle without area.
pub(crate) fn closed_t_junction() -> TriangleMesh {
    let mut mesh = t_junction(false);
    mesh.triangles.push([0, 1, 8]);
    mesh
}

/// Many tetrahedra, all through each other.
pub(crate) fn tangle(count: u32) -> TriangleMesh {
    let share = |i: u32, factor: f64| (f64::from(i) * factor).fract() - 0.5;
    let mut mesh = TriangleMesh::default();
    for i in 1..=4 * count {
        mesh.vertices.push(
            DVec3::new(share(i, 0.819_172_5), share(i, 0.671_043_6), share(i, 0.549_700_5)).normalize(),
        );
    }
    for base in (0..4 * count).step_by(4) {
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        mesh.triangles.extend(faces.map(|face| face.map(|i| base + i)));
    }
    mesh
}

/// Two closed cones tip to tip with a common axis, fanned into many slivers.
pub(crate) fn sliver_cone() -> TriangleMesh {
    let sides = 700;
    let mut mesh = TriangleMesh { vertices: vec![DVec3::Z, DVec3::ZERO], triangles: Vec::new() };
    for i in 0..sides {
        let turn = 2.0 * PI * f64::from(i) / f64::from(sides);
        mesh.vertices.push(DVec3::new(turn.cos(), turn.sin(), 0.0));
        let (a, b) = (2 + i, 2 + (i + 1) % sides);
        mesh.triangles.extend([[0, a, b], [1, b, a]]);
    }
    mesh
}
