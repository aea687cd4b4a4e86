//! What can be wrong with a mesh.

use glam::DVec3;
use std::path::PathBuf;

/// Why a file or a list of triangles is not a solid.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The file could not be read.
    #[error("cannot read {}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// The path leads to a folder or a device.
    #[error("{} is no regular file; name a mesh file", path.display())]
    NotAFile {
        /// The path.
        path: PathBuf,
    },
    /// The file has no bytes.
    #[error("{} is empty; export the mesh again", path.display())]
    EmptyFile {
        /// The file.
        path: PathBuf,
    },
    /// The file's extension names no format that is read here.
    #[error("{} is no mesh file known here: use .obj, .stl, .ply, .gltf or .glb", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The content is not what the extension announces.
    #[error("{} is not readable as {format}: {what}; check that the extension fits the content", path.display())]
    Parse {
        /// The file.
        path: PathBuf,
        /// Format that the extension announces.
        format: &'static str,
        /// What the parser met.
        what: String,
    },
    /// There is no face.
    #[error("the mesh has no triangles; export faces, not only points or lines")]
    NoTriangles,
    /// A coordinate is NaN or infinite.
    #[error("vertex {index} has a coordinate that is NaN or infinite: {position}; repair it in the file")]
    VertexNotFinite {
        /// Index of the first such vertex.
        index: usize,
        /// Its position.
        position: DVec3,
    },
    /// A triangle refers to a vertex that does not exist.
    #[error("triangle {triangle} refers to vertex {vertex}, but there are only {count} vertices")]
    IndexOutOfRange {
        /// Index of the first such triangle.
        triangle: usize,
        /// The index it holds.
        vertex: u32,
        /// Number of vertices.
        count: usize,
    },
    /// Fewer faces are left after cleaning than any closed surface has.
    #[error(
        "only {count} triangles are left once degenerate and duplicate faces are dropped; a closed surface has at least 4"
    )]
    TooFewTriangles {
        /// Faces left.
        count: usize,
    },
    /// Edges that belong to one face only: the surface has holes.
    #[error(
        "the mesh is not closed: {count} open edges, the first from {} to {}; fill the holes before packing", first[0], first[1]
    )]
    OpenEdges {
        /// Number of edges with one face.
        count: usize,
        /// End points of the first one (m).
        first: [DVec3; 2],
    },
    /// Edges where more than two faces meet that do not bound wedges of material, in a mesh whose parts do not follow each
    /// other: inside and outside are not defined there.
    #[error(
        "{count} edges have more than two faces, the first from {} to {} with {faces}; write the parts that touch there one after another, or separate them", first[0], first[1]
    )]
    NonManifoldEdges {
        /// Number of such edges.
        count: usize,
        /// End points of the first one (m).
        first: [DVec3; 2],
        /// Faces at the first one.
        faces: usize,
    },
    /// A one-sided surface, such as a Klein bottle.
    #[error(
        "the surface is one-sided: triangle {triangle} cannot be oriented like its neighbours; there is no inside"
    )]
    NotOrientable {
        /// A triangle whose neighbours ask for both orientations.
        triangle: usize,
    },
    /// The size is none that single precision can hold the volumes of.
    #[error(
        "the mesh measures {size:e} m; scale it to between 1e-9 and 1e12 m, as single precision cannot hold the volumes of its spheres"
    )]
    SizeOutOfRange {
        /// Diagonal of the bounding box (m).
        size: f64,
    },
    /// No ball that single precision can tell from a point fits into the bounding box.
    #[error(
        "the mesh is {extent:e} m thin, but single precision resolves no ball smaller than {smallest:e} m in radius at its place; move it towards the origin or make it thicker"
    )]
    BelowResolution {
        /// Shortest edge of the bounding box (m).
        extent: f64,
        /// Smallest radius that can be told from a point there (m).
        smallest: f64,
    },
    /// The surface cuts itself too often.
    #[error(
        "the surface cuts itself in {count} places or more; it is a tangle: remesh it, for instance from voxels"
    )]
    TooManyIntersections {
        /// Pairs of triangles found until the search was given up.
        count: usize,
    },
    /// The surface encloses nothing.
    #[error("the mesh encloses no volume ({volume:e} m³ in a box of {size:e} m); give it thickness")]
    ZeroVolume {
        /// Enclosed volume (m³).
        volume: f64,
        /// Diagonal of the bounding box (m).
        size: f64,
    },
}
