//! PLY, ASCII and binary.

use super::{Parsed, polygon};
use crate::TriangleMesh;
use glam::DVec3;
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{Property, PropertyAccess, PropertyAccessResult};

/// Last line of the header.
const END: &[u8] = b"end_header";

pub(super) fn parse(bytes: &[u8]) -> Parsed {
    // Comments in other encodings than UTF-8 do no harm.
    let mut readable = bytes.to_vec();
    let header = bytes.windows(END.len()).position(|window| window == END).unwrap_or_default();
    readable[..header].iter_mut().filter(|byte| !byte.is_ascii()).for_each(|byte| *byte = b'?');
    let mut reader = Reader::new(&readable[..]);
    let header = Parser::<Skipped>::new().read_header(&mut reader).map_err(|error| error.to_string())?;
    let mut mesh = TriangleMesh::default();
    let mut polygons = Vec::new();
    for definition in header.elements.values() {
        // A damaged count must not reserve memory for elements that the file cannot hold.
        if definition.count > bytes.len() {
            return Err(format!(
                "{} elements announced in a file of {} bytes",
                definition.count,
                bytes.len()
            ));
        }
        match definition.name.as_str() {
            "vertex" => {
                let vertices = Parser::<Vertex>::new()
                    .read_payload_for_element(&mut reader, definition, &header)
                    .map_err(|error| error.to_string())?;
                mesh.vertices.extend(vertices.into_iter().map(|v| v.0));
            }
            "face" => {
                let faces = Parser::<Face>::new()
                    .read_payload_for_element(&mut reader, definition, &header)
                    .map_err(|error| error.to_string())?;
                polygons.extend(faces);
            }
            _ => {
                Parser::<Skipped>::new()
                    .read_payload_for_element(&mut reader, definition, &header)
                    .map_err(|error| error.to_string())?;
            }
        }
    }
    for face in &polygons {
        polygon::add(&mut mesh.triangles, &mesh.vertices, &face.0);
    }
    Ok(mesh)
}

struct Vertex(DVec3);

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self(DVec3::ZERO)
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let axis = match name {
            "x" => 0,
            "y" => 1,
            "z" => 2,
            _ => return PropertyAccessResult::Ignored,
        };
        self.0[axis] = match property {
            Property::Float(value) => value.into(),
            Property::Double(value) => value,
            Property::Char(value) => value.into(),
            Property::UChar(value) => value.into(),
            Property::Short(value) => value.into(),
            Property::UShort(value) => value.into(),
            Property::Int(value) => value.into(),
            Property::UInt(value) => value.into(),
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}

struct Face(Vec<u32>);

impl PropertyAccess for Face {
    fn new() -> Self {
        Self(Vec::new())
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !matches!(name, "vertex_indices" | "vertex_index") {
            return PropertyAccessResult::Ignored;
        }
        // A negative index becomes one that is out of range and is reported as such.
        let index = |i: i64| u32::try_from(i).unwrap_or(u32::MAX);
        self.0 = match property {
            Property::ListChar(list) => list.into_iter().map(|i| index(i.into())).collect(),
            Property::ListUChar(list) => list.into_iter().map(u32::from).collect(),
            Property::ListShort(list) => list.into_iter().map(|i| index(i.into())).collect(),
            Property::ListUShort(list) => list.into_iter().map(u32::from).collect(),
            Property::ListInt(list) => list.into_iter().map(|i| index(i.into())).collect(),
            Property::ListUInt(list) => list,
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}

/// An element whose content does not matter here.
struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}
