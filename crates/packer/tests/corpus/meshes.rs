//! Meshes made in code.

use crate::certificate::certify;
use crate::common::{bumpy_sphere, cuboid, inverted, join, rotated, scaled, torus};
use crate::shapes::*;
use crate::{guarded, variant};
use glam::{DQuat, DVec3};
use packer::{PackOptions, Solid, TriangleMesh, diagnose, pack};

/// What becomes of a mesh: the name of its error, or a certified packing of 50 spheres.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Expected {
    MeshError(&'static str),
    Packing,
}

use Expected::{MeshError, Packing};

/// Tries `mesh`; balls are certified against `reference`, which is consistently oriented.
fn expect(name: &'static str, mesh: TriangleMesh, reference: &TriangleMesh, expected: Expected) {
    let reference = reference.clone();
    guarded(name, move || {
        let diagnosis = diagnose(&mesh);
        let solid = match Solid::new(&mesh) {
            Ok(solid) => solid,
            Err(error) => {
                assert_eq!(expected, MeshError(&variant(&error).leak()[..]), "{name}: {error}");
                assert_eq!(variant(&diagnosis.refusal().unwrap()), variant(&error), "{name}");
                return;
            }
        };
        assert!(diagnosis.refusal().is_none(), "{name}");
        assert_eq!(&diagnosis, solid.diagnosis(), "{name}");
        match pack(&solid, &PackOptions::fast().spheres(50)) {
            Ok(packed) => {
                assert_eq!(expected, Packing, "{name}");
                certify(name, &reference, &solid, &packed.packing);
            }
            Err(error) => panic!("{name}: {error}"),
        }
    });
}

fn cube() -> TriangleMesh {
    cuboid(DVec3::ZERO, DVec3::ONE)
}

fn ring() -> TriangleMesh {
    torus(1.0, 0.4, 24)
}

#[test]
fn meshes_without_an_inside_are_refused_by_name() {
    let edited = |mesh: TriangleMesh, edit: fn(&mut TriangleMesh)| {
        let mut mesh = mesh;
        edit(&mut mesh);
        mesh
    };
    let cases = [
        ("nothing", TriangleMesh::default(), "NoTriangles"),
        ("points only", edited(cube(), |m| m.triangles.clear()), "NoTriangles"),
        ("one triangle", edited(cube(), |m| m.triangles.truncate(1)), "TooFewTriangles"),
        (
            "a triangle and its back",
            edited(cube(), |m| m.triangles = vec![[0, 1, 2], [0, 2, 1]]),
            "TooFewTriangles",
        ),
        ("one point many times", edited(cube(), |m| m.vertices.fill(DVec3::ONE)), "TooFewTriangles"),
        ("one triangle many times", edited(cube(), |m| m.triangles.fill([0, 1, 2])), "TooFewTriangles"),
        ("NaN", edited(cube(), |m| m.vertices[3].y = f64::NAN), "VertexNotFinite"),
        ("infinite", edited(cube(), |m| m.vertices[7].x = f64::NEG_INFINITY), "VertexNotFinite"),
        ("NaN in an unused vertex", edited(cube(), |m| m.vertices.push(DVec3::NAN)), "VertexNotFinite"),
        ("an index too large", edited(cube(), |m| m.triangles[2][0] = 8), "IndexOutOfRange"),
        ("the largest index", edited(cube(), |m| m.triangles[2][0] = u32::MAX), "IndexOutOfRange"),
        ("a face missing", edited(cube(), |m| m.triangles.truncate(11)), "OpenEdges"),
        (
            "a sheet",
            edited(cube(), |m| m.triangles = vec![[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5]]),
            "OpenEdges",
        ),
        (
            "nearly welded",
            edited(cube(), |m| {
                m.vertices.push(m.vertices[0] + 1e-7);
                m.triangles[0] = m.triangles[0].map(|v| if v == 0 { 8 } else { v });
            }),
            "OpenEdges",
        ),
        ("a Moebius strip", moebius_strip(), "OpenEdges"),
        ("a T-junction", t_junction(false), "OpenEdges"),
        ("a Klein bottle", klein_bottle(), "NotOrientable"),
        (
            "a fin",
            edited(cube(), |m| {
                m.vertices.push(DVec3::splat(2.0));
                m.triangles.push([0, 1, 8]);
            }),
            "NonManifoldEdges",
        ),
        ("a wall inside", edited(cube(), |m| m.triangles.extend([[0, 1, 7], [0, 7, 6]])), "NonManifoldEdges"),
        ("flat", cuboid(DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0)), "TooFewTriangles"),
        ("nearly flat", cuboid(DVec3::ZERO, DVec3::new(1.0, 1.0, 1e-13)), "BelowResolution"),
        (
            "nearly flat and oblique",
            rotated(
                &cuboid(-DVec3::ONE, DVec3::new(1.0, 1.0, -1.0 + 1e-13)),
                DQuat::from_rotation_x(0.7),
                DVec3::ZERO,
            ),
            "ZeroVolume",
        ),
        ("a line", cuboid(DVec3::ZERO, DVec3::new(1.0, 1e-8, 1e-8)), "BelowResolution"),
        ("1e-30 m", scaled(&ring(), 1e-30), "SizeOutOfRange"),
        ("1e-300 m", scaled(&ring(), 1e-300), "SizeOutOfRange"),
        ("1e30 m", scaled(&ring(), 1e30), "SizeOutOfRange"),
        ("1e308 m", scaled(&cuboid(-DVec3::ONE, DVec3::ONE), 1e308), "SizeOutOfRange"),
        ("a tangle", tangle(1_200), "TooManyIntersections"),
    ];
    for (name, mesh, error) in cases {
        expect(name, mesh.clone(), &mesh, MeshError(error));
    }
}

#[test]
fn what_single_precision_cannot_hold_is_refused_by_name() {
    let far = DVec3::new(1e9, -1e9, 1e9);
    for (name, mesh) in [
        ("a plate of a nanometre", cuboid(DVec3::ZERO, DVec3::new(1.0, 1.0, 1e-9))),
        ("a cube at 1e9 m", cuboid(far, far + 1.0)),
        ("a hair", cuboid(DVec3::ZERO, DVec3::new(1.0, 3e-6, 3e-6))),
    ] {
        expect(name, mesh.clone(), &mesh, MeshError("BelowResolution"));
    }
}

#[test]
fn extreme_sizes_and_places_are_packed() {
    for (name, scale) in [
        ("1e-8 m", 1e-8),
        ("1e-6 m", 1e-6),
        ("1e-3 m", 1e-3),
        ("1e3 m", 1e3),
        ("1e6 m", 1e6),
        ("1e11 m", 1e11),
    ] {
        let mesh = scaled(&ring(), scale);
        expect(name, mesh.clone(), &mesh, Packing);
    }
    for (name, place) in [("1 km away", 1e3), ("100 km away", 1e5)] {
        let mesh = cuboid(DVec3::splat(place), DVec3::splat(place + if place > 1e4 { 10.0 } else { 1.0 }));
        expect(name, mesh.clone(), &mesh, Packing);
    }
}

#[test]
fn shapes_that_are_hard_are_packed() {
    let spike = {
        let mut mesh = cube();
        mesh.vertices[7] = DVec3::new(1.0, 1.0, 40.0);
        mesh
    };
    for (name, mesh) in [
        ("a thin plate", cuboid(DVec3::ZERO, DVec3::new(1.0, 1.0, 1e-2))),
        ("a long bar", cuboid(DVec3::ZERO, DVec3::new(1.0, 1e-3, 1e-3))),
        ("a spike", spike),
        ("a hedgehog", hedgehog()),
        ("a flat pyramid", tetrahedron(1e-3)),
        ("a needle", tetrahedron(500.0)),
        ("a fan of slivers", sliver_cone()),
        ("an edge with a vertex in its middle", t_junction(true)),
        ("a triangle without area", closed_t_junction()),
        ("tips that touch", hourglass()),
        ("corners that touch", join(&cube(), &cuboid(DVec3::ONE, DVec3::splat(2.0)))),
        (
            "cubes with a common edge",
            join(&cube(), &cuboid(DVec3::new(1.0, 1.0, 0.0), DVec3::new(2.0, 2.0, 1.0))),
        ),
        ("solids apart", join(&cube(), &rotated(&ring(), DQuat::IDENTITY, DVec3::X * 50.0))),
        ("sizes apart", join(&scaled(&cube(), 100.0), &rotated(&cube(), DQuat::IDENTITY, DVec3::X * 200.0))),
        ("negative zero", cuboid(DVec3::splat(-1.0), DVec3::splat(-0.0))),
    ] {
        expect(name, mesh.clone(), &mesh, Packing);
    }
}

#[test]
fn surfaces_that_cut_or_cover_themselves_are_packed() {
    let ball = bumpy_sphere(14, 1.0, 0.2, 2);
    let moved =
        |mesh: &TriangleMesh, x: f64| rotated(mesh, DQuat::from_rotation_z(0.4), DVec3::new(x, 0.2, 0.1));
    for (name, mesh) in [
        ("a pentagram", star(5, 2)),
        ("a star of nine, three times around", star(9, 4)),
        ("a bow tie", star(4, 2).clone()),
        ("a figure-eight torus", figure_eight_torus()),
        ("balls that overlap", join(&ball, &moved(&ball, 0.9))),
        ("balls that nearly coincide", join(&ball, &moved(&ball, 1e-3))),
        (
            "rings through each other",
            join(&ring(), &rotated(&ring(), DQuat::from_rotation_x(1.5), DVec3::ZERO)),
        ),
        (
            "a face on a larger face",
            join(&cube(), &cuboid(DVec3::new(0.2, 0.2, 1.0), DVec3::new(0.8, 0.8, 1.5))),
        ),
        (
            "an edge on a face",
            join(
                &cube(),
                &rotated(
                    &cube(),
                    DQuat::from_rotation_y(0.25 * std::f64::consts::PI),
                    DVec3::new(0.1, 0.3, 1.0 + 0.5_f64.sqrt()),
                ),
            ),
        ),
        ("flush", join(&cube(), &cuboid(DVec3::new(0.5, 0.25, 0.0), DVec3::new(1.5, 0.75, 1.0)))),
        ("nearly the same twice", join(&cube(), &cuboid(DVec3::splat(1e-13), DVec3::splat(1.0 + 1e-13)))),
        ("a tangle of a few", tangle(12)),
    ] {
        let expected = if name == "a bow tie" { MeshError("BelowResolution") } else { Packing };
        // The reference has to be oriented as the solid is: outwards.
        let reference = if name.contains("tangle") { oriented(&mesh) } else { mesh.clone() };
        expect(name, mesh.clone(), &reference, expected);
    }
}

/// Every four triangles, a tetrahedron, turned outwards.
fn oriented(mesh: &TriangleMesh) -> TriangleMesh {
    let mut out = mesh.clone();
    for (index, tetrahedron) in out.triangles.chunks_mut(4).enumerate() {
        let volume: f64 = (0..4)
            .map(|i| {
                let [a, b, c] = mesh.corners(4 * index + i);
                a.dot(b.cross(c))
            })
            .sum();
        if volume < 0.0 {
            tetrahedron.iter_mut().for_each(|t| t.swap(1, 2));
        }
    }
    out
}

#[test]
fn defects_that_can_be_mended_are() {
    let mut flipped = ring();
    flipped.triangles.iter_mut().step_by(3).for_each(|t| t.swap(0, 1));
    let mut soup = TriangleMesh::default();
    for triangle in 0..cube().triangles.len() {
        let base = soup.vertices.len() as u32;
        soup.vertices.extend(cube().corners(triangle));
        soup.triangles.push([base, base + 1, base + 2]);
    }
    let mut repeated = cube();
    repeated.triangles.extend_from_within(..);
    let mut two_sided = cube();
    two_sided.triangles.extend(inverted(&cube()).triangles);
    let mut degenerate = cube();
    degenerate.triangles.extend([[0, 0, 1], [3, 3, 3]]);
    degenerate.vertices.push(DVec3::splat(77.0));
    for (name, mesh, reference) in [
        ("inside out", inverted(&ring()), ring()),
        ("faces turned", flipped, ring()),
        ("no two faces have a vertex in common", soup, cube()),
        ("every face twice", repeated, cube()),
        ("every face from both sides", two_sided, cube()),
        ("degenerate faces and an unused vertex", degenerate, cube()),
    ] {
        expect(name, mesh, &reference, Packing);
    }
    // Four cubes in a square, with all the walls between them.
    let four = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|[x, y]| {
        let lower = DVec3::new(x, y, 0.0);
        cuboid(lower, lower + 1.0)
    });
    let four = four.into_iter().reduce(|a, b| join(&a, &b)).unwrap();
    expect("cubes with walls between them", four.clone(), &four, Packing);
    // One after another they are four parts that touch; with faces in another order the walls tell that they are.
    let mut mixed = four.clone();
    mixed.triangles.sort_by_key(|t| t[0] % 8);
    for (mesh, counts) in [(four, (0, 4)), (mixed, (16, 1))] {
        let solid = Solid::new(&mesh).unwrap();
        assert_eq!((solid.diagnosis().paired_faces, solid.diagnosis().shells), counts);
        assert!((solid.properties().volume - 4.0).abs() < 1e-12);
        assert!((solid.depth(DVec3::new(1.0, 1.0, 0.5)) - 0.5).abs() < 1e-12);
    }
    // A cavity, and a solid in it: which way they face in the file does not matter.
    let shell = |half: f64| cuboid(DVec3::splat(-half), DVec3::splat(half));
    let outer = join(&shell(1.0), &inverted(&shell(0.7)));
    expect("a cavity", join(&shell(1.0), &shell(0.7)), &outer, Packing);
    let nested = join(&outer, &join(&shell(0.4), &inverted(&shell(0.1))));
    let as_they_come = [1.0, 0.7, 0.4, 0.1].map(shell).into_iter().reduce(|a, b| join(&a, &b)).unwrap();
    expect("four shells", as_they_come, &nested, Packing);
}
