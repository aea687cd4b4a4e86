//! Wavefront OBJ.

use super::{Parsed, polygon};
use crate::TriangleMesh;
use glam::DVec3;

pub(super) fn parse(bytes: &[u8]) -> Parsed {
    let options =
        tobj::LoadOptions { ignore_points: true, ignore_lines: true, ..tobj::LoadOptions::default() };
    let no_materials = |_: &std::path::Path| Ok(Default::default());
    // Names and comments in other encodings than UTF-8 do no harm.
    let text = surface_only(&String::from_utf8_lossy(bytes));
    let (models, _) = tobj::load_obj_buf(&mut text.as_bytes(), &options, no_materials)
        .map_err(|error| error.to_string())?;
    let mut mesh = TriangleMesh::default();
    for model in models {
        let base = mesh.vertices.len() as u32;
        mesh.vertices.extend(model.mesh.positions.chunks_exact(3).map(DVec3::from_slice));
        let indices: Vec<u32> = model.mesh.indices.iter().map(|index| base + index).collect();
        let mut rest = &indices[..];
        // No list of arities stands for triangles only.
        if model.mesh.face_arities.is_empty() {
            mesh.triangles.extend(indices.chunks_exact(3).map(|face| [face[0], face[1], face[2]]));
        }
        for arity in &model.mesh.face_arities {
            let (face, others) = rest.split_at_checked(*arity as usize).ok_or("a face is cut off")?;
            polygon::add(&mut mesh.triangles, &mesh.vertices, face);
            rest = others;
        }
    }
    Ok(mesh)
}

/// The lines that make the surface: positions, and faces by their positions alone. The rest says nothing about the shape, and
/// the crate tobj stumbles over it: it takes a polyline of three points (`l 1 2 3`) for a triangle, refuses files of which some
/// vertices have a colour, and panics, where overflow is checked, at an index of a normal that is far out of range.
fn surface_only(text: &str) -> String {
    let mut kept = String::with_capacity(text.len());
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let numbers: Vec<&str> = words.collect();
                // A fourth number alone is the weight, more are a colour.
                let count = if numbers.len() == 4 { 4 } else { numbers.len().min(3) };
                kept.push_str("v ");
                kept.push_str(&numbers[..count].join(" "));
            }
            Some("f") => {
                kept.push('f');
                for corner in words {
                    kept.push(' ');
                    // A corner without a position stays as it is, for tobj to refuse.
                    let position = corner.split('/').next().filter(|position| !position.is_empty());
                    kept.push_str(position.unwrap_or(corner));
                }
            }
            _ => continue,
        }
        kept.push('\n');
    }
    kept
}
