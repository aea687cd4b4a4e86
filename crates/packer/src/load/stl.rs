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

/// `stl_io` takes every file for ASCII that begins with `solid` and a blank, and none else. Some exporters
/// write that word into binary headers, others leave out the name: the length tells binary files apart.
fn normalise(bytes: &[u8]) -> Vec<u8> {
    let is_binary = bytes.get(HEADER..HEADER + 4).is_some_and(|count| {
        let count = u32::from_le_bytes([count[0], count[1], count[2], count[3]]) as usize;
        bytes.len() == HEADER + 4 + count * RECORD
    });
    if is_binary {
        let mut out = bytes.to_vec();
        out[..HEADER].fill(b' ');
        out
    } else if bytes.get(..5).is_some_and(|start| start.eq_ignore_ascii_case(b"solid")) {
        one_solid(bytes)
    } else {
        bytes.to_vec()
    }
}

/// All solids of an ASCII file as one without a name: `stl_io` reads the first only, and names may be in any
/// encoding. A file that is cut off stays so.
fn one_solid(bytes: &[u8]) -> Vec<u8> {
    let mut out = b"solid \n".to_vec();
    let mut is_complete = false;
    for line in bytes.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii).filter(|line| !line.is_empty()) {
        let line = line.to_ascii_lowercase();
        is_complete = line.starts_with(b"endsolid");
        if !is_complete && !line.starts_with(b"solid") {
            out.extend(line);
            out.push(b'\n');
        }
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
