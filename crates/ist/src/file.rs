//! The `.ist` file: a packing as bytes.
//!
//! Everything is little-endian. The signature follows PNG's: a byte over 127 and the two kinds of line end
//! reveal a file that was mangled as text.
//!
//! | bytes | content |
//! |---|---|
//! | 8 | signature `89 49 53 54 0D 0A 1A 0A` |
//! | 4 | format version, 2 |
//! | 4 | length `p` of the provenance text |
//! | 8 | sphere count `n` |
//! | 80 | solid: volume, centroid (3), inertia xx yy zz xy xz yz, as f64 |
//! | p | provenance: three UTF-8 lines: generator, source, options |
//! | 44 n | spheres: centre (3), radius, cell volume, centroid of the cell (3), normal (3), as f32 |
//! | 4 | CRC-32 of all bytes before it |

use crate::{InnerSphere, PackingError, SolidProperties, SpherePacking};
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use glam::{DMat3, DVec3, Vec3};

const SIGNATURE: [u8; 8] = *b"\x89IST\r\n\x1a\n";
const VERSION: u32 = 2;
const HEADER: usize = 8 + 4 + 4 + 8 + 80;
const SPHERE: usize = 44;
const CHECKSUM: usize = 4;
/// No honest provenance is longer; a damaged length must not ask for gigabytes.
const MAX_PROVENANCE: usize = 1 << 16;

/// Where a packing comes from, so that a cached file can be compared with a new request.
///
/// A file holds each as one line: control characters become blanks, and what is beyond 4,096 characters is left out.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Provenance {
    /// Program and version that made the packing, for example `rapier-ist-packer 0.1.0`.
    pub generator: String,
    /// What was packed: name and content hash of the mesh.
    pub source: String,
    /// The options it was packed with.
    pub options: String,
}

/// Why bytes are not an `.ist` file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// The file could not be read.
    #[cfg(feature = "std")]
    #[error("cannot read {}", path.display())]
    Io {
        /// The file.
        path: std::path::PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// The first bytes are not those of an `.ist` file.
    #[error("not an .ist file; pack the mesh first: packer pack MESH -o OUT.ist")]
    Signature,
    /// Written by another version of this crate.
    #[error(
        "the file has version {found} of the .ist format, and version {VERSION} is read here; pack the mesh again, or update rapier-ist-core if the file is the newer one"
    )]
    Version {
        /// Version in the file.
        found: u32,
    },
    /// Fewer or more bytes than the header announces.
    #[error(
        "the file has {found} bytes where its header announces {expected}: it is truncated or damaged; pack the mesh again"
    )]
    Length {
        /// Bytes announced.
        expected: u64,
        /// Bytes found.
        found: u64,
    },
    /// The checksum does not match.
    #[error("the checksum does not match: the file is damaged; pack the mesh again")]
    Checksum,
    /// The provenance is not three lines of UTF-8.
    #[error("the provenance is unreadable: the file is damaged; pack the mesh again")]
    Provenance,
    /// The spheres are not a packing.
    #[error("the file holds no valid packing: {0}")]
    Packing(#[from] PackingError),
}

impl SpherePacking {
    /// The `.ist` file of this packing. Equal packings give equal bytes.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let provenance = self.provenance().to_text();
        let mut out =
            Vec::with_capacity(HEADER + provenance.len() + SPHERE * self.spheres().len() + CHECKSUM);
        out.extend_from_slice(&SIGNATURE);
        out.extend_from_slice(&VERSION.to_le_bytes());
        out.extend_from_slice(&(provenance.len() as u32).to_le_bytes());
        out.extend_from_slice(&(self.spheres().len() as u64).to_le_bytes());
        for number in solid_numbers(self.solid()) {
            out.extend_from_slice(&number.to_le_bytes());
        }
        out.extend_from_slice(provenance.as_bytes());
        for s in self.spheres() {
            let [x, y, z] = s.center.to_array();
            let [cx, cy, cz] = s.cell_centroid.to_array();
            let [nx, ny, nz] = s.normal.to_array();
            for number in [x, y, z, s.radius, s.cell_volume, cx, cy, cz, nx, ny, nz] {
                out.extend_from_slice(&number.to_le_bytes());
            }
        }
        out.extend_from_slice(&crc32fast::hash(&out).to_le_bytes());
        out
    }

    /// Reads an `.ist` file from memory.
    ///
    /// # Errors
    /// [`FileError`] names what is wrong; every byte is covered by the checksum, and the spheres are checked
    /// as in [`SpherePacking::new`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, FileError> {
        if bytes.len() < SIGNATURE.len() || bytes[..SIGNATURE.len()] != SIGNATURE {
            return Err(FileError::Signature);
        }
        let length =
            |expected: usize| FileError::Length { expected: expected as u64, found: bytes.len() as u64 };
        if bytes.len() < HEADER + CHECKSUM {
            return Err(length(HEADER + CHECKSUM));
        }
        let mut at = SIGNATURE.len();
        let version = u32::from_le_bytes(take(bytes, &mut at));
        if version != VERSION {
            return Err(FileError::Version { found: version });
        }
        let provenance_length = u32::from_le_bytes(take(bytes, &mut at)) as usize;
        if provenance_length > MAX_PROVENANCE {
            return Err(FileError::Provenance);
        }
        let count = u64::from_le_bytes(take(bytes, &mut at));
        let expected = u128::from(count) * SPHERE as u128 + (HEADER + provenance_length + CHECKSUM) as u128;
        if expected != bytes.len() as u128 {
            return Err(FileError::Length {
                expected: expected.min(u128::from(u64::MAX)) as u64,
                found: bytes.len() as u64,
            });
        }
        let (content, checksum) = bytes.split_at(bytes.len() - CHECKSUM);
        if checksum != crc32fast::hash(content).to_le_bytes() {
            return Err(FileError::Checksum);
        }
        let numbers = core::array::from_fn(|_| f64::from_le_bytes(take(bytes, &mut at)));
        let solid = solid_from_numbers(numbers);
        let text =
            core::str::from_utf8(&bytes[at..at + provenance_length]).map_err(|_| FileError::Provenance)?;
        let provenance = Provenance::from_text(text).ok_or(FileError::Provenance)?;
        at += provenance_length;
        let spheres = content[at..]
            .chunks_exact(SPHERE)
            .map(|record| {
                let mut at = 0;
                let mut number = || f32::from_le_bytes(take(record, &mut at));
                InnerSphere {
                    center: Vec3::new(number(), number(), number()),
                    radius: number(),
                    cell_volume: number(),
                    cell_centroid: Vec3::new(number(), number(), number()),
                    normal: Vec3::new(number(), number(), number()),
                }
            })
            .collect();
        Ok(Self::new(spheres, solid)?.with_provenance(provenance))
    }

    /// Reads an `.ist` file.
    ///
    /// # Errors
    /// As [`SpherePacking::from_bytes`], and [`FileError::Io`] where the file cannot be read.
    #[cfg(feature = "std")]
    pub fn load(path: impl AsRef<std::path::Path>) -> Result<Self, FileError> {
        let path = path.as_ref();
        let io_error = |source| FileError::Io { path: path.into(), source };
        // To read from a pipe would be to wait for whoever writes to it.
        if !std::fs::metadata(path).map_err(io_error)?.is_file() {
            return Err(io_error(std::io::Error::other("it is no regular file")));
        }
        let bytes = std::fs::read(path).map_err(io_error)?;
        Self::from_bytes(&bytes)
    }
}

impl Provenance {
    fn to_text(&self) -> String {
        // One line each: a line end or an endless name inside a field would tear the record apart.
        let line = |field: &str| -> String {
            field.chars().map(|c| if c.is_control() { ' ' } else { c }).take(4096).collect()
        };
        [line(&self.generator), line(&self.source), line(&self.options)].join("\n")
    }

    fn from_text(text: &str) -> Option<Self> {
        let mut lines = text.split('\n').map(ToString::to_string);
        let provenance = Self { generator: lines.next()?, source: lines.next()?, options: lines.next()? };
        lines.next().is_none().then_some(provenance)
    }
}

fn solid_numbers(solid: &SolidProperties) -> [f64; 10] {
    let (c, i) = (solid.centroid, solid.unit_inertia);
    [solid.volume, c.x, c.y, c.z, i.x_axis.x, i.y_axis.y, i.z_axis.z, i.x_axis.y, i.x_axis.z, i.y_axis.z]
}

fn solid_from_numbers([volume, x, y, z, xx, yy, zz, xy, xz, yz]: [f64; 10]) -> SolidProperties {
    SolidProperties {
        volume,
        centroid: DVec3::new(x, y, z),
        unit_inertia: DMat3::from_cols(
            DVec3::new(xx, xy, xz),
            DVec3::new(xy, yy, yz),
            DVec3::new(xz, yz, zz),
        ),
    }
}

/// The next `N` bytes; the caller has checked the length.
fn take<const N: usize>(bytes: &[u8], at: &mut usize) -> [u8; N] {
    let mut out = [0; N];
    out.copy_from_slice(&bytes[*at..*at + N]);
    *at += N;
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn packing() -> SpherePacking {
        let spheres = (0..5).map(|i| InnerSphere {
            center: Vec3::new(i as f32, 0.5, -0.25),
            radius: 0.3,
            cell_volume: 0.2,
            cell_centroid: Vec3::new(i as f32, 0.5, -0.2),
            normal: Vec3::Z,
        });
        let provenance = Provenance {
            generator: "test 1".into(),
            source: "five balls".into(),
            options: "none\nat all".into(),
        };
        SpherePacking::new(spheres.collect(), SolidProperties::ball(1.0)).unwrap().with_provenance(provenance)
    }

    #[test]
    fn bytes_round_trip() {
        let back = SpherePacking::from_bytes(&packing().to_bytes()).unwrap();
        assert_eq!(back.spheres(), packing().spheres());
        assert_eq!(back.solid(), packing().solid());
        assert_eq!(back.provenance().options, "none at all");
        assert_eq!(back.to_bytes(), packing().to_bytes());
    }

    #[test]
    fn any_flipped_byte_is_noticed() {
        let bytes = packing().to_bytes();
        for at in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[at] ^= 0x10;
            assert!(SpherePacking::from_bytes(&damaged).is_err(), "byte {at}");
        }
    }

    #[test]
    fn any_truncation_is_noticed() {
        let bytes = packing().to_bytes();
        for length in 0..bytes.len() {
            assert!(SpherePacking::from_bytes(&bytes[..length]).is_err(), "{length} bytes");
        }
    }

    #[test]
    fn an_endless_provenance_is_cut_not_refused() {
        let long = Provenance { source: "x".repeat(100_000), ..Provenance::default() };
        let packing = packing().with_provenance(long);
        assert!(SpherePacking::from_bytes(&packing.to_bytes()).is_ok());
    }
}
