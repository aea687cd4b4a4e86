//! What is wrong with a mesh, in words, with what to do about it.

use glam::DVec3;
use packer::{Diagnosis, Findings};
use serde_json::{Value, json};
use std::fmt;

/// One kind of defect.
pub(super) struct Finding {
    /// Name for programs.
    pub(super) kind: &'static str,
    pub(super) severity: Severity,
    pub(super) count: usize,
    /// What there is `count` times.
    pub(super) what: &'static str,
    pub(super) places: Vec<Place>,
    pub(super) remedy: Option<&'static str>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Severity {
    /// Keeps the mesh from being packed.
    Error,
    /// The mesh can be packed, but may not be what was meant.
    Warning,
    /// Repaired.
    Mended,
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Error => "error",
            Self::Warning => "warning",
            Self::Mended => "mended",
        })
    }
}

/// Where a defect is.
pub(super) enum Place {
    Vertex(usize),
    Triangle(usize),
    /// (m)
    Point(DVec3),
    /// Ends (m).
    Edge([DVec3; 2]),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Vertex(index) => write!(f, "vertex {index}"),
            Self::Triangle(index) => write!(f, "triangle {index}"),
            Self::Point(p) => write!(f, "{p}"),
            Self::Edge([from, to]) => write!(f, "edge from {from} to {to}"),
        }
    }
}

impl Place {
    pub(super) fn to_json(&self) -> Value {
        match self {
            Self::Vertex(index) => json!({ "vertex": index }),
            Self::Triangle(index) => json!({ "triangle": index }),
            Self::Point(p) => json!({ "point": p.to_array() }),
            Self::Edge(ends) => json!({ "edge": ends.map(|end| end.to_array()) }),
        }
    }
}

/// All findings, errors first.
pub(super) fn of(d: &Diagnosis) -> Vec<Finding> {
    let mut all = errors(d);
    all.extend(warnings(d));
    all.extend(mended(d));
    all.retain(|finding| finding.count > 0);
    all
}

fn places<T>(findings: &Findings<T>, place: impl Fn(&T) -> Place) -> Vec<Place> {
    findings.some.iter().map(place).collect()
}

fn errors(d: &Diagnosis) -> Vec<Finding> {
    let error = |kind, count, what, places, remedy| Finding {
        kind,
        severity: Severity::Error,
        count,
        what,
        places,
        remedy: Some(remedy),
    };
    let is_too_thin = matches!(d.refusal(), Some(packer::MeshError::BelowResolution { .. }));
    let is_tangle = matches!(d.refusal(), Some(packer::MeshError::TooManyIntersections { .. }));
    let is_empty = matches!(d.refusal(), Some(packer::MeshError::ZeroVolume { .. }));
    let is_out_of_range = matches!(d.refusal(), Some(packer::MeshError::SizeOutOfRange { .. }));
    vec![
        error(
            "no_triangles",
            usize::from(d.input_triangles == 0),
            "mesh without triangles",
            vec![],
            "export faces, not only points or lines",
        ),
        error(
            "not_finite",
            d.not_finite.count,
            "vertices with a coordinate that is NaN or infinite",
            places(&d.not_finite, |v| Place::Vertex(v.0)),
            "repair them in the file; their faces are left out of what follows",
        ),
        error(
            "dangling",
            d.dangling.count,
            "triangles that refer to vertices that do not exist",
            places(&d.dangling, |t| Place::Triangle(t.0)),
            "the file is damaged or cut off; export it again",
        ),
        error(
            "open_edges",
            d.open_edges.count,
            "open edges: the surface has holes",
            places(&d.open_edges, |e| Place::Edge(*e)),
            "fill the holes; where vertices should be the same and are not quite, merge them by distance; where an edge has a vertex in its middle, split it there",
        ),
        error(
            "non_manifold_edges",
            d.non_manifold_edges.count,
            "edges with more than two faces",
            places(&d.non_manifold_edges, |e| Place::Edge(e.0)),
            "delete faces inside the solid, write one part after another, or separate the parts that touch there by a small gap",
        ),
        error(
            "one_sided",
            d.one_sided.count,
            "shells without an inner side, like a Klein bottle",
            places(&d.one_sided, |t| Place::Triangle(*t)),
            "model the wall with a thickness",
        ),
        error(
            "size_out_of_range",
            usize::from(is_out_of_range),
            "size that single precision has no volumes for",
            vec![],
            "scale the mesh to between 1e-9 and 1e12 m",
        ),
        error(
            "below_resolution",
            usize::from(is_too_thin),
            "mesh thinner than what single precision resolves at its place",
            vec![],
            "move the mesh towards the origin, or make it thicker",
        ),
        error(
            "tangle",
            usize::from(is_tangle),
            "surface that cuts itself everywhere",
            vec![],
            "remesh it, for instance from voxels",
        ),
        error(
            "zero_volume",
            usize::from(is_empty),
            "surface that encloses no volume",
            vec![],
            "give it a thickness",
        ),
    ]
}

/// Share of the size of a mesh above which its resolution is worth a word: the smallest ball among 5,000 in a femur has a radius
/// of 2.2e-3 of its size.
const COARSE: f64 = 2e-3;

fn warnings(d: &Diagnosis) -> Vec<Finding> {
    let warning = |kind, count, what, places, remedy| Finding {
        kind,
        severity: Severity::Warning,
        count,
        what,
        places,
        remedy: Some(remedy),
    };
    let point = |p: &DVec3| Place::Point(*p);
    vec![
        warning(
            "self_intersections",
            d.self_intersections.count,
            "pairs of triangles that pass through each other",
            places(&d.self_intersections, point),
            "all that the surface winds around is inside, and counts once; if that is not meant, unite the parts in a modeller",
        ),
        warning(
            "covering_faces",
            d.covering_faces.count,
            "pairs of triangles that cover each other in one plane",
            places(&d.covering_faces, point),
            "parts that touch face to face become one; if that is not meant, move them apart",
        ),
        warning(
            "overlapping_shells",
            d.overlapping_shells,
            "pairs of shells that cut each other",
            vec![],
            "their union is packed; the volume that they share counts once",
        ),
        warning(
            "shared_edges",
            d.shared_edges.count,
            "edges along which parts touch",
            places(&d.shared_edges, |e| Place::Edge(*e)),
            "they have more than two faces; which belong together is told by their orientation",
        ),
        warning(
            "far_from_the_origin",
            usize::from(d.resolution > COARSE * d.size()),
            "mesh so far from the origin that single precision resolves no small balls there",
            vec![],
            "move the mesh towards the origin, or expect fewer balls and gaps",
        ),
        warning(
            "folds",
            d.folds.count,
            "edges folded by more than 154°",
            places(&d.folds, point),
            "these are knife edges, or slivers turned over by rounding; inside and outside are told apart by rays there",
        ),
        warning(
            "flat_faces",
            d.flat_faces.count,
            "triangles without area",
            places(&d.flat_faces, point),
            "they are kept, as the surface would have gaps without them",
        ),
        warning(
            "uncut_faces",
            d.uncut_faces,
            "triangles cut by too many others",
            vec![],
            "balls do not cross them, and their share of the volume is sampled; unite the parts in a modeller",
        ),
    ]
}

fn mended(d: &Diagnosis) -> Vec<Finding> {
    let mended = |kind, count, what| Finding {
        kind,
        severity: Severity::Mended,
        count,
        what,
        places: Vec::new(),
        remedy: None,
    };
    vec![
        mended("unused_vertices", d.unused_vertices, "vertices without faces left out"),
        mended("merged_vertices", d.merged_vertices, "coincident vertices merged"),
        mended("degenerate_faces", d.degenerate_faces, "degenerate faces dropped"),
        mended("duplicate_faces", d.duplicate_faces, "duplicate faces dropped"),
        mended("paired_faces", d.paired_faces, "faces of walls between parts that touch dropped"),
        mended("turned_faces", d.turned_faces, "faces turned to agree with their neighbours"),
        mended("reversed_shells", d.reversed_shells, "shells turned inside out"),
        mended("hidden_faces", d.hidden_faces, "faces inside the union left out"),
        mended("cut_faces", d.cut_faces, "faces cut where others pass through them"),
    ]
}
