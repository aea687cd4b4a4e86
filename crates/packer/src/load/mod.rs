//! Mesh files: Wavefront OBJ, STL, PLY and glTF, each read by the crate that is kept for it.
//!
//! A loader's only task is to collect triangles; what they enclose is the business of [`crate::Solid`].

mod accessor;
mod gltf;
mod obj;
mod ply;
mod polygon;
mod stl;

use crate::{MeshError, TriangleMesh};
use std::path::Path;

/// What a format's reader met, in words; the path and the format are added by [`TriangleMesh::load`].
type Parsed = Result<TriangleMesh, String>;

impl TriangleMesh {
    /// Reads a mesh file; the extension decides on the format: `.obj`, `.stl` (binary or ASCII), `.ply`
    /// (either), `.gltf` or `.glb`. Polygons become triangles; all objects of a file become one mesh. Of glTF that is
    /// the default scene, each mesh as often as nodes place it; meshes compressed by an extension are not read.
    ///
    /// # Errors
    /// [`MeshError`] tells whether the file is missing, empty, of another kind, without faces, has a
    /// coordinate that is not finite, or a face at a vertex that does not exist.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, MeshError> {
        let mesh = Self::load_unchecked(path)?;
        mesh.validate()?;
        Ok(mesh)
    }

    /// As [`Self::load`], but also returns meshes without faces, with coordinates that are not finite, or with
    /// faces at vertices that do not exist: [`crate::diagnose`] tells how many and where.
    ///
    /// # Errors
    /// [`MeshError`] where the file cannot be read as what its extension announces.
    pub fn load_unchecked(path: impl AsRef<Path>) -> Result<Self, MeshError> {
        let path = path.as_ref();
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        let format = match extension.as_str() {
            "obj" => "OBJ",
            "stl" => "STL",
            "ply" => "PLY",
            "gltf" => "glTF",
            "glb" => "GLB",
            // A missing file is the better news than its extension.
            _ if !path.exists() => "",
            _ => return Err(MeshError::UnknownFormat { path: path.into() }),
        };
        let io_error = |source| MeshError::Io { path: path.into(), source };
        if !std::fs::metadata(path).map_err(io_error)?.is_file() {
            return Err(MeshError::NotAFile { path: path.into() });
        }
        let bytes = std::fs::read(path).map_err(io_error)?;
        if bytes.is_empty() {
            return Err(MeshError::EmptyFile { path: path.into() });
        }
        // Some editors mark text as UTF-8 in front of its first word. A binary STL file may begin with anything.
        let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&bytes);
        let parse = || match format {
            "OBJ" => obj::parse(text),
            "STL" => stl::parse(&bytes),
            "PLY" => ply::parse(text),
            _ => gltf::parse(text, path.parent().unwrap_or(Path::new(""))),
        };
        // A file at which a reader panics is damaged, not the program. None is known.
        let parsed = std::panic::catch_unwind(parse).unwrap_or_else(|_| Err("its reader gave up".to_owned()));
        parsed.map_err(|what| MeshError::Parse { path: path.into(), format, what })
    }
}
