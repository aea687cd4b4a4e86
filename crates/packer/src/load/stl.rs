//! STL, binary and ASCII.

use super::Parsed;
use crate::TriangleMesh;
use glam::DVec3;
use std::io::Cursor;

const HEADER: usize = 80;
const RECORD: usize = 50;

pub(super) fn parse(bytes: &[u8]) -> Parsed {
    let normalised = normalise(bytes);
    let mut cursor = Cursor::new(normalised);
    let reader = stl_io::create_stl_reader(&mut cursor).map_err(|error| error.to_string())?;
    let mut mesh = TriangleMesh::default();
    for triangle in reader {
        let triangle = triangle.map_err(|error| error.to_string())?;
        let first = mesh.vertices.len() as u32;
        mesh.vertices.extend(triangle.vertices.map(|v| DVec3::from_array(v.0.map(f64::from))));
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    Ok(mesh)
}

/// `stl_io` takes every file for ASCII that begins with `solid` and a blank, and none else. Some exporters write that word
/// into binary headers, others leave out the name, or begin with a mark or a blank line.
fn normalise(bytes: &[u8]) -> Vec<u8> {
    if let Some(end) = end_of_binary(bytes) {
        let mut out = bytes[..end].to_vec();
        out[..HEADER].fill(b' ');
        return out;
    }
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes).trim_ascii_start();
    if text.get(..5).is_some_and(|start| start.eq_ignore_ascii_case(b"solid")) {
        one_solid(text)
    } else {
        bytes.to_vec()
    }
}

/// Where the last facet of a binary file ends. The length tells it from text; and where something follows the facets, the zeros
/// in their number, of which text has none.
fn end_of_binary(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(HEADER..HEADER + 4)?;
    let facets = u32::from_le_bytes([count[0], count[1], count[2], count[3]]) as usize;
    let end = facets.checked_mul(RECORD)?.checked_add(HEADER + 4)?;
    (bytes.len() == end || (bytes.len() > end && count.contains(&0))).then_some(end)
}

/// All solids of an ASCII file as one without a name: `stl_io` reads the first only, and names may be in any
/// encoding. Normals are left out, as some exporters write `nan` for those of thin facets. A file that is cut off stays so.
fn one_solid(bytes: &[u8]) -> Vec<u8> {
    let mut out = b"solid \n".to_vec();
    let mut is_complete = false;
    for line in bytes.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii).filter(|line| !line.is_empty()) {
        let line = line.to_ascii_lowercase();
        is_complete = line.starts_with(b"endsolid");
        if is_complete || line.starts_with(b"solid") {
            continue;
        }
        out.extend(if line.starts_with(b"facet") { b"facet normal 0 0 0" } else { &line[..] });
        out.push(b'\n');
    }
    if is_complete {
        out.extend(b"endsolid \n");
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_binary_file_that_calls_itself_solid_is_read_as_binary() {
        let mut bytes = vec![b' '; HEADER];
        bytes[..6].copy_from_slice(b"solid ");
        bytes.extend(1_u32.to_le_bytes());
        bytes.extend(
            [0.0_f32, 0., 1., 0., 0., 0., 1., 0., 0., 0., 1., 0.].iter().flat_map(|x| x.to_le_bytes()),
        );
        bytes.extend([0, 0]);
        assert_eq!(parse(&bytes).unwrap().vertices[1], DVec3::X);
    }

    #[test]
    fn an_ascii_file_without_a_name_is_read() {
        let text = "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n";
        assert_eq!(parse(text.as_bytes()).unwrap().triangles.len(), 1);
    }
}
