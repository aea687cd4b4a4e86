//! The two messages that Foxglove has no schema for: contacts and metrics.
//!
//! Protobuf, as everything in the file: viewers show JSON channels as raw bytes at best. The schemas that go into
//! the file are built here next to the structs; a test holds the two together.

use foxglove::messages::Vector3;
use foxglove::{Encode, Schema};
use prost::Message;
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{DescriptorProto, FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet};

/// `rapier_ist.Contacts`: all volume contacts of a step.
#[derive(Clone, PartialEq, Message)]
pub(crate) struct Contacts {
    #[prost(message, repeated, tag = "1")]
    pub(crate) contacts: Vec<Contact>,
}

/// `rapier_ist.Contact`: one overlapping pair, world frame, SI units.
#[derive(Clone, PartialEq, Message)]
pub(crate) struct Contact {
    #[prost(string, tag = "1")]
    pub(crate) body_a: String,
    #[prost(string, tag = "2")]
    pub(crate) body_b: String,
    #[prost(double, tag = "3")]
    pub(crate) volume: f64,
    #[prost(double, tag = "4")]
    pub(crate) depth: f64,
    #[prost(message, optional, tag = "5")]
    pub(crate) centroid: Option<Vector3>,
    #[prost(message, optional, tag = "6")]
    pub(crate) force: Option<Vector3>,
    #[prost(message, optional, tag = "7")]
    pub(crate) torque: Option<Vector3>,
    #[prost(message, optional, tag = "8")]
    pub(crate) relative_velocity: Option<Vector3>,
    #[prost(message, repeated, tag = "9")]
    pub(crate) patches: Vec<Patch>,
}

/// `rapier_ist.Patch`: the part of a contact that pushes in about the same direction, world frame, SI units.
#[derive(Clone, PartialEq, Message)]
pub(crate) struct Patch {
    #[prost(double, tag = "1")]
    pub(crate) volume: f64,
    #[prost(double, tag = "2")]
    pub(crate) depth: f64,
    #[prost(message, optional, tag = "3")]
    pub(crate) centroid: Option<Vector3>,
    #[prost(message, optional, tag = "4")]
    pub(crate) force: Option<Vector3>,
    #[prost(message, optional, tag = "5")]
    pub(crate) torque: Option<Vector3>,
    #[prost(message, optional, tag = "6")]
    pub(crate) relative_velocity: Option<Vector3>,
}

/// `rapier_ist.Metrics`: sums over the world after a step, SI units.
#[derive(Clone, PartialEq, Message)]
pub(crate) struct Metrics {
    #[prost(uint64, tag = "1")]
    pub(crate) step: u64,
    #[prost(double, tag = "2")]
    pub(crate) kinetic_energy: f64,
    #[prost(double, tag = "3")]
    pub(crate) potential_energy: f64,
    #[prost(double, tag = "4")]
    pub(crate) deepest_overlap: f64,
    #[prost(double, tag = "5")]
    pub(crate) overlap_volume: f64,
    #[prost(uint32, tag = "6")]
    pub(crate) contact_count: u32,
    #[prost(uint32, tag = "7")]
    pub(crate) awake_bodies: u32,
    #[prost(message, optional, tag = "8")]
    pub(crate) timings: Option<Timings>,
}

/// `rapier_ist.Timings`: wall times of a step.
#[derive(Clone, PartialEq, Message)]
pub(crate) struct Timings {
    #[prost(double, tag = "1")]
    pub(crate) query_ms: f64,
    #[prost(double, tag = "2")]
    pub(crate) solve_ms: f64,
    #[prost(double, tag = "3")]
    pub(crate) step_ms: f64,
}

const CONTACTS: &str = "rapier_ist.Contacts";
const METRICS: &str = "rapier_ist.Metrics";

/// Implements [`Encode`] for a message of [`file_descriptors`].
macro_rules! encode {
    ($message:ty, $name:expr) => {
        impl Encode for $message {
            type Error = prost::EncodeError;

            fn get_schema() -> Option<Schema> {
                Some(Schema::new($name, "protobuf", file_descriptors().encode_to_vec()))
            }

            fn get_message_encoding() -> String {
                "protobuf".into()
            }

            fn encode(&self, buffer: &mut impl foxglove::bytes::BufMut) -> Result<(), Self::Error> {
                Message::encode(self, buffer)
            }
        }
    };
}
encode!(Contacts, CONTACTS);
encode!(Metrics, METRICS);

/// `rapier_ist.proto` and the file it imports, dependencies first as readers ask for.
fn file_descriptors() -> FileDescriptorSet {
    let vector = Vector3::get_schema()
        .and_then(|schema| FileDescriptorSet::decode(schema.data.as_ref()).ok())
        .unwrap_or_default();
    let dependency = vector.file.iter().filter_map(|file| file.name.clone()).collect();
    let own = FileDescriptorProto {
        name: Some("rapier_ist.proto".into()),
        package: Some("rapier_ist".into()),
        syntax: Some("proto3".into()),
        dependency,
        message_type: descriptors(),
        ..Default::default()
    };
    FileDescriptorSet { file: vector.file.into_iter().chain([own]).collect() }
}

/// The messages above, fields in the order of their tags.
fn descriptors() -> Vec<DescriptorProto> {
    use FieldType::{Count, Double, Many, One, Text, Unsigned64};
    const VECTOR: &str = ".foxglove.Vector3";
    vec![
        message("Contacts", &[("contacts", Many(".rapier_ist.Contact"))]),
        message(
            "Contact",
            &[
                ("body_a", Text),
                ("body_b", Text),
                ("volume", Double),
                ("depth", Double),
                ("centroid", One(VECTOR)),
                ("force", One(VECTOR)),
                ("torque", One(VECTOR)),
                ("relative_velocity", One(VECTOR)),
                ("patches", Many(".rapier_ist.Patch")),
            ],
        ),
        message(
            "Patch",
            &[
                ("volume", Double),
                ("depth", Double),
                ("centroid", One(VECTOR)),
                ("force", One(VECTOR)),
                ("torque", One(VECTOR)),
                ("relative_velocity", One(VECTOR)),
            ],
        ),
        message(
            "Metrics",
            &[
                ("step", Unsigned64),
                ("kinetic_energy", Double),
                ("potential_energy", Double),
                ("deepest_overlap", Double),
                ("overlap_volume", Double),
                ("contact_count", Count),
                ("awake_bodies", Count),
                ("timings", One(".rapier_ist.Timings")),
            ],
        ),
        message("Timings", &[("query_ms", Double), ("solve_ms", Double), ("step_ms", Double)]),
    ]
}

#[derive(Clone, Copy)]
enum FieldType {
    Text,
    Double,
    Count,
    Unsigned64,
    One(&'static str),
    Many(&'static str),
}

/// A message whose fields are numbered from 1.
fn message(name: &str, fields: &[(&str, FieldType)]) -> DescriptorProto {
    let field = |(number, &(name, field_type)): (i32, &(&str, FieldType))| {
        let (kind, type_name) = match field_type {
            FieldType::Text => (Type::String, None),
            FieldType::Double => (Type::Double, None),
            FieldType::Count => (Type::Uint32, None),
            FieldType::Unsigned64 => (Type::Uint64, None),
            FieldType::One(message) | FieldType::Many(message) => (Type::Message, Some(message.into())),
        };
        let repeated = matches!(field_type, FieldType::Many(_));
        FieldDescriptorProto {
            name: Some(name.into()),
            number: Some(number),
            label: Some(if repeated { Label::Repeated } else { Label::Optional } as i32),
            r#type: Some(kind as i32),
            type_name,
            ..Default::default()
        }
    };
    DescriptorProto {
        name: Some(name.into()),
        field: (1..).zip(fields).map(field).collect(),
        ..Default::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use prost::encoding::{DecodeContext, WireType, decode_key, skip_field};

    /// Tag and wire type of every field in an encoded message.
    fn wire(message: &impl Message) -> Vec<(u32, WireType)> {
        let bytes = message.encode_to_vec();
        let mut rest = bytes.as_slice();
        let mut keys = Vec::new();
        while !rest.is_empty() {
            let (tag, wire_type) = decode_key(&mut rest).unwrap();
            skip_field(wire_type, tag, &mut rest, DecodeContext::default()).unwrap();
            keys.push((tag, wire_type));
        }
        keys
    }

    /// Tag and wire type of every field as the schema in the file has it.
    fn schema(name: &str) -> Vec<(u32, WireType)> {
        let message = descriptors().into_iter().find(|m| m.name() == name).unwrap();
        let wire_type = |kind| match kind {
            Type::Double => WireType::SixtyFourBit,
            Type::Uint32 | Type::Uint64 => WireType::Varint,
            _ => WireType::LengthDelimited,
        };
        message.field.iter().map(|f| (f.number() as u32, wire_type(f.r#type()))).collect()
    }

    #[test]
    fn structs_and_schema_agree() {
        let vector = Some(Vector3 { x: 1.0, y: 2.0, z: 3.0 });
        let patch = Patch {
            volume: 1.0,
            depth: 1.0,
            centroid: vector,
            force: vector,
            torque: vector,
            relative_velocity: vector,
        };
        let contact = Contact {
            body_a: "a".into(),
            body_b: "b".into(),
            volume: 1.0,
            depth: 1.0,
            centroid: vector,
            force: vector,
            torque: vector,
            relative_velocity: vector,
            patches: vec![patch.clone()],
        };
        let timings = Timings { query_ms: 1.0, solve_ms: 1.0, step_ms: 1.0 };
        let metrics = Metrics {
            step: 1,
            kinetic_energy: 1.0,
            potential_energy: 1.0,
            deepest_overlap: 1.0,
            overlap_volume: 1.0,
            contact_count: 1,
            awake_bodies: 1,
            timings: Some(timings.clone()),
        };
        assert_eq!(wire(&contact), schema("Contact"));
        assert_eq!(wire(&patch), schema("Patch"));
        assert_eq!(wire(&timings), schema("Timings"));
        assert_eq!(wire(&metrics), schema("Metrics"));
        assert_eq!(wire(&Contacts { contacts: vec![contact] }), schema("Contacts"));
    }

    #[test]
    fn the_schema_holds_its_imports() {
        let files = file_descriptors().file;
        let own = files.last().unwrap();
        assert_eq!(own.name(), "rapier_ist.proto");
        assert!(!own.dependency.is_empty());
        for import in &own.dependency {
            assert!(files.iter().any(|file| file.name() == import));
        }
    }
}
