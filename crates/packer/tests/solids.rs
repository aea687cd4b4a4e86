//! What is a solid, what is not, and what is known about one.

mod common;

use common::{cuboid, inverted, join, torus};
use glam::DVec3;
use packer::{MeshError, Solid, TriangleMesh};
use std::f64::consts::PI;

#[test]
fn mass_properties_of_a_box_are_exact_wherever_it_stands() {
    for offset in [DVec3::ZERO, DVec3::new(1e5, -2e5, 1e5)] {
        let extent = DVec3::new(1.0, 2.0, 3.0);
        let solid = Solid::new(&cuboid(offset, offset + extent)).unwrap();
        let p = solid.properties();
        assert!((p.volume - 6.0).abs() < 1e-12);
        assert!(p.centroid.distance(offset + 0.5 * extent) < 1e-9);
        let inertia = p.unit_inertia;
        // m/12·(b² + c²)
        assert!((inertia.x_axis.x - 0.5 * 13.0).abs() < 1e-8 && (inertia.z_axis.z - 0.5 * 5.0).abs() < 1e-8);
        assert!(inertia.x_axis.y.abs() < 1e-8);
    }
}

#[test]
fn depth_of_a_box_matches_the_formula() {
    let solid = Solid::new(&cuboid(DVec3::ZERO, DVec3::ONE)).unwrap();
    for i in 0..4_000_u32 {
        let fraction = |factor: f64| (f64::from(i) * factor).fract() * 2.0 - 0.5;
        let p = DVec3::new(fraction(0.618_034), fraction(0.754_878), fraction(0.569_84));
        let outside = (p - p.clamp(DVec3::ZERO, DVec3::ONE)).length();
        let inside = p.min(1.0 - p).min_element();
        let expected = if outside > 0.0 { -outside } else { inside };
        assert!((solid.depth(p) - expected).abs() < 1e-12, "{p}");
    }
}

#[test]
fn the_depth_is_lipschitz_on_every_asset() {
    // A sign that is wrong somewhere shows as a jump.
    for name in ["bunny.obj", "spider_gear.obj", "pelvis.obj"] {
        let solid = Solid::new(&TriangleMesh::load(common::asset(name)).unwrap()).unwrap();
        let (lower, upper) = solid.bounds();
        let step = 1e-5 * solid.size();
        for i in 0..60_000_u32 {
            let fraction = |factor: f64| (f64::from(i) * factor).fract();
            let p = lower
                + (upper - lower) * DVec3::new(fraction(0.618_034), fraction(0.754_878), fraction(0.569_84));
            let change = (solid.depth(p) - solid.depth(p + DVec3::X * step)).abs();
            assert!(change <= step * 1.001, "{name}: the depth jumps by {change} at {p}");
        }
    }
}

/// Where the squares of coordinates overflow, a Voronoi vertex counted as a place for a ball of 1e154 m.
#[test]
fn issue_what_is_far_away_is_outside() {
    let solid = Solid::new(&cuboid(DVec3::ZERO, DVec3::ONE)).unwrap();
    for exponent in 1..=307 {
        let far = 1.8 * 10.0_f64.powi(exponent);
        for toward in [DVec3::X, DVec3::NEG_Y, DVec3::new(1.0, 0.7, 0.3), DVec3::new(-0.2, 0.5, -1.0)] {
            let p = DVec3::new(0.5, -2.5, -0.1) + far * toward;
            assert!(!solid.contains(p), "{p}");
            assert!(!solid.closest_point(p).depth.is_nan(), "{p}");
        }
    }
}

/// Folded slivers gave a pseudonormal of the wrong side at corners: a sphere stood outside the gear.
#[test]
fn issue_folded_slivers_do_not_turn_the_outside_in() {
    let solid = Solid::new(&TriangleMesh::load(common::asset("spider_gear.obj")).unwrap()).unwrap();
    for p in [
        DVec3::new(0.343_749_999_999_993_34, -0.322_916_666_666_666_7, -0.180_939_166_666_666_65),
        DVec3::new(-0.434_296_607_971_191_4, 0.201_181_411_743_164_06, -0.175_810_445_022_583),
    ] {
        assert!(!solid.contains(p), "{p}");
    }
}

#[test]
fn inverted_surfaces_are_turned_and_cavities_kept() {
    let outer = cuboid(DVec3::ZERO, DVec3::ONE);
    let inner = cuboid(DVec3::splat(0.25), DVec3::splat(0.75));
    for (a, b) in [(&outer, &inner), (&inverted(&outer), &inner), (&outer, &inverted(&inner))] {
        let solid = Solid::new(&join(a, b)).unwrap();
        assert_eq!((solid.diagnosis().shells, solid.diagnosis().cavities), (2, 1));
        assert!((solid.properties().volume - 0.875).abs() < 1e-12);
        assert!(solid.contains(DVec3::splat(0.1)) && !solid.contains(DVec3::splat(0.5)));
    }
    let torus = torus(2.0, 0.5, 64);
    let solid = Solid::new(&inverted(&torus)).unwrap();
    assert_eq!(solid.diagnosis().reversed_shells, 1);
    let exact = 2.0 * PI * PI * 2.0 * 0.25;
    assert!((solid.properties().volume / exact - 1.0).abs() < 0.02);
}

#[test]
fn single_faces_that_are_turned_are_mended() {
    let mut mesh = torus(2.0, 0.5, 32);
    for triangle in mesh.triangles.iter_mut().step_by(3).skip(1) {
        triangle.swap(0, 1);
    }
    let solid = Solid::new(&mesh).unwrap();
    assert!(solid.diagnosis().turned_faces > 100);
    assert!(solid.contains(DVec3::new(2.0, 0.0, 0.0)) && !solid.contains(DVec3::ZERO));
}

#[test]
fn unwelded_and_repeated_faces_are_cleaned() {
    let clean = cuboid(DVec3::ZERO, DVec3::ONE);
    let mut soup = TriangleMesh::default();
    for i in (0..clean.triangles.len()).chain([0, 5]) {
        let base = soup.vertices.len() as u32;
        soup.vertices.extend(clean.corners(i));
        soup.triangles.push([base, base + 1, base + 2]);
    }
    soup.triangles.push([0, 0, 1]);
    let solid = Solid::new(&soup).unwrap();
    let d = solid.diagnosis();
    assert_eq!((d.vertices, d.triangles, d.duplicate_faces, d.degenerate_faces), (8, 12, 2, 1));
}

#[test]
fn two_boxes_that_touch_in_a_corner_are_a_solid() {
    let two = join(&cuboid(DVec3::ZERO, DVec3::ONE), &cuboid(DVec3::ONE, DVec3::splat(2.0)));
    let solid = Solid::new(&two).unwrap();
    assert!(solid.contains(DVec3::splat(0.9)) && solid.contains(DVec3::splat(1.1)));
    assert!(!solid.contains(DVec3::new(0.9, 0.9, 1.1)));
}

#[test]
fn what_has_no_inside_is_refused_by_name() {
    let cube = cuboid(DVec3::ZERO, DVec3::ONE);
    let error = |mesh: &TriangleMesh| Solid::new(mesh).unwrap_err();

    let mut open = cube.clone();
    open.triangles.pop();
    assert!(matches!(error(&open), MeshError::OpenEdges { count: 3, .. }));

    let mut fin = cube.clone();
    fin.vertices.push(DVec3::splat(2.0));
    fin.triangles.push([0, 1, 8]);
    assert!(matches!(error(&fin), MeshError::NonManifoldEdges { count: 1, faces: 3, .. }));

    let mut broken = cube.clone();
    broken.vertices[5].y = f64::NAN;
    assert!(matches!(error(&broken), MeshError::VertexNotFinite { index: 5, .. }));

    let mut dangling = cube.clone();
    dangling.triangles[3][1] = 99;
    assert!(matches!(error(&dangling), MeshError::IndexOutOfRange { triangle: 3, vertex: 99, count: 8 }));

    let flat = cuboid(DVec3::ZERO, DVec3::new(1.0, 1.0, 1e-30));
    assert!(matches!(error(&flat), MeshError::BelowResolution { .. }));

    let two_faces =
        TriangleMesh { vertices: cube.vertices[..3].to_vec(), triangles: vec![[0, 1, 2], [0, 2, 1]] };
    assert!(matches!(error(&two_faces), MeshError::TooFewTriangles { count: 1 }));
    assert!(matches!(error(&TriangleMesh::default()), MeshError::NoTriangles));
}

/// A shell whose first face lies inside another one was taken for a cavity, even if the two only overlap.
#[test]
fn issue_overlapping_cubes_are_one_solid_and_no_cavity() {
    // Corner in corner, at a generic and at a symmetric place, and a bar through a block.
    let cube = cuboid(DVec3::ZERO, DVec3::ONE);
    let bar = |offset: DVec3| cuboid(DVec3::new(-1.0, 0.2, 0.3) + offset, DVec3::new(2.0, 0.7, 0.6) + offset);
    for (other, volume) in [
        (cuboid(DVec3::new(0.6, 0.45, 0.55), DVec3::new(1.6, 1.45, 1.55)), 2.0 - 0.4 * 0.55 * 0.45),
        (cuboid(DVec3::splat(0.5), DVec3::splat(1.5)), 1.875),
        (cuboid(DVec3::splat(-0.5), DVec3::splat(0.5)), 1.875),
        (bar(DVec3::ZERO), 1.0 + 2.0 * 0.15),
    ] {
        for mesh in [join(&cube, &other), join(&other, &cube), join(&inverted(&other), &cube)] {
            let solid = Solid::new(&mesh).unwrap();
            assert_eq!((solid.diagnosis().shells, solid.diagnosis().cavities), (2, 0));
            let p = solid.properties();
            assert!((p.volume - volume).abs() < 1e-12, "{} is not {volume}", p.volume);
            let (a, b) = (DVec3::splat(0.5), 0.5 * (other.bounds().0 + other.bounds().1));
            assert!(solid.contains(a), "{a}: {:?}", solid.closest_point(a));
            assert!(solid.contains(b), "{b}: {:?}", solid.closest_point(b));
        }
    }
}

/// Its faces cover each other, nothing is left of them, and a hierarchy over nothing was built.
#[test]
fn issue_a_flat_tetrahedron_has_no_volume() {
    let vertices = [[0.0, 0.0, 0.0], [3.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.1, 0.1, 0.0]];
    let triangles = vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
    let mesh = TriangleMesh { vertices: vertices.map(DVec3::from_array).to_vec(), triangles };
    assert!(matches!(Solid::new(&mesh), Err(MeshError::ZeroVolume { .. })));
}

/// Two parts with a common edge, of which one cuts itself. Shells are turned to agree within, and then the faces at the edge
/// no longer told where material is: what was mended was refused when it was read again.
#[test]
fn issue_faces_at_a_common_edge_still_tell_where_material_is_when_they_are_turned() {
    let vertices = [
        [0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 1.0, 1.0],
        [0.0, 1.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 1.0],
        [1.0, 6.0, 2.0],
        [0.5, 0.25, 0.125],
        [0.5, 1.25, 0.125],
        [0.5, 1.25, 2.125],
        [0.5, 0.25, 1.125],
    ];
    let one = [[0, 1, 2], [0, 2, 3], [4, 3, 2], [4, 2, 1], [0, 4, 1], [0, 3, 4]];
    let other = [
        [4, 2, 5],
        [4, 5, 6],
        [7, 8, 9],
        [7, 9, 10],
        [4, 7, 10],
        [4, 10, 2],
        [6, 5, 9],
        [6, 9, 8],
        [4, 6, 8],
        [4, 8, 7],
        [2, 10, 9],
        [2, 9, 5],
    ];
    let triangles = one.into_iter().chain(other).collect();
    let mesh = TriangleMesh { vertices: vertices.map(DVec3::from_array).to_vec(), triangles };
    // Their order in the file tells them apart.
    let part = |triangles: &[[u32; 3]]| {
        Solid::new(&TriangleMesh { triangles: triangles.to_vec(), ..mesh.clone() }).unwrap()
    };
    let (parts, solid) = ([part(&one), part(&other)], Solid::new(&mesh).unwrap());
    let again = Solid::new(solid.mesh()).unwrap();
    assert!((again.properties().volume - solid.properties().volume).abs() < 1e-12);
    assert_eq!((again.diagnosis().turned_faces, again.diagnosis().reversed_shells), (0, 0));
    let (lower, upper) = mesh.bounds();
    for i in 0..2_000_u32 {
        let share = (f64::from(i) * DVec3::new(0.819_172_5, 0.671_043_6, 0.549_700_5)).fract();
        let p = lower + share * (upper - lower);
        assert_eq!(solid.contains(p), parts.iter().any(|part| part.contains(p)), "{p}");
    }
}

#[test]
fn parts_that_touch_along_an_edge_are_a_solid() {
    // Two cubes with a common edge; two with a common wall, cut along the one and the other diagonal.
    let block = |x: f64, y: f64| cuboid(DVec3::new(x, y, 0.0), DVec3::new(x + 1.0, y + 1.0, 1.0));
    let two = join(&block(0.0, 0.0), &block(1.0, 1.0));
    let mut other_diagonals = block(1.0, 0.0);
    for pair in other_diagonals.triangles.chunks_mut(2) {
        let ([a, b, c], d) = (pair[0], pair[1][2]);
        (pair[0], pair[1]) = ([a, b, d], [b, c, d]);
    }
    let wall = join(&block(0.0, 0.0), &other_diagonals);
    for (mesh, edges) in [(&two, 1), (&inverted(&two), 1), (&wall, 4)] {
        let solid = Solid::new(mesh).unwrap();
        assert_eq!((solid.diagnosis().shared_edges.count, solid.diagnosis().cavities), (edges, 0));
        assert!((solid.properties().volume - 2.0).abs() < 1e-12);
        for p in [DVec3::new(0.9, 0.9, 0.5), DVec3::new(0.999_9, 0.999_8, 0.5), DVec3::splat(0.2)] {
            assert!(solid.contains(p), "{p}");
        }
        assert!(
            !solid.contains(DVec3::new(0.9, 1.1, 0.5)) && !solid.contains(DVec3::new(0.999_9, 1.000_2, 0.5))
        );
    }
    let solid = Solid::new(&two).unwrap();
    assert!(solid.contains(DVec3::new(1.1, 1.1, 0.5)) && !solid.contains(DVec3::new(1.1, 0.9, 0.5)));
    // The wall does not count: the two blocks are one of 2 by 1 by 1.
    let solid = Solid::new(&wall).unwrap();
    assert!((solid.depth(DVec3::new(1.0, 0.5, 0.5)) - 0.5).abs() < 1e-12);
    assert!(solid.contains(DVec3::new(1.2, 0.5, 0.5)) && !solid.contains(DVec3::new(1.2, 1.1, 0.5)));
    // With faces turned at random the order in the file tells, and where the parts' faces are mixed nobody can.
    let mut turned = two;
    turned.triangles.iter_mut().step_by(2).for_each(|t| t.swap(0, 1));
    let solid = Solid::new(&turned).unwrap();
    assert_eq!((solid.diagnosis().shells, solid.diagnosis().cavities), (2, 0));
    assert!((solid.properties().volume - 2.0).abs() < 1e-12);
    turned.triangles.swap(0, 12);
    assert!(matches!(Solid::new(&turned), Err(MeshError::NonManifoldEdges { faces: 4, .. })));
}
