//! Wavefront OBJ.

use super::Parsed;
use crate::TriangleMesh;
use glam::DVec3;

pub(super) fn parse(bytes: &[u8]) -> Parsed {
    let options = tobj::LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..tobj::LoadOptions::default()
    };
    // Materials say nothing about the shape: their files are not opened.
    let no_materials = |_: &std::path::Path| Ok(Default::default());
    let (models, _) =
        tobj::load_obj_buf(&mut &*bytes, &options, no_materials).map_err(|error| error.to_string())?;
    let mut mesh = TriangleMesh::default();
    for model in models {
        let base = mesh.vertices.len() as u32;
        mesh.vertices.extend(model.mesh.positions.chunks_exact(3).map(DVec3::from_slice));
        let faces = model.mesh.indices.chunks_exact(3);
        mesh.triangles.extend(faces.map(|face| [base + face[0], base + face[1], base + face[2]]));
    }
    Ok(mesh)
}
