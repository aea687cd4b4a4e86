//! Wavefront OBJ.

use super::{Parsed, polygon};
use crate::TriangleMesh;
use glam::DVec3;
use std::borrow::Cow;

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
/// vertices have a colour, comments behind numbers and lines that go on, and panics, where overflow is checked, at an index of a
/// normal that is far out of range.
fn surface_only(text: &str) -> String {
    let mut kept = String::with_capacity(text.len());
    let mut lines = text.lines().map(without_comment);
    while let Some(line) = lines.next() {
        match line.split_whitespace().next().map(|word| word.trim_end_matches('\\')) {
            Some("v") => {
                let line = continued(line, &mut lines);
                let numbers: Vec<&str> = line.split_whitespace().skip(1).collect();
                // A fourth number alone is the weight, more are a colour.
                let count = if numbers.len() == 4 { 4 } else { numbers.len().min(3) };
                kept.push_str("v ");
                kept.push_str(&numbers[..count].join(" "));
            }
            Some("f") => {
                kept.push('f');
                for corner in continued(line, &mut lines).split_whitespace().skip(1) {
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

fn without_comment(line: &str) -> &str {
    line.split_once('#').map_or(line, |(line, _)| line)
}

/// A line with those in which it goes on: a backslash at its end stands for a space. Only of lines that matter: names of folders
/// end in one, too.
fn continued<'a>(line: &'a str, rest: &mut impl Iterator<Item = &'a str>) -> Cow<'a, str> {
    let mut whole = Cow::Borrowed(line);
    while let Some(before) = whole.trim_end().strip_suffix('\\').map(str::len) {
        let whole = whole.to_mut();
        whole.truncate(before);
        whole.push(' ');
        whole.push_str(rest.next().unwrap_or_default());
    }
    whole
}
