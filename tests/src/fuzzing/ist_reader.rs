//! The reader of `.ist` files.
//!
//! Whatever the bytes: an error or a packing, no panic, and no memory beyond that of the bytes. What is read is written
//! and read again unchanged, and makes a tree whose overlap with itself has no NaN.

use super::numbers::{any_float, below, raw};
use arbitrary::Unstructured;
use glamx::Pose3;
use ist::{InnerSphereTree, OverlapWorkspace, SpherePacking};

const SIGNATURE: &[u8] = b"\x89IST\r\n\x1a\n";
const VERSION: u32 = 2;
/// Number of values of the solid in the header, and of a sphere.
const SOLID: usize = 10;
const SPHERE: usize = 11;
/// Most spheres of which a tree is made here.
const MOST_SPHERES: usize = 200;

/// The bytes as a file, the same under a right checksum, and a file of which they are the numbers.
pub fn check(data: &[u8]) {
    read(data);
    let content = data.len().saturating_sub(4);
    read(&sealed(data[..content].to_vec()));
    read(&sealed(records(&mut Unstructured::new(data))));
}

/// `content` followed by its checksum.
#[must_use]
pub fn sealed(mut content: Vec<u8>) -> Vec<u8> {
    let checksum = crc32fast::hash(&content);
    content.extend(checksum.to_le_bytes());
    content
}

/// All of a file but its checksum, mostly with a right header.
fn records(u: &mut Unstructured) -> Vec<u8> {
    let count = u64::from(below(u, 12));
    let text = match below(u, 4) {
        0 => "a\nb\nc".as_bytes().to_vec(),
        1 => "\n\n".as_bytes().to_vec(),
        _ => {
            let length = usize::from(below(u, 40)).min(u.len());
            u.bytes(length).unwrap_or_default().to_vec()
        }
    };
    let lie = below(u, 16);
    let version = if lie == 1 { raw(u) } else { VERSION };
    let text_length = if lie == 2 { raw(u) } else { text.len() as u32 };
    let announced = if lie == 3 { raw(u) } else { count };
    let mut out = SIGNATURE.to_vec();
    out.extend(version.to_le_bytes());
    out.extend(text_length.to_le_bytes());
    out.extend(announced.to_le_bytes());
    for i in 0..SOLID {
        let value: f64 = match below(u, 4) {
            0 => f64::from_bits(raw(u)),
            _ if i == 0 => 1.0,
            _ => f64::from(any_float(u)),
        };
        out.extend(value.to_le_bytes());
    }
    out.extend(text);
    for _ in 0..count {
        let is_usual = below(u, 8) > 0;
        for i in 0..SPHERE {
            // Radius and volume are positive and the normal, which is last, is a unit vector.
            let value = match i {
                3 | 4 if is_usual => any_float(u).abs(),
                8..=10 if is_usual => f32::from(i == 8),
                _ => any_float(u),
            };
            out.extend(value.to_le_bytes());
        }
    }
    out
}

/// Reads, and checks what was read.
fn read(bytes: &[u8]) {
    let Ok(packing) = SpherePacking::from_bytes(bytes) else { return };
    let written = packing.to_bytes();
    // Control characters and endless lines of the provenance are not written; all else is.
    let provenance = packing.provenance();
    let fields = [&provenance.generator, &provenance.source, &provenance.options];
    let is_plain = |field: &&String| field.chars().count() <= 4096 && !field.chars().any(char::is_control);
    if fields.iter().all(is_plain) {
        assert_eq!(written, bytes, "what was read is not what is written");
    }
    let again = match SpherePacking::from_bytes(&written) {
        Ok(again) => again,
        Err(error) => unreachable!("a packing that was written is not read: {error}"),
    };
    assert_eq!((again.spheres(), again.solid()), (packing.spheres(), packing.solid()));
    assert_eq!(again.to_bytes(), written);
    assert!(!packing.coverage().is_nan());
    if packing.spheres().len() <= MOST_SPHERES {
        let tree = InnerSphereTree::new(&packing);
        let overlap = tree.overlap(&tree, &Pose3::IDENTITY, &mut OverlapWorkspace::default());
        let vectors = [overlap.centroid, overlap.gradient, overlap.force, overlap.torque];
        assert!(!(overlap.volume.is_nan() || vectors.iter().any(|v| v.is_nan())), "{overlap:?}");
    }
}
