//! What is known about a mesh, packable or not.

use crate::MeshError;
use glam::DVec3;

/// What was found in a mesh, and what was mended.
///
/// Made by [`crate::diagnose`] for any mesh, and by [`crate::Solid::new`] for those that are solids. Findings of later
/// steps are those of the mesh without what earlier ones left out: faces at vertices that are not finite or do not
/// exist, faces of two or fewer different corners, repeated faces.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Diagnosis {
    /// Vertices as they came.
    pub input_vertices: usize,
    /// Triangles as they came.
    pub input_triangles: usize,
    /// Vertices with a coordinate that is NaN or infinite: index and position.
    pub not_finite: Findings<(usize, DVec3)>,
    /// Triangles that refer to vertices that do not exist: index of the triangle, and the index it holds.
    pub dangling: Findings<(usize, u32)>,
    /// Vertices after welding.
    pub vertices: usize,
    /// Triangles after cleaning.
    pub triangles: usize,
    /// Vertices that no face uses.
    pub unused_vertices: usize,
    /// Vertices that coincided with another one and were merged.
    pub merged_vertices: usize,
    /// Faces dropped because two corners were the same point.
    pub degenerate_faces: usize,
    /// Faces dropped because they occurred twice.
    pub duplicate_faces: usize,
    /// Faces dropped in pairs of the same three corners: walls between parts that touch.
    pub paired_faces: usize,
    /// Faces of three different corners on a line, or so near to one that they have no normal: lower than 1e-10 of
    /// their longest side. They are kept, as dropping them would open the surface. Their centroids (m).
    pub flat_faces: Findings<DVec3>,
    /// Edges of one face: the borders of holes. Their ends (m).
    pub open_edges: Findings<[DVec3; 2]>,
    /// Loops that the open edges make; those that touch count as one.
    pub holes: usize,
    /// Edges along which parts of the solid touch: they have four faces or more, whose orientations tell which two
    /// belong together. Their ends (m).
    pub shared_edges: Findings<[DVec3; 2]>,
    /// Other edges of more than two faces: their ends (m), and the number of faces.
    pub non_manifold_edges: Findings<([DVec3; 2], usize)>,
    /// Shells that have no inner and outer side, such as a Klein bottle: a triangle of each.
    pub one_sided: Findings<usize>,
    /// Edges folded by more than 154°: their middles (m). Inside and outside are told apart by rays near them.
    pub folds: Findings<DVec3>,
    /// Pairs of triangles that pass through each other, neighbours excepted: a common point of each (m).
    pub self_intersections: Findings<DVec3>,
    /// Pairs of triangles that cover each other in part and lie in one plane: a common point of each (m).
    pub covering_faces: Findings<DVec3>,
    /// Faces turned to agree with their neighbours.
    pub turned_faces: usize,
    /// Connected parts of the surface.
    pub shells: usize,
    /// Shells that bound cavities; known for closed surfaces.
    pub cavities: usize,
    /// Shells whose normals pointed into the material and were reversed; known for closed surfaces.
    pub reversed_shells: usize,
    /// Pairs of shells that cut each other: overlapping solids, of which the union counts.
    pub overlapping_shells: usize,
    /// Triangles left out because they lie inside the union of what overlaps.
    pub hidden_faces: usize,
    /// Triangles of which a part was left out for the same reason.
    pub cut_faces: usize,
    /// Triangles that so many others cut that they were left whole: balls do not cross them, and their share of the
    /// volume is sampled at 64 points each.
    pub uncut_faces: usize,
    /// Volume that the shells enclose more than once (m³): their volumes, those of cavities subtracted, less
    /// [`Self::volume`]. Negative where a shell is partly inside out.
    pub overlap_volume: f64,
    /// Enclosed volume (m³); known for closed surfaces.
    pub volume: Option<f64>,
    /// Corners of the smallest axis-aligned box around the surface (m).
    pub bounds: Option<(DVec3, DVec3)>,
    /// Radius under which single precision cannot resolve a ball here (m): 16 units in the last place of the largest
    /// coordinate.
    pub resolution: f64,
}

/// Findings of which details are kept: enough to see whether they lie together.
const MOST_KEPT: usize = 16;

/// How many there are of something, and some of them.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Findings<T> {
    /// How many there are.
    pub count: usize,
    /// The first of them, at most 16.
    pub some: Vec<T>,
}

impl<T> Findings<T> {
    pub(super) fn push(&mut self, finding: T) {
        self.count += 1;
        if self.some.len() < MOST_KEPT {
            self.some.push(finding);
        }
    }
}

impl<T> Default for Findings<T> {
    fn default() -> Self {
        Self { count: 0, some: Vec::new() }
    }
}

impl<T> FromIterator<T> for Findings<T> {
    fn from_iter<I: IntoIterator<Item = T>>(iter: I) -> Self {
        let mut findings = Self::default();
        iter.into_iter().for_each(|finding| findings.push(finding));
        findings
    }
}

/// Sizes of meshes (m) that can be packed. Cells of a millionth of the volume, in the spheres' single precision, are far
/// above its smallest number at the lower end, and the volume is far under its largest one at the upper end.
pub(super) const SIZES: std::ops::RangeInclusive<f64> = 1e-9..=1e12;
/// Share of the cube of its size under which a surface encloses nothing. A sheet of paper, 1 m by 1 m and 0.1 mm
/// thick, has 1e-4.
const LEAST_VOLUME: f64 = 1e-12;

impl Diagnosis {
    /// Why the mesh cannot be packed, if so: the first reason of several.
    #[must_use]
    pub fn refusal(&self) -> Option<MeshError> {
        if self.input_triangles == 0 {
            return Some(MeshError::NoTriangles);
        }
        if let Some((index, position)) = self.not_finite.some.first() {
            return Some(MeshError::VertexNotFinite { index: *index, position: *position });
        }
        if let Some((triangle, vertex)) = self.dangling.some.first() {
            let count = self.input_vertices;
            return Some(MeshError::IndexOutOfRange { triangle: *triangle, vertex: *vertex, count });
        }
        if self.triangles < 4 {
            return Some(MeshError::TooFewTriangles { count: self.triangles });
        }
        if let Some((first, faces)) = self.non_manifold_edges.some.first() {
            let count = self.non_manifold_edges.count;
            return Some(MeshError::NonManifoldEdges { count, first: *first, faces: *faces });
        }
        if let Some(first) = self.open_edges.some.first() {
            return Some(MeshError::OpenEdges { count: self.open_edges.count, first: *first });
        }
        if let Some(triangle) = self.one_sided.some.first() {
            return Some(MeshError::NotOrientable { triangle: *triangle });
        }
        let size = self.size();
        if !SIZES.contains(&size) {
            return Some(MeshError::SizeOutOfRange { size });
        }
        if let Some((lower, upper)) = self.bounds {
            let (extent, smallest) = ((upper - lower).min_element(), self.resolution);
            // A box without extent has a surface without volume: that is the better news.
            if extent > 0.0 && extent < 2.0 * smallest {
                return Some(MeshError::BelowResolution { extent, smallest });
            }
        }
        let count = self.self_intersections.count + self.covering_faces.count;
        if count >= super::meetings::MOST {
            return Some(MeshError::TooManyIntersections { count });
        }
        // A volume that is not a number is not above either.
        let is_solid = |volume: &f64| *volume > LEAST_VOLUME * size.powi(3);
        let volume = self.volume.filter(|volume| !is_solid(volume))?;
        Some(MeshError::ZeroVolume { volume, size })
    }

    /// Diagonal of the bounding box (m); zero without faces.
    #[must_use]
    pub fn size(&self) -> f64 {
        self.bounds.map_or(0.0, |(lower, upper)| lower.distance(upper))
    }
}
