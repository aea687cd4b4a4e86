//! What every generated solid must satisfy.

use packer::TriangleMesh;
use std::collections::HashMap;

/// What is known about a solid beforehand.
pub(super) struct Expected {
    /// Closed-form volume (m³).
    pub(super) volume: f64,
    /// Allowed relative error of the volume: the faceting error.
    pub(super) tolerance: f64,
    /// Euler characteristic V − E + F: 2 for a ball, 0 for a torus.
    pub(super) euler: i64,
}

/// Asserts that `mesh` is one closed, outward-oriented manifold with the expected volume and topology.
pub(super) fn assert_solid(mesh: &TriangleMesh, expected: &Expected) {
    assert!(mesh.vertices.iter().all(|v| v.is_finite()));
    let mut edges: HashMap<(u32, u32), u32> = HashMap::new();
    let mut used = vec![false; mesh.vertices.len()];
    for &[a, b, c] in &mesh.triangles {
        assert!(a != b && b != c && c != a, "degenerate triangle");
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *edges.entry((from, to)).or_default() += 1;
            used[from as usize] = true;
        }
    }
    for (&(from, to), &count) in &edges {
        assert_eq!(count, 1, "edge {from}–{to} runs {count} times in one direction");
        assert!(edges.contains_key(&(to, from)), "edge {from}–{to} is open");
    }
    assert!(used.iter().all(|&u| u), "unused vertex");
    let euler = mesh.vertices.len() as i64 - edges.len() as i64 / 2 + mesh.triangles.len() as i64;
    assert_eq!(euler, expected.euler, "Euler characteristic");
    let volume = volume(mesh);
    let error = volume / expected.volume - 1.0;
    assert!(error.abs() <= expected.tolerance, "volume {volume} instead of {}", expected.volume);
    assert_distinct_vertices(mesh);
}

/// Enclosed volume (m³) by the divergence theorem; positive where triangles face outwards.
fn volume(mesh: &TriangleMesh) -> f64 {
    mesh.triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|i| mesh.vertices[i as usize]);
            a.dot(b.cross(c)) / 6.0
        })
        .sum()
}

/// Two vertices at one place would be a seam that only looks closed.
fn assert_distinct_vertices(mesh: &TriangleMesh) {
    let keys: std::collections::HashSet<[i64; 3]> =
        mesh.vertices.iter().map(|v| v.to_array().map(|x| (x * 1e9).round() as i64)).collect();
    assert_eq!(keys.len(), mesh.vertices.len(), "coincident vertices");
}
